"""The structure solver, compiled: one implicit step of a whole structure inside Chipmunk's solver.

| file | job |
|---|---|
| ``layout``, ``views`` | what lies where in the memory that kernels and `sim.structure` share |
| ``bare`` | arrays as kernels hand them to each other |
| ``kinematics``, ``inertia`` | deformations of the joints and their gradient; masses, implicit geometric stiffness |
| ``blocks`` | the matrix: assembly, L D Lᵀ by 3 × 3 blocks, substitution |
| ``residual``, ``newton`` | impulses of the joints: Newton's method with a line search |
| ``approach``, ``admissible`` | joints made soft where that gets nowhere; none bears more than it can |
| ``spread`` | a load pattern under displacement control |
| ``contacts``, ``complement``, ``delassus``, ``rows`` | contacts of structures, solved through the structures |
| ``abutting`` | contacts of bodies that touch where they are joined: nobody solves them |
| ``active_rows`` | contacts where sweeps, or turns between contacts and joints, would take forever |
| ``ties``, ``tie_impulses`` | Chipmunk's own constraints at the structures' bodies, solved through the structures |
| ``tie_blows`` | blows that such constraints give: what a rope catches, say |
| ``restitution``, ``overlap`` | no more bounce than there is energy for; taking out overlap |
| ``owners``, ``others`` | which structures are solved together, and the bodies that move with them |
| ``pushes`` | where steps in parts leave bodies when the next step has another length |
| ``commit``, ``halfway`` | the end of a step: plastic state, breaking, what the joints bore |
| ``energy``, ``guard``, ``strained`` | the ledger, and no energy from nowhere; what was strained before |
| ``resolved`` | the average-acceleration rule only where it resolves how bodies turn |
| ``refusal``, ``noted`` | a step that is refused, and what else it has changed in the space |
| ``idle`` | joints that another one acts for, out of Chipmunk's list while it solves |
| ``loose``, ``reached``, ``links`` | bodies without joints; those reached by Chipmunk's own constraints, and these |
| ``bodies``, ``moves``, ``settle`` | velocities and places; joints, contacts and ties in turn until they agree |
| ``blow``, ``sudden`` | when a step is taken in parts, inside the one that Chipmunk takes |
| ``parts``, ``part``, ``lengths`` | how it is taken in them, and how long they are |
| ``near``, ``beside``, ``late`` | contacts that come, go, or are beside a group; bodies that touched before a step |
| ``step``, ``callbacks`` | one step of a structure, and the functions that Chipmunk calls |
"""

from sim.kernels.callbacks import compiled_callbacks

__all__ = ["compiled_callbacks"]
