"""What was measured at one level of the drive: a verdict, and an exponent where there is one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..errors import BadInput
from ..timeseries import ChaosReport

WORDS = ("chaotic", "regular", "stochastic", "undecided")


@dataclass(frozen=True)
class Level:
    """One drive level and what its series said.

    ``amplitude`` of the base motion [rad]; ``word`` the verdict, of which "chaotic" and "regular" count and the others say
    nothing; ``exponent`` and ``stderr`` [1/drive period], None for regular motion and where no number could be had.
    """

    amplitude: float
    word: str
    exponent: float | None = None
    stderr: float | None = None

    def __post_init__(self) -> None:
        if not (np.isfinite(self.amplitude) and self.amplitude > 0.0):
            raise BadInput(f"amplitude {self.amplitude}: wanted that of the base motion, above zero [rad]")
        if self.word not in WORDS:
            raise BadInput(f"verdict {self.word!r}: wanted one of {', '.join(WORDS)}")
        if (self.exponent is None) != (self.stderr is None):
            raise BadInput(f"exponent {self.exponent} with stderr {self.stderr}: wanted both or neither")
        if self.exponent is not None and self.stderr is not None:
            if not np.isfinite(self.exponent):
                raise BadInput(f"exponent {self.exponent}: wanted a finite number [1/drive period]")
            if not (np.isfinite(self.stderr) and self.stderr > 0.0):
                raise BadInput(f"stderr {self.stderr}: wanted a number above zero [1/drive period]")

    @classmethod
    def measured(cls, amplitude: float, report: ChaosReport, frequency: float) -> Level:
        """From the analysis of a series (`jaxbacklash.chaos`) and the frequency of the drive [Hz]."""
        if report.verdict.word != "chaotic" or report.lyapunov is None or report.exponent is None:
            return cls(amplitude, report.verdict.word)
        per_period = 1.0 / frequency
        return cls(amplitude, "chaotic", report.lyapunov * per_period, report.exponent.stderr / report.dt * per_period)

    @property
    def counts(self) -> bool:
        """Whether the level says anything about the play."""
        return self.word in ("chaotic", "regular")
