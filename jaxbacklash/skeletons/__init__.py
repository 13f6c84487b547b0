"""Play, stiffness and damping from envelopes and phases: the classical ways, which stand beside the fit."""

from .estimate import skeleton as skeleton
from .frf import Response as Response
from .frf import frequency_response as frequency_response
from .result import Curve as Curve
from .result import Skeleton as Skeleton
from .result import Skeletons as Skeletons
from .result import Value as Value
