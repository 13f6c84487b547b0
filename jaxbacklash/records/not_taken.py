"""What a record of a drive with one encoder is not taken for: work that looks at the motion of link and base, and, where the
motor is not seen, at the torque that is missing."""

from __future__ import annotations

from collections.abc import Iterable

from ..errors import BadInput
from .record import Record


def require_encoders(records: Iterable[Record], what: str, encoders: tuple[str, ...] = ("motor", "link")) -> None:
    """Refuse records of a drive with one encoder that lack one of some encoders.

    Parameters
    ----------
    records : to be worked on
    what : which work it is that does not take them, as in "skeleton"
    encoders : that it needs, ``"motor"``, ``"link"`` or both

    Raises
    ------
    BadInput
        Naming the record and what takes it.
    """
    wanted = f"the {encoders[0]}'s encoder" if len(encoders) == 1 else "both encoders"
    for record in records:
        if record.blind and not set(encoders) <= set(record.channels):
            raise BadInput(
                f"{record.path or 'the record'}: is of a drive with the encoder of the {record.observed_name} alone, which "
                f"{what} does not take so far; wanted {wanted}, or jaxbacklash fit, with laws by --effects"
            )
