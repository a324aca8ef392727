"""Speed of the main parts; run with ``pytest benchmarks``. Compare within one run: machines differ and drift."""

import itertools
import subprocess
import sys
import timeit

import numpy as np
import pymunk
import pytest
from pytest_benchmark.fixture import BenchmarkFixture

from capacity import capacity, parse_material, parse_section
from fem_reference import pushover
from scene import builtin_text, load_scene, parse_scene
from sim import DuctileJoint, ElasticPlastic, Structure
from sim.world import World

STEEL = parse_material("fy=235 MPa, E=200 GPa, rho=7800 kg/m^3")
SECTION = parse_section("rectangle 100x100 mm")


PIECE = 0.04


def pieces_of_chain(pieces: int) -> pymunk.Space:
    """Equal pieces of steel in a row, 50 of them 2 m long, in a gravity that bends the root of a chain alike."""
    space = pymunk.Space()
    space.gravity, space.iterations = (0.0, -9.81 * (50 / pieces) ** 2), 2
    for i in range(pieces):
        mass = STEEL.density * SECTION.area * PIECE
        body = pymunk.Body(mass, mass * PIECE**2 / 12)
        body.position = ((i + 0.5) * PIECE, 0.0)
        space.add(body)
    return space


def chain(pieces: int) -> tuple[pymunk.Space, Structure]:
    """A cantilever of them."""
    c, space, joints = capacity(SECTION, STEEL), pieces_of_chain(pieces), []
    for i, (a, b) in enumerate(itertools.pairwise([space.static_body, *space.bodies])):
        share = PIECE * (0.5 if i == 0 else 1.0)
        law = ElasticPlastic((c.EA / share, c.GA_s / share, c.EI / share), (c.N_max, c.Q_max, c.M_max))
        joints.append(DuctileJoint(a, b, (i * PIECE, 0.0), law, direction=0.0))
    structure = Structure(joints)
    space.add(*joints)
    for _ in range(120):
        space.step(1 / 60)
    return space, structure


@pytest.mark.parametrize("iterations", [2, 10, 30])
@pytest.mark.parametrize("pieces", [10, 50, 1000, 10000])
def test_elastic_chain_step(benchmark: BenchmarkFixture, pieces: int, iterations: int) -> None:
    """One step of a chain at 1/60 s; µs a joint is in the extra columns: of all, of the bodies, of what joints add."""
    space, structure = chain(pieces)
    loose = pieces_of_chain(pieces)
    space.iterations = loose.iterations = iterations
    steps = max(1, 2000 // pieces)

    def run() -> None:
        for _ in range(steps):
            space.step(1 / 60)

    benchmark(run)
    without = min(timeit.repeat(lambda: loose.step(1 / 60), number=10 * steps, repeat=5)) / (10 * steps)
    whole = benchmark.stats.stats.min / steps
    benchmark.extra_info["microseconds_per_joint_step"] = 1e6 * whole / pieces
    benchmark.extra_info["bodies_without_joints"] = 1e6 * without / pieces
    benchmark.extra_info["added_by_a_joint"] = 1e6 * (whole - without) / pieces
    assert structure.unconverged == 0


def test_first_use_in_a_process(benchmark: BenchmarkFixture) -> None:
    """A new process that imports `sim`, makes a joint and takes a step; processor time of each in the extra columns."""
    code = (
        "import time; start = time.process_time()\n"
        "import pymunk, sim; imported = time.process_time()\n"
        "space, body = pymunk.Space(), pymunk.Body(1.0, 1.0)\n"
        "law = sim.ElasticPlastic((1e6, 1e6, 1e4), (1e4, 1e4, 1e3))\n"
        "space.add(body, sim.DuctileJoint(space.static_body, body, (0.0, 0.0), law))\n"
        "space.step(0.01)\n"
        "print(imported - start, time.process_time() - imported)"
    )

    def run() -> list[float]:
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        return [float(seconds) for seconds in done.stdout.split()]

    run()  # compiles what is not yet in the cache
    times = np.array([run() for _ in range(5)])
    benchmark.pedantic(run, rounds=1)
    imports, first_use = np.median(times, axis=0).tolist()
    benchmark.extra_info |= {"import_seconds": imports, "first_use_seconds": first_use}


def test_frame_of_a_thousand_joints(benchmark: BenchmarkFixture) -> None:
    """One step at 1/60 s of ten floors of ten bays under own weight; the real-time factor is in the extra column."""
    text = builtin_text("multifloor-frame")
    four, ten = (", ".join(['"2.5 m"'] * n) for n in (4, 10))
    world = World(parse_scene(text[: text.index('[measures."')].replace(four, ten), "frame"), dt=1 / 60)
    world.step()
    benchmark(world.step)
    joints = [joint for joint in world.space.constraints if isinstance(joint, DuctileJoint)]
    assert len(joints) >= 1000
    benchmark.extra_info["real_time_factor"] = 1.0 / 60.0 / benchmark.stats.stats.median


def test_reference_pushover(benchmark: BenchmarkFixture) -> None:
    """The built-in cantilever, all refinements."""
    answer = benchmark(pushover, load_scene("cantilever"))
    assert answer.error_estimate <= 5e-4
    assert np.isfinite(answer.load).all()
