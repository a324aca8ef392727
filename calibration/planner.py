"""Which models to try, from cheap to dear."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from calibration.member_plans import ELASTIC_JOINTS, MemberPlan
from scene import Scene
from sim import AVERAGE_ACCELERATION, MemberModel, Model

_HINGES = (3, 5)
# Joints and fibres where a section yields bit by bit; from so many joints on they are drawn to where moments peak, for
# less of an error. Fewer would leave pieces so long that frequencies are off by per cents.
_FIBRES = tuple(
    (joints, fibres)
    for joints, counts in {
        4: (8,),
        5: (8,),
        6: (8, 12),
        7: (12,),
        8: (12,),
        9: (12, 16),
        10: (12, 16),
        12: (8, 12, 16, 48),
        14: (12, 16, 96),
        17: (16, 24, 48),
        20: (24, 96),
    }.items()
    for fibres in counts
)
_FEWEST_GRADED = 8
_EQUAL = ((9, 8), (17, 12), (33, 16))
# Where more joints and fibres no longer help it may be the step: fine models again, stepped finer.
_FINE_STEPPING = ((1.0 / 240.0, 2), (1.0 / 1000.0, 4))
_FINE = ((10, 16), (17, 48))
# In a motion: joints and fibres; steps a second; average acceleration, damped little where something yields, and not
# at all where nothing does: with 0.02 a struck beam came 5 % short of its peak at 1/480 s, undamped 1 %.
_MOTION_FIBRES = ((4, 8), (6, 12), (8, 12), (10, 16), (14, 16), (20, 24))
MOTION_RATES = (60, 120, 240, 480, 1000, 2000, 4000, 8000)
MOTION_SCHEME = (AVERAGE_ACCELERATION[0], 0.02)
_ELASTIC_SCHEME = (AVERAGE_ACCELERATION[0], 0.0)

# Prices of `benchmarks/model_prices.py` in microseconds, rounded: of a step, of a joint in it, of each Newton step
# after the first for every joint, and for every Newton step what a law adds, that of fibres per fibre.
_STEP, _JOINT, _FURTHER = 5.0, 0.25, 0.5
_LAW = {"rigid-plastic": 0.0, "elastic-plastic": 0.0, "interaction": 0.15, "fibre": 0.005}
#: Newton steps in a step, on average, that a model is expected to take before it was tried.
EXPECTED_NEWTON_STEPS = 1.5


def relative_cost(model: Model, members: Iterable[str] = ("",), newton_steps: float = EXPECTED_NEWTON_STEPS) -> float:
    """Cost of a second of simulation of ``members``, as processor time in microseconds of the machine of the prices.

    Times vary from run to run and from machine to machine; joints, fibres and Newton steps are counted, so that the
    same model has the same cost. The prices tell times within 15 % on average.
    """
    joints = 0.0
    for name in members:
        own = model.of(name)
        law = _LAW[own.law] * (own.fibres if own.law == "fibre" else 1)
        joints += (own.joints - 1) * (_JOINT + _FURTHER * (newton_steps - 1.0) + law * newton_steps)
    return (_STEP + joints) * (0.8 + 0.1 * model.iterations) / model.dt


def candidates(scene: Scene, plans: Mapping[str, MemberPlan]) -> list[Model]:
    """Models in order of `relative_cost`: rules, numbers of joints, laws, fibres and steps worth trying.

    They differ in the members that yield; the others have what does for them. A scene in which none yields is tried
    with more elastic joints instead. Two iterations do: a structure is solved whole in each, and where nothing else
    acts on it the second only finds that nothing is left to do.
    """
    if all(plan.fixed is not None for plan in plans.values()):
        models = [Model("lobatto", joints, "elastic-plastic") for joints in (3, 4, 5, 6, 8, 10, 14, 20)]
        models[0] = replace(models[0], members=_fixed(plans))
        models += [
            Model("lobatto", 10, "elastic-plastic", dt=dt, iterations=iterations) for dt, iterations in _FINE_STEPPING
        ]
    else:
        models = [Model("lobatto", joints, law) for joints in _HINGES for law in ("elastic-plastic", "interaction")]
        models += [Model(_rule(joints), joints, "fibre", fibres) for joints, fibres in _FIBRES]
        models += [Model("equal", joints, "fibre", fibres) for joints, fibres in _EQUAL]
        models += [
            Model(_rule(joints), joints, "fibre", fibres, dt, iterations)
            for dt, iterations in _FINE_STEPPING
            for joints, fibres in _FINE
        ]
        models = [replace(model, members=_fixed(plans)) for model in models]
    return sorted(models, key=lambda model: relative_cost(model, scene.members))


def _rule(joints: int) -> str:
    """The rule that goes with so many joints of a member that yields bit by bit."""
    return "graded" if joints >= _FEWEST_GRADED else "lobatto"


def _fixed(plans: Mapping[str, MemberPlan]) -> dict[str, MemberModel]:
    return {name: plan.fixed for name, plan in plans.items() if plan.fixed is not None}


def candidates_to_fit(scene: Scene) -> list[Model]:
    """Models in order of `relative_cost` whose parameters are fitted to a continuum.

    In a stocky member yielding spreads further than beam theory says, which few joints mimic that stand for long parts.
    """
    models = [Model("lobatto", joints, "fibre", fibres) for joints in (3, 4, 5, 6, 8, 10) for fibres in (8, 12, 16, 24)]
    return sorted(models, key=lambda model: relative_cost(model, scene.members))


def motion_cuts(scene: Scene, plans: Mapping[str, MemberPlan]) -> list[Model]:
    """Models for a motion in order of `relative_cost`, to be tried with the steps of `MOTION_RATES`.

    A member that stays elastic has as many joints as the others, for waves run through it, too.
    """
    yields = any(plan.kind == "elastic-plastic" for plan in plans.values())
    if not yields:
        cuts = [Model("lobatto", joints, "elastic-plastic") for joints in (3, 4, 5, 6, 8, 10, 14)]
    else:
        cuts = [Model("lobatto", joints, law) for joints in _HINGES for law in ("elastic-plastic", "interaction")]
        cuts += [Model("lobatto", joints, "fibre", fibres) for joints, fibres in _MOTION_FIBRES]
    models = []
    for cut in cuts:
        elastic = MemberModel("lobatto", cut.joints, "elastic-plastic")
        own = {name: elastic for name, plan in plans.items() if plan.kind == "elastic"} | _fixed(plans)
        models.append(replace(cut, scheme=MOTION_SCHEME if yields else _ELASTIC_SCHEME, members=own))
    return sorted(models, key=lambda model: relative_cost(model, scene.members))


def cheaper(model: MemberModel, plan: MemberPlan) -> list[MemberModel]:
    """Cheaper models for a member, cheapest first.

    A member that yields at one end only, or a little, may do with less than its neighbours: a hinge at each end, three
    rungs lower, or one. One that waves run through may do with the joints that carry slow ones.
    """
    if plan.kind == "elastic":
        return [MemberModel("lobatto", joints, model.law) for joints in (ELASTIC_JOINTS, 4, 6) if joints < model.joints]
    if model.law != "fibre":
        return []
    rungs = [(joints, fibres) for joints, fibres in _FIBRES if joints < model.joints and fibres <= model.fibres]
    lower = [
        MemberModel(_rule(joints) if model.rule == "graded" else "lobatto", joints, "fibre", fibres)
        for joints, fibres in (rungs[-4:-3] + rungs[-2:-1])
    ]
    return [MemberModel("lobatto", _HINGES[0], "elastic-plastic"), *lower]


def groups(scene: Scene, plans: Mapping[str, MemberPlan]) -> list[list[str]]:
    """Members that are not decided beforehand, those alike together, in the order of how much they bear.

    Alike are members of one section and length whose forces come as near to first yield: the two halves of a symmetric
    beam, say, which must stay symmetric.
    """
    found: dict[tuple[float, str, float], list[str]] = {}
    for name, plan in plans.items():
        if plan.fixed is None:
            length = float(f"{scene.axis(name)[2]:.6g}")
            found.setdefault((round(plan.utilisation, 2), scene.members[name].section.name, length), []).append(name)
    return [found[key] for key in sorted(found)]
