"""Chaos from a measured series; arrays in, arrays out, knows no system."""

from .analyse import ChaosReport as ChaosReport
from .analyse import chaos as chaos
from .correlation import Correlation as Correlation
from .correlation import correlation as correlation
from .dimension import Dimension as Dimension
from .dimension import embedding_dimension as embedding_dimension
from .embedding import embed as embed
from .exponent import Exponent as Exponent
from .exponent import largest_exponent as largest_exponent
from .mutual_information import Delay as Delay
from .mutual_information import choose_delay as choose_delay
from .mutual_information import mutual_information as mutual_information
from .noise_reduction import Cleaned as Cleaned
from .noise_reduction import projective as projective
from .noise_reduction import simple as simple
from .scales import mean_period as mean_period
from .stretching import Stretching as Stretching
from .stretching import stretching as stretching
from .surrogates import SurrogateTest as SurrogateTest
from .surrogates import aaft as aaft
from .surrogates import fourier as fourier
from .surrogates import iaaft as iaaft
from .surrogates import surrogate_test as surrogate_test
from .verdict import Verdict as Verdict
from .zero_one import ZeroOne as ZeroOne
from .zero_one import zero_one as zero_one
