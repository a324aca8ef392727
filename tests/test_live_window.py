"""The live window, on a screen that nobody sees."""

import builtins
from typing import Any

import numpy as np
import pytest
from replay_runs import cantilever, world

from calibration.live_window import live
from capacity import InputError


def test_it_steps_draws_and_closes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    pygame = pytest.importorskip("pygame", reason="pygame is not installed")
    space = world()
    tip = cantilever(space)[-1].b
    pictures = []

    def step() -> None:
        space.step(1 / 240)
        if len(pictures) < 2 and tip.position.y < -1e-3 * len(pictures):
            picture = pygame.surfarray.array3d(pygame.display.get_surface())
            # On a slow machine many steps are taken before the window is drawn first, or again.
            if picture.any() and not any(np.array_equal(picture, other) for other in pictures):
                pictures.append(picture)
            if len(pictures) == 2 or tip.position.y < -1.0:
                pygame.event.post(pygame.event.Event(pygame.QUIT))

    live(space, step, 1 / 240, title="cantilever")
    assert not pygame.display.get_init()
    first, second = (picture.astype(int) @ [1 << 16, 1 << 8, 1] for picture in pictures)
    assert len(np.unique(second)) > 4
    assert np.any(second != first)


def test_a_finished_run_takes_no_more_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    pygame = pytest.importorskip("pygame", reason="pygame is not installed")
    space = world()
    cantilever(space)
    steps, asked = 0, 0

    def step() -> None:
        nonlocal steps
        space.step(0.001)
        steps += 1

    def finished() -> bool:
        nonlocal asked
        asked += steps >= 20
        if asked == 5:
            pygame.event.post(pygame.event.Event(pygame.QUIT))
        return steps >= 20

    live(space, step, 0.001, finished)
    assert steps == 20


def test_without_pygame_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    load = builtins.__import__

    def without_pygame(name: str, *rest: Any) -> Any:
        if name.startswith("pygame"):
            raise ImportError(name)
        return load(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without_pygame)
    with pytest.raises(InputError, match=r"--live: .*pip install 'ductile-joints\[live\]'"):
        live(world(), lambda: None, 0.1)
