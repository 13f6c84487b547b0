"""The catalogue of laws, one family per file, one law per class."""

from .contact import Contact as Contact
from .contact import Damper as Damper
from .contact import Spring as Spring
from .contact import corner as corner
from .damping import ContactDamping as ContactDamping
from .damping import HuntCrossley as HuntCrossley
from .damping import QuadraticDrag as QuadraticDrag
from .drift import GapDrift as GapDrift
from .drift import StiffnessDrift as StiffnessDrift
from .friction import CoulombGround as CoulombGround
from .friction import CoulombJoint as CoulombJoint
from .friction import Stribeck as Stribeck
from .friction import direction as direction
from .friction import smooth_sign as smooth_sign
from .hysteresis import BoucWen as BoucWen
from .hysteresis import Dahl as Dahl
from .hysteresis import Lugre as Lugre
from .loads import Gravity as Gravity
from .loads import LinearGravity as LinearGravity
from .loads import Preload as Preload
from .loads import TorqueRipple as TorqueRipple
from .stiffness import AsymmetricGap as AsymmetricGap
from .stiffness import AsymmetricStiffness as AsymmetricStiffness
from .stiffness import CubicStiffness as CubicStiffness
from .stiffness import GapSpring as GapSpring
from .structure import FlexibleLink as FlexibleLink
