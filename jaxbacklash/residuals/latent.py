r"""The missing torque as a function of time.

The link is given one more torque, unknown but not arbitrary: piecewise linear in time, its first or second differences
Gaussian, of a size (and an order) chosen by the marginal likelihood of the record. It is estimated inside the shooting
windows, tied into one trajectory, together with every window's start and the input's spline, so that nothing is
differentiated and the band counts both noises.

While an effect is missing, a fit bends play, stiffness and damping to cover part of it. So the parameters are estimated anew
beside the torque (each within about half of its value): the torque is then what they cannot be, and how far they moved is told
(Kennedy & O'Hagan, 2001, on why the two must be estimated together). ``hold`` keeps them as fitted.

Of a drive of which the motor alone is seen the link is found along with the torque, which is sought at the motor.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from ..errors import BadInput, NoAnswer
from ..fitting import Fit
from ..fitting.continuation import continued
from ..fitting.fit import prepare
from ..fitting.setup import first_guess, free_names, make_problem
from ..frames import dataframe
from ..parameters import unit_text, values, with_values
from ..pointwise import along
from ..precision import require_double_precision
from ..records import Record
from ..records.not_taken import require_encoders
from ..shooting.multiple_shooting import Blocks, Trajectory
from ..shooting.problem import Problem, Unknowns
from ..showing import Shown
from ..system import System
from .at_motor import as_pushed
from .smoother import Improved, Point, Smoother, finish, improve, make_hats, misfit

NODES = 10
"""Values of the torque per shooting window of 0.1 s, where the rate allows: as fast as the data can tell."""
WIDE = np.linspace(-2.0, 4.0, 7)
"""Sizes of the torque's steps tried first, powers of ten of the torque that the noise of one window would hide."""
MOTION = ("y", "dy", "x", "dx", "z", "dz", "deflection")
NARROW = np.linspace(-0.75, 0.75, 7)
STEPS, SOON, FALLEN = 8, 3, 0.1
"""Steps of a search at most, and those after which it must have come down to this share of where it began."""
CALMED = 5.0
"""A misfit of more noises than this may keep the search from arriving; factor by which the noise is taken for less each time."""
NEAR = 5e-3
"""Half of a sum of squares, for each sample, that a search under such a noise may leave to gain."""
BEGIN, ROUNDS = 0.1, 3
"""Missing torque that is begun with where the motor alone is seen, as a share of the torque, and fits that find its size."""
EVIDENT = 6.0
"""Gain in log marginal likelihood from which a torque counts as missing: odds of 400 to 1."""


@dataclass(frozen=True)
class Inside:
    """The smoother where it ended: for further questions at the same point. ``linear`` the normal equations there, ``precision``
    that of the torque's differences of order ``order``."""

    smoother: Smoother
    point: Point
    path: Trajectory
    linear: Blocks
    order: int
    precision: float
    free: tuple[str, ...]


@dataclass(frozen=True)
class Latent(Shown):
    """The missing torque at N times, and where the joint was then.

    Attributes: ``t`` [s]; ``record`` (N,) which record; ``torque`` and its standard error ``stderr`` [unit]; ``y``, ``dy``,
    ``x``, ``dx``, ``z``, ``dz`` the smoothed motion [rad, rad/s]; ``deflection`` beyond the play [rad]; ``side`` -1, 0, 1 for
    contact below, play, contact above; ``evidence`` log marginal likelihood gained over no torque; ``system`` with the parameters
    that go with this torque, ``moved`` their (value as fitted, value here, standard error here); ``converged``; ``port`` at which
    it was sought, ``"link"`` or, of a drive of which the motor alone is seen, ``"motor"``.
    """

    t: np.ndarray
    record: np.ndarray
    torque: np.ndarray
    stderr: np.ndarray
    y: np.ndarray
    dy: np.ndarray
    x: np.ndarray
    dx: np.ndarray
    z: np.ndarray
    dz: np.ndarray
    deflection: np.ndarray
    side: np.ndarray
    evidence: float
    converged: bool
    system: System
    moved: dict[str, tuple[float, float, float]]
    unit: str
    records: tuple[Record, ...] = field(repr=False)
    inside: Inside = field(repr=False)
    port: str = "link"

    @property
    def evident(self) -> bool:
        """True when the record asks for this torque."""
        return self.evidence > EVIDENT

    @property
    def band95(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper end of the pointwise 95 % band [unit]."""
        return self.torque - 1.96 * self.stderr, self.torque + 1.96 * self.stderr

    @property
    def rms(self) -> float:
        """Root mean square of the torque [unit]."""
        return float(np.sqrt(np.mean(self.torque**2)))

    @property
    def spacing(self) -> float:
        """Time between neighbouring values [s]."""
        return float(np.median(np.diff(self.t)))

    def __str__(self) -> str:
        if not self.evident:
            return f"No torque is missing beyond {2 * float(np.median(self.stderr)):.2g} {self.unit}."
        return f"A torque of {self.rms:.3g} {self.unit} rms is missing, known to {float(np.median(self.stderr)):.2g}."

    def to_dataframe(self) -> Any:
        """The torque as a `pandas.DataFrame` along ``t`` [s]: ``record``, ``torque`` and ``stderr``, and the smoothed motion."""
        names = ("t", "record", "torque", "stderr", "y", "dy", "x", "dx", "z", "dz", "deflection", "side")
        units = {"t": "s", "torque": self.unit, "stderr": self.unit}
        return dataframe({name: np.asarray(getattr(self, name)) for name in names}, "t", units=units)


def missing_torque(fit: Fit, *, hold: bool = False) -> Latent:
    """The torque missing from a fitted model on its link, at its records; of a drive at the first of them.

    Of a drive of which the motor alone is seen it is sought at the motor, where one that acts on the link shows as well.

    Parameters
    ----------
    fit : a fit
    hold : keep the parameters as fitted, instead of estimating them anew beside the torque

    Returns
    -------
    `Latent`: ``t``, ``torque`` and its ``stderr``, (N,) each; prints how large it is

    Raises
    ------
    BadInput
        A drive of which the link alone is seen.
    NoAnswer
        The smoother does not reach a finite misfit, or the model's own parameters leave the torque open.

    Examples
    --------
    >>> record, heldout = jb.demo_records()
    >>> fit = jb.fit(record.between(0.0, 2.0), inertia=3.16, starts=1)
    >>> print(jb.missing_torque(fit))
    A torque of ... N m rms is missing, known to ...
    """
    require_encoders(fit.records, "missing_torque", ("motor",))
    if fit.system.motor is not None and fit.records[0].blind:
        unit = unit_text("N m", translational=fit.translational, per_inertia=fit.per_inertia)
        if hold:
            raise BadInput("hold: where the motor alone is seen, the parameters move with the torque; leave hold out")
        return _at_motor(*as_pushed(fit.system, fit.free, fit.records[0]), unit)
    if fit.system.motor is not None:
        # On the link, which the motor moves as it was measured: what is missing at the motor's own port does not come into it.
        joint, record = fit.system.on_its_base(), fit.records[0].on_its_base()
        return missing_torque_of(joint, record, hold=hold, translational=fit.translational, per_inertia=fit.per_inertia)
    if fit.problem is None or fit.unknowns is None:
        return missing_torque_of(
            fit.system, fit.records[0], hold=hold, translational=fit.translational, per_inertia=fit.per_inertia
        )
    unit = unit_text("N m", translational=fit.translational, per_inertia=fit.per_inertia)
    return _smooth(fit.problem, fit.unknowns, fit.system, fit.free, fit.records, unit, hold)


def missing_torque_of(
    system: System, record: Record, *, hold: bool = True, translational: bool = False, per_inertia: bool = False
) -> Latent:
    """The torque missing from a system with given parameters, at one record; see `missing_torque`."""
    windows, _, _ = prepare(system, [record], None)
    free = free_names(system)
    problem = make_problem(system, windows, free)
    unit = unit_text("N m", translational=translational, per_inertia=per_inertia)
    return _smooth(problem, first_guess(problem), system, free, (record,), unit, hold)


def _at_motor(system: System, free: tuple[str, ...], record: Record, unit: str) -> Latent:
    """The torque missing at the motor of a drive of which the motor alone is seen: where its link was is found along with it.

    A fit takes the torque for as noisy as what is missing of it is large, and lets as much go where windows join as the record
    likes; what it has then changed in the torque is what is missing. The band is the smoother's at that point.
    """
    windows, _, _ = prepare(system, [record], None)
    problem = make_problem(system, windows, free)
    unknowns, weight = first_guess(problem), np.asarray(windows.input_weight)
    size = BEGIN * float(np.std(record.channels["torque"]))
    seen = weight > 0.0
    for _ in range(ROUNDS):
        loose = np.where(seen, np.minimum(1.0 / max(size, 1e-300), weight), 0.0)
        at = eqx.tree_at(lambda p: p.windows.input_weight, problem, loose)
        found = continued(at, unknowns)
        unknowns = found.minimum.value
        changed = np.where(seen, np.asarray(unknowns.coefficients) - np.asarray(windows.input), 0.0)
        size = float(np.sqrt(np.sum(changed**2) / np.sum(seen)))
    smoother = _smoother(eqx.tree_at(lambda p: p.windows, problem, replace(windows, at_motor=True)), system, unknowns, hold=False)
    smoother = eqx.tree_at(lambda s: s.problem.tie, smoother, jnp.asarray(found.tie))
    torque = changed.reshape(len(changed), smoother.nodes, -1).mean(axis=2) / float(smoother.unit)
    still = Unknowns(unknowns.theta, unknowns.starts, np.asarray(windows.coefficients))
    point = Point(still, jnp.asarray(torque))
    sizes = np.tile(WIDE, 2)
    for around in (WIDE, NARROW):
        told = improve(smoother, point, jnp.asarray(np.repeat([1, 2], WIDE.size)), jnp.asarray(-2.0 * np.log(10.0) * sizes))
        best = np.argmax(np.asarray(told.evidence).reshape(2, -1), axis=1)
        sizes = np.concatenate([sizes.reshape(2, -1)[k, best[k]] + NARROW for k in range(2)]) if around is WIDE else sizes
    return _latent(smoother, point, told, found.converged, system, free, (record,), unit)


def _smooth(
    problem: Problem, start: Unknowns, system: System, free: tuple[str, ...], records: tuple[Record, ...], unit: str, hold: bool
) -> Latent:
    require_double_precision("missing_torque")
    smoother, point, found, converged = _settled(_smoother(problem, system, start, hold=hold), start)
    return _latent(smoother, point, found, converged, system, free, records, unit)


def _smoother(problem: Problem, system: System, start: Unknowns, *, hold: bool) -> Smoother:
    w = problem.windows
    nodes = _nodes(w.samples)
    length = float(w.panel) * w.every * w.samples
    noise = 1.0 / float(np.max(np.asarray(w.weight)))
    # The unit is the torque that the noise of one sample would hide over one window.
    moved = system.motor.motor_inertia if w.at_motor and system.motor is not None else system.inertia
    scale = 2.0 * float(moved) * noise / length**2
    return Smoother(
        eqx.tree_at(lambda p: p.tie, problem, jnp.asarray(1.0)),
        jnp.asarray(make_hats(w.basis.shape[1] - 1, nodes)),
        jnp.asarray(scale),
        jnp.asarray(np.any(np.asarray(w.weight) > 0.0, axis=1).astype(float)),
        start.theta,
        jnp.asarray(float(hold)),
    )


def _latent(
    smoother: Smoother, point: Point, found: Improved, converged: bool, system: System, free: tuple[str, ...],
    records: tuple[Record, ...], unit: str,
) -> Latent:  # fmt: skip
    problem, scale = smoother.problem, float(smoother.unit)
    spread, loose, path, linear = finish(smoother, point, found.best[0].astype(int), found.best[1])
    if not np.all(np.isfinite(np.asarray(spread)[np.asarray(smoother.present) > 0.0])):
        raise NoAnswer(
            "the missing torque could not be found: effects of the model stand in for one another, so that nothing tells their "
            "strengths; leave some of them out"
        )
    names = list(values(system))
    vector = np.asarray(problem.base) + np.asarray(problem.directions) @ np.asarray(point.unknowns.theta)
    here = with_values(system, dict(zip(names, vector)))
    errors = np.asarray(loose) * np.sum(np.asarray(problem.directions), axis=0)
    before, after = values(system), values(here)
    columns = _along(here, records, scale * np.asarray(point.torque), scale * np.asarray(spread), path)
    return Latent(
        **columns,
        evidence=float(np.max(np.asarray(found.evidence)) - float(found.without)),
        converged=converged,
        system=here,
        moved={name: (before[name], after[name], float(error)) for name, error in zip(free, errors)},
        unit=unit,
        records=records,
        inside=Inside(smoother, point, path, linear, int(found.best[0]), float(np.exp(found.best[1])), free),
        port="motor" if problem.windows.at_motor else "link",
    )


def _nodes(samples: int) -> int:
    """As many values a window as wished, a divisor of its samples where one is near, so that values meet samples."""
    wanted = max(2, min(NODES, samples // 4))
    near = [k for k in range(max(2, wanted - 3), wanted + 3) if samples % k == 0]
    return min(near, key=lambda k: abs(k - wanted)) if near else wanted


def _settled(smoother: Smoother, start: Unknowns) -> tuple[Smoother, Point, Improved, bool]:
    """Where the smoother ends, and under which noise.

    Far beyond the noise, ties are so sharp that no step gets past a corner of friction or contact, and the parameters run away
    with the torque. There they are held, and the noise is taken for as large as the misfit, then for smaller and smaller, as long
    as the search arrives; the band tells by how wide it is what it was taken for.
    """
    none = jnp.zeros((smoother.problem.windows.count, smoother.nodes))
    rows = float(np.sum(np.asarray(smoother.problem.windows.weight) > 0.0))
    point, found, converged = _search(smoother, Point(start, none), hopeless=0.5 * CALMED**2 * rows)
    if converged:
        return smoother, point, found, True
    rms = float(misfit(smoother.problem, start))
    if not CALMED < rms < np.inf:
        return smoother, *_search(smoother, point)  # near the noise it may still come down
    held = eqx.tree_at(lambda s: s.held, smoother, jnp.asarray(1.0))
    calmer = _calmer(held, rms)
    best = calmer, *_search(calmer, Point(start, none), NEAR * rows)
    for factor in np.geomspace(rms, 1.0, 1 + round(np.ceil(np.log(rms) / np.log(CALMED))))[1:]:
        calmer, (before, point, *_) = _calmer(held, float(factor)), best
        then = calmer, *_search(calmer, Point(point.unknowns, point.torque * before.unit / calmer.unit), NEAR * rows)
        if not then[-1]:
            break
        best = then
    return best


def _calmer(smoother: Smoother, factor: float) -> Smoother:
    """The same under so many times the noise, its torque in a unit as much larger."""
    windows = smoother.problem.windows.noisier(factor)
    return eqx.tree_at(lambda s: (s.problem.windows, s.unit), smoother, (windows, smoother.unit * factor))


def _search(
    smoother: Smoother, at: Point, near: float = 0.0, hopeless: float = np.inf
) -> tuple[Point, Improved, bool]:  # fmt: skip
    # Corners that a step crosses to and fro may leave ``near`` to gain; above ``hopeless`` a search that does not fall ends soon.
    orders = jnp.asarray(np.repeat([1, 2], WIDE.size))

    def total(seen: Improved, prior: np.ndarray) -> float:
        return float(seen.cost) + 0.5 * float(np.exp(prior[1]) * np.asarray(seen.rough)[int(prior[0])])

    sizes = np.tile(WIDE, 2)
    before: tuple[Point, Improved] | None = None
    first = np.inf
    for step in range(STEPS):
        seen = improve(smoother, at, orders, jnp.asarray(-2.0 * np.log(10.0) * sizes))
        first = first if step else float(seen.cost)
        if step >= SOON and float(seen.cost) > max(hopeless, FALLEN * first):
            break
        if before is not None:
            prior = np.asarray(before[1].best)
            gain = total(before[1], prior) - total(seen, prior)
            if not gain > -0.01 * (1.0 + total(before[1], prior)):
                # The step was too long for the corners it crossed: go half of the way.
                at = _middle(before[0], at)
                continue
            if abs(gain) < 0.05 + near + 1e-4 * abs(total(seen, prior)):
                return at, seen, True
        if not np.isfinite(float(seen.cost)):
            raise NoAnswer("the missing torque could not be found: the model's motion grows without bound")
        before, at = (at, seen), seen.point
        told = np.asarray(seen.evidence).reshape(2, -1)
        sizes = np.concatenate([np.reshape(sizes, (2, -1))[k, np.argmax(told[k])] + NARROW for k in range(2)])
    assert before is not None
    return before[0], before[1], False


def _middle(one: Point, other: Point) -> Point:
    middle = lambda a, b: 0.5 * (a + b)  # noqa: E731
    u, v = one.unknowns, other.unknowns
    return Point(
        Unknowns(middle(u.theta, v.theta), middle(u.starts, v.starts), middle(u.coefficients, v.coefficients)),
        middle(one.torque, other.torque),
    )


def _along(
    system: System, records: tuple[Record, ...], torque: np.ndarray, stderr: np.ndarray, path: Trajectory
) -> dict[str, np.ndarray]:
    columns: dict[str, list[np.ndarray]] = {}
    per = path.times.shape[1]
    for number, (record, rows) in enumerate(zip(records, record_rows(records, per))):
        at = np.asarray(path.times)[rows].ravel()
        each = torque.shape[1]
        t = at[0] + (at[1] - at[0]) * per / each * np.arange((rows.stop - rows.start) * each)
        inside = t <= record.t[-1] + 1e-9
        base = system.base(path.states, path.drive.x, path.drive.dx)
        found = [np.interp(t, at, np.asarray(v)[rows].ravel()) for v in (*path.states[:2], *base)]
        now = along(system.on_its_base(), t, *found).now
        part = {
            "t": t, "record": np.full(t.size, number), "torque": torque[rows].ravel(), "stderr": stderr[rows].ravel(),
            **{name: np.broadcast_to(np.asarray(getattr(now, name)), t.shape) for name in MOTION},
            "side": np.sign(np.broadcast_to(np.asarray(now.deflection), t.shape)),
        }  # fmt: skip
        for name, row in part.items():
            columns.setdefault(name, []).append(row[inside])
    return {name: np.concatenate(parts) for name, parts in columns.items()}


def record_rows(records: tuple[Record, ...], samples: int) -> list[slice]:
    """Which windows hold each record; an empty one follows each."""
    counts = [-(-record.samples // samples) for record in records]
    firsts = np.cumsum([0, *(count + 1 for count in counts[:-1])])
    return [slice(int(first), int(first) + count) for first, count in zip(firsts, counts)]
