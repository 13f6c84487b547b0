"""From a record and a wish to a problem: which system, where it starts, which of its parameters are free."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ..compiled import kept_jit
from ..effects import Contact, Damper, Servo, Spring
from ..errors import BadInput
from ..mechanics import AbstractEffect, Drive, canonical_name, catalogue, motion_of
from ..one_encoder.carried import filtered, hides
from ..parameters import free_specs, ravel, specs, values, with_values
from ..records import Record
from ..regression.along_motion import Motion, own_states
from ..regression.drive_start import start_of_drive
from ..regression.equation_error import Start, estimate
from ..regression.force_loop import read_loop
from ..shooting.problem import Problem, Unknowns
from ..shooting.windows import Windows
from ..system import System, observe
from .settings import NEWTON, PERIOD, ROUNDING, STABLE, UNLIKE_A_LOOP
from .stick_slip import march, place, sticks_and_slips

MODELS = ("joint", "linear", "free")


def base_system(
    record: Record, model: str, inertia: float | None, effects: Sequence[AbstractEffect | str] = ()
) -> tuple[System, tuple[str, ...], Start]:
    """A base model with starting values from the record, and the names of its free parameters.

    Parameters
    ----------
    record : the record to start from
    model : ``"joint"``, ``"linear"`` (no play) or ``"free"`` (no spring)
    inertia : J [kg m^2]; None fits it to a record with a force, and takes 1 (values per unit inertia) otherwise
    effects : added as they are, or by canonical name at their starting values

    Raises
    ------
    BadInput
        An unknown model, or a record that cannot carry it.
    """
    if model not in MODELS:
        raise BadInput(f"--model {model}: not a model; choose {', '.join(MODELS)} or a model file ending in .toml")
    if inertia is not None and not (np.isfinite(inertia) and inertia > 0):
        raise BadInput(f"--inertia {inertia:g}: wanted a positive number of kg m^2 (kg for a translating mass)")
    if record.kind == "transmitted":
        return stick_slip_system(record, model, inertia, effects)
    if record.kind == "drive":
        return drive_system(record, model, inertia, effects)
    known = inertia
    if inertia is None and record.kind != "force":
        known = 1.0
    play, spring = model == "joint", model != "free"
    start = estimate(record, inertia=known, play=play, spring=spring)
    system = _sharpen(add_effects(_system(start, record, model), effects), record)
    if system.effects:
        # Once more with the effects in the regression: a load left out bends the estimate of the joint.
        start = estimate(record, inertia=known, play=play, spring=spring, effects=list(system.effects.values()))
        system = _system(start, record, model).with_effects(*start.effects)
    free = () if known is not None else ("inertia",)
    return system, free + free_names(system), start


def drive_system(
    record: Record, model: str, inertia: float | None, effects: Sequence[AbstractEffect | str] = ()
) -> tuple[System, tuple[str, ...], Start]:
    """`base_system` for a drive: all of its parameters are started from the record.

    Raises
    ------
    BadInput
        A model without a play, or a record of one encoder.
    """
    if model != "joint":
        raise BadInput(f"--model {model}: a drive (torque with motor or link) is fitted as a joint with play; leave --model out")
    motor, start = start_of_drive(record, inertia)
    if inertia is not None:
        start = replace(start, inertia=inertia)
    joint = System(start.inertia, Contact(start.backlash, start.stiffness), Damper(start.damping), motor=motor,
                   observed=" ".join(record.observed_names))  # fmt: skip
    system = add_effects(joint, effects)
    free = free_names(system)
    if isinstance(motor, Servo):  # no torque was measured: one of the two inertias is the scale
        return system, free if inertia is None else ("motor_inertia", *(n for n in free if n != "inertia")), start
    return system, (() if inertia is not None else ("inertia",)) + free, start


def stick_slip_system(
    record: Record, model: str, inertia: float | None, effects: Sequence[AbstractEffect | str] = ()
) -> tuple[System, tuple[str, ...], Start]:
    """`base_system` for a record of transmitted force, started from its force loop: a link that friction at the ground holds.

    Raises
    ------
    BadInput
        The force is not that of a link which something holds while its base moves slowly.
    """
    loop = read_loop(record)
    if loop.share > UNLIKE_A_LOOP:
        raise BadInput(
            f"{record.path}: has the base motion x and the transmitted force T but no motion of the link, and T is not that of a "
            f"link held by friction (such a loop leaves {100 * loop.share:.0f} % of it unexplained); wanted z or y beside x"
        )
    moving = np.gradient(record.channels["x"], record.dt)
    # Without friction only its own weight can hold the link; with it, the contact's resonance is where the record can show it.
    slow = 0.1 * float(np.std(moving)) / float(np.std(record.channels["x"]))
    added = add_effects(System(1.0, None, Damper(0.0)), effects).effects
    rubs = any(effect.slides and effect.port == "ground" for effect in added.values())
    omega = 2.0 * np.pi * record.rate_hz / PERIOD if rubs else slow
    mass = inertia if inertia is not None else loop.stiffness / omega**2
    damping = 0.2 * float(np.sqrt(loop.stiffness * mass)) if rubs else 1e-3 * loop.stiffness / omega
    start = Start(mass, loop.backlash if model == "joint" else None, loop.stiffness, damping, loop.share)
    system = add_effects(_system(start, record, model), effects)
    strength = {
        f"{name}.Tc": loop.sliding
        for name, effect in system.effects.items()
        if effect.slides and effect.port == "ground" and "Tc" in specs(effect)
    }
    system = _sharpen(with_values(system, strength), record)
    return system, (() if inertia is not None else ("inertia",)) + free_names(system), start


def _sharpen(system: System, record: Record) -> System:
    """Regularise the sign of a speed over less than half a percent of the speeds in the record, where that is sharper.

    For the regression and the referee; the fit's located steps have no width.
    """
    moved = record.channels["x" if record.kind == "transmitted" else record.observed_name]
    lag = max(1, round(0.01 / record.dt))
    speed = float(np.sqrt(np.mean((moved[lag:] - moved[:-lag]) ** 2))) / (lag * record.dt)
    present = values(system)
    sharper = {
        name: min(present[name], 0.004 * speed)
        for name, spec in specs(system).items()
        if spec.fixed and spec.unit == "rad/s" and speed > 0.0
    }
    return with_values(system, sharper)


def _system(start: Start, record: Record, model: str) -> System:
    contact: Contact | Spring | None = None
    if model == "joint":
        contact = Contact(start.backlash, start.stiffness)
    elif model == "linear":
        contact = Spring(start.stiffness)
    return System(start.inertia, contact, Damper(start.damping), observed=record.observed_name)


def free_names(system: System, beside: Iterable[str] | None = None) -> tuple[str, ...]:
    """All parameters that a fit may change: everything but the inertia (of its motor where that has a servo), numerical settings,
    shapes at their usual values, and what an effect yields to those of ``beside`` (default: all that the system has)."""
    present = set(system.effects if beside is None else beside)
    effects = system.effects.items()
    held = {f"{name}.{own}" for name, effect in effects for own, other in effect.yields.items() if other in present}
    held |= {"motor_inertia" if isinstance(system.motor, Servo) else "inertia"}
    return tuple(n for n in free_specs(system) if n not in held)


def add_effects(system: System, effects: Sequence[AbstractEffect | str]) -> System:
    """The system with effects added: as they are, or by canonical name at their starting values.

    Raises
    ------
    BadInput
        A name that is not in the catalogue, or an effect that the system has already.
    """
    known = catalogue()
    for effect in effects:
        name = effect if isinstance(effect, str) else canonical_name(effect)
        if name in system.effects:
            raise BadInput(f"--effects {name}: the model has this effect already; name it once, here or in the model file")
        if isinstance(effect, str):
            if effect not in known:
                near = difflib.get_close_matches(effect, known, n=1)
                meant = f" (did you mean {near[0]}?)" if near else ""
                raise BadInput(f"--effects {effect}: no such effect{meant}, wanted some of {', '.join(known)}")
            effect = known[effect].guesses(system)[0]
        system = system.with_effects(effect)
    return system


def check_motion(system: System, *, translational: bool) -> None:
    """Refuse effects that make no sense for how the link moves, such as gravity, G sin y, for a mass that slides, and laws of a
    motor where there is none.

    Raises
    ------
    BadInput
        With the first such effect's name.
    """
    _check_ports(system)
    motion = motion_of(translational)
    odd = next((name for name, effect in system.effects.items() if motion not in effect.motions), None)
    if odd is None:
        return
    law = (system.effects[odd].__doc__ or "").strip().partition("\n")[0].partition(",")[0].rstrip(".")
    other, said = ("turning", "with --translation it slides") if translational else ("sliding", "without --translation it turns")
    raise BadInput(
        f"--effects {odd}: is a law of a {other} link ({law}), and {said}; wanted laws of a {motion} link, or the other option"
    )


def _check_ports(system: System) -> None:
    """Refuse laws of a motor where there is none, and of the measuring chain where several encoders are one motion's."""
    for name, effect in system.effects.items():
        if system.motor is None and effect.port == "motor":
            raise BadInput(
                f"--effects {name}: acts on the motor of a drive, and this base moves as prescribed; wanted a record with the "
                "motor's torque, or laws of the joint and of the link"
            )
        changes = type(effect).observe is not AbstractEffect.observe or type(effect).lag is not AbstractEffect.lag
        if system.motor is not None and changes:
            raise BadInput(f"--effects {name}: the measuring chain of a drive is taken as it is so far; wanted laws that act")


def make_problem(system: System, windows: Windows, free: Sequence[str], *, tie: float = 0.0) -> Problem:
    """The shooting problem with the named parameters free, in units of their present size.

    A law's stiffness stays below that with which the link would swing faster than a step of the integration can follow: a law of
    friction that gives hardly at all before it slips would be integrated into anything.
    """
    described, present = specs(system), values(system)
    stiffest = _stiffest(system, windows)
    names = list(described)
    base = ravel(system)
    directions = np.zeros((base.size, len(free)))
    lower, upper = np.empty(len(free)), np.empty(len(free))
    for j, name in enumerate(free):
        spec = described[name]
        scale = abs(present[name]) or spec.scale or 1.0
        directions[names.index(name), j] = scale
        lower[j] = (spec.lower - present[name]) / scale
        most = stiffest if "." in name and spec.unit == "N m/rad" else np.inf
        upper[j] = (min(spec.upper, max(most, present[name])) - present[name]) / scale
    shrink = np.array([described[name].positive and present[name] > 0 for name in free], dtype=bool)
    return Problem(
        windows,
        system,
        np.asarray(base),
        directions,
        lower,
        upper,
        shrink,
        np.asarray(float(tie)),
        np.asarray(len(free)),
    )


def _stiffest(system: System, windows: Windows) -> float:
    """The stiffness [N m/rad] with which the link swings as fast as a step of the integration can follow."""
    return float(system.reduced_inertia) * (STABLE / (0.5 * float(windows.panel))) ** 2


def as_stiff_as_can_be(problem: Problem, system: System, free: Sequence[str]) -> frozenset[str]:
    """Free parameters of a fitted system at the bound that `make_problem` sets to the stiffness of laws: the record may ask for
    more of them."""
    most, described, present = (1.0 - 1e-6) * _stiffest(problem.system, problem.windows), specs(system), values(system)
    return frozenset(n for n in free if "." in n and described[n].unit == "N m/rad" and present[n] >= most)


def first_guess(problem: Problem) -> Unknowns:
    """Starts from the smoothed data, the base motion from its spline, parameters as they are."""
    w, system = problem.windows, problem.system
    if sticks_and_slips(system):
        theta = np.zeros(problem.directions.shape[1])
        return Unknowns(theta, np.asarray(march(problem, theta, w.coefficients)), np.asarray(w.coefficients))
    zero = np.zeros(problem.directions.shape[1])
    if hides(system) and system.observed != "T":
        return Unknowns(zero, filtered(problem, zero)[0], np.asarray(w.coefficients))
    if system.motor is not None:
        return Unknowns(zero, drive_at_rest(w, system, np.asarray(w.starts)), np.asarray(w.coefficients))
    y, dy = np.asarray(w.starts)
    if system.observed == "T":
        # A link that something holds, where its contact would carry the first force of the window.
        level = 10.0 / np.max(np.asarray(w.weight))
        y, dy = y + np.asarray(place(system, w.t0, y, np.asarray(w.measured)[:, 0], level)), 0.0 * dy
    starts = read_through(w, at_rest(w, system, y, dy), system)
    if len(starts) > 2 and system.observed != "T":
        starts = np.concatenate([starts[:2], followed(w, system, starts[0], starts[1])])
    return Unknowns(zero, starts, np.asarray(w.coefficients))


def drive_at_rest(w: Windows, system: System, starts: np.ndarray) -> np.ndarray:
    """Starts (n, W) of a drive at these places and speeds (4, W): what laws remember is what they would of nothing before."""
    if len(system.state_names) == system.mechanical:
        return starts
    full = system.rest(w.t0, starts[0], starts[1], Drive(0.0 * starts[0]))
    return np.concatenate([starts, np.stack([np.broadcast_to(s, starts[0].shape) for s in full[system.mechanical :]])])


def at_rest(w: Windows, system: System, y: np.ndarray, dy: np.ndarray) -> np.ndarray:
    """Starts (n, W) of a link that is at ``y``, ``dy`` (W,): what laws remember is what they would of nothing before that."""
    if len(system.state_names) == 2:
        return np.stack([y, dy])
    z, dz = relative(w, y, dy)
    full = system.rest(w.t0, y, dy, Drive(y - z, dy - dz, 0.0 * y))
    return np.stack([np.broadcast_to(s, y.shape) for s in full])


def followed(w: Windows, system: System, y: np.ndarray, dy: np.ndarray) -> np.ndarray:
    """Internal states (S, W) of all laws where windows begin, as they follow the measured motion from one window to the next.

    Parameters
    ----------
    w : the windows
    system : its laws, in a joint like this one
    y, dy : (W,) motion of the link where windows begin; between, it is the cubic that meets both
    """
    length = w.samples * w.every * float(w.panel)
    s = np.arange(w.samples) / w.samples
    following = np.stack([np.append(v[1:], v[-1]) for v in (y, dy)])
    ends = np.stack([y, length * dy, following[0], length * following[1]], axis=1)
    place = np.stack([(1 + 2 * s) * (1 - s) ** 2, s * (1 - s) ** 2, s**2 * (3 - 2 * s), s**2 * (s - 1)])
    speed = np.stack([6 * s * (s - 1), 1 - 4 * s + 3 * s**2, 6 * s * (1 - s), 3 * s**2 - 2 * s]) / length
    base = np.zeros((2, y.size * w.samples))
    if w.intervals and not w.by_force:
        base = np.stack([(_local(w) @ np.asarray(w.basis)[k, : -1 : w.every].T).ravel() for k in (0, 1)])
    t = float(w.panel) * w.every * np.arange(y.size * w.samples)
    motion = Motion(t, (ends @ place).ravel(), (ends @ speed).ravel(), base[0], base[1], np.zeros_like(t))
    laws = (system.effects[name] for name in sorted(system.effects))
    return np.stack([state[:: w.samples] for law in laws if law.states for state in own_states(law, system, motion)])


def read_through(w: Windows, starts: np.ndarray, system: System, before: System | None = None) -> np.ndarray:
    """Starts (n, W) moved to where a system's measuring chain shows what another's did, or what was measured.

    Where an offset of the sensor gives way to a play off its centre, the link was elsewhere all the time.
    """
    if system.observed == "T":
        return starts
    y, dy = starts[0], starts[1]
    z, dz = relative(w, y, dy) if system.observed == "z" else (y, dy)
    seen, slope = (z, np.ones_like(z)) if before is None else _chain(before, z, _remembered(w, before, y, dy))
    place, hidden = z, _remembered(w, system, y, dy)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):  # a chain may show nothing of a motion
        shown, own = _chain(system, place, hidden)
        first = float(np.max(np.abs(seen - shown)))
        for _ in range(NEWTON):
            place = place + (seen - shown) / own
            shown, own = _chain(system, place, hidden)
        speed = dz * slope / own
        # Where rounding alone keeps the slope from zero, it leads anywhere.
        astray = np.max(np.abs(seen - shown)) > max(first, ROUNDING * float(np.max(np.abs(seen))))
    if astray or not np.all(np.isfinite([place, speed])):
        return starts
    return np.concatenate([[y - z + place, dy - dz + speed], starts[2:]])


def _chain(system: System, place: np.ndarray, hidden: tuple[np.ndarray, ...]) -> tuple[np.ndarray, np.ndarray]:
    """What the measuring chain shows of places (W,), and how it grows with them; ``hidden`` are the states (W,) of its laws."""
    # Without all that does not take part, one program serves every system.
    shown, slope = _through(_measuring(system), np.asarray(place), hidden)
    return np.asarray(shown), np.asarray(slope)


def _measuring(system: System) -> dict[str, AbstractEffect]:
    """The laws of the measuring chain by name."""
    return {name: e for name, e in system.effects.items() if type(e).observe is not AbstractEffect.observe}


def _remembered(w: Windows, system: System, y: np.ndarray, dy: np.ndarray) -> tuple[np.ndarray, ...]:
    """Internal states (W,) of the measuring chain where nothing is known of what was before."""
    chain = _measuring(system)
    if not any(effect.states for effect in chain.values()):
        return ()
    starts = zip(at_rest(w, system, y, dy), system.state_names)
    return tuple(state for state, name in starts if name.partition(".")[0] in chain)


@kept_jit
def _through(chain: dict[str, AbstractEffect], place: np.ndarray, hidden: tuple[np.ndarray, ...]) -> Any:
    return jax.jvp(lambda value: observe(chain, value, hidden), (place,), (jnp.ones_like(place),))


def relative(w: Windows, y: np.ndarray, dy: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Motion (W,) of a link against its base where windows begin, from that against the ground, ``y`` and ``dy``."""
    if not w.intervals or w.by_force:
        return y, dy
    local = _local(w)
    return y - local @ w.basis[0, 0], dy - local @ w.basis[1, 0]


def _local(w: Windows) -> np.ndarray:
    """Spline coefficients (W, m + 5) that each window sees, those included that it shares with the next one."""
    own = np.asarray(w.coefficients)
    following = np.concatenate([own[1:], np.zeros_like(own[:1])])
    return np.concatenate([own, following[:, : w.basis.shape[2] - w.intervals]], axis=1)
