"""Arrays in, arrays out; knows no system."""

from .bump import Bump as Bump
from .noise import noise_level as noise_level
from .smoothing import DEGREE as DEGREE
from .smoothing import NEGLIGIBLE as NEGLIGIBLE
from .smoothing import SmoothMotion as SmoothMotion
from .smoothing import choose_intervals as choose_intervals
from .smoothing import fit_spline as fit_spline
from .smoothing import is_smooth as is_smooth
from .smoothing import knots as knots
