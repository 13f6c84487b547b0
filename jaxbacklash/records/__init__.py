"""Records: what was measured, read from a file and refused at birth when it cannot be used."""

import lazy_loader as _lazy

# What it holds is listed in __init__.pyi, and loaded when it is asked for.
__getattr__, __dir__, __all__ = _lazy.attach_stub(__name__, __file__)
