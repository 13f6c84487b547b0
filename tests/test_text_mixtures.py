"""Text tables with several oddities at once, drawn at random: read to the last digit or refused, never read wrong."""

import gzip

import numpy as np
import pytest

from jaxbacklash.errors import BadInput
from jaxbacklash.records.text import read_text

FILES = 60
"""Files of each seed."""

NAMES = ("t", "base", "joint")
UNITS = ("s", "deg", "mrad")


class Dress:
    """One file: the values it holds and the bytes they are written as."""

    def __init__(self, rng: np.random.Generator):
        self.rng = rng
        rows = int(rng.integers(12, 260))
        step = float(self.pick(0.002, 0.001, 0.0005, 0.01))
        self.values = [
            np.round(np.arange(rows) * step + self.pick(0.0, 0.0, 12.5, 1000.0), 6),
            np.round(np.cumsum(rng.normal(size=rows)) * self.pick(1e-3, 1.0, 300.0), int(self.pick(3, 6, 7))),
            np.round(rng.normal(size=rows) * self.pick(1e-5, 1e-2, 40.0), int(self.pick(2, 5, 8))),
        ]
        self.separator = self.pick(",", ";", "\t", "|", " ", "  ", ", ", " ; ")
        self.mark = self.pick(".", ".", ",")
        self.quote = "'\"'"[1] if (self.mark == "," and "," in self.separator) or rng.random() < 0.1 else ""
        self.style = self.pick("{:.12g}", "{:.9f}", "{:.10e}", "{:+.9f}", "{:.9E}")
        self.missing = self.pick("", "NaN", "-", "#N/A", "NULL") if rng.random() < 0.3 else None
        if self.missing == "" and not self.separator.strip():
            self.missing = "NaN"

    def pick(self, *choices):
        """One of these, by chance."""
        return choices[int(self.rng.integers(len(choices)))]

    def chance(self, share: float) -> bool:
        """True in this share of cases."""
        return bool(self.rng.random() < share)

    def row(self, index: int) -> str:
        cells = [self.style.format(column[index]).replace(".", self.mark) for column in self.values]
        cells = [self.missing if np.isnan(column[index]) else cell for column, cell in zip(self.values, cells, strict=True)]
        return self.separator.join(f"{self.quote}{cell}{self.quote}" for cell in cells)

    def header(self) -> list[str]:
        sep, quote = self.separator, self.quote
        left, right = self.pick(("", ""), (" [", "]"), (" (", ")"), ("_", "")) if sep.strip() or quote else ("", "")
        self.units = UNITS if left else ("", "", "")
        names = [f"{name}{left}{unit}{right}" if left else name for name, unit in zip(NAMES, UNITS, strict=True)]
        self.names = names
        prefix = self.pick("# ", "% ", "#", "// ") if self.chance(0.2) and not quote else ""
        lines = [prefix + sep.join(f"{quote}{name}{quote}" for name in names)]
        if not left and self.chance(0.3):
            self.units = UNITS
            lines.append(prefix + sep.join(f"{quote}{unit}{quote}" for unit in UNITS))
        return lines

    def above(self) -> list[str]:
        return self.pick(
            [],
            [],
            ["# rig 4, noon"],
            ["Logger 3", "Serial: 0017", ""],
            ["Model;X200;;", "Channels;3;;", ";;;"],
            ["Operator,M. Smith,lab 3", "Gain,1.5,2.5,3.5", ""],
            ["Date\t2025-11-12", "Time\t10:03:29", "[Data]"],
            [f"Remark {number}: nothing of note" for number in range(130)],
        )

    def below(self) -> list[str]:
        return self.pick([], [], [], ["End of file"], ["", "Rows: many"], ["# end"], ["", ""])

    def data(self) -> bytes:
        if self.missing is not None:
            for column in self.values[1:]:
                column[self.rng.integers(2, column.size, 3)] = np.nan
        rows = [self.row(index) for index in range(self.values[0].size)]
        if self.chance(0.15):
            rows.insert(int(self.rng.integers(1, len(rows))), "# a comment, with 3 words")
        if self.chance(0.1):
            rows.insert(int(self.rng.integers(1, len(rows))), "")
        above, header = self.above(), self.header()
        first = "sep=" + self.separator.strip() if self.chance(0.1) and self.separator.strip() else None
        trail = self.separator.strip() if self.separator.strip() and self.chance(0.15) else ""
        lines = [*([first] if first else []), *above, *header, *(row + trail for row in rows), *self.below()]
        end = self.pick("\n", "\n", "\r\n", "\r")
        encoded = (end.join(lines) + self.pick("", end)).encode(self.pick("utf-8", "utf-8-sig", "utf-16", "utf-16-le", "latin-1"))
        return gzip.compress(encoded) if self.chance(0.15) else encoded


@pytest.mark.parametrize("seed", range(6))
def test_a_mixture_of_oddities_is_read_to_the_last_digit(tmp_path, seed):
    refused = []
    for number in range(FILES):
        dress = Dress(np.random.default_rng([seed, number]))
        path = tmp_path / f"{number}.csv"
        path.write_bytes(dress.data())
        try:
            table = read_text(path)
        except BadInput as why:
            refused.append(f"{number}: {why}")
            continue
        assert table.names == dress.names, number
        assert tuple(column.unit for column in table.columns) == dress.units, number
        for column, values in zip(table.columns, dress.values, strict=True):
            written = np.array([float(dress.style.format(value)) for value in values])
            np.testing.assert_allclose(column.values, written, rtol=1e-14, atol=0, err_msg=f"file {number}")
    assert not refused
