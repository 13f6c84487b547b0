r"""Does what a model leaves hang together in a way that no law of the catalogue has? The last test before a model is complete.

A misfit over all samples hides what is small; along one direction it shows (as powers of what was fitted do in Ramsey's RESET,
1969). Simple torques that the catalogue does not hold, products of the motion's coordinates and a rhythm of its own, are held
against the model's own motion, free of noise: their score tests propose, and what the likeliest bring is tried.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import equinox as eqx
import numpy as np

from ..fitting.settings import ALIKE, SEEN, SURE
from ..pointwise import along
from ..regression.along_motion import Motion
from ..regression.weak_form import WeakForm
from ..shooting.levenberg import Levenberg, minimise
from ..system import System
from .candidates import column_gains, likeliest_sine
from .evidence import demanded, most_of_noise
from .fitted_model import FittedModel
from .model_builder import ModelBuilder
from .perturbed import answered, as_it_ended, blurred, delayed, model_record, panel_edges, parabola


@dataclass(frozen=True)
class Unnamed:
    """A torque that no law in the catalogue exerts: ``words`` for what it goes with, ``fall`` of the sum of squares, in units of
    the noise, that it promises."""

    words: str
    fall: float


@dataclass(frozen=True)
class Glimpse:
    """A torque (W, P + 1) at the panel edges of the model's own motion, at its likeliest size: one of ``tried`` of its kind.
    ``evidence``, the fall of twice the cost that it promises."""

    words: str
    torque: np.ndarray
    evidence: float
    tried: int

    @property
    def chance(self) -> float:
        """What the best of so many torques brings where none is missing."""
        return 2.0 * float(np.log(self.tried))


def unnamed(builder: ModelBuilder, model: FittedModel) -> Unnamed | None:
    """The torque outside the catalogue that a model clearly asks for, the clearest; None where there is none.

    Of a model that leaves more than noise, and of a link that is not seen, nothing is told.
    """
    if builder.weak_form.blind or model.misfit > most_of_noise(model):
        return None
    problem, unknowns = as_it_ended(builder, model)
    ended = minimise(problem, unknowns, Levenberg(limit=1)).stats
    still = float(ended["cost"] - ended["promise"])
    own = WeakForm(model_record(builder, ended["predicted"]))
    applied = np.asarray(builder.windows.force)
    unit = 0.5 * max(1.0, model.misfit**2) * model.correlation
    found = []
    likely = glimpses(builder, model, own)
    # What a sensor explains as well that was read along a line between two samples, as one that lags may be, is no torque.
    read = 0.5 * blurred(builder, model) / unit if likely and delayed(builder, model) else 0.0
    for seen in likely:

        def rise(share: float, torque: np.ndarray = seen.torque) -> float:
            return answered(eqx.tree_at(lambda p: p.windows.force, problem, applied + share * torque), unknowns)[0] - still

        bar = read + seen.chance + SURE * demanded(builder)
        fall = best_fall(rise) / unit
        if fall > bar:
            found.append(Unnamed(seen.words, fall))
    return max(found, key=lambda one: one.fall, default=None)


def best_fall(rise: Callable[[float], float], furthest: float = 3.0) -> float:
    """The largest fall of a cost over sizes of a torque; ``rise`` tells how far the cost rises with one.

    Sizes are in units of what the weak form says; a parabola through sizes 1 and 2 is followed no further than ``furthest``, one
    such step beyond.
    """
    once, twice = rise(1.0), rise(2.0)
    slope, curvature = parabola(once, twice, 1.0)
    best = -slope / curvature if np.isfinite(curvature) and curvature > 0.0 else 0.0
    # What the parabola says of its own lowest point is not believed but tried: corners bend it.
    return max(-min(once, twice), -rise(float(np.clip(best, -furthest, furthest))))


def glimpses(builder: ModelBuilder, model: FittedModel, own: WeakForm, keep: int = 3) -> list[Glimpse]:
    """The ``keep`` likeliest torques outside the catalogue beside a model, whose own motion looks like ``own``, by the score test
    of each along it.

    What the model's parameters can do is taken off them, so that they bend its trajectory no more than they have to.
    """
    words, torques = zip(*products(model.system, own.motion).items())
    rows, by = np.stack(torques), own.along(model.system, model.free)[1]
    left = rows - np.linalg.lstsq(by.T, rows.T, rcond=None)[0].T @ by
    told = np.sum(left**2, axis=1) > ALIKE * np.sum(rows**2, axis=1)
    edges = panel_edges(builder)
    at_edges = np.array([np.interp(edges, own.motion.t, row) for row in left[told]])
    gains = column_gains(*as_it_ended(builder, model), len(model.free), at_edges)
    named = zip(np.array(words)[told], at_edges, gains)
    found = [Glimpse(str(word), float(size[0]) * torque, gain, len(words)) for word, torque, (size, gain) in named]
    if (sine := likeliest_sine(builder, model)) is not None:
        course = sine.amplitude * np.sin(sine.frequency * edges + sine.phase)
        found.append(Glimpse(f"a rhythm of its own of {sine.frequency / (2.0 * np.pi):.3g} Hz", course, sine.gain, sine.tried))
    likely = [g for g in found if g.evidence > max(SEEN, g.chance)]
    return sorted(likely, key=lambda g: -g.evidence)[:keep]


def products(system: System, m: Motion) -> dict[str, np.ndarray]:
    """Torques (N,) of no law in the catalogue, by what they go with: products of the coordinates of joint, link and base."""
    now = along(system.on_its_base(), *m.rows).now
    pressed, touching = np.asarray(now.deflection), np.asarray(now.contact)
    free = 1.0 - touching
    z, dz, y, dy, dx = m.y - m.x, m.dy - m.dx, m.y, m.dy, m.dx
    return {
        "deflection and speed in contact": pressed * np.abs(dz),
        "deflection and the square of speed in contact": pressed * dz**2,
        "the square of deflection": pressed * np.abs(pressed),
        "the square of deflection, one way": pressed**2,
        "speed and the square of deflection": dz * pressed**2,
        "the square of speed in contact": touching * dz * np.abs(dz),
        "the square of speed in contact, one way": touching * dz**2,
        "the square of speed in the play": free * dz * np.abs(dz),
        "the square of speed in the play, one way": free * dz**2,
        "position in the play": free * z,
        "position and speed in the play": free * z * np.abs(dz),
        "the square of the angle": y**2,
        "the cube of the angle": y**3,
        "angle and speed of the link": y * np.abs(dy),
        "angle and the square of the link's speed": y * dy**2,
        "speed of the link and the square of its angle": dy * y**2,
        "the link's speed": dy,
        "the square of the link's speed, one way": dy**2,
        "the cube of the link's speed": dy**3,
        "the base's speed": dx,
        "the square of the base's speed": dx * np.abs(dx),
    }
