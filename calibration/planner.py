"""Which models to try, from cheap to dear."""

from sim import Model

# A hinge at each joint knows no gradual yielding, and more joints do not teach it.
_HINGES = (3, 5, 8)
_LOBATTO = (3, 4, 5, 6, 7, 8, 9, 10, 12, 14, 17, 20)
_EQUAL = (5, 9, 17, 33)
_FIBRES = (8, 12, 16, 24)
# Where more joints and fibres no longer help it may be the step: the finest models again, stepped finer.
_FINE_STEPPING = ((1.0 / 240.0, 2), (1.0 / 1000.0, 4))
_FINE_JOINTS = (10, 20)


def relative_cost(model: Model) -> float:
    """Cost of a second of simulation, in units of one elastic–plastic joint stepped once.

    Measured on a chain: what Chipmunk and the solver do for a joint costs about as much as sixteen fibres.
    """
    fibres = model.fibres if model.law == "fibre" else 0
    return (model.joints - 1) * (1.0 + fibres / 16.0) * (0.8 + 0.1 * model.iterations) / model.dt


def candidates() -> list[Model]:
    """Models in order of `relative_cost`: rules, numbers of joints, laws, fibres, steps and iterations worth trying.

    Two iterations do: a structure is solved whole in each, and where nothing else acts on it the second only finds
    that nothing is left to do.
    """
    models = [Model("lobatto", joints, "elastic-plastic") for joints in _HINGES]
    models += [Model("lobatto", joints, "fibre", fibres) for joints in _LOBATTO for fibres in _FIBRES]
    models += [Model("equal", joints, "fibre", fibres) for joints in _EQUAL for fibres in _FIBRES]
    models += [
        Model("lobatto", joints, "fibre", _FIBRES[-1], dt, iterations)
        for dt, iterations in _FINE_STEPPING
        for joints in _FINE_JOINTS
    ]
    return sorted(models, key=relative_cost)
