"""What a step costs: the prices of `calibration.planner.relative_cost`, fitted to the processor times of many models.

    python benchmarks/model_prices.py

Pushes the cantilever and the portal frame with every law and several numbers of joints and fibres, and prints the
prices that fit best, in microseconds of this machine, and as multiples of the price of a joint.
"""

import numpy as np
from scipy.optimize import nnls

from calibration.comparable_push import push_model
from scene import load_scene
from sim import Model

REPEATS = 5
LAWS = (("elastic-plastic", 4), ("interaction", 4), ("fibre", 8), ("fibre", 16), ("fibre", 32))
PRICES = ("step", "joint", "each further Newton step", "interaction, a Newton step", "fibre, a Newton step")


def main() -> None:
    rows, times = [], []
    for name in ("cantilever", "portal-frame"):
        scene = load_scene(name)
        way = np.linspace(0.0, scene.push.stops()[0], 101)
        for law, fibres in LAWS:
            for joints in (3, 5, 8, 12):
                pushes = [push_model(scene, Model("lobatto", joints, law, fibres), way) for _ in range(REPEATS)]
                push = pushes[0]
                solved = push.newton_steps * push.joints
                more = (solved * (law == "interaction"), solved * fibres * (law == "fibre"))
                rows.append((1.0, push.joints, solved - push.joints, *more))
                times.append(1e6 * min(p.seconds for p in pushes) / push.steps)
                print(f"{name:14} {law:16} {fibres:3} fibres {joints:3} joints a member: {times[-1]:7.2f} µs a step")
    A, b = np.array(rows), np.array(times)
    prices, _ = nnls(A / b[:, None], np.ones_like(b))
    off = A @ prices / b - 1.0
    for name, price in zip(PRICES, prices.tolist(), strict=True):
        print(f"{name:26} {price:8.4f} µs {price / prices[1]:8.3f}")
    print(f"off by {100.0 * np.sqrt(np.mean(off**2)):.0f} % in the mean, {100.0 * np.abs(off).max():.0f} % at most")


if __name__ == "__main__":
    main()
