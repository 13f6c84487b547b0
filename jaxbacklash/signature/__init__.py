"""Chaos as a signature of the play: the exponent over the drive level, and what measured exponents say of the backlash."""

from .expected_precision import ExpectedPrecision as ExpectedPrecision
from .expected_precision import expected_precision as expected_precision
from .expected_precision import imagine as imagine
from .exponent_map import ExponentMap as ExponentMap
from .exponent_map import exponent_map as exponent_map
from .infer import PlayFromChaos as PlayFromChaos
from .infer import play_from_exponents as play_from_exponents
from .levels import Level as Level
from .pattern import PatternMatch as PatternMatch
from .pattern import match_pattern as match_pattern
