"""The play of slow records, without dynamics."""

from .estimate import lost_motion as lost_motion
from .reading import Condition as Condition
from .result import LostMotion as LostMotion
