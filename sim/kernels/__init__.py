"""The structure solver, compiled: one implicit step of a whole structure inside Chipmunk's solver.

| file | job |
|---|---|
| ``layout``, ``views`` | what lies where in the memory that kernels and `sim.structure` share |
| ``kinematics`` | deformations of the joints and their gradient |
| ``inertia`` | masses of the bodies, with geometric stiffness where it must be implicit |
| ``blocks`` | the matrix: assembly, L D Lᵀ by 3 × 3 blocks, substitution |
| ``residual``, ``newton`` | impulses of the joints: Newton's method with a line search |
| ``spread`` | a load pattern under displacement control |
| ``contacts``, ``complement`` | contacts of the structures' bodies, solved through the structures |
| ``restitution`` | no more bounce than there is energy for |
| ``commit`` | the end of a step: plastic state, breaking, what the joints bore |
| ``energy``, ``guard`` | the ledger, and no energy from nowhere |
| ``resolved`` | the average-acceleration rule only where it resolves how bodies turn |
| ``refusal``, ``noted`` | a step that is refused, and what else it has changed in the space |
| ``loose`` | bodies without joints, for the ledger of a space |
| ``bodies``, ``settle`` | velocities and places of the bodies; joints and contacts in turn until they agree |
| ``blow``, ``parts`` | when a step is taken in parts, inside the one that Chipmunk takes, and how |
| ``step``, ``callbacks`` | one step of a structure, and the functions that Chipmunk calls |
"""

from sim.kernels.callbacks import compiled_callbacks

__all__ = ["compiled_callbacks"]
