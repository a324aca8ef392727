"""What is there: nodes, members, supports, loose bodies, and what happens to them; read from TOML.

Signs, for the whole project
----------------------------
Global axes: x to the right, y up, angles and moments counter-clockwise.

A member's local axes: x from its start to its end, y to the left of that. With a cut that leaves part *a* before it
and part *b* behind it (seen along local x):

    N > 0   tension: b pulls a along +x
    Q > 0   b pulls a along +y, and is itself pulled along -y
    M > 0   b turns a counter-clockwise: fibres at y < 0 are in tension ("sagging" for a member drawn left to right)

so that a fibre's strain is ε = ε₀ - y κ with κ = dθ/dx, and N = ∫σ dA, M = -∫σ y dA. The matching deformations of a
joint from a to b are u = extension along x, v = slip along y, θ = rotation of b less rotation of a.
"""

from scene.actions import Load, LoadKind, Motion, Push
from scene.bodies import GROUND, Body, Box, Circle, Ground, Joint, Polygon, Shape
from scene.checks import check, is_supported
from scene.model import HELD, Member, MemberEnd, Node, Scene
from scene.plane import EdgeSupport, Plane
from scene.programme import Measure, Simulation
from scene.reading import builtin_names, builtin_text, json_schema, load_scene, parse_scene
from scene.simulation_checks import ALL_JOINTS
from scene.vehicles import Vehicle, Wheel

__all__ = [
    "ALL_JOINTS",
    "GROUND",
    "HELD",
    "Body",
    "Box",
    "Circle",
    "EdgeSupport",
    "Ground",
    "Joint",
    "Load",
    "LoadKind",
    "Measure",
    "Member",
    "MemberEnd",
    "Motion",
    "Node",
    "Plane",
    "Polygon",
    "Push",
    "Scene",
    "Shape",
    "Simulation",
    "Vehicle",
    "Wheel",
    "builtin_names",
    "builtin_text",
    "check",
    "is_supported",
    "json_schema",
    "load_scene",
    "parse_scene",
]
