"""A window in which a space runs, drawn by pymunk's own drawing for pygame."""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

import pymunk

from capacity.errors import InputError
from sim import DuctileJoint

_SIZE = (1100, 650)
_PAPER, _INK, _CALM, _FULL = (244, 246, 248), (34, 48, 60), (223, 233, 242), (210, 34, 45)
_FRAMES_A_SECOND = 60
# So much is simulated at most between two frames [s]: what is slower than real time is shown slower.
_LONGEST_FRAME = 0.05
_ZOOM = 1.2
_KEYS = "space: pause, arrows: move, + and -: zoom, escape: close"


def live(
    space: pymunk.Space,
    step: Callable[[], None],
    dt: float,
    finished: Callable[[], bool] = lambda: False,
    title: str = "",
) -> None:
    """Run a space in a window until it is closed, in real time if the machine can.

    Parameters
    ----------
    space : pymunk.Space
    step : callable
        Takes one step.
    dt : float
        That step [s].
    finished : callable
        Whether no more steps are to be taken; the window then stays as it is.
    title : str

    Raises
    ------
    InputError
        When pygame is not installed, or there is no screen.
    """
    # pygame greets on standard output, which may be for an answer in JSON.
    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    try:
        import pygame
        import pymunk.pygame_util as drawing
    except ImportError as error:
        raise InputError("--live", "pygame is not installed", "pip install 'ductile-joints[live]'") from error
    try:
        pygame.display.init()
        screen = pygame.display.set_mode(_SIZE, pygame.RESIZABLE)
    except pygame.error as error:
        raise InputError("--live", f"no window can be opened ({error})", "leave --live out") from error
    drawing.positive_y_is_up = True
    options, view, clock = drawing.DrawOptions(screen), _View(space), pygame.time.Clock()
    # Points of contact are left out: pymunk draws them so many pixels of its own long, which here become metres.
    options.flags = pymunk.SpaceDebugDrawOptions.DRAW_SHAPES | pymunk.SpaceDebugDrawOptions.DRAW_CONSTRAINTS
    running, owed, simulated = True, 0.0, 0.0
    try:
        while True:
            for event in pygame.event.get():
                if event.type == pygame.QUIT or (event.type == pygame.KEYDOWN and event.key == pygame.K_ESCAPE):
                    return
                if event.type == pygame.KEYDOWN and event.key == pygame.K_SPACE:
                    running = not running
                elif event.type == pygame.KEYDOWN:
                    view.press(pygame.key.name(event.key))
            owed += min(clock.tick(_FRAMES_A_SECOND) / 1000.0, _LONGEST_FRAME)
            while owed >= dt:
                owed -= dt
                if running and not finished():
                    step()
                    simulated += dt
            screen.fill(_PAPER)
            options.transform = view.transform(screen.get_size())
            space.debug_draw(options)
            _draw_joints(pygame, screen, space, options.transform)
            pygame.display.set_caption(f"{title}  {simulated:.2f} s   ({_KEYS})")
            pygame.display.flip()
    finally:
        pygame.quit()


class _View:
    """What of the world the window shows: its middle [m] and how many metres it is wide and high at least."""

    def __init__(self, space: pymunk.Space) -> None:
        boxes = [shape.cache_bb() for body in space.bodies for shape in body.shapes]
        points = [point for box in boxes for point in ((box.left, box.bottom), (box.right, box.top))]
        points += [(body.position.x, body.position.y) for body in space.bodies]
        points = points or [(-1.0, -1.0), (1.0, 1.0)]
        xs, ys = zip(*points, strict=True)
        self.x, self.y = 0.5 * (min(xs) + max(xs)), 0.5 * (min(ys) + max(ys))
        self.wide, self.high = (2.0 * max(max(v) - min(v), 0.1) for v in (xs, ys))

    def press(self, key: str) -> None:
        """Move or zoom by a key's name."""
        factor = {"+": 1 / _ZOOM, "=": 1 / _ZOOM, "-": _ZOOM}.get(key, 1.0)
        self.wide, self.high = factor * self.wide, factor * self.high
        step = 0.1 * min(self.wide, self.high)
        right, up = {"left": (-1, 0), "right": (1, 0), "up": (0, 1), "down": (0, -1)}.get(key, (0, 0))
        self.x, self.y = self.x + right * step, self.y + up * step

    def transform(self, size: tuple[int, int]) -> pymunk.Transform:
        """From metres to pixels, y upwards."""
        scale = min(size[0] / self.wide, size[1] / self.high)
        return pymunk.Transform(a=scale, d=scale, tx=0.5 * size[0] - scale * self.x, ty=0.5 * size[1] - scale * self.y)


def _draw_joints(pygame: Any, screen: Any, space: pymunk.Space, transform: pymunk.Transform) -> None:
    """A dot for each ductile joint, red as it is loaded up to what it can bear."""
    height = screen.get_height()
    for structure in {joint.structure for joint in space.constraints if isinstance(joint, DuctileJoint)}:
        if structure is None:
            continue
        shares = structure.utilisation.max(axis=1).clip(max=1.0).tolist()
        for joint, share, holds in zip(structure.joints, shares, structure.active, strict=True):
            if holds:
                colour = [round(calm + share * (full - calm)) for calm, full in zip(_CALM, _FULL, strict=True)]
                x, y = transform @ joint.point_on(joint.a)
                pygame.draw.circle(screen, _INK, (x, height - y), 6)
                pygame.draw.circle(screen, colour, (x, height - y), 5)
