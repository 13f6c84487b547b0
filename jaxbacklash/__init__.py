"""Backlash, stiffness, damping and the missing physics of a loose joint, from measured motion.

Importing this package changes nothing global. The fits need double precision: call `enable_double_precision` first.
"""

import lazy_loader as _lazy

from .showing import shown_by as _shown_by

# What it holds is listed in __init__.pyi, and loaded when it is asked for.
__getattr__, __dir__, __all__ = _lazy.attach_stub(__name__, __file__)

_shown_by("jaxbacklash.report.cards")  # loaded when a result is shown, not before

__version__ = "0.1.0"
