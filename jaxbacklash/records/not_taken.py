"""What a record of a drive with one encoder is not taken for: work that looks at the motion of link and base, and, where the
motor is not seen, at the torque that is missing."""

from __future__ import annotations

from collections.abc import Iterable

from ..errors import BadInput
from .record import Record


def require_relative(records: Iterable[Record], what: str) -> None:
    """Refuse records of a drive of which motor or link has no encoder.

    Parameters
    ----------
    records : to be worked on
    what : which work it is that does not take one, as in "skeleton"

    Raises
    ------
    BadInput
        Naming the record and what takes it.
    """
    _refuse((record for record in records if record.blind), what, "both encoders")


def require_motor(records: Iterable[Record], what: str) -> None:
    """Refuse records of a drive of which the link alone has an encoder.

    Parameters
    ----------
    records : to be worked on
    what : which work it is that does not take one, as in "diagnose"

    Raises
    ------
    BadInput
        Naming the record and what takes it.
    """
    _refuse((record for record in records if record.blind and "motor" not in record.channels), what, "the motor's encoder")


def _refuse(records: Iterable[Record], what: str, wanted: str) -> None:
    for record in records:
        raise BadInput(
            f"{record.path or 'the record'}: is of a drive with the encoder of the {record.observed_name} alone, which "
            f"{what} does not take so far; wanted {wanted}, or jaxbacklash fit, with laws by --effects"
        )
