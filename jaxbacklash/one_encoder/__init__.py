"""Drives with one encoder alone: where the side that is not seen is, and the way to the neighbourhood of the parameters.

Between `jaxbacklash.shooting`, on whose problem it works, and `jaxbacklash.fitting`, which begins from what it finds.
"""

from .carried import carried as carried
from .carried import one_side as one_side
from .near_by import Means as Means
from .near_by import in_turns as in_turns
from .near_by import near_by as near_by
