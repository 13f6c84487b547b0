"""What drives a joint: harmonic, chirp, multisine, stepped sine, or measured samples; and the torque of a drive's motor.

Every excitation gives the `Drive` at a time; the default ``grid`` samples it at panel edges for the fixed-step solvers.
"""

from __future__ import annotations

import abc
from typing import TYPE_CHECKING, Any, ClassVar

import equinox as eqx
import jax
import jax.numpy as jnp

from .mechanics import Drive
from .parameters import Scalar

Array = Any


class AbstractExcitation(eqx.Module):
    """A prescribed base motion [rad] or force [N m] as a function of time.

    ``series`` names the fields that are arrays even of one drive; all others are numbers, or arrays over the cells of a map.
    """

    series: ClassVar[tuple[str, ...]] = ()

    @abc.abstractmethod
    def at(self, t: Scalar) -> Drive:
        """The drive at time ``t`` [s], a scalar."""

    def grid(self, t0: Scalar, h: Scalar, panels: int) -> Drive:
        """The drive at the ``panels + 1`` edges of panels of length ``h`` that begin at ``t0``; arrays of that length."""
        return jax.vmap(self.at)(t0 + h * jnp.arange(panels + 1))


class AbstractSignal(AbstractExcitation):
    """An excitation made from one analytic signal, applied as base motion or as force."""

    if TYPE_CHECKING:  # each signal declares it as its last field, since it has a default
        as_force: ClassVar[bool]

    @abc.abstractmethod
    def signal(self, t: Scalar) -> Scalar:
        """The signal at time ``t``; its rate is taken by differentiation."""

    def at(self, t: Scalar) -> Drive:
        value, rate = jax.jvp(self.signal, (t,), (jnp.ones_like(t),))
        zero = jnp.zeros_like(value)
        return Drive(zero, zero, value, rate) if self.as_force else Drive(value, rate, zero, zero)


class Rest(AbstractExcitation):
    """No excitation: free decay with the base at rest."""

    def at(self, t: Scalar) -> Drive:
        zero = jnp.zeros_like(t)
        return Drive(zero, zero, zero, zero)


class Harmonic(AbstractSignal):
    r"""A steady sine, :math:`A \cos(\omega t + \varphi)`; ``omega`` in rad/s."""

    amplitude: Scalar
    omega: Scalar
    phase: Scalar = 0.0
    as_force: bool = eqx.field(default=False, static=True)

    def signal(self, t: Scalar) -> Scalar:
        return self.amplitude * jnp.cos(self.omega * t + self.phase)


class Chirp(AbstractSignal):
    r"""A linear sweep from ``f0`` to ``f1`` [Hz] over ``duration`` [s], started as a sine.

    A servo's roll-off may be modelled by ``corner`` [Hz]: the amplitude falls as :math:`1/\sqrt{1 + (f/f_c)^2}`.
    """

    amplitude: Scalar
    f0: Scalar
    f1: Scalar
    duration: Scalar
    corner: Scalar = 1e9
    as_force: bool = eqx.field(default=False, static=True)

    def signal(self, t: Scalar) -> Scalar:
        rate = (self.f1 - self.f0) / self.duration
        frequency = self.f0 + rate * t
        level = self.amplitude / jnp.sqrt(1.0 + (frequency / self.corner) ** 2)
        return level * jnp.sin(2.0 * jnp.pi * (self.f0 * t + 0.5 * rate * t * t))


class Multisine(AbstractSignal):
    """A sum of sines; ``amplitudes``, ``omegas`` [rad/s] and ``phases`` are arrays of one length."""

    amplitudes: Array
    omegas: Array
    phases: Array
    as_force: bool = eqx.field(default=False, static=True)
    series: ClassVar[tuple[str, ...]] = ("amplitudes", "omegas", "phases")

    def signal(self, t: Scalar) -> Scalar:
        return jnp.sum(self.amplitudes * jnp.sin(self.omegas * t + self.phases))


class SteppedSine(AbstractSignal):
    """Sines of given ``frequencies`` [Hz] and ``amplitudes``, each held for ``dwell`` [s], continuous in phase.

    The step in amplitude and frequency is smoothed over a tenth of the dwell so that the base's speed stays bounded.
    """

    amplitudes: Array
    frequencies: Array
    dwell: Scalar
    as_force: bool = eqx.field(default=False, static=True)
    series: ClassVar[tuple[str, ...]] = ("amplitudes", "frequencies")

    def signal(self, t: Scalar) -> Scalar:
        amplitudes, frequencies = jnp.asarray(self.amplitudes), jnp.asarray(self.frequencies)
        starts = self.dwell * jnp.arange(1, amplitudes.shape[0])
        blend = 0.05 * self.dwell
        u = jnp.clip((t - starts) / blend, -1.0, 1.0)
        step = 0.5 + u * (0.75 - 0.25 * u * u)
        # The integral of the smoothed step keeps the phase continuous while the frequency changes.
        ramp = jnp.where(u < 1.0, blend * (0.1875 + u * (0.5 + u * (0.375 - 0.0625 * u * u))), t - starts)
        level = amplitudes[0] + jnp.sum(jnp.diff(amplitudes) * step)
        phase = frequencies[0] * t + jnp.sum(jnp.diff(frequencies) * ramp)
        return level * jnp.sin(2.0 * jnp.pi * phase)


class Sampled(AbstractExcitation):
    """A measured drive on a uniform grid: values and rates at the samples, cubic in between (Hermite); a force whose rate is not
    known is straight.

    Attributes: ``t0`` time of the first sample and ``dt`` spacing [s]; ``x``, ``dx``, ``force`` of one length, and
    ``dforce`` where the rate of the force is known. Rates come from a smoothing spline (`jaxbacklash.signals.smoothing`),
    never from differences of raw samples.
    """

    t0: Scalar
    dt: Scalar
    x: Array
    dx: Array
    force: Array
    dforce: Array | None = None
    series: ClassVar[tuple[str, ...]] = ("x", "dx", "force", "dforce")

    def at(self, t: Scalar) -> Drive:
        position = (t - self.t0) / self.dt
        k = jnp.clip(jnp.floor(position).astype(int), 0, self.x.shape[0] - 2)
        s = position - k
        x, dx = self._curve(self.x, self.dx, k, s)
        if self.dforce is None:
            return Drive(x, dx, (1.0 - s) * self.force[k] + s * self.force[k + 1])
        return Drive(x, dx, *self._curve(self.force, self.dforce, k, s))

    def _curve(self, value: Array, rate: Array, k: Any, s: Scalar) -> tuple[Scalar, Scalar]:
        """Value and rate a share ``s`` of the spacing behind sample ``k``."""
        a, b, c, d = value[k], self.dt * rate[k], value[k + 1], self.dt * rate[k + 1]
        c2, c3 = 3.0 * (c - a) - 2.0 * b - d, b + d - 2.0 * (c - a)
        return a + s * (b + s * (c2 + s * c3)), (b + s * (2.0 * c2 + 3.0 * s * c3)) / self.dt


class Panelled(Sampled):
    """Samples that are the panel edges of one run; the fixed-step solvers take them as they are."""

    def grid(self, t0: Scalar, h: Scalar, panels: int) -> Drive:
        return Drive(self.x, self.dx, self.force, self.dforce)


class MotorTorque(AbstractExcitation):
    """A signal as the torque at the motor of a drive [N m], or the position command of its servo [rad], without a hold.

    Examples
    --------
    >>> push = jb.MotorTorque(jb.Harmonic(0.2, 10.0))
    >>> round(float(push.at(jnp.asarray(0.0)).torque), 3)
    0.2
    """

    signal: AbstractSignal

    def at(self, t: Scalar) -> Drive:
        value, rate = jax.jvp(self.signal.signal, (t,), (jnp.ones_like(t),))
        zero = jnp.zeros_like(value)
        return Drive(zero, zero, zero, zero, value, rate)


class HeldTorque(AbstractExcitation):
    """Samples of the torque at the motor of a drive, each held until the next: what a controller puts out. Of a motor with a
    servo these are of its position command [rad].

    Attributes: ``t0`` time of the first sample and ``dt`` spacing [s]; ``torque`` (N,) [N m]. Before the first and after the last
    sample those go on.

    Examples
    --------
    >>> push = jb.HeldTorque(0.0, 0.001, np.array([0.1, 0.3, 0.2]))
    >>> [float(push.at(jnp.asarray(t)).torque) for t in (0.0, 0.0009, 0.001)]
    [0.1, 0.1, 0.3]
    """

    t0: Scalar
    dt: Scalar
    torque: Array
    series: ClassVar[tuple[str, ...]] = ("torque",)

    def at(self, t: Scalar) -> Drive:
        # A millionth of a sample early is the sample: times are sums of panels.
        k = jnp.floor((t - self.t0) / self.dt + 1e-6).astype(int)
        value = jnp.asarray(self.torque)[jnp.clip(k, 0, self.torque.shape[0] - 1)]
        zero = jnp.zeros_like(value)
        return Drive(zero, zero, zero, zero, value)
