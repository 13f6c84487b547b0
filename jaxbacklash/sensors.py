"""What the measuring chain does to the motion; these are effects like any other, but exert no torque."""

from __future__ import annotations

from .mechanics import AbstractEffect
from .parameters import Scalar, param


class SensorDelay(AbstractEffect):
    r"""The measured channel lags the input channel by :math:`\tau`: :math:`z_\mathrm{meas}(t) = z(t - \tau)`."""

    tau: Scalar = param(unit="s", null=0.0, scale=1e-3)

    def lag(self) -> Scalar:
        return self.tau


class SensorGain(AbstractEffect):
    r"""The measured channel is scaled, :math:`z_\mathrm{meas} = g z`.

    By half to twice: more is no calibration's error but a wrong unit, and a joint of other size would explain as much.
    """

    g: Scalar = param(unit="1", null=1.0, lower=0.5, upper=2.0, scale=0.01)

    def observe(self, value: Scalar) -> Scalar:
        return self.g * value


class SensorOffset(AbstractEffect):
    r"""The measured channel is shifted, :math:`z_\mathrm{meas} = z + z_s`."""

    z_s: Scalar = param(unit="rad", null=0.0, scale=1e-3)

    def observe(self, value: Scalar) -> Scalar:
        return value + self.z_s
