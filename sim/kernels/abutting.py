"""Contacts of bodies that touch where they are joined, see `sim.abutting`: nobody solves them."""

from sim.chipmunk import (
    CONTACT_NORMAL_IMPULSE,
    CONTACT_NORMAL_MASS,
    CONTACT_TANGENT_IMPULSE,
    CONTACT_TANGENT_MASS,
)
from sim.kernels import layout as at
from sim.kernels import views
from sim.memory import kernel

# Of a contact that is to do nothing [kg]: Chipmunk divides by it.
_NO_MASS = 1e-300


@kernel
def abut(t, i, j):  # type: ignore[no-untyped-def]
    """Whether two bodies of a structure touch where they are joined; by bisection."""
    pairs, key = views.abutting(t), min(i, j) * t[at.BODIES] + max(i, j)
    low, high = 0, t[at.ABUTTING]
    while low < high:
        middle = (low + high) >> 1
        if pairs[middle] < key:
            low = middle + 1
        else:
            high = middle
    return low < t[at.ABUTTING] and pairs[low] == key


@kernel
def silence(contact):  # type: ignore[no-untyped-def]
    """Have Chipmunk make nothing of a contact; in the next step the masses are its own again."""
    contact[CONTACT_NORMAL_MASS], contact[CONTACT_TANGENT_MASS] = _NO_MASS, _NO_MASS
    contact[CONTACT_NORMAL_IMPULSE], contact[CONTACT_TANGENT_IMPULSE] = 0.0, 0.0
