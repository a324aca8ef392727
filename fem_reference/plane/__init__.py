"""Plane stress bodies of an elastic–plastic metal: what a beam cannot say of short members, notches and clamps."""

from fem_reference.plane.bodies import plane_fault
from fem_reference.plane.fields import field_files
from fem_reference.plane.push import AxisShape, Fields, PlanePush, plane_push

__all__ = ["AxisShape", "Fields", "PlanePush", "field_files", "plane_fault", "plane_push"]
