"""Tables as CSV."""

import csv
import io
from collections.abc import Iterable
from typing import Any


def csv_text(head: list[str], rows: Iterable[Iterable[Any]]) -> str:
    """``rows`` below ``head``, lines ended by a line feed on every system."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(head)
    writer.writerows(rows)
    return text.getvalue()
