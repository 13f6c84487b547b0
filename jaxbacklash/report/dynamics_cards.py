"""Cards of skeletons, responses and the cross-check, of chaos, and of what models do."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..dynamics import Basins, Exponents
from ..plot.style import format_interval, format_value, short
from ..second_opinion import CrossCheck
from ..signature import ExpectedPrecision, ExponentMap, PatternMatch, PlayFromChaos
from ..simulation import Trajectory
from ..skeletons import Response, Skeleton, Skeletons
from ..skeletons.result import LABELS, METHODS, Value, verdict
from ..timeseries import ChaosReport
from .card import Card, Grid, Picture, card_of, grid, name_of

QUANTITIES = {
    "lyapunov": "largest Lyapunov exponent", "lyapunov_bits": "the same in bits", "lyapunov_per_period": "per drive period",
    "delay": "delay", "dimension": "embedding dimension", "correlation_dimension": "correlation dimension",
    "p_value": "chance of linear noise", "zero_one": "K of the 0-1 test",
}  # fmt: skip


def values(found: Mapping[str, Value], labels: Mapping[str, str]) -> list[list[str]]:
    """A row for each value: its label, the value with its error, the interval; the reason where there is none."""
    rows = []
    for name, one in found.items():
        told = f"none: {one.why}" if one.value is None else format_value(one.value, one.stderr, one.unit)
        ends = format_interval(None if one.ci95 is None else list(one.ci95), one.stderr, one.unit)
        rows.append([labels.get(name, name.replace("_", " ")), told, ends])
    return rows


HEADS = ("parameter", "value ± standard error", "95 % interval")


def _methods(found: Skeletons) -> tuple[Grid, ...]:
    return tuple(grid(HEADS, values(method.parameters, LABELS), METHODS[method.method]) for method in found.methods)


@card_of.register
def of_skeletons(found: Skeletons) -> Card:
    """What both methods tell of play, stiffness and damping."""
    title = f"Skeletons of {name_of(found.record.path)}"
    said = (verdict(found), *(f"Note: {one}." for one in found.warnings))
    return Card(title, said, _methods(found), (Picture("skeleton", (found,)),))


@card_of.register
def of_skeleton(found: Skeleton) -> Card:
    """What one method tells."""
    said = (f"{100.0 * (1.0 - found.masked_fraction):.0f} % of the record counts.", *(f"Note: {one}." for one in found.warnings))
    return Card(METHODS[found.method], said, (grid(HEADS, values(found.parameters, LABELS)),))


@card_of.register
def of_cross_check(found: CrossCheck) -> Card:
    """What other methods say of a fit."""
    if found.skeletons is None:
        return Card("A second opinion", (found.text,))
    pictures = (Picture("skeleton", (found.skeletons,)),)
    return Card("A second opinion", (found.text,), _methods(found.skeletons), pictures)


@card_of.register
def of_response(found: Response) -> Card:
    """Natural frequency, damping and inertia of the preloaded joint."""
    told = f"{int(found.used.sum())} of {found.used.size} lines are coherent."
    return Card(
        "Frequency response", (told,), (grid(HEADS, values(found.values, {})),), (Picture("frequency_response", (found,)),)
    )


@card_of.register
def of_chaos(found: ChaosReport) -> Card:
    """The verdict, and the numbers that there are."""
    rows = []
    for name, value, interval, unit, why in found.numbers():
        told = f"none: {why}"
        if value is not None:
            told = str(value) if isinstance(value, int) else short(value, 4 if interval else 3)
            told += "" if unit == "1" else f" {unit}"
        rows.append([QUANTITIES[name], told, "–" if interval is None else f"{short(interval[0], 4)} to {short(interval[1], 4)}"])
    table = grid(["quantity", "value", "95 % interval"], rows)
    return Card(f"A series: {found.verdict.word}", (found.verdict.text,), (table,), (Picture("chaos", (found,)),))


@card_of.register
def of_exponents(found: Exponents) -> Card:
    """Lyapunov exponents of a model, the largest first."""
    rows = [[number, f"{value:.5g} ± {error:.2g}"] for number, (value, error) in enumerate(zip(found.values, found.stderr), 1)]
    told = f"Over {found.time:.5g} units of time; their sum is {float(np.sum(found.values)):.5g}."
    return Card("Lyapunov exponents", (told,), (grid(["exponent", "per unit of time"], rows),))


@card_of.register
def of_basins(found: Basins) -> Card:
    """The attractors, and where each is reached from."""
    rows = [[number, str(one), f"{100.0 * one.share:.1f} %"] for number, one in enumerate(found.attractors)]
    told = f"{found.number.size} starts lead to {len(rows)} attractors."
    table = grid(["attractor", "motion", "share of the starts"], rows)
    return Card("Basins of attraction", (told,), (table,), (Picture("basins", (found,)),))


@card_of.register
def of_trajectory(found: Trajectory) -> Card:
    """A simulated motion."""
    text = str(found)
    return Card("A simulated motion", (f"{text[:1].upper()}{text[1:]}.",), (), (Picture("record", (found,)),))


@card_of.register
def of_play(found: PlayFromChaos) -> Card:
    """The play as exponents tell it, and what each level says."""
    told = ["–" if one.exponent is None else f"{one.exponent:.3g} ± {one.stderr:.2g}" for one in found.levels]
    rows = [[f"{np.degrees(one.amplitude):.4g} deg", one.word, words] for one, words in zip(found.levels, told)]
    table = grid(["amplitude of the base", "verdict", "exponent per drive period"], rows)
    said = tuple(line.strip() for line in str(found).splitlines())
    return Card("The play from exponents", said, (table,), (Picture("play_likelihood", (found,)),))


@card_of.register
def of_expected_precision(found: ExpectedPrecision) -> Card:
    """What a set of drive levels would tell of the play."""
    return Card("What these drive levels are worth", (f"{found}.",), (), (Picture("expected_precision", (found,)),))


@card_of.register
def of_exponent_map(found: ExponentMap) -> Card:
    """Exponents over the drive's amplitude; drawn where there is no further axis."""
    text = str(found)
    pictures = () if found.axes else (Picture("exponent_over_drive", (found,)),)
    return Card("Exponents over the drive", (f"{text[:1].upper()}{text[1:]}.",), (), pictures)


@card_of.register
def of_pattern(found: PatternMatch) -> Card:
    """How much of a region shows a pattern, and what it depends on."""
    text = str(found)
    rows = [[name, f"{100.0 * share:.0f} %"] for name, share in found.matters().items()]
    names = [name for name in found.axes if name != "backlash"][:1]
    pictures = tuple(Picture("pattern_region", (found, name)) for name in names)
    return Card(
        "A pattern of regimes", (f"{text[:1].upper()}{text[1:]}.",), (grid(["axis", "share of the variance"], rows),), pictures
    )
