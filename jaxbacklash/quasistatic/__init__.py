"""The play of slow records, without dynamics."""

from .estimate import lost_motion as lost_motion
from .quick import said_of as said_of
from .quick import slow_reading as slow_reading
from .quick import why_not as why_not
from .reading import Condition as Condition
from .result import LostMotion as LostMotion
