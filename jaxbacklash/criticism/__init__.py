"""Which effects a model lacks: absent laws ranked, and the search that adds them."""

from .ranking import Ranked as Ranked
from .ranking import Ranking as Ranking
from .ranking import rank_effects as rank_effects
from .refine import refine as refine
from .refinement import Refinement as Refinement
from .steps import Stage as Stage
