"""What lies on a structure in a pile."""

import pymunk
import pytest
from piles import DEPTH, beam, box, boxes


def test_what_overlaps_a_held_structure_moves_out_of_it_alone() -> None:
    """A box that is put into a beam, by 20 mm, bends it by nothing; a ball has struck that before, and lost energy."""
    space = pymunk.Space()
    space.collision_slop = 1e-3
    structure = beam(space, 20)[0]
    ball = pymunk.Body(100.0, 10.0)
    ball.position, ball.velocity = (5.0, 0.5 * DEPTH + 0.2), (0.0, -3.0)
    space.add(ball, pymunk.Circle(ball, 0.2))
    for _ in range(60):
        space.step(1 / 60)
    assert structure.structure is not None
    assert structure.structure.energy.contact + structure.structure.energy.numerical > 100.0
    space.remove(ball, *ball.shapes)
    before = structure.structure.energy
    wedge = box(space, 2.5, -0.5 * DEPTH - 0.5 * 0.4 + 0.02, 0.4)
    for _ in range(60):
        space.step(1 / 60)
    after = structure.structure.energy
    assert after.elastic + after.plastic < before.elastic + before.plastic + 1.0
    assert wedge.position.y == pytest.approx(-0.5 * DEPTH - 0.5 * 0.4, abs=2e-3)


@pytest.mark.parametrize("pieces", [10, 20])
def test_boxes_that_fall_on_a_beam_come_to_rest_in_a_pile(pieces: int) -> None:
    """What loses a contact for a step falls at ½ g h, 80 mm/s, at the end of it: none does in the end."""
    space = pymunk.Space()
    space.gravity, space.collision_slop = (0.0, -9.81), 1e-3
    joint = beam(space, pieces)[0]
    pile, fastest = boxes(space, 18, seed=2), []
    for _ in range(240):
        space.step(1 / 60)
        fastest.append(max(body.velocity.length for body in pile))
    assert max(fastest[-30:]) < 0.01
    assert joint.structure is not None
    assert joint.structure.unconverged == 0
