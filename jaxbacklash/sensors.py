"""What the measuring chain does to the motion; these are effects like any other, but exert no torque."""

from __future__ import annotations

from typing import Any, ClassVar

import jax.numpy as jnp
import numpy as np

from .mechanics import AbstractEffect, Instant
from .parameters import Scalar, param


class SensorDelay(AbstractEffect):
    r"""The measured channel lags the input channel by :math:`\tau`: :math:`z_\mathrm{meas}(t) = z(t - \tau)`."""

    tau: Scalar = param(unit="s", null=0.0, scale=1e-3)

    def lag(self, t: Scalar) -> Scalar:
        return self.tau


class SensorGain(AbstractEffect):
    r"""The measured channel is scaled, :math:`z_\mathrm{meas} = g z`.

    By half to twice: more is no calibration's error but a wrong unit, and a joint of other size would explain as much.
    """

    g: Scalar = param(unit="1", null=1.0, lower=0.5, upper=2.0, scale=0.01)

    def observe(self, value: Scalar, state: tuple[Scalar, ...] = ()) -> Scalar:
        return self.g * value


class SensorOffset(AbstractEffect):
    r"""The measured channel is shifted, :math:`z_\mathrm{meas} = z + z_s`."""

    z_s: Scalar = param(unit="rad", null=0.0, scale=1e-3)

    def observe(self, value: Scalar, state: tuple[Scalar, ...] = ()) -> Scalar:
        return value + self.z_s


LABORATORY = 0.02
"""Time in which a joint of the source paper's size turns by a radian of phase [s]."""
QUICKEST = 1e-3
"""Time constant [s] below which what a low-pass remembers follows no quicker: fixed steps must be able to take it."""


class SensorFilter(AbstractEffect):
    r"""The measured channel is behind a low-pass of first order, :math:`\tau_f \dot z_\mathrm{meas} = z - z_\mathrm{meas}`.

    The state is the rate at which the channel moves, v, so that :math:`z_\mathrm{meas} = z - \tau_f v` vanishes with the time
    constant :math:`\tau_f`; the corner is at :math:`1 / (2 \pi \tau_f)` hertz.
    """

    alike: ClassVar[dict[str, str]] = {
        "sensor_delay": "motion of several times the frequency: a filter also makes it smaller, a delay does not",
        "sensor_gain": "motion of several frequencies: a gain makes all of them smaller by one factor",
    }

    tau_f: Scalar = param(unit="s", null=0.0, lower=0.0, scale=1e-3)
    states: ClassVar[tuple[str, ...]] = ("v",)

    @classmethod
    def guesses(cls, system: Any, motion: Any | None = None) -> list[AbstractEffect]:
        # Shares of the time in which the motion of the record turns by a radian of phase.
        radian = LABORATORY if motion is None else float(np.std(motion.y - motion.x) / max(np.std(motion.dy - motion.dx), 1e-300))
        return [cls(share * radian) for share in (0.1, 0.2, 0.4, 0.8)]

    def simpler(self) -> list[AbstractEffect]:
        return [SensorDelay(self.tau_f)]

    def rate(self, now: Instant) -> tuple[Scalar, ...]:
        return ((now.dseen - now.state[0]) / jnp.maximum(self.tau_f, QUICKEST),)

    def start(self, now: Instant) -> tuple[Scalar, ...]:
        return (now.dseen,)

    def observe(self, value: Scalar, state: tuple[Scalar, ...] = ()) -> Scalar:
        return value - self.tau_f * state[0]


class ClockDrift(AbstractEffect):
    r"""The clock of the measured channel runs :math:`1 + r` times as fast as that of the input (two loggers).

    What it stamps with t was there at :math:`t / (1 + r)`: :math:`z_\mathrm{meas}(t) = z(t / (1 + r))`.
    """

    alike: ClassVar[dict[str, str]] = {"sensor_delay": "a longer record: the lag of another clock grows, a delay stays"}

    r: Scalar = param(unit="1", null=0.0, lower=-1e-3, upper=1e-3, scale=1e-5)

    def lag(self, t: Scalar) -> Scalar:
        return t * (self.r / (1.0 + self.r))
