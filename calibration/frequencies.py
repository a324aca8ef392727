"""First natural frequencies, of the reference and of a model."""

from __future__ import annotations

from fem_reference import natural_modes
from scene import Scene
from sim import Model, assemble
from sim import natural_modes as modes_of_joints


def reference_frequency(scene: Scene) -> float:
    """Lowest natural frequency of the reference [Hz]; 0 for a structure that is free to move."""
    try:
        return float(natural_modes(scene, 1).frequency[0])
    except RuntimeError:  # SuperLU's: the stiffness is singular
        return 0.0


def model_frequency(scene: Scene, model: Model) -> float:
    """Lowest natural frequency of ``model`` [Hz]."""
    return float(modes_of_joints(assemble(scene, model, shapes=False).joints)[0][0])
