"""The command line: ``ductile``.

Only what every command needs is imported here; each command imports the rest when it runs.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated

from cyclopts import App, CycloptsError, Parameter
from rich.console import Console

from capacity.errors import InputError

app = App(
    name="ductile",
    help="Joints for rigid-body simulations that yield and tear as steel does, held against an elastic–plastic FEM.",
    version_flags=["--version"],
    result_action="return_value",
)

Json = Annotated[bool, Parameter(name="--json", negative=())]
Signed = Annotated[str | None, Parameter(allow_leading_hyphen=True)]
Folder = Annotated[Path | None, Parameter(name=["-o", "--output"])]


@app.command
def capacity(
    section: str | None = None,
    /,
    *,
    material: str = "S235",
    criterion: str = "von-mises",
    list_family: Annotated[str | None, Parameter(name="--list")] = None,
    thickness: str | None = None,
    turned: Signed = None,
    axial_force: Signed = None,
    shear_force: Signed = None,
    moment: Signed = None,
    curvature: Signed = None,
    hinge_length: str | None = None,
    largest_rotation: str | None = None,
    largest_deflection: str | None = None,
    stiffness: str | None = None,
    frequency: str | None = None,
    damping_ratio: str | None = None,
    inertia: str | None = None,
    other_inertia: str | None = None,
    own_weight_moment: str | None = None,
    own_weight_share: str | None = None,
    plastic_share: str | None = None,
    plastic_rotation: str | None = None,
    heaviest_vehicle: str | None = None,
    span: str | None = None,
    vehicle_at: str | None = None,
    joint_at: str | None = None,
    family: str | None = None,
    gravity: str = "9.81 m/s^2",
    plot: Path | None = None,
    as_json: Json = False,
) -> int:
    """What a section carries: N_max, Q_max, M_max, how stiff it is; or which capacity a wanted behaviour asks for.

    Parameters
    ----------
    section
        A shape with dimensions ("rectangle 50x100 mm" is width x height, "circle 80 mm", "CHS 168.3x8 mm",
        "RHS 200x100x8 mm", "I 300x150x7.1x10.7 mm", "U", "T", "L", "polygon 0,0 50,0 50,80 mm"), a catalogue name
        ("IPE 300"), a path of a mesh or DXF drawing, or several joined by " + " and cut by " - ", each with
        "at 0,160 mm", "rotated 90 deg", "mirrored" or "of S355" behind it.
    material
        A grade (S235, S355 …) or values ("fy=235 MPa, E=210 GPa, rho=7850 kg/m^3, Et=2 GPa, eu=15 %").
    criterion
        What yields in shear: tresca or von-mises.
    list_family
        Show a family of the catalogue (IPE, HEA, HEB, HEM, UPN, UPE, L, CHS, RHS, SHS, W) and stop.
    thickness
        Greatest thickness of the product, on which a grade's yield stress depends ("30 mm").
    turned
        Turn the section counter-clockwise before it is loaded ("90 deg").
    axial_force
        Axial force beside the moment, tension positive ("-200 kN").
    shear_force
        Shear force beside the moment ("50 kN").
    moment
        With the two above: is this (N, Q, M) borne, and how far from yielding ("80 kN m").
    curvature
        Moments at these curvatures, one after the other, loading and unloading ("0.01 1/m, 0.02 1/m, 0 1/m").
    hinge_length
        Length of the plastic hinge, for its rotation at break; the depth by default.
    largest_rotation
        Largest elastic rotation of the joint ("0.12 rad"): M_max = stiffness x rotation.
    largest_deflection
        Largest elastic deflection ("20 mm"): force = stiffness x deflection.
    stiffness
        Of the joint ("2 MN m/rad", or "1e6 N/m" for a deflection).
    frequency
        In place of the stiffness ("1 Hz"), with the inertia of the bodies joined.
    damping_ratio
        Of the joint given by its frequency (0.2).
    inertia
        Of the body on the joint ("58320 kg m^2", or "500 kg" for a deflection).
    other_inertia
        Of the body on the other side; fixed by default.
    own_weight_moment
        Moment of own weight in the joint ("194 kN m").
    own_weight_share
        Share of M_max that own weight at rest shall use ("70 %").
    plastic_share
        Share of the plastic rotation that own weight shall use when let go at once ("13 %").
    plastic_rotation
        At which the joint breaks ("0.4 rad").
    heaviest_vehicle
        Its mass ("50 t"): Q_max above its weight, M_max so that the joint starts to rotate under it, and the lightest
        section of the catalogue that does both.
    span
        Of the bridge ("25 m").
    vehicle_at
        Where the vehicle is when the joint starts to rotate; mid-span by default.
    joint_at
        Where the joint is; mid-span by default.
    family
        Look for the lightest section in this family alone.
    gravity
        For weights.
    plot
        Draw the N-M curve to this file (.svg, .png, .pdf).
    as_json
        Print one JSON object, in SI units.
    """
    from calibration import capacity_command

    options = {
        name.replace("_", "-"): value
        for name, value in locals().items()
        if name not in ("capacity_command", "as_json", "plot", "section", "list_family")
    }
    if list_family is not None:
        capacity_command.list_catalogue(list_family, as_json, Console())
    else:
        capacity_command.answer(section, options, plot, as_json, Console())
    return 0


@app.command
def scenes(name: str | None = None, /) -> int:
    """List the scenes that come with it, or write one out to edit: ductile scenes cantilever > my.toml

    Parameters
    ----------
    name
        A built-in scene.
    """
    import scene as package

    if name is not None:
        sys.stdout.write(package.builtin_text(name))
        return 0
    for builtin in package.builtin_names():
        print(f"{builtin:20} {package.load_scene(builtin).title}")
    return 0


@app.command
def calibrate(
    scene: str,
    /,
    *,
    target_error: str = "1 %",
    output: Folder = None,
    as_json: Json = False,
) -> int:
    """Find the cheapest rigid-body model that follows the elastic–plastic reference closely enough.

    Parameters
    ----------
    scene
        A TOML file, or the name of a built-in scene.
    target_error
        Largest difference of load allowed on the path, as a share of the largest load ("1 %", "0.003").
    output
        Folder for report.html, joints.json and the curves as CSV; out/SCENE by default.
    as_json
        Print one JSON object, in SI units, in place of the report.
    """
    import scene as scenes_package
    from calibration.output import prepare_folder, write_files
    from calibration.progress import explained_compilation, progress_bar
    from capacity.units import positive

    target = positive(target_error, "number", "--target-error")
    if target >= 1.0:
        raise InputError("--target-error", f'"{target_error}" is not below 100 %', 'write a share such as "1 %"')
    loaded = scenes_package.load_scene(scene)
    folder = output or Path("out") / Path(scene).stem
    prepare_folder(folder)

    messages = Console(stderr=True)
    with explained_compilation(messages):
        import sim  # noqa: F401
    from calibration.export import calibration_object, curve_csv, joint_table
    from calibration.page import report_page
    from calibration.report import print_report
    from calibration.tuning import calibrate as tune

    with progress_bar(messages) as watch:
        result = tune(loaded, target, scene, watch)
        watch("writing the report", 1.0)
        joints = joint_table(loaded, result.best.model, scene)
        whole = calibration_object(result)
        files = {
            "report.html": report_page(result),
            "calibration.json": json.dumps(whole, indent=1),
            "joints.json": json.dumps(joints, indent=1),
            "reference.csv": curve_csv(result.reference.displacement, result.reference.load),
            "model.csv": curve_csv(result.best.push.displacement, result.best.push.load),
        }
        write_files(folder, files)
    if as_json:
        print(json.dumps(whole))
    else:
        print_report(result, Console())
    messages.print(f"Written to {folder}: {', '.join(files)}", soft_wrap=True)
    return 0 if result.target_met else 1


@app.command
def reference(
    scene: str,
    /,
    *,
    target_error: str = "0.05 %",
    output: Folder = None,
    as_json: Json = False,
    cache: bool = True,
) -> int:
    """Follow a push with the elastic–plastic finite-element reference: curve, hinges, energies, and their errors.

    Parameters
    ----------
    scene
        A TOML file, or the name of a built-in scene.
    target_error
        Largest estimated error of the load, as a share of the largest load ("0.05 %", "0.001").
    output
        Folder for the curve, hinges and sections as CSV and a plot as SVG; out/SCENE by default.
    as_json
        Print one JSON object, in SI units, in place of tables.
    cache
        Keep results on disk and use them again for the same content.
    """
    import scene as scenes_package
    from calibration.output import prepare_folder, write_files
    from calibration.progress import progress_bar
    from calibration.reference_command import answer, files, print_answer
    from capacity.units import positive

    target = positive(target_error, "number", "--target-error")
    loaded = scenes_package.load_scene(scene)
    folder = output or Path("out") / Path(scene).stem
    prepare_folder(folder)
    messages = Console(stderr=True)
    with progress_bar(messages) as watch:
        found = answer(loaded, target, cache, lambda share: watch("reference", share))
    texts = files(found, loaded.title)
    write_files(folder, texts)
    if as_json:
        print(json.dumps(found))
    else:
        print_answer(found, Console())
    messages.print(f"Written to {folder}: {', '.join(texts)}", soft_wrap=True)
    return 0 if found["error_estimate"] <= target else 1


def _run(tokens: Sequence[str] | None) -> int:
    return int(app(tokens, exit_on_error=False, print_error=False) or 0)


def main(tokens: Sequence[str] | None = None, run: Callable[[Sequence[str] | None], int] = _run) -> None:
    """Entry point of the command; exits with 0 (done), 1 (done, but the target was missed) or 2 (bad input)."""
    try:
        status = run(tokens)
    except InputError as error:
        status = _refuse(str(error))
    except CycloptsError as error:
        status = _refuse(f"{error} (see `ductile --help`)")
    except KeyboardInterrupt:
        status = 130
    except RuntimeError as error:
        from fem_reference import NotConverged
        from sim import SolverError

        if not isinstance(error, (NotConverged, SolverError)):
            raise
        status = _refuse(str(error))
    sys.exit(status)


def _refuse(message: str) -> int:
    Console(stderr=True, soft_wrap=True, highlight=False).print(f"ductile: {message}", markup=False)
    return 2


if __name__ == "__main__":
    main()
