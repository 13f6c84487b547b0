"""Where a model fails, the torque it misses, which effect that is, and the loop that adds it."""

from .failures import Dependence as Dependence
from .latent import Latent as Latent
from .latent import missing_torque as missing_torque
from .latent import missing_torque_of as missing_torque_of
from .ranking import Ranked as Ranked
from .ranking import Ranking as Ranking
from .ranking import rank_effects as rank_effects
from .refine import refine as refine
from .refinement import Refinement as Refinement
from .residuals import Findings as Findings
from .residuals import where_it_fails as where_it_fails
from .steps import Stage as Stage
from .surface import Surface as Surface
from .surface import explain_torque as explain_torque
