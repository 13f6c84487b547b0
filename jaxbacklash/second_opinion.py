"""Other methods beside a fit: skeletons by Hilbert transform and wavelet, which share nothing with it but the samples.

Both know the joint alone; the torque of effects that the fit has found is taken from its model along the measured motion and
told to them as a known load. Where they disagree, the sentence says which assumption broke.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .effects import Contact
from .errors import BadInput, NoAnswer
from .fitting import Fit
from .frames import dataframe
from .pointwise import along
from .regression.force_loop import read_plateau
from .showing import Shown
from .signals import choose_intervals, fit_spline, span
from .skeletons import Skeleton, Skeletons, skeleton
from .skeletons.result import INDEX

AGREE = 3.0
"""Standard errors of the difference within which two methods agree."""
READING = 0.03
"""Share of its width to which a plateau can be read off a loop."""
NEGLIGIBLE = 0.005
"""Relative difference of play and stiffness that nobody would call disagreement, whatever the error bars say."""
JUDGED = ("backlash", "stiffness")
METHODS = {"hilbert": "Hilbert transform", "wavelet": "wavelet"}


@dataclass(frozen=True)
class CrossCheck(Shown):
    """What other methods say about a fit: ``agrees`` is None where none could judge; ``why`` and ``text`` are sentences.

    ``apart`` holds (method, parameter, standard errors) of every disagreement.
    """

    skeletons: Skeletons | None
    agrees: bool | None
    text: str
    why: str = ""
    apart: tuple[tuple[str, str, float], ...] = ()
    loop: dict[str, Any] | None = None

    def __str__(self) -> str:
        return self.text

    def to_dataframe(self) -> Any:
        """What each method tells of each parameter, see `Skeletons.to_dataframe`; no rows where none could be asked."""
        if self.skeletons is None:
            return dataframe({"method": [], "parameter": [], "value": [], "stderr": [], "unit": [], "why": []}, INDEX)
        return self.skeletons.to_dataframe()

    def as_json(self) -> dict[str, Any]:
        """The entries ``hilbert``, ``wavelet``, ``agrees``, ``text``, ``masked_fraction`` of result.json."""
        found: dict[str, Any] = {}
        if self.skeletons is not None:
            for method in self.skeletons.methods:
                found[method.method] = {name: value.as_json() for name, value in method.parameters.items()}
            found["masked_fraction"] = self.skeletons.masked_fraction
        if self.loop is not None:
            found["loop"] = self.loop
        found |= {"agrees": self.agrees, "text": self.text}
        return found | ({"why": self.why} if self.why else {})


def cross_check(fit: Fit) -> CrossCheck:
    """Set the Hilbert and wavelet skeletons of the fit's first record beside it. Never raises for a record it cannot use.

    Returns
    -------
    `CrossCheck`: prints a sentence; ``agrees`` is None where no method could judge

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> print(jb.cross_check(jb.fit(record, inertia=3.16, effects=["gravity"], starts=1)))
    Hilbert transform and wavelet...
    """
    record = fit.records[0]
    if record.kind == "transmitted":
        return beside_loop(fit)
    if record.kind == "drive":
        return _silent("the torque of its motor drives this joint, and skeletons know a base that is prescribed")
    if not isinstance(fit.system.contact, Contact):
        return _silent("the model has no play, so there is none to compare")
    try:
        with np.errstate(all="ignore"):
            inertia = float(fit.system.inertia)
            found = skeleton(record, inertia, load=_loads(fit), translational=fit.translational)
    except (BadInput, NoAnswer, np.linalg.LinAlgError, ValueError, IndexError) as error:
        return _silent(f"the skeletons failed: {error}")
    judges = [method for method in found.methods if not method.why]
    if not judges:
        return _silent(found.hilbert.why or found.wavelet.why, found)
    apart, asked = [], 0
    for method in judges:
        for name in JUDGED:
            distance = _apart(fit, method, name)
            if distance is None:
                continue
            asked += 1
            if distance > AGREE:
                apart.append((method.method, name, distance))
    if not asked:
        return _silent("neither the fit nor the skeletons tell a play and a stiffness to compare", found)
    if not apart:
        names = " and ".join(METHODS[m.method] for m in judges)
        agree = f"{names[:1].upper()}{names[1:]}, independent of the fit, agree with its play and stiffness"
        missing = _left_out(found)
        return CrossCheck(
            found, True, f"{agree}. Their errors allow for what they do not know: {missing}." if missing else f"{agree}."
        )
    return CrossCheck(found, False, _broken(fit, found, tuple(apart)), "", tuple(apart))


def beside_loop(fit: Fit) -> CrossCheck:
    """Read the play off a force loop without a model, and off the fit's prediction in the same way.

    Both count the travel over which less than a tenth of the sliding force is carried, so a contact that begins softly makes
    them differ from the fitted play, but not from one another where the model is right.
    """
    record = fit.records[0]
    x = record.channels["x"]
    unit = "m" if fit.translational else "rad"
    known, told = read_plateau(x, record.channels["T"]), read_plateau(x, fit.score.predicted)
    loop: dict[str, Any] = {"backlash": known.as_json(unit), "backlash_of_model": told.as_json(unit)}
    if known.median is None or told.median is None:
        why = "the force does not pass from one side to the other, so there is no play to read off"
        return CrossCheck(None, None, f"The force loop cannot judge this fit: {why}.", why, (), loop)
    spread = max(float(np.hypot(known.stderr or 0.0, told.stderr or 0.0)), READING * known.median)
    distance = abs(known.median - told.median)
    words = f"Read off the force loop, the joint carries next to nothing over {known.median:.3g} {unit} of travel"
    if distance < AGREE * spread:
        return CrossCheck(None, True, f"{words}, and so does the model's: {told.median:.3g} {unit}.", "", (), loop)
    side = "wider" if told.median > known.median else "narrower"
    words += f", the model's over {told.median:.3g} {unit}: the contact does not begin as the model has it, and the fitted play"
    return CrossCheck(None, False, f"{words} is {side} than what is seen.", "", (("loop", "backlash", distance / spread),), loop)


def _silent(why: str, found: Skeletons | None = None) -> CrossCheck:
    return CrossCheck(found, None, f"Hilbert transform and wavelet cannot judge this fit: {why}.", why)


def _apart(fit: Fit, method: Skeleton, name: str) -> float | None:
    """Distance of the fit's value from the skeleton's in standard errors of the difference; None where either has none."""
    ours, theirs = fit.parameters.get(name), method.parameters.get(name)
    if ours is None or theirs is None or ours.value is None or theirs.value is None or theirs.stderr is None:
        return None
    difference = abs(ours.value - theirs.value)
    if difference < NEGLIGIBLE * abs(ours.value):
        return 0.0
    return float(difference / max(float(np.hypot(theirs.stderr, ours.stderr or 0.0)), 1e-300))


def _broken(fit: Fit, found: Skeletons, apart: tuple[tuple[str, str, float], ...]) -> str:
    """Which assumption broke: the first of those that can be tested and fails."""
    method, name, distance = max(apart, key=lambda entry: entry[2])
    said = f"The {METHODS[method]} tells another {name} than the fit, by {distance:.1f} standard errors"
    drifting = next((s for m in found.methods for s in m.warnings if s.startswith("large amplitudes")), "")
    missing = _left_out(found)
    if not fit.adequate:
        own = "each method takes what is missing for play and stiffness in its own way"
        return f"{said}: the model misses something, and {own}{'; ' + missing if missing else ''}."
    if missing:
        return f"{said}; {missing}."
    if drifting:
        return f"{said}; {drifting}."
    hidden = sorted(name for name, effect in fit.system.effects.items() if effect.states)
    if hidden:
        return f"{said}: {' and '.join(hidden)} has a state of its own, whose torque the skeletons cannot be told."
    one = {m.method for m in found.methods if not m.why} - {entry[0] for entry in apart}
    if one:
        other = METHODS[one.pop()]
        return f"{said}, the {other} does not: more likely the {METHODS[method]}'s assumption of a slow envelope has broken."
    masked = found.masked_fraction
    if masked > 0.5:
        return f"{said}: {100 * masked:.0f} % of the record had to be masked, so the skeleton may not be typical of the whole."
    return f"{said}, though the model explains the record: the skeleton's assumption of one slow oscillation has broken."


def _left_out(found: Skeletons) -> str:
    """The skeletons' own sentence about a torque that they were not told of, without the advice that is meant for them alone."""
    said = next((sentence for sentence in found.warnings if "was left out" in sentence), "")
    return said.split(";")[0]


def _loads(fit: Fit) -> np.ndarray | None:
    """Torque of the fit's effects along the measured motion [N m], shape (N,), None where there are none.

    Internal states (hysteresis, a second inertia) stay at rest here: they are not measured.
    """
    system, record = fit.system, fit.records[0]
    if not system.effects:
        return None
    zero = np.zeros(record.samples)
    channels = record.channels
    x, dx = _smooth(record.t, channels.get("x", zero))
    y, dy = _smooth(record.t, channels["y"] if "y" in channels else channels["z"] + channels.get("x", zero))
    whole, bare = (along(of, record.t, y, dy, x, dx) for of in (system, system.without(*system.effects)))
    return whole.torque - bare.torque


def _smooth(t: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    if not np.any(values):
        return values, values
    window = span(t[1] - t[0])
    spline = fit_spline(t, values, t[0], window / choose_intervals(t, values, window))
    return spline(t), spline(t, 1)
