"""The structure solver, compiled: one implicit step of a whole structure inside Chipmunk's solver.

| file | job |
|---|---|
| ``layout`` | what lies where in the memory that kernels and `sim.structure` share |
| ``kinematics`` | deformations of the joints and their gradient |
| ``blocks`` | the matrix: assembly, L D Lᵀ by 3 × 3 blocks, substitution |
| ``newton`` | impulses of the joints: Newton's method with a line search |
| ``spread`` | a load pattern under displacement control |
| ``contacts`` | contacts of the structure's bodies, solved through the structure |
| ``commit`` | the end of a step: plastic state, breaking, what the joints bore |
| ``callbacks`` | the functions that Chipmunk calls |
"""

from sim.kernels.callbacks import AFTER_STEP, FUNCTIONS

__all__ = ["AFTER_STEP", "FUNCTIONS"]
