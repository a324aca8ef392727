"""The one error that a user's input can cause."""


class InputError(ValueError):
    """Input that cannot be used, said in one line: where, what is wrong, and how to mend it.

    Parameters
    ----------
    place : str
        Where the fault is, e.g. ``"members[0].section"`` or ``"--material"``.
    fault : str
        What is wrong there.
    cure : str
        What to write instead.
    """

    def __init__(self, place: str, fault: str, cure: str) -> None:
        super().__init__(place, fault, cure)
        self.place = place
        self.fault = fault
        self.cure = cure

    def __str__(self) -> str:
        return f"{self.place}: {self.fault}; {self.cure}"

    def at(self, place: str) -> "InputError":
        """The same fault, seen from further out: ``place`` is put before the place named so far."""
        return InputError(f"{place} > {self.place}" if self.place else place, self.fault, self.cure)
