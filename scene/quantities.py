"""Numbers of a scene that are written with a unit and read as SI floats."""

from capacity.units import to_si


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
