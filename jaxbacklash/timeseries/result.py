"""What a measured series says of chaos, and how a person reads it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..frames import dataframe, dataset, known
from ..showing import Shown
from .correlation import Correlation
from .dimension import Dimension
from .drift import Drift
from .driven import Driven
from .exponent import Exponent
from .mutual_information import Delay
from .noise_reduction import Cleaned
from .stretching import Stretching
from .surrogates import SurrogateTest
from .verdict import Verdict
from .zero_one import ZeroOne


@dataclass(frozen=True, eq=False)
class ChaosReport(Shown):
    """What one series says. Prints itself; in a notebook it shows a table and its picture (`jaxbacklash.plot.chaos`).

    Exponents are per sample inside ``exponent`` and ``raw_exponent``; the properties give them per second. ``series`` is the
    standardised series, ``cleaned`` its noise reduction (of the middle of a long series, see `clean_series`), which counts only
    where ``uses_cleaned``. ``drive_period`` [s] is None, with ``why_no_period``, for a record without a drive that repeats.
    ``shortened`` says what was used of a long series, None where all was; ``dt`` is the time between samples used.
    ``drift`` is what was found before all else; where it was ``removed``, ``series`` is what is left.
    ``driven`` is the growth under the measured drive, None without one; where ``conditional``, verdict and exponent are its.
    """

    series: np.ndarray
    dt: float
    mean: float
    deviation: float
    period: float
    delay: Delay
    theiler: int
    raw_dimension: Dimension
    cleaned_dimension: Dimension | None
    cleaned: Cleaned | None
    simple: Cleaned | None
    uses_cleaned: bool
    raw_exponent: Exponent | None
    exponent: Exponent | None
    curve: Stretching
    correlation: Correlation
    raw_correlation: Correlation
    surrogates: SurrogateTest
    walk: ZeroOne
    verdict: Verdict
    why_no_number: str | None
    drive_period: float | None
    why_no_period: str | None
    driven: Driven | None
    conditional: bool
    seed: int
    drift: Drift
    shortened: str | None

    @property
    def lyapunov(self) -> float | None:
        """Largest exponent [1/s], None where there is none to give (see ``why_no_number``)."""
        if self.why_no_number:
            return None
        if self.conditional:
            return None if self.driven is None or self.driven.value is None else self.driven.value / self.dt
        return None if self.exponent is None else self.exponent.value / self.dt

    @property
    def interval(self) -> tuple[float, float] | None:
        """95 % interval of the largest exponent [1/s]."""
        found = self.driven if self.conditional else self.exponent
        if self.lyapunov is None or found is None or found.interval is None:
            return None
        return found.interval[0] / self.dt, found.interval[1] / self.dt

    def __str__(self) -> str:
        return text(self)

    def numbers(self) -> list[tuple[str, float | None, tuple[float, float] | None, str, str]]:
        """What was found: name, value, 95 % interval, unit, and why there is none."""
        per = None if self.lyapunov is None or self.drive_period is None else self.lyapunov * self.drive_period
        bits = None if self.lyapunov is None else self.lyapunov / math.log(2.0)
        of = self.correlation
        return [
            ("lyapunov", self.lyapunov, self.interval, "1/s", self.why_no_number or ""),
            ("lyapunov_bits", bits, None, "bit/s", self.why_no_number or ""),
            ("lyapunov_per_period", per, None, "1", self.why_no_number or self.why_no_period or ""),
            ("delay", self.delay.samples * self.dt, None, "s", ""),
            ("dimension", self.raw_dimension.cao, None, "1", "" if self.raw_dimension.cao else "Cao's E1 does not settle"),
            ("correlation_dimension", of.dimension, None, "1", "" if of.dimension is not None else of.why),
            ("p_value", self.surrogates.p_value, None, "1", ""),
            ("zero_one", self.walk.k, None, "1", ""),
        ]

    def to_dataframe(self) -> Any:
        """What was found as a `pandas.DataFrame`, a row for each ``quantity``.

        Columns: ``value``, ``low`` and ``high`` of the 95 % interval in ``unit``; NaN, with a ``why``, where there is no number.
        """
        rows = self.numbers()
        return dataframe(
            {
                "quantity": [row[0] for row in rows], "value": known([row[1] for row in rows]),
                "low": known([None if row[2] is None else row[2][0] for row in rows]),
                "high": known([None if row[2] is None else row[2][1] for row in rows]),
                "unit": [row[3] for row in rows], "why": [row[4] for row in rows],
            },
            "quantity", verdict=self.verdict.word,
        )  # fmt: skip

    def to_dataset(self) -> Any:
        """The curves behind the verdict as an `xarray.Dataset`.

        Stretching curves stand along ``lag`` [s], ``information`` along ``delay`` [s], Cao's ``e1`` and ``e2`` and the
        ``false_share`` of neighbours along ``dimension``, correlation ``sums`` over ``embedding`` and ``radius`` [standard
        deviations], and prediction errors of the ``surrogates``.
        """
        curve, delay, raw, of, dt = self.curve, self.delay, self.raw_dimension, self.correlation, self.dt
        return dataset(
            {
                **{name: ("lag", getattr(curve, name), "1") for name in ("kantz", "smooth", "rosenstein")},
                "information": ("delay", delay.information, "nat"), "e1": ("dimension", raw.e1, "1"),
                "e2": ("dimension", raw.e2, "1"), "false_share": ("dimension", raw.false_share, "1"),
                "sums": (("embedding", "radius"), of.sums, "1"), "surrogates": ("surrogate", self.surrogates.surrogates, "1"),
            },
            {
                "lag": (dt * curve.lags, "s"), "delay": (dt * delay.lags, "s"), "dimension": (raw.dimensions, "1"),
                "embedding": (of.dimensions, "1"), "radius": (of.radii, "1"),
            },
            verdict=self.verdict.word,
        )  # fmt: skip


def text(found: ChaosReport) -> str:
    """Verdict first, then the exponent, then what was chosen and why."""
    dt, raw = found.dt, found.raw_dimension
    lines = [f"{found.verdict.word}: {found.verdict.text}", ""]
    lines.append(_exponent(found))
    if found.shortened:
        lines.append(f"  used                            {found.shortened}")
    lines += [f"  why so wide                     {one}" for one in why_wide(found)]
    lines += _driven(found)
    if found.conditional:
        lines.append("  what follows looks at the series alone, as if nothing had driven it")
    elif found.lyapunov is not None and found.curve.slope is not None:
        low, high = found.curve.interval or (math.nan, math.nan)
        lines.append(
            f"  from stretching curves alone    {found.curve.slope / dt:.4g} 1/s, {low / dt:.4g} to {high / dt:.4g}"
            f" (Kantz), {(found.curve.rosenstein_slope or 0.0) / dt:.4g} (Rosenstein)"
        )
    elif found.lyapunov is not None:
        lines.append("  from stretching curves alone    none: their straight part is shorter than a factor of two")
    p = found.surrogates
    lines += [
        f"  prediction error one delay ahead {found.raw_exponent.error:.3g} of the signal" if found.raw_exponent else "",
        f"  surrogates                      {p.count} {p.kind.upper()}, prediction error {p.statistic:.3g} against "
        f"{p.surrogates.mean():.3g}, p = {p.p_value:.3g}",
        f"  0-1 test                        K = {found.walk.k:.2f} from {found.walk.samples} samples, {found.walk.stride} apart",
        "",
        f"  delay                           {found.delay.samples} samples, {found.delay.samples * dt:.4g} s: {found.delay.why}",
        f"  mean period of a swing          {found.period:.4g} samples; neighbours within {found.theiler} samples are left out",
        f"  embedding dimension             {_or_none(raw.cao)} by Cao's E1, {_or_none(raw.false_neighbours)} by false "
        "neighbours",
    ]
    if found.cleaned is not None:
        gain = "unknown" if found.cleaned.gain_db is None else f"{found.cleaned.gain_db:.1f} dB"
        use = "used for the exponent" if found.uses_cleaned else "not used: it would gain too little"
        use = "the exponent is not from it" if found.conditional else use
        use = f"taken off: gain about {gain}, {use}"
        use = found.cleaned.why_untouched or use
        after = found.cleaned_dimension
        if after is not None:
            lines.append(
                f"  after noise reduction           {_or_none(after.cao)} by Cao's E1, {_or_none(after.false_neighbours)} by "
                "false neighbours"
            )
        lines.append(f"  noise                           {100 * found.cleaned.noise:.2g} % of the signal; {use}")
    d = found.correlation
    shown = f"{d.dimension:.2f} +- {d.spread:.2f}" if d.dimension is not None else f"none: {d.why}"
    lines.append(f"  correlation dimension           {shown}")
    return "\n".join(lines)


def _exponent(found: ChaosReport) -> str:
    value, interval = found.lyapunov, found.interval
    if value is None or interval is None:
        return f"  largest Lyapunov exponent       none: {found.why_no_number}"
    per = ""
    if found.drive_period is not None:
        per = f", {value * found.drive_period:.4g} per drive period"
    return (
        f"  largest Lyapunov exponent       {value:.4g} 1/s, 95 % interval {interval[0]:.4g} to {interval[1]:.4g}, "
        f"{value / math.log(2.0):.4g} bit/s{per}"
    )


def why_wide(found: ChaosReport) -> list[str]:
    """What makes the interval wider than the scatter of the series would; nothing where that is little."""
    one = found.exponent
    if found.conditional or found.lyapunov is None or one is None or not one.widened:
        return []
    said = []
    if one.bend > one.shift / 2.0:
        said.append(
            f"with twice as many neighbours the local maps give {one.bend / found.dt:.2g} 1/s more or less: states lie too far "
            "apart for affine maps; more samples, or finer ones, narrow it"
        )
    if one.shift > one.bend / 2.0:
        said.append(
            f"taking noise off changed it by {one.shift / found.dt:.2g} 1/s, and with {found.period:.3g} samples a swing it may "
            "have taken motion off too; finer sampling narrows it, or --no-clean"
        )
    return said


def _driven(found: ChaosReport) -> list[str]:
    """The growth under the measured drive, or why there is none."""
    one = found.driven
    if one is None:
        return []
    if one.value is None or one.interval is None or one.second is None or one.error is None:
        return [f"  under the measured drive        none: {one.why}"]
    low, high = (end / found.dt for end in one.interval)
    told = f"  under the measured drive        {one.value / found.dt:.4g} 1/s, {low:.4g} to {high:.4g}"
    return [
        "  how                             tangent of the measured law along the record" if found.conditional else told,
        f"  its second exponent             {one.second / found.dt:.4g} 1/s; together they are the rate at which volumes shrink",
        f"  law of motion                   read from the record as {tables_in_words(one.used)}; it misses the acceleration by "
        f"{100 * one.error:.2g} %",
        *([f"  the law drifts                  {drift_words(one.drift)}"] if one.drift else []),
    ]


def tables_in_words(used: Sequence[tuple[int, Any, Any]]) -> str:
    """What the law of motion was read as: ``a table of 57 positions`` or ``3 tables of 40 to 57 positions``."""
    sizes = sorted({size for size, _, _ in used})
    if len(sizes) == 1:
        return f"a table of {sizes[0]} positions"
    return f"{len(sizes)} tables of {sizes[0]} to {sizes[-1]} positions"


def drift_words(drift: float) -> str:
    """What a drift of the law's lengths says of a joint."""
    return f"its lengths, the play among them, change by {100 * drift:+.2g} % from the record's beginning to its end"


def _or_none(value: int | None) -> str:
    return "none found" if value is None else str(value)
