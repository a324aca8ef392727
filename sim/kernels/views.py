"""The arrays of a structure, by its control table."""

from numba import njit

from sim.kernels import layout as at
from sim.memory import floats, integers, table


@njit
def control(address):  # type: ignore[no-untyped-def]
    """Control table at an address."""
    return integers(address, at.CONTROL_WORDS)


@njit
def body_at(t):  # type: ignore[no-untyped-def]
    return integers(t[at.BODY_AT], t[at.BODIES])


@njit
def joint_at(t):  # type: ignore[no-untyped-def]
    return integers(t[at.JOINT_AT], t[at.JOINTS])


@njit
def joint_bodies(t):  # type: ignore[no-untyped-def]
    return integers(t[at.JOINT_BODIES], 2 * t[at.JOINTS]).reshape(t[at.JOINTS], 2)


@njit
def geometry(t):  # type: ignore[no-untyped-def]
    return table(t[at.GEOMETRY], t[at.JOINTS], at.GEOMETRY_WORDS)


@njit
def laws(t):  # type: ignore[no-untyped-def]
    return integers(t[at.LAWS], 5 * t[at.JOINTS]).reshape(t[at.JOINTS], 5)


@njit
def stiffness(t):  # type: ignore[no-untyped-def]
    return table(t[at.STIFFNESS], t[at.JOINTS], 6)


@njit
def damping(t):  # type: ignore[no-untyped-def]
    return table(t[at.DAMPING], t[at.JOINTS], 3)


@njit
def limits(t):  # type: ignore[no-untyped-def]
    return table(t[at.LIMITS], t[at.JOINTS], at.LIMITS_WORDS)


@njit
def scale(t):  # type: ignore[no-untyped-def]
    return floats(t[at.SCALE], t[at.JOINTS])


@njit
def active(t):  # type: ignore[no-untyped-def]
    return integers(t[at.ACTIVE], t[at.JOINTS])


@njit
def column_start(t):  # type: ignore[no-untyped-def]
    return integers(t[at.COLUMN_START], t[at.MOVING] + 1)


@njit
def column_rows(t):  # type: ignore[no-untyped-def]
    return integers(t[at.COLUMN_ROWS], t[at.LOWER])


@njit
def fill_targets(t):  # type: ignore[no-untyped-def]
    return integers(t[at.FILL_TARGETS], 1)


@njit
def joint_slot(t):  # type: ignore[no-untyped-def]
    return integers(t[at.JOINT_SLOT], t[at.JOINTS])


@njit
def settings(t):  # type: ignore[no-untyped-def]
    return floats(t[at.SETTINGS], at.SETTINGS_WORDS)


@njit
def ledger(t):  # type: ignore[no-untyped-def]
    return floats(t[at.LEDGER], at.LEDGER_WORDS)


@njit
def jacobian(t):  # type: ignore[no-untyped-def]
    return table(t[at.JACOBIAN], t[at.JOINTS], 18)


@njit
def response(t):  # type: ignore[no-untyped-def]
    return table(t[at.RESPONSE], t[at.JOINTS], at.RESPONSE_WORDS)


@njit
def result(t):  # type: ignore[no-untyped-def]
    return table(t[at.RESULT], t[at.JOINTS], at.RESULT_WORDS)


@njit
def per_joint(t, word):  # type: ignore[no-untyped-def]
    """One of the (joints, 3) arrays."""
    return table(t[word], t[at.JOINTS], 3)


@njit
def per_body(t, word):  # type: ignore[no-untyped-def]
    """One of the (bodies, 3) arrays."""
    return table(t[word], t[at.BODIES], 3)


@njit
def shift(t):  # type: ignore[no-untyped-def]
    return table(t[at.SHIFT], t[at.BODIES], 6)


@njit
def weight(t):  # type: ignore[no-untyped-def]
    return table(t[at.WEIGHT], t[at.MOVING], at.WEIGHT_WORDS)


@njit
def diagonal(t):  # type: ignore[no-untyped-def]
    return table(t[at.DIAGONAL], t[at.MOVING], 9)


@njit
def lower(t):  # type: ignore[no-untyped-def]
    return table(t[at.LOWER_BLOCKS], t[at.LOWER], 9)


@njit
def scaled(t):  # type: ignore[no-untyped-def]
    return table(t[at.SCALED_BLOCKS], t[at.LOWER], 9)


@njit
def places(t):  # type: ignore[no-untyped-def]
    return integers(t[at.PLACES], at.PLACE_WORDS * t[at.ROOM]).reshape(t[at.ROOM], at.PLACE_WORDS)


@njit
def touches(t):  # type: ignore[no-untyped-def]
    return table(t[at.TOUCHES], t[at.ROOM], at.TOUCH_WORDS)
