"""Collapse load of a cantilever from the fibre-beam reference: P = M_p / L, here 29.375 kN."""

from fem_reference import pushover
from scene import load_scene


def main() -> float:
    """Load at the end of the push [kN]."""
    answer = pushover(load_scene("cantilever"))
    print(f"estimated error {100 * answer.error_estimate:.3f} % of the peak load")
    return 1e-3 * float(answer.load[-1])


if __name__ == "__main__":
    print(f"P = {main():.3f} kN")
