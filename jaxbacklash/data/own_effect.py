"""An effect of one's own, as a user would write it: --laws own_effect.py makes every command know it."""

from jaxbacklash import AbstractEffect, param


class CableSpring(AbstractEffect):
    r"""A cable that pulls the link back to its middle, T = -s y."""

    port = "ground"
    s: float = param(unit="N m/rad", null=0.0, lower=0.0, scale=10.0)

    def torque(self, now):
        return -self.s * now.y
