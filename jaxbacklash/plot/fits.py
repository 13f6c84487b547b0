"""Pictures of fits and comparisons: the record beside its model, what is left, and the joint itself."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..errors import BadInput
from ..fitting import Comparison, Fit, Score
from ..parameters import channel_unit, unit_text
from ..records import MeasuredSeries, Record
from ..regression.force_loop import NOTHING, sliding_level
from ..simulation import Trajectory
from ..system import System
from .drawing import Drawn, Where
from .joints import force_loop as loop_of_force
from .joints import phase_plane as plane_of_phases
from .joints import restoring_force as force_over_motion
from .motion import INSIDE, Motion, joint_law
from .times import channels_in_time, measured_against_model, residual_in_time, stretch_of_model


class Beside(NamedTuple):
    """A model beside one record, whoever has set it there."""

    system: System
    record: Record
    score: Score
    noise: float
    translational: bool
    per_inertia: bool

    @property
    def length(self) -> str:
        """Unit of the motion."""
        return "m" if self.translational else "rad"

    @property
    def edges(self) -> tuple[float, ...] | None:
        """Edges of the play, None where there is none."""
        return tuple(float(edge) for edge in self.system.edges(0.0)) if self.system.has_play else None


def beside(found: Fit | Comparison, number: int = 0) -> Beside:
    """A fit's model beside one of its records, or a comparison's."""
    if isinstance(found, Comparison):
        return Beside(found.system, found.record, found.score, found.noise, found.translational, False)
    if not isinstance(found, Fit):
        raise BadInput(f"found a {type(found).__name__}, wanted a fit or a comparison")
    if not 0 <= number < len(found.records):
        raise BadInput(f"record {number}: the fit has {len(found.records)}, counted from 0")
    return Beside(
        found.system, found.records[number], found.scores[number], found.noise[number], found.translational, found.per_inertia
    )


def fit(found: Fit | Comparison, *, record: int = 0, between: tuple[float, float] | None = None, ax: Where = None) -> Drawn:
    """The record with its model: all of it, and below the stretch that the model misses most and a typical one.

    Each window is predicted from its own start. On one axes the whole record is drawn, or the stretch that is asked for.

    Parameters
    ----------
    found : a fit or a comparison
    record : which of a fit's records
    between : draw this stretch alone, from one time to another [s], sample by sample
    ax : axes, as many as there are panels (5, or 2 of a stretch) or one; a figure or part of one; None: a new figure

    Returns
    -------
    the axes, or an array of them

    Raises
    ------
    BadInput
        No such record, or other axes than asked for.

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> fit = jb.fit(record.between(0.0, 2.0), inertia=3.16, starts=1)
    >>> len(jb.plot.fit(fit))
    5
    >>> figure, ax = plt.subplots()
    >>> jb.plot.fit(fit, between=(0.5, 1.0), ax=ax) is ax
    True
    """
    one = beside(found, record)
    name, score = one.record.observed_name, one.score
    what: dict[str, Any] = {
        "window_starts": score.window_times, "label": name, "noise": one.noise,
        "unit": channel_unit(name, translational=one.translational),
    }  # fmt: skip
    if between is not None:
        return stretch_of_model(score.t, score.measured, score.predicted, between=between, ax=ax, **what)
    return measured_against_model(score.t, score.measured, score.predicted, window_rms=score.window_rms, ax=ax, **what)


def residuals(found: Fit | Comparison, *, record: int = 0, ax: Where = None) -> Drawn:
    """What the model leaves, over the noise: every sample, and below each window's root mean square.

    Parameters
    ----------
    found : a fit or a comparison
    record : which of a fit's records
    ax : two axes, or one for every sample; a figure or part of one; None: a new figure

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> fit = jb.fit(record.between(0.0, 2.0), inertia=3.16, starts=1)
    >>> every, windows = jb.plot.residuals(fit)
    >>> every.get_ylabel()
    'residual over noise'
    """
    score = beside(found, record).score
    return residual_in_time(score.t, score.residual, window_edges=score.window_times, window_rms=score.window_rms, ax=ax)


def record(measured: Record | MeasuredSeries | Trajectory, *, ax: Where = None) -> Drawn:
    """What was measured, or simulated, one panel a channel.

    Parameters
    ----------
    measured : a record, a series, or a motion from `jaxbacklash.simulate`
    ax : as many axes as there are channels, or one for the first of them; a figure or part of one; None: a new figure

    Returns
    -------
    the axes, or an array of them

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> [ax.get_ylabel() for ax in jb.plot.record(record)]
    ['x [rad]', 'z [rad]']
    """
    if isinstance(measured, MeasuredSeries):
        return channels_in_time(measured.t, {measured.name: (measured.values, measured.unit)}, ax=ax)
    if isinstance(measured, Trajectory):
        moved = {"x": measured.x} if np.any(measured.drive.x) else {}
        pushed = {"F": np.broadcast_to(measured.drive.force, measured.t.shape)} if np.any(measured.drive.force) else {}
        channels = {**pushed, **moved, "z" if moved else "y": measured.z if moved else measured.y}
        return channels_in_time(measured.t, {name: (np.asarray(v), channel_unit(name)) for name, v in channels.items()}, ax=ax)
    return channels_in_time(measured.t, {name: (v, channel_unit(name)) for name, v in measured.channels.items()}, ax=ax)


def phase_plane(found: Fit | Comparison | Record, *, record: int = 0, ax: Where = None) -> Drawn:
    """How often the joint passes each relative position and speed, as measured, with the play of the model.

    Parameters
    ----------
    found : a fit or a comparison, or a record, of which no play is known
    record : which of a fit's records
    ax : one axes; a figure or part of one; None: a new figure

    Returns
    -------
    the axes

    Raises
    ------
    BadInput
        The record holds the transmitted force, and no motion of the link.

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> jb.plot.phase_plane(record).get_xlabel()
    'z [rad]'
    """
    one = None if isinstance(found, Record) else beside(found, record)
    motion = _motion(found if isinstance(found, Record) else one.record)  # type: ignore[union-attr]
    edges, unit = (None, "rad") if one is None else (one.edges, one.length)
    return plane_of_phases(motion.z[INSIDE], motion.dz[INSIDE], edges=edges, unit=unit, ax=ax)


def restoring_force(found: Fit | Comparison, *, record: int = 0, ax: Where = None) -> Drawn:
    """The joint's torque over its relative motion: points from the measured motion, a line the model's law.

    Points are what the joint returns when inertia, damping and loads are taken off the smoothed motion.

    Parameters
    ----------
    found : a fit or a comparison
    record : which of a fit's records
    ax : one axes; a figure or part of one; None: a new figure

    Returns
    -------
    the axes

    Raises
    ------
    BadInput
        The model has no spring, or the record no motion of the link.

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> fit = jb.fit(record.between(0.0, 2.0), inertia=3.16, starts=1)
    >>> jb.plot.restoring_force(fit).get_ylabel()
    'torque of the joint [N m]'
    """
    one = beside(found, record)
    if one.system.contact is None:
        raise BadInput("the model has no spring, so it returns no torque that could be drawn")
    motion, joint = _motion(one.record), one.system.on_its_base()
    at = np.linspace(motion.z.min(), motion.z.max(), 801)
    return force_over_motion(
        motion.z[INSIDE], motion.restoring_torque(joint)[INSIDE], model_z=at, model_torque=joint_law(joint, at),
        edges=one.edges, unit=unit_text("N m", translational=one.translational, per_inertia=one.per_inertia),
        length_unit=one.length, ax=ax,
    )  # fmt: skip


def force_loop(found: Fit | Comparison, *, record: int = 0, ax: Where = None) -> Drawn:
    """Transmitted force over the base motion, measured and as the model predicts it.

    Parameters
    ----------
    found : a fit or a comparison of a record that holds x and T
    record : which of a fit's records
    ax : two axes, or one for both loops; a figure or part of one; None: a new figure

    Returns
    -------
    the axes, or an array of them

    Raises
    ------
    BadInput
        The record holds no transmitted force.

    Examples
    --------
    >>> t = np.arange(0.0, 4.0, 0.004)
    >>> x = 0.02 * np.sin(2.0 * np.pi * t)
    >>> force = 30.0 * np.tanh(400.0 * np.gradient(x, t))
    >>> measured = jb.Record(t, {"x": x, "T": -force + 0.3 * np.random.default_rng(0).standard_normal(t.size)})
    >>> fit = jb.fit(measured, inertia=0.5, effects=["coulomb_ground"], starts=1)
    >>> len(jb.plot.force_loop(fit))
    2
    """
    one = beside(found, record)
    if "T" not in one.record.channels:
        raise BadInput(f"{one.record.path or 'the record'}: holds no transmitted force T, wanted a record of x and T")
    force = one.record.channels["T"]
    return loop_of_force(
        one.record.channels["x"], force, one.score.predicted, level=NOTHING * sliding_level(force),
        unit=channel_unit("T", translational=one.translational), length_unit=one.length, ax=ax,
    )  # fmt: skip


def _motion(record: Record) -> Motion:
    if record.observed_name == "T":
        raise BadInput(f"{record.path or 'the record'}: holds the transmitted force and no motion of the link; draw force_loop")
    if record.kind == "drive" and record.relative is None:
        raise BadInput(f"{record.path or 'the record'}: has one encoder and no motion of the joint; draw fit or residuals")
    seen = record.on_its_base()
    return Motion(seen, seen.observed_name)
