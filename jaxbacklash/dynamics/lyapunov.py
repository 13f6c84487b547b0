r"""Lyapunov exponents by the tangent flow: the derivative of the step itself carries the tangent vectors.

For a flow :math:`\dot q = f(q, t)` the exponents are the mean logarithmic growth rates of tangent vectors, and vectors that are
kept orthogonal give the whole spectrum (Benettin, Galgani, Giorgilli, Strelcyn, Meccanica 15, 1980; Shimada, Nagashima,
Prog. Theor. Phys. 61, 1979). The tangents are carried by `jax.jvp` of the step, so no second trajectory and no difference is
taken.

**Corners and jumps.** Where a law switches, the derivative of the flow holds a jump of its own, the saltation matrix
:math:`I + (f^+ - f^-) n^T / (n \cdot f^-)` (Aizerman and Gantmacher, 1958; Leine and Nijmeijer, 2004), 1 where only the slope
of the law jumps, as at the edge of the play, and not where the torque itself does: contact damping, Coulomb friction. Located
panels end a step at the switch, at a time that is a function of the state; its derivative is part of theirs: the saltation.
A link that sticks loses a direction: its smallest exponent is then minus infinity.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from ..errors import NoAnswer
from ..excitation import AbstractExcitation, Harmonic, Rest
from ..frames import dataframe
from ..precision import require_double_precision
from ..showing import html_of, print_of, table_of
from ..solvers.exact_courses import Course, Joint, advance_course
from ..solvers.exact_periods import Phase, advance_periods, begin
from ..solvers.linear_pieces import LinearPieces
from ..solvers.panels import rk4
from ..solvers.substeps import run_panels
from ..system import System
from .courses import begins, check_length, course
from .errorbars import batch_error
from .located import default_panels
from .normal_form import bare_joint, normal_form, not_linear, why_not

Array = Any
Advance = Callable[[Array, Array], Array]


class Exponents(NamedTuple):
    """Lyapunov exponents, largest first.

    ``values`` (k,) and ``stderr`` (k,) [1/time], the error bar of the finite run from batch means; ``time`` the stretch they
    were averaged over; ``growth`` (K, k) the logarithm of the growth at ``times`` (K,).
    """

    values: np.ndarray
    stderr: np.ndarray
    time: float
    times: np.ndarray
    growth: np.ndarray

    def __str__(self) -> str:
        pairs = ", ".join(f"{v:.5g} ± {e:.2g}" for v, e in zip(self.values, self.stderr))
        return f"Lyapunov exponents {pairs} per unit of time, over {self.time:.5g}"

    def to_dataframe(self) -> Any:
        """The exponents as a `pandas.DataFrame`, a row each, the largest first: ``value`` and ``stderr`` [1/time]."""
        columns = {"exponent": range(1, self.values.size + 1), "value": self.values, "stderr": self.stderr}
        return dataframe(columns, "exponent", time=self.time)

    def _repr_html_(self) -> str:
        return html_of(self)

    def __rich__(self) -> Any:
        return table_of(self)

    def _repr_pretty_(self, printer: Any, cycle: bool) -> None:
        print_of(self, printer, cycle)


def lyapunov_spectrum(
    system: System, drive: AbstractExcitation | None = None, *, count: int | None = None, periods: int = 400, skip: int = 100,
    y0: float = 0.0, dy0: float = 0.0, period: float | None = None, panels: int | None = None, exact: bool | None = None,
) -> Exponents:  # fmt: skip
    """The largest or all exponents of any system of this package, per second (or per unit of the system's time).

    Parameters
    ----------
    system, drive : what moves and what drives it; None: free motion
    count : how many exponents; default: all, one for each state of `System.state_names`
    periods, skip : stretches that are followed, and how many are transient and do not count
    y0, dy0 : start of the link [rad, rad/s]
    period : length of a stretch [s], whole periods of the drive for a steady motion; default: the drive's own
    panels : located panels in a stretch; default: at least 128, and 40 in a period of the contact resonance
    exact : False forbids the exact steps, which are taken wherever the system allows them and no panels are given

    Returns
    -------
    `Exponents`: ``values``, largest first, and their ``stderr``; prints itself

    Raises
    ------
    NoAnswer
        The motion grows without bound.
    ValueError
        The drive has no period and none is given.
    BadInput
        A measured drive ends before the run does.

    Examples
    --------
    >>> system, force = jb.dynamics.PaperCase(1).build({})
    >>> found = jb.dynamics.lyapunov_spectrum(system, force, periods=60, skip=20)
    >>> round(float(found.values.sum()), 6)  # minus twice the damping ratio
    -0.04
    """
    require_double_precision("a Lyapunov spectrum")
    drive = Rest() if drive is None else drive
    may, first = exact is not False and panels is None, jnp.asarray(begins(drive), dtype=float)
    start = drive.at(first)
    if may and period is None and why_not(system, drive) is None:
        assert isinstance(drive, Harmonic)
        form = normal_form(system, drive)
        p0, v0 = (y0 - start.x - form.middle) / form.half_play, (dy0 - start.dx) / form.half_play
        times, growth, end = _run_exact(form.pieces, form.phase, p0, v0, periods, count or 2)
        return _exponents(times * 2.0 * np.pi / float(drive.omega), growth, end, skip)
    if period is None:
        if not isinstance(drive, Harmonic):
            raise ValueError("the drive has no period of its own: give period, the length of a stretch [s]")
        period = 2.0 * np.pi / float(drive.omega)
    check_length(drive, periods * period)
    path = (not_linear(system) or course(drive, periods * period)) if may else None
    if isinstance(path, Course):
        joint, middle, half = bare_joint(system)
        p0, v0 = (y0 - start.x - middle) / half, (dy0 - start.dx) / half
        times, growth, end = _run_course(joint, path, jnp.asarray(period), p0, v0, periods, count or 2)
        return _exponents(times * period, growth, end, skip)
    many = panels or default_panels(system, period)
    state = jnp.stack([jnp.asarray(s, dtype=float) for s in system.rest(first, jnp.asarray(y0), jnp.asarray(dy0), start)])
    args = (system, drive, jnp.asarray(period))
    times, growth, end = _run_system(args, state, periods, count or state.size, many)
    return _exponents(times * period, growth, end, skip)


@eqx.filter_jit
def _run_system(args: Any, state: Array, periods: int, count: int, panels: int) -> Any:
    system, drive, period = args
    h, first = period / panels, begins(drive)

    def segment(k: Array, q: Array) -> Array:
        t = first + k * period
        after, _ = run_panels(system, t, tuple(q), drive.grid(t, h, panels), h, panels, system.switches)
        return jnp.stack(after)

    return _grow(segment, state, periods, count)


@eqx.filter_jit
def _run_exact(pieces: LinearPieces, phase: Array, p0: Array, v0: Array, periods: int, count: int) -> Any:
    """One period after another by exact steps: a lane for each tangent vector, all with the same motion."""
    lanes = jnp.ones(count)
    pieces = jax.tree.map(lambda number: number * lanes, pieces)
    return _grow_exact(lambda k, y: advance_periods(pieces, phase, y, k, 1.0), p0, v0, periods, count)


@eqx.filter_jit
def _run_course(joint: Joint, path: Course, period: Array, p0: Array, v0: Array, periods: int, count: int) -> Any:
    """The same along a drive of polynomials."""
    lanes = jnp.ones(count)
    joint = jax.tree.map(lambda number: number * lanes, joint)
    return _grow_exact(lambda k, y: advance_course(joint, path, y, k * period, (k + 1.0) * period), p0, v0, periods, count)


def _grow_exact(step: Callable[[Array, Phase], Phase], p0: Array, v0: Array, periods: int, count: int) -> Any:
    lanes = jnp.ones(count)
    first = begin(p0 * lanes, v0 * lanes)._replace(dp=jnp.eye(2, count)[0], dv=jnp.eye(2, count)[1])

    def one(carry: Any, k: Array) -> Any:
        y, growth = carry
        y = step(k, y._replace(growth=jnp.zeros(count)))
        size = jnp.exp(y.growth)
        frame, r = jnp.linalg.qr(jnp.stack([y.dp * size, y.dv * size]))
        growth = growth + jnp.log(jnp.abs(jnp.diagonal(r)))
        return (y._replace(dp=frame[0], dv=frame[1]), growth), growth

    (y, _), growth = jax.lax.scan(one, (first, jnp.zeros(count)), jnp.arange(float(periods)))
    return jnp.arange(periods + 1.0), jnp.concatenate([jnp.zeros((1, count)), growth]), jnp.stack([y.p, y.v])


def field_spectrum(
    field: Callable[[Array, Array], Array], start: Any, *, step: float, stretches: int, skip: int, steps: int = 10,
    count: int | None = None,
) -> Exponents:  # fmt: skip
    """Exponents of a smooth vector field ``field(t, q)`` by Runge-Kutta steps of fourth order.

    Parameters
    ----------
    field : rates of change of the (n,) state
    start : (n,) state at t = 0
    step : length of a step
    stretches, skip, steps : stretches of so many steps each between two orthogonalisations; the first ``skip`` are transient
    count : how many exponents; default all n

    Returns
    -------
    `Exponents`

    Examples
    --------
    >>> def decay(t, q):
    ...     return -0.5 * q
    >>> jb.dynamics.field_spectrum(decay, [1.0], step=0.01, stretches=60, skip=20).values.round(6)
    array([-0.5])
    """
    require_double_precision("a Lyapunov spectrum")
    state = jnp.asarray(start, dtype=float)
    times, growth, end = _run_field(field, state, jnp.asarray(step), stretches, steps, count or state.size)
    return _exponents(times * step * steps, growth, end, skip)


@eqx.filter_jit
def _run_field(field: Any, state: Array, step: Array, stretches: int, steps: int, count: int) -> Any:
    def segment(k: Array, q: Array) -> Array:
        def one(q: Array, i: Array) -> Any:
            return rk4(lambda t, s: (field(t, s[0]),), (k * steps + i) * step, (q,), step)[0], None

        return jax.lax.scan(one, q, jnp.arange(float(steps)))[0]

    return _grow(segment, state, stretches, count)


def _grow(segment: Advance, state: Array, stretches: int, count: int) -> Any:
    """Tangent vectors carried stretch by stretch and made orthonormal after each; the logarithm of their growth so far."""
    frame = jnp.eye(state.size, count)

    def one(carry: Any, k: Array) -> Any:
        state, frame, growth = carry

        def push(direction: Array) -> tuple[Array, Array]:
            return jax.jvp(lambda q: segment(k, q), (state,), (direction,))

        after, moved = jax.vmap(push, in_axes=1, out_axes=(None, 1))(frame)
        frame, r = jnp.linalg.qr(moved)
        # A vector that dry friction has stopped has length zero, and an exponent of minus infinity.
        growth = growth + jnp.log(jnp.abs(jnp.diagonal(r)))
        return (after, frame, growth), growth

    begun: Any = (state, frame, jnp.zeros(count))
    (state, *_), growth = jax.lax.scan(one, begun, jnp.arange(float(stretches)))
    return jnp.arange(stretches + 1.0), jnp.concatenate([jnp.zeros((1, count)), growth]), state


def _exponents(times: Array, growth: Array, end: Array, skip: int) -> Exponents:
    times, growth = np.asarray(times), np.asarray(growth)
    if not np.all(np.isfinite(np.asarray(end))):
        raise NoAnswer("the motion grows without bound, so it has no exponents")
    if not 0 <= skip < times.size - 2:
        raise ValueError(f"skip {skip}: wanted fewer than the {times.size - 1} stretches, by two at least")
    counted, clock = growth[skip:], times[skip:]
    with np.errstate(invalid="ignore"):
        values = (counted[-1] - counted[0]) / (clock[-1] - clock[0])
        values = np.where(np.isneginf(growth[-1]), -np.inf, values)
        stderr = np.asarray(batch_error(clock, counted))
    order = np.argsort(-values, kind="stable")
    return Exponents(values[order], stderr[order], float(clock[-1] - clock[0]), times, growth)
