"""What a record of a drive is not taken for: work that knows a base whose motion is prescribed, and nothing of a motor."""

from __future__ import annotations

from collections.abc import Iterable

from ..errors import BadInput
from .record import Record


def require_prescribed(records: Iterable[Record], what: str) -> None:
    """Refuse records of a drive.

    Parameters
    ----------
    records : to be worked on
    what : which work it is that does not take a drive, as in "refine"

    Raises
    ------
    BadInput
        Naming the record and what takes it.
    """
    for record in records:
        if record.kind == "drive":
            raise BadInput(
                f"{record.path or 'the record'}: is of a drive (torque with motor or link), which {what} does not take so far; "
                "wanted jaxbacklash fit, with laws by --effects, or motor and link alone as t,x,y with --ratio"
            )
