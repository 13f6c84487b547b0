"""Pictures of records, fits and everything else that the package finds: the report's own, on axes of your choice.

Every function draws one picture, of one panel or several, and takes as ``ax`` what to draw it on. None makes a new figure; a
matplotlib figure, or part of one, is laid out with all panels; one axes takes the most telling panel alone; as many axes as there
are panels take one each. What comes back is what was drawn on: the axes, or an array of them.

>>> record, heldout = jb.demo_records()
>>> figure, (above, below) = plt.subplots(2)
>>> axes = jb.plot.record(record, ax=[above, below])
>>> [one.get_ylabel() for one in axes]
['x [rad]', 'z [rad]']
"""

import lazy_loader as _lazy

# What it holds is listed in __init__.pyi, and loaded when it is asked for, with matplotlib.
__getattr__, __dir__, __all__ = _lazy.attach_stub(__name__, __file__)
