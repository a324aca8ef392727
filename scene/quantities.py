"""Numbers of a scene that are written with a unit and read as SI floats."""

from typing import Any

from capacity.units import to_si


def si(number: float) -> Any:
    """A default, in SI. It is a plain float, as the JSON schema wants it, where a `Quantity` is declared."""
    return number


class Quantity(float):
    """A float that a scene file writes as text with a unit."""

    kind: str

    @classmethod
    def read(cls, value: object) -> "Quantity":
        """From text such as ``"75 mm"`` or an SI number; raises `capacity.InputError`."""
        return cls(to_si(value, cls.kind, ""))  # type: ignore[arg-type]


class Length(Quantity):
    """A length [m]."""

    kind = "length"


class Acceleration(Quantity):
    """An acceleration [m/s²]."""

    kind = "acceleration"


class Force(Quantity):
    """A force [N]."""

    kind = "force"


class ForcePerLength(Quantity):
    """A force per length of member [N/m]."""

    kind = "force per length"


class Moment(Quantity):
    """A moment [N m]."""

    kind = "moment"


class Mass(Quantity):
    """A mass [kg]."""

    kind = "mass"


class Speed(Quantity):
    """A speed [m/s]."""

    kind = "speed"


class Duration(Quantity):
    """A time [s]."""

    kind = "time"


class Stiffness(Quantity):
    """A spring's stiffness [N/m]."""

    kind = "stiffness"


class RotationalStiffness(Quantity):
    """A rotational spring's stiffness [N m/rad]."""

    kind = "rotational stiffness"


class Angle(Quantity):
    """An angle, counter-clockwise [rad]."""

    kind = "angle"


class AngularSpeed(Quantity):
    """An angular speed, counter-clockwise [rad/s]."""

    kind = "angular speed"


class Density(Quantity):
    """A mass per volume [kg/m³]."""

    kind = "density"


class Frequency(Quantity):
    """A frequency [Hz]."""

    kind = "frequency"


class MomentOfInertia(Quantity):
    """A moment of inertia about a body's centre of mass [kg m²]."""

    kind = "moment of inertia"
