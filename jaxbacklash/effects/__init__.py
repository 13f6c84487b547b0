"""The catalogue of laws, one family per file, one law per class."""

from .contact import Contact as Contact
from .contact import Damper as Damper
from .contact import Spring as Spring
from .contact import corner as corner
from .friction import CoulombGround as CoulombGround
from .friction import CoulombJoint as CoulombJoint
from .friction import Dahl as Dahl
from .friction import smooth_sign as smooth_sign
from .loads import Gravity as Gravity
from .loads import LinearGravity as LinearGravity
from .loads import Preload as Preload
from .stiffness import AsymmetricGap as AsymmetricGap
from .stiffness import CubicStiffness as CubicStiffness
from .stiffness import GapSpring as GapSpring
from .structure import FlexibleLink as FlexibleLink
