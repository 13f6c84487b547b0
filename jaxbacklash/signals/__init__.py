"""Arrays in, arrays out; knows no system."""

from .analytic import Carrier as Carrier
from .analytic import analytic as analytic
from .analytic import carrier as carrier
from .analytic import denoised as denoised
from .analytic import low_passed as low_passed
from .bandwidth import highest_frequency as highest_frequency
from .bump import Bump as Bump
from .cycles import CycleSpline as CycleSpline
from .cycles import SlowCurve as SlowCurve
from .morlet import Atoms as Atoms
from .morlet import Morlet as Morlet
from .morlet import Scalogram as Scalogram
from .morlet import frequency_grid as frequency_grid
from .morlet import scalogram as scalogram
from .noise import noise_level as noise_level
from .noise import noise_of_differences as noise_of_differences
from .noise import noise_of_speed as noise_of_speed
from .ridge import ridge as ridge
from .smoothing import DEGREE as DEGREE
from .smoothing import NEGLIGIBLE as NEGLIGIBLE
from .smoothing import SmoothMotion as SmoothMotion
from .smoothing import choose_intervals as choose_intervals
from .smoothing import fit_spline as fit_spline
from .smoothing import is_smooth as is_smooth
from .smoothing import knots as knots
