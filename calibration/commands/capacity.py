"""``ductile capacity``: what a section carries."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console

from calibration.commands.options import Json

Signed = Annotated[str | None, Parameter(allow_leading_hyphen=True)]


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
