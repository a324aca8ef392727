"""The main job: the cheapest rigid bodies whose load–deflection curve is the reference's within 1 %.

    path error = max |F_model - F_reference| / max |F_reference|

Give a file name to draw the two curves.
"""

import sys

from calibration import calibrate
from scene import load_scene


def main(picture: str | None = None) -> float:
    """Path error of the model that was chosen [%]."""
    result = calibrate(load_scene("cantilever"), target_error=0.01)
    best = result.best
    print(f"{best.push.bodies} bodies, {best.push.joints} {best.model.law} joints, {best.model.rule} rule")
    if picture is not None:
        from calibration.figures import curves

        curves(result).savefig(picture, dpi=120)
    return 100.0 * best.errors.path_max


if __name__ == "__main__":
    print(f"path error {main(*sys.argv[1:]):.2f} %")
