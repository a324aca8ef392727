"""The ledger of every scene that comes with it, in the time integration that it asks for."""

import pytest
from whole_runs import whole_run

from scene import builtin_names, load_scene
from sim import energy
from sim.world import World


@pytest.mark.parametrize("shorter", [1, 4])
@pytest.mark.parametrize("name", builtin_names())
def test_no_scene_is_given_energy_by_its_time_integration(name: str, shorter: int) -> None:
    """To a thousandth of what came in, at its own step and a fourth of it.

    The average-acceleration rule gives and takes a little in each step.
    """
    if shorter == 1:
        world, _ = whole_run(name)
    else:
        world = World(load_scene(name), dt=World(load_scene(name)).dt / shorter)
        while not world.finished:
            world.step()
    found = energy(world.space)
    assert found.numerical >= -1e-3 * max(abs(found.external), found.plastic)
