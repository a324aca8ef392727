"""Faults in what only a simulation needs, named by place with a cure."""

import pytest

from capacity import InputError
from scene import builtin_names, builtin_text, load_scene, parse_scene


@pytest.mark.parametrize(
    ("old", "new", "place", "fault"),
    [
        ("duration", "duraton", "simulation", 'did you mean "duration"'),
        ('"1 s"', '"0 s"', "simulation.duration", "greater than zero"),
        ('duration = "1 s"', "", "simulation.duration", "missing"),
        ('"1 s"', '"1 s"\nrule = "radau"\njoints = 5', "simulation.joints", "too few"),
        ('"1 s"', '"1 s"\nrule = "graded"\njoints = 5', "simulation.joints", "too few"),
        ('"1 s"', '"1 s"\ngravity_ramp = "-1 s"', "simulation.gravity_ramp", "negative"),
        ('"1 s"', '"1 s"\ndt = "0 s"', "simulation.dt", "greater than zero"),
        ('"1 s"', '"1 s"\nlaw = "fibr"', "simulation.law", "fibr"),
        ("[simulation]", "[simulatio]", "top level", 'did you mean "simulation"'),
        ("radius", "radus", "bodies.disc.shapes[0]", 'did you mean "radius"'),
        ('"circle"', '"circel"', "bodies.disc.shapes[0]", "circel"),
        ('radius = "1 m"', 'radius = "0 m"', "bodies.disc.shapes[0].radius", "greater than zero"),
        ('mass = "6 kg"', 'mass = "-6 kg"', "bodies.disc.mass", "greater than zero"),
        ('"disc", "ground"', '"dics", "ground"', "joints.hold.between", "did you mean disc"),
        ('"disc", "ground"', '"disc", "disc"', "joints.hold.between", "nothing moves"),
        ('M_max = "3 kN m"', "", "joints.hold.M_max", "missing"),
        ('N_max = "3 kN"', "", "joints.hold.N_max", "missing"),
        ('M_max = "3 kN m"', 'M_max = "3 kN m"\ndamping_ratio = 0.1', "joints.hold.damping_ratio", "frequency"),
        ('M_max = "3 kN m"', 'M_max = "3 kN m"\ndamping_ratio = -0.1', "joints.hold.damping_ratio", "0"),
        ("[joints.hold]", "[joints.disc]", "joints.disc", "already names"),
        ('["9 m", "0 m"]', "", "grounds[0].points", "two points"),
        ('["9 m", "0 m"]', '["-9 m", "0 m"]', "grounds[0].points[1]", "repeats"),
        ('["9 m", "0 m"]', '["9 m", "0 m"], ["0 m", "0 m"]', "grounds[0].points[1]", "turns back"),
        ("[[grounds]]", '[[grounds]]\nthickness = "0 m"', "grounds[0].thickness", "greater than zero"),
        ("[[grounds]]", "[[grounds]]\nrestitution = 1.5", "grounds[0].restitution", "greater than 1"),
        ('mass = "6 kg"', 'mass = "6 kg"\nrestitution = 2.0', "bodies.disc.restitution", "greater than 1"),
        ('mass = "6 kg"', 'mass = "6 kg"\nvelocity = [1e9, 0]', "bodies.disc.velocity", "faster than light"),
        ('mass = "6 kg"', "mass = nan", "bodies.disc.mass", "not a finite mass"),
        ('of = "disc"', 'of = "disc"\nat = "2 s"', "measures.height.at", "not within the run"),
        ('of = "disc"', 'of = "disc"\nsince = "-1 s"', "measures.height.since", "not within the run"),
        ('of = "disc"', 'of = "disc"\nsince = "0.5 s"\nuntil = "0.4 s"', "measures.height.until", "before `since`"),
        ('radius = "0.4 m"', 'radius = "-0.4 m"', "vehicles.cart.wheels[0].radius", "greater than zero"),
        ("driven", "drivn", "vehicles.cart.wheels[0]", 'did you mean "driven"'),
        ("driven = true", "driven = false", "vehicles.cart.drive", "no wheel is driven"),
        ('["1 m", "1 m"], ', '["0 m", "0.5 m"], ["1 m", "1 m"], ', "vehicles.cart.chassis[0].points", "not convex"),
        ('of = "disc"', 'of = "dusc"', "measures.height.of", "did you mean disc"),
        ('quantity = "y"', 'quantity = "M"', "measures.height.of", "nothing with a M"),
        ('quantity = "y"', 'quantity = "heigth"', "measures.height.quantity", "heigth"),
        ('quantity = "y"', 'quantity = "y"\ntake = "laps"', "measures.height.take", "no vehicle drives laps"),
    ],
)
def test_faults_are_named_by_place(old: str, new: str, place: str, fault: str) -> None:
    assert old in TEXT
    with pytest.raises(InputError) as caught:
        parse_scene(TEXT.replace(old, new, 1), "my.toml")
    message = str(caught.value)
    assert message.startswith("my.toml")
    assert place in message
    assert fault in message
    assert "\n" not in message


TEXT = """
title = "Everything that a world can hold"
[simulation]
duration = "1 s"
[[grounds]]
points = [["-9 m", "0 m"], ["9 m", "0 m"]]
[bodies.disc]
at = ["0 m", "5 m"]
mass = "6 kg"
shapes = [{ kind = "circle", radius = "1 m" }]
[joints.hold]
between = ["disc", "ground"]
at = ["0 m", "6 m"]
N_max = "3 kN"
Q_max = "3 kN"
M_max = "3 kN m"
[vehicles.cart]
at = ["-5 m", "1 m"]
chassis = [{ kind = "polygon", points = [["-1 m", "0 m"], ["1 m", "0 m"], ["1 m", "1 m"], ["-1 m", "1 m"]] }]
drive = [{ time = "0 s", speed = "-10 rad/s", torque = "10 N m" }]
[[vehicles.cart.wheels]]
at = ["0 m", "-0.5 m"]
radius = "0.4 m"
mass = "10 kg"
driven = true
[measures.height]
quantity = "y"
of = "disc"
"""


def test_the_text_without_faults_is_a_scene() -> None:
    assert parse_scene(TEXT, "my.toml").vehicles["cart"].wheels[0].driven


@pytest.mark.parametrize("name", builtin_names())
def test_built_in_scenes_say_what_happens_in_them(name: str) -> None:
    scene = load_scene(name)
    assert scene.pushed is not None or scene.measures
    assert builtin_text(name).startswith("# ")
