"""Causes of misfit that lie in the record and not in the joint: found by `find_causes`, before any law is looked for."""

from .cause import Cause as Cause
from .find import find_causes as find_causes
