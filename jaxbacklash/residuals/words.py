"""Findings in plain sentences."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..fitting import Fit, error_in_words
from .failures import PLACES, Dependence
from .surface import Surface

NOISE = "What is left is noise: the error is {error}, and no torque is missing{where} beyond {bound:.2g} {unit}."
NONE_ON_LINK = "On the link no torque is missing beyond {bound:.2g} {unit}."
NOT_APART = (
    "The torque is told at the motor: one that acts on the link shows there as well, and the motor's encoder alone does not tell "
    "the two apart."
)
STRONG = 0.1
"""Share of the variance of ranks below which a dependence is not worth a sentence."""


def headline(fit: Fit, surface: Surface) -> str:
    """How much is missing."""
    if fit.score.rms < 1.05:
        return (
            f"Window by window the misfit looks like noise ({error_in_words(fit.score)}), but the record as a whole asks for a "
            f"torque of {surface.rms:.3g} {surface.unit} rms."
        )
    return (
        f"The misfit is {error_in_words(fit.score)} (median window {fit.score.median:.3g}): a torque of "
        f"{surface.rms:.3g} {surface.unit} rms is missing."
    )


def sentences(surface: Surface, asked: Sequence[Dependence]) -> list[str]:
    """One sentence for the best coordinates, one for the place, and one for each further telling dependence."""
    told = [best_coordinates(surface)]
    found = {(d.coordinate, d.of): d for d in asked if d.significant and d.strength > STRONG}
    place = found.get(("place", "size")) or found.get(("place", "value"))
    if place is not None:
        told.append(_place(place))
    told.append(_sides(surface))
    kept: list[tuple[float, str]] = []
    for key, dependence in found.items():
        text = _sentence(dependence, surface, found)
        if text and key[0] != "place":
            # What the best coordinates are is told first; the rest by strength.
            kept.append((dependence.strength + (1.0 if key[0] in surface.coordinates else 0.0), text))
    told += [text for _, text in sorted(kept, reverse=True)[:2]]
    return [text for text in told if text]


def best_coordinates(surface: Surface) -> str:
    """What a missing torque depends on."""
    if surface.share < 0.3:
        return f"No coordinate that was tried explains it: the best table predicts only {100 * surface.share:.0f} % of it."
    return str(surface)


def _place(d: Dependence) -> str:
    share, time = 100.0 * d.share, 100.0 * d.time
    contact = share[[0, 4]].sum(), time[[0, 4]].sum()
    for index in (0, 4, 1, 3):
        if share[index] > 60.0 and share[index] > 1.3 * time[index]:
            where = PLACES[index].replace("contact, ", "in contact on the ")
            where = where if index in (0, 4) else f"near the {where}"
            return _lies(share[index], where, time[index])
    if contact[0] > 60.0 and contact[0] > 1.3 * contact[1]:
        sides = f"in contact, {share[4]:.0f} % on the positive side and {share[0]:.0f} % on the negative one"
        return _lies(contact[0], sides, contact[1])
    if share[2] > 60.0 and share[2] > 1.3 * time[2]:
        return _lies(share[2], "inside the play", time[2])
    if d.of == "value" and share[2] > 0.3 * time[2]:
        inside = f"{share[2]:.0f} % of its mean square in {time[2]:.0f} % of the time"
        return f"It acts inside the play ({inside}) as well as in contact."
    return ""


def _lies(share: float, where: str, time: float) -> str:
    return f"{share:.0f} % of it (in mean square) lies {where}, where the joint is {time:.0f} % of the time."


def _sides(surface: Surface) -> str:
    """How the torque answers speed on either side of the play and inside it."""
    if surface.coordinates != ("side", "dz"):
        return ""
    speeds = np.asarray(surface.knots[1])
    table = surface.table.reshape(3, -1)
    used = [surface.coordinate_values[:, 0] == side for side in (-1, 0, 1)]
    reach = [np.max(np.abs(surface.coordinate_values[rows, 1]), initial=0.0) for rows in used]
    slope = [np.polyfit(speeds, row, 1, w=(np.abs(speeds) <= r) + 1e-6)[0] for row, r in zip(table, reach)]
    unit = surface.unit + (" s/rad" if surface.unit.endswith("N m") else " s" if "/" in surface.unit else " s/m")
    return (
        f"Against z' it slopes by {slope[2]:.3g} {unit} in contact on the positive side, {slope[1]:.3g} inside the play and "
        f"{slope[0]:.3g} in contact on the negative side."
    )


def _sentence(d: Dependence, surface: Surface, found: dict[tuple[str, str], Dependence]) -> str:
    unit, key = surface.unit, (d.coordinate, d.of)
    if key == ("sign_dz", "value"):
        other = found.get(("sign_dy", "value"))
        if other is not None and other.strength > d.strength:
            return ""
        by_speed = found.get(("dz", "value"))
        # Where the speed tells much more than its sign does, the sign alone would mislead.
        if by_speed is not None and d.strength < 0.6 * by_speed.strength:
            return ""
        return _signs(d, "the relative motion", "z'", unit)
    if key == ("sign_dy", "value"):
        other = found.get(("sign_dz", "value"))
        if other is not None and other.strength > d.strength:
            return ""
        return _signs(d, "the motion of the link", "y'", unit)
    if abs(d.trend) < 0.3 and d.coordinate not in surface.coordinates:
        return ""
    low, high = _middle(d, 0), _middle(d, -1)
    name = {"speed": "|z'|"}.get(d.coordinate, d.label)
    if d.of == "size":
        rival = found.get(("frequency", "size")) if d.coordinate == "t" else None
        if d.rms[-1] < 2.5 * d.rms[0] < 6.25 * d.rms[-1] or (rival is not None and abs(rival.trend) > 0.3):
            return ""  # little to tell, or a chirp, whose time is its frequency
        way = "grows" if d.trend > 0 else "shrinks"
        return f"It {way} with {name}: {d.rms[0]:.3g} {unit} rms at {low}, {d.rms[-1]:.3g} at {high}."
    if d.coordinate == "dz" and ("sign_dz", "value") in found and found["sign_dz", "value"].strength > 0.6 * d.strength:
        return ""  # told by the sign
    if d.coordinate == "z" and "z" not in surface.coordinates and ("y", "value") in found:
        return ""
    way = "rises" if d.trend > 0 else "falls"
    if abs(d.trend) < 0.3:
        peak = int(np.argmax(np.abs(d.mean)))
        at = float(np.mean(d.edges[peak : peak + 2]))
        mean = f"{d.mean[peak]:.3g} {unit}"
        return f"It neither rises nor falls with the {name}: on average it is largest, {mean}, near {at:.3g} {d.unit}."
    return f"It {way} with the {name}: on average {d.mean[0]:.3g} {unit} at {low}, {d.mean[-1]:.3g} at {high}."


def _signs(d: Dependence, motion: str, symbol: str, unit: str) -> str:
    way = "opposes" if d.mean[1] < d.mean[0] else "drives"
    return (
        f"It {way} {motion}, with the sign of {symbol}: on average {d.mean[1]:.3g} {unit} while {symbol} > 0 and "
        f"{d.mean[0]:.3g} {unit} while {symbol} < 0."
    )


def _middle(d: Dependence, index: int) -> str:
    at = float(np.mean(d.edges[:2] if index == 0 else d.edges[-2:]))
    return f"{at:.3g} {d.unit}".strip()
