"""The one table of laws that the tests walk: a law with telling values, one row each."""

from jaxbacklash.effects import (
    AsymmetricGap,
    CoulombGround,
    CoulombJoint,
    CubicStiffness,
    Dahl,
    FlexibleLink,
    GapSpring,
    Gravity,
    LinearGravity,
    Preload,
)
from jaxbacklash.sensors import SensorDelay, SensorGain, SensorOffset

LAWS = {
    "asymmetric_gap": AsymmetricGap(0.002),
    "coulomb_ground": CoulombGround(3.0, 0.05),
    "coulomb_joint": CoulombJoint(4.0, 0.05),
    "cubic_stiffness": CubicStiffness(3e7),
    "dahl": Dahl(6.0, 2000.0),
    "flexible_link": FlexibleLink(0.6, 17000.0, 1.2),
    "gap_spring": GapSpring(300.0, 0.001),
    "gravity": Gravity(-28.0),
    "linear_gravity": LinearGravity(-28.0),
    "preload": Preload(5.0),
    "sensor_delay": SensorDelay(0.003),
    "sensor_gain": SensorGain(1.02),
    "sensor_offset": SensorOffset(0.001),
}
