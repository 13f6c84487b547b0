"""Simulate a system under an excitation, through diffrax: one place for steps and tolerances.

Two ways. ``fixed`` steps, located at the edges of the play and where dry friction brings the link to rest, are what the fit
uses: exact switches, fourth order, cheap. ``adaptive`` steps with smoothed corners and signs are the referee: another
method, another treatment of the switches.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from .effects import Servo
from .excitation import AbstractExcitation, Rest, Sampled
from .frames import dataframe
from .mechanics import Drive
from .precision import require_double_precision
from .records import Record
from .showing import Shown
from .system import System

Array = Any

LONG = 60_000
"""Panels of a run from which on it is computed in pieces."""
PIECE = 8192
"""Panels in such a piece."""
ROUGH_PANELS = 8
"""Straight lines a sample that stand for a force that is held or curved, unless said."""
MOST_FINER = 16
"""A play is followed by panels so many times shorter than usual, and no more: a tiny one is hardly felt."""


class Driven(eqx.Module):
    """What the solvers take as ``args``: systems and excitations travel as data, so that new numbers compile nothing."""

    system: System
    excitation: AbstractExcitation
    t0: Any


class Trajectory(Shown, eqx.Module):
    """A simulated motion at N times.

    ``t`` (N,) [s]; ``states`` one (N,) array per name in ``System.state_names``; ``drive`` at the same times;
    ``observed`` (N,) the measured channel without noise, of a drive (N, C) its encoders'.
    """

    t: Array
    states: tuple[Array, ...]
    drive: Drive
    observed: Array

    @property
    def y(self) -> Array:
        """Absolute motion of the link [rad], (N,)."""
        return self.states[0]

    @property
    def dy(self) -> Array:
        """Absolute speed of the link [rad/s], (N,)."""
        return self.states[1]

    @property
    def x(self) -> Array:
        """Base motion [rad], (N,); of a drive that of the motor behind its gear."""
        return jnp.broadcast_to(self.drive.x, self.t.shape)

    @property
    def z(self) -> Array:
        """Relative motion y - x [rad], (N,)."""
        return self.y - self.x

    def __str__(self) -> str:
        return f"a simulated motion of {self.t.size} samples from {float(self.t[0]):g} to {float(self.t[-1]):g} s"

    def to_dataframe(self) -> Any:
        """The motion as a `pandas.DataFrame` along ``t`` [s]: ``x``, ``y``, ``dy``, ``z``, what is ``observed``, the ``force``.

        Examples
        --------
        >>> joint = jb.base_motion_joint(inertia=3.16, backlash=0.026, stiffness=11000.0, damping=20.0)
        >>> motion = jb.simulate(joint, jb.Harmonic(0.05, 10.0), duration=1.0, rate=100.0)
        >>> list(motion.to_dataframe().columns)
        ['x', 'y', 'dy', 'z', 'observed', 'force']
        """
        columns = {name: np.asarray(getattr(self, name)) for name in ("t", "x", "y", "dy", "z", "observed")}
        force = np.broadcast_to(np.asarray(self.drive.force), columns["t"].shape)
        return dataframe({**columns, "force": force}, "t")


def simulate(
    system: System,
    excitation: AbstractExcitation | None = None,
    *,
    duration: float,
    rate: float = 500.0,
    y0: float | None = None,
    dy0: float | None = None,
    th0: float | None = None,
    dth0: float | None = None,
    t0: float = 0.0,
    panels_per_sample: int | None = None,
    adaptive: bool = False,
    rtol: float = 1e-9,
    atol: float = 1e-12,
) -> Trajectory:
    """Simulate a system from given initial values and return N = duration * rate + 1 samples.

    Parameters
    ----------
    system : what moves; its ``contact.width`` matters only to the adaptive referee
    excitation : base motion or force; None: free decay
    duration, rate : [s], samples per second [Hz]
    y0, dy0 : start of the link [rad, rad/s]; default: with the base, at its speed; of a drive at rest
    th0, dth0 : start of the motor of a drive [rad, rad/s]; default: where the link is, in the middle of the play
    t0 : start time [s]
    panels_per_sample : integration panels between samples (a panel is two Runge-Kutta steps); default: at most 1 ms
        each, at least 20 a period of the contact resonance, and none so long that the link goes right through the play in it
    adaptive : use diffrax's adaptive Dopri8 with the smoothed corner, as a referee
    rtol, atol : tolerances of the referee

    Returns
    -------
    `Trajectory`: ``t``, ``x``, ``y``, ``dy``, ``z`` and what is ``observed``, (N,) each

    Raises
    ------
    RuntimeError
        JAX is in single precision, or the referee ran out of steps.

    Examples
    --------
    >>> joint = jb.base_motion_joint(inertia=3.16, backlash=0.026, stiffness=15000.0, damping=20.0)
    >>> motion = jb.simulate(joint, jb.Harmonic(0.05, 10.0), duration=1.0, rate=100.0)
    >>> motion.z.shape
    (101,)
    >>> bool(abs(motion.z).max() > 0.013)  # it leaves the play
    True
    """
    require_double_precision("simulate")
    drive = Rest() if excitation is None else excitation
    samples = round(duration * rate) + 1
    start = drive.at(jnp.asarray(float(t0)))
    y = jnp.asarray(start.x if y0 is None else float(y0), dtype=float)
    dy = jnp.asarray(start.dx if dy0 is None else float(dy0), dtype=float)
    state = tuple(jnp.asarray(s, dtype=float) for s in system.rest(jnp.asarray(float(t0)), y, dy, start))
    if system.motor is not None:
        given = (jnp.asarray(s if v is None else float(v), dtype=float) for s, v in zip(state[2:4], (th0, dth0)))
        state = (*state[:2], *given, *state[4:])
    args = Driven(system, drive, jnp.asarray(float(t0)))
    if adaptive:
        times, states = _adaptive(args, state, jnp.asarray(1.0 / rate), samples, rtol, atol)
    else:
        every = panels_per_sample or default_panels(system, rate)
        times, states = _in_pieces(args, state, jnp.asarray(1.0 / rate), samples - 1, every, system.switches)
        finer = every if panels_per_sample else crossing_panels(system, drive, times, states, rate, every)
        if finer > every:
            times, states = _in_pieces(args, state, jnp.asarray(1.0 / rate), samples - 1, finer, system.switches)
    at = jax.vmap(drive.at)(times)
    if system.motor is not None:
        at = dataclasses.replace(at, **dict(zip(("x", "dx"), system.base(states, at.x, at.dx))))
    observed = jax.vmap(system.output)(times, states, at)
    return Trajectory(times, states, at, observed)


def default_panels(system: System, rate: float) -> int:
    """Panels between samples: none longer than 1 ms, at least 20 in a period of the contact resonance, or of a servo."""
    longest = min(1e-3, 2.0 * np.pi / max(float(system.pace), 1e-9) / 20.0)
    return max(1, int(np.ceil(1.0 / rate / longest - 1e-9)))


def crossing_panels(system: System, drive: AbstractExcitation, times: Array, states: Any, rate: float, every: int) -> int:
    """Panels between samples, ``every`` at least, so that none holds both edges of the play: a panel finds the first it meets."""
    play = getattr(system.contact, "backlash", None)
    at = jax.vmap(drive.at)(times)
    speeds = states[1] - system.base(states, at.x, at.dx)[1]
    if play is None or any(isinstance(v, jax.core.Tracer) for v in (play, speeds)):
        return every
    fastest = float(np.max(np.abs(speeds), initial=0.0, where=np.isfinite(speeds)))
    if not (float(play) > 0.0 and fastest > 0.0):
        return every
    # A multiple, so that what drives is read at the same places.
    return every * int(min(max(1, np.ceil(fastest / (rate * float(play) * every))), MOST_FINER))


def _in_pieces(args: Driven, state: Any, dt: Any, intervals: int, every: int, located: bool) -> Any:
    """`_fixed`, a long run one piece after the other: what a step costs grows with the length of the run that it is in."""
    if intervals * every <= LONG or any(isinstance(leaf, jax.core.Tracer) for leaf in jax.tree.leaves((args, state))):
        return _fixed(args, state, dt, intervals, every, located)
    piece, parts = max(1, PIECE // every), []
    for first in range(0, intervals, piece):  # the last one runs on beyond the end: all are the same program
        here = Driven(args.system, args.excitation, args.t0 + dt * first)
        edges = [np.asarray(edge) for edge in _fixed(here, state, dt, piece, every, located)[1]]
        state = tuple(jnp.asarray(edge[-1]) for edge in edges)
        parts.append([edge[:-1] for edge in edges])
    ends = [np.asarray(edge)[-1:] for edge in edges]
    whole = tuple(np.concatenate([*column, end])[: intervals + 1] for column, end in zip(zip(*parts), ends))
    return args.t0 + dt * jnp.arange(intervals + 1), tuple(jnp.asarray(column) for column in whole)


@eqx.filter_jit
def _fixed(args: Driven, state: Any, dt: Any, intervals: int, every: int, located: bool) -> Any:
    from .solvers.panel_solver import DrivenTerm, PanelRK4  # diffrax loads a quarter of a second, for which few commands wait

    # One step of the solver is the whole run. `diffrax.diffeqsolve` would ask for no other, in a larger program.
    solver = PanelRK4(intervals * every, intervals, located)
    edges = solver.step(DrivenTerm(), 0.0, dt * intervals, state, args, None, False)[2]["edges"]
    return args.t0 + dt * jnp.arange(intervals + 1), tuple(edges)


@eqx.filter_jit
def _adaptive(args: Driven, state: Any, dt: Any, samples: int, rtol: float, atol: float) -> Any:
    import diffrax

    from .solvers.panel_solver import DrivenTerm

    times = dt * jnp.arange(samples)
    solution = diffrax.diffeqsolve(
        DrivenTerm(), diffrax.Dopri8(), times[0], times[-1], dt, state, args,
        saveat=diffrax.SaveAt(ts=times), max_steps=1_000_000, adjoint=diffrax.ForwardMode(),
        stepsize_controller=diffrax.PIDController(rtol=rtol, atol=atol, dtmax=0.01),
    )  # fmt: skip
    return args.t0 + times, solution.ys


def measured_base(record: Record, *, between: str | None = None, panels: int = ROUGH_PANELS) -> Sampled:
    """The measured drive of a record as an excitation, going on between its samples as a fit takes it.

    Base motion and a smooth force go along their smoothing splines; of a rough force `jaxbacklash.records.force.way` decides.

    Parameters
    ----------
    record : what was measured
    between : how a model says that a rough force goes on; None asks the record
    panels : straight lines a sample that stand for a force that is held or curved, best as many as the simulation has panels

    Returns
    -------
    the drive, for `simulate` and `jaxbacklash.dynamics`

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> joint = jb.base_motion_joint(inertia=3.16, backlash=0.026, stiffness=13000.0, damping=12.0)
    >>> motion = jb.simulate(joint, jb.measured_base(record), duration=2.0)
    >>> bool(abs(motion.x - record.channels["x"][:1001]).max() < 2e-4)
    True
    """
    # scipy's splines load a sixth of a second, for which a map need not wait
    from .records.force import way
    from .signals import choose_intervals, edges_between, fit_spline, span

    def smooth(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        spacing = span(record.dt) / choose_intervals(record.t, values, span(record.dt))
        spline = fit_spline(record.t, values, record.t[0], spacing)
        return spline(record.t), spline(record.t, 1)

    zero, dt, rate = np.zeros(record.samples), record.dt, None
    x, dx = smooth(record.channels["x"]) if "x" in record.channels else (zero, zero)
    force, how = record.channels.get("F", zero), way(record, between)
    if how == "smooth":
        force, rate = smooth(force)
    elif how != "straight":  # at a base at rest
        force, dt = edges_between(force, panels, how), dt / panels
        x = dx = np.zeros(force.size)
    a = jnp.asarray
    return Sampled(a(record.t[0]), a(dt), a(x), a(dx), a(force), None if rate is None else a(rate))


def as_record(trajectory: Trajectory, system: System, *, path: str = "") -> Record:
    """A simulated motion as a record with the channels a measurement would have."""
    if system.motor is not None:
        push = np.zeros(1) if trajectory.drive.torque is None else np.asarray(trajectory.drive.torque)
        seen = {name: np.asarray(trajectory.observed)[:, i] for i, name in enumerate(system.channels)}
        told_by = "command" if isinstance(system.motor, Servo) else "torque"
        channels = {told_by: np.broadcast_to(push, trajectory.t.shape).copy(), **seen}
        told = frozenset({"t", *channels})
        return Record(np.asarray(trajectory.t), channels, path, confirmed=told, ratio=float(system.motor.ratio))
    channels = {}
    force = np.asarray(jnp.broadcast_to(trajectory.drive.force, trajectory.t.shape))
    if np.any(np.asarray(trajectory.x)):
        channels["x"] = np.asarray(trajectory.x)
    if np.any(force):
        channels["F"] = force
    channels[system.observed] = np.asarray(trajectory.observed)
    # What was computed is in seconds and radians, however large.
    return Record(np.asarray(trajectory.t), channels, path, confirmed=frozenset({"t", *channels}))
