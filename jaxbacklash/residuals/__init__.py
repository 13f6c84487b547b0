"""Where a fitted model fails, the torque that it misses as a function of time, and of what that torque is a function."""

from .failures import Dependence as Dependence
from .findings import Findings as Findings
from .findings import where_it_fails as where_it_fails
from .latent import Latent as Latent
from .latent import missing_torque as missing_torque
from .latent import missing_torque_of as missing_torque_of
from .surface import Surface as Surface
from .surface import explain_torque as explain_torque
