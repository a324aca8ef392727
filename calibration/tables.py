"""What the report of a calibration says."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from calibration import figures
from calibration.export import joint_table
from calibration.fitting import Fit
from calibration.member_plans import MemberPlan
from calibration.sheets import Picture, Report, Sheet, percent
from calibration.tuning import Calibration
from capacity import Capacity
from capacity.units import engineering
from fem_reference import Pushover
from scene import Scene
from sim import MemberModel, Model


def report(result: Calibration) -> Report:
    """All of it: the verdict, tables and figures."""
    reference = result.reference
    fibres = f" a member, {reference.fibres} fibres a section" if isinstance(reference, Pushover) else ""
    curves = (
        f"Reference: {reference.method}; {reference.elements} elements{fibres}, estimated error "
        f"{percent(reference.error_estimate, 2)} of the peak load. Below: model less reference, the target shaded."
    )
    frontier = "Path error against computing time of every model tried; the chosen one is ringed."
    return Report(
        kind="Calibration",
        title=result.scene.title,
        scene=result.name,
        met=result.target_met,
        verdict=verdict(result),
        limit=result.limit,
        remarks=result.remarks,
        sheets=tuple(sheets(result)),
        pictures=(
            Picture("Load and displacement", figures.curves(result), curves),
            Picture("", figures.frontier(result), frontier),
        ),
    )


def verdict(result: Calibration) -> tuple[str, str]:
    """Whether the target is met, and with what; two sentences."""
    best, push = result.best, result.best.push
    head = "Target met" if result.target_met else "Target missed"
    asked = f"{percent(best.errors.path_max)} of the peak load; {percent(result.target_error)} was asked"
    text = (
        f"{push.bodies} rigid bodies with {push.joints} joints ({in_words(best.model, result.scene.members)}) follow "
        f"the reference within {asked}. "
        f"A simulated second takes {engineering(push.seconds_per_simulated_second, 's')} "
        f"({stepping(best.model)}): {1.0 / push.seconds_per_simulated_second:.0f} times faster than real time."
    )
    return head, text


def sheets(result: Calibration) -> list[Sheet]:
    """All tables of the report, in its order."""
    tables = [
        capacity_sheet(result.scene, result.capacity),
        member_sheet(result.plans, result.best.model),
        _errors(result),
    ]
    if result.fit is not None:
        tables.extend(fit_sheets(result.fit))
    if result.findings.hinges:
        tables.append(_hinges(result))
    return [*tables, joint_sheet(result.fitted_scene, result.best.model), _trials(result)]


def in_words(model: Model, members: Iterable[str]) -> str:
    """How the ``members`` are modelled, in a few words."""
    counts = Counter(_own_words(model.of(name)) for name in members)
    if len(counts) == 1:
        return next(iter(counts))
    return "; ".join(f"{count} × {words}" for words, count in counts.items())


def _own_words(own: MemberModel) -> str:
    return f"{own.rule} {own.joints}, {f'{own.fibres} fibres' if own.law == 'fibre' else own.law}"


def stepping(model: Model) -> str:
    """How a model is stepped."""
    return f"dt = 1/{1.0 / model.dt:.0f} s, {model.iterations} iterations"


def capacity_sheet(scene: Scene, capacities: Mapping[str, Capacity]) -> Sheet:
    """Capacities and stiffnesses of all members."""
    units = {"N_max": "N", "Q_max": "N", "M_max": "N m", "M_yield": "N m", "EA": "N", "GA_s": "N", "EI": "N m²"}
    rows = [
        (
            name,
            scene.members[name].section.name,
            *(engineering(getattr(c, key), unit) for key, unit in units.items()),
        )
        for name, c in capacities.items()
    ]
    note = f"Yield criterion {scene.criterion}."
    heads = ("<member", "<section", *units)
    return Sheet("Capacities", note, heads, tuple(rows), wide=("M_yield", "EA", "GA_s"))


def member_sheet(plans: Mapping[str, MemberPlan], model: Model) -> Sheet:
    """What was decided for each member, and why."""
    rows = [(name, plan.kind, plan.reason(model.of(name))) for name, plan in plans.items()]
    return Sheet("What each member needs", "", ("<member", "<decided", "<why"), tuple(rows))


def _errors(result: Calibration) -> Sheet:
    errors, findings = result.best.errors, result.findings
    signed = {
        "initial stiffness": errors.stiffness,
        "first yield (slope fallen by 2 %)": errors.first_yield,
        "largest load": errors.collapse_load,
        "residual displacement, of the largest displacement": errors.residual,
        "energy of the loops": errors.loop_energy,
        "first natural frequency": findings.frequency_error,
    }
    rows = [
        ("the reference, by its own estimate", percent(result.reference.error_estimate)),
        ("path, of the peak load", percent(errors.path_max)),
        *((name, f"{100.0 * value:+.3f} %") for name, value in signed.items() if value is not None),
    ]
    if findings.hinges_in_order is not None:
        rows.append(("hinges where and as the reference has them", "yes" if findings.hinges_in_order else "no"))
    model = result.best.model
    note = f"Model: {in_words(model, result.scene.members)}; {stepping(model)}. Reference: {result.reference.method}."
    return Sheet("Errors", note, ("<kind", "error"), tuple(rows))


def fit_sheets(found: Fit) -> tuple[Sheet, Sheet]:
    """Fitted parameters, and what they do for each load case."""
    rows: list[tuple[str, ...]] = []
    for name, value in found.parameters.items():
        low, high = found.bounds[name]
        remarks = ["at its bound"] * (name in found.at_bound) + ["not determined by the data"] * (
            name in found.undetermined
        )
        rows.append((name, f"{value:.4g}", f"{low:g} to {high:g}", ", ".join(remarks) or "–"))
    note = (
        "Stiffness and strength are factors of what the scene says of E and fy; spread s: half of each fibre yields at "
        "1 - s, half at 1 + s of it; hardening is E_t / E, with a reserve r from 1 - r of the strength up to it; "
        "the hinge length is in section depths, damping in s."
    )
    errors = [(case, percent(after), percent(found.before[case]), "fitted to") for case, after in found.after.items()]
    errors += [
        (case, percent(after), percent(before), "not seen by the fit") for case, (before, after) in found.checks.items()
    ]
    return (
        Sheet("Fit", note, ("<what", "value", "bounds", "<remark"), tuple(rows)),
        Sheet(
            "Errors of the fit",
            "Largest difference, as a share of the largest load or of the peak.",
            ("<load case", "with the fit", "without", "<remark"),
            tuple(errors),
        ),
    )


def _hinges(result: Calibration) -> Sheet:
    scale = max(abs(float(load)) for load in result.reference.load)
    is_factor = bool(result.scene.loads_of("proportional"))

    def said(load: float) -> str:
        return f"{load:.5g}" if is_factor else engineering(load, "N")

    rows = []
    for pair in result.findings.hinges:
        model = "none"
        difference = "–"
        if pair.model is not None:
            model, difference = said(pair.model), f"{100.0 * (pair.model - pair.reference) / scale:+.2f} %"
        rows.append((pair.where, said(pair.reference), model, difference))
    note = (
        "Loads at which plastic hinges form, in the reference's order; a joint counts as one at 98.5 % of its plastic "
        "moment. Differences are shares of the peak load." + (" Loads are load factors." if is_factor else "")
    )
    return Sheet("Hinges", note, ("<where", "reference", "model", "difference"), tuple(rows))


def joint_sheet(scene: Scene, model: Model) -> Sheet:
    """All joints that ``model`` gives ``scene``."""
    table = joint_table(scene, model)
    rows = []
    for i, joint in enumerate(table["joints"], 1):
        stiffness = joint["elastic_stiffness"]
        rows.append(
            (
                str(i),
                f"{joint['a']} → {joint['b']}",
                f"{joint['member']} {joint['position']:.4g} m" if "member" in joint else "support",
                f"{joint['length']:.4g} m" if "length" in joint else "–",
                joint["law"]["name"],
                engineering(stiffness["axial"], "N/m"),
                engineering(stiffness["shear"], "N/m"),
                engineering(stiffness["rotation"], "N m/rad"),
            )
        )
    note = (
        "Stiffnesses are those of the length that a joint stands for. Also in joints.json, with bodies, anchors and "
        "fibres: everything needed to build them elsewhere."
    )
    heads = (
        "joint",
        "<bodies",
        "<at",
        "stands for",
        "<law",
        "axial stiffness",
        "shear stiffness",
        "rotational stiffness",
    )
    return Sheet("Joints", note, heads, tuple(rows), wide=("<bodies", "axial stiffness", "shear stiffness"))


def _trials(result: Calibration) -> Sheet:
    rows = []
    for trial in result.trials:
        push = trial.push
        rows.append(
            (
                in_words(trial.model, result.scene.members),
                f"{1 / trial.model.dt:.0f}",
                str(trial.model.iterations),
                str(push.bodies),
                percent(trial.errors.path_max),
                f"{1e3 * push.seconds_per_simulated_second:.3g}",
                f"{push.microseconds_per_joint_step:.2f}",
            )
        )
    note = (
        "All models tried, from cheap to dear, with milliseconds for a simulated second and microseconds for a joint "
        "and step. Times are this machine's and vary from run to run; errors do not."
    )
    if result.failures:
        note += f" {len(result.failures)} more could not be stepped, the first: {result.failures[0].reason}."
    heads = ("<model", "1/dt", "iterations", "bodies", "path error", "ms/s", "µs")
    return Sheet("Speed against error", note, heads, tuple(rows), result.trials.index(result.best))
