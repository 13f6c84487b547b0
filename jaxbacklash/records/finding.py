"""One thing found in a record that may be other than it seems."""

from __future__ import annotations

import dataclasses

REFUSE, WARN, ASK = "refuse", "warn", "ask"
"""A command refuses the record (exit code 2), warns and goes on, or refuses with a question that a flag answers."""


@dataclasses.dataclass(frozen=True)
class Finding:
    """What was found, where, and what to do.

    Parameters
    ----------
    kind : str
        A row of the table in `findings`: "wrap", "held", "spike", "sentinel", "gear", "sign", "lag", "clock", "unit", ...
    action : str
        `REFUSE`, `WARN` or `ASK`.
    channel : str
        The channel it is about ("t", "x", ...), or the name of a column; empty where it is about whole rows.
    found : str
        What was found and where (rows from 1), the middle of a sentence: "jumps by 2 pi, the first at row 812".
    remedy : str
        What to add to the command, ready for a shell: "--unwrap x"; empty where there is nothing to add.
    rows : tuple of int
        The first rows concerned (from 0).
    size : float or None
        Its size in SI: the lag [s], the ratio, the relative difference of clocks.
    bridged : tuple of int
        Rows (from 0) of the channel that are replaced by what its neighbours give, see `findings.mend.after`.
    left_out : int
        Rows at the beginning of the record that are left out.
    otherwise : str
        What to add to the command where it is right as it is; empty for "--accept KIND".
    """

    kind: str
    action: str
    channel: str
    found: str
    remedy: str = ""
    rows: tuple[int, ...] = ()
    size: float | None = None
    bridged: tuple[int, ...] = ()
    left_out: int = 0
    otherwise: str = ""

    def sentence(self, where: str) -> str:
        """The whole sentence, for the file called ``where``; one that refuses or asks says how to answer it."""
        ways = [self.remedy] if self.remedy else []
        if self.action != WARN:
            ways.append(f"{self.otherwise or f'--accept {self.kind}'} if it is right as it is")
        place = f"{where}, column {self.channel}" if self.channel else where
        return f"{place}: {self.found}{'; pass ' if ways else ''}{', or '.join(ways)}."
