"""Which joints, which rule, which step: rigid bodies tuned to the continuum, with the error and what it costs.

>>> from calibration import calibrate
>>> from scene import load_scene
>>> result = calibrate(load_scene("cantilever"), target_error=0.01)
>>> result.target_met
True
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from calibration.fitting import Fit, LoadCase, fit
    from calibration.motion_tuning import MotionCalibration, calibrate_motion
    from calibration.trials import Trial
    from calibration.tuning import Calibration, calibrate

__all__ = ["Calibration", "Fit", "LoadCase", "MotionCalibration", "Trial", "calibrate", "calibrate_motion", "fit"]

_ROOMS = {"Calibration": "tuning", "calibrate": "tuning", "Trial": "trials"}
_ROOMS |= dict.fromkeys(("MotionCalibration", "calibrate_motion"), "motion_tuning")
_ROOMS |= dict.fromkeys(("Fit", "LoadCase", "fit"), "fitting")


def __getattr__(name: str) -> Any:
    # Imported on demand: the command line lives in this package and must answer before the kernels are loaded.
    if name in _ROOMS:
        from importlib import import_module

        return getattr(import_module(f"calibration.{_ROOMS[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
