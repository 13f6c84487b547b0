"""A fitted model as the search compares it: parameters, evidence, and how large a torque it leaves out."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..fitting.continuation import TIGHTEST, Stop
from .workbench import Trial


@dataclass(frozen=True)
class FittedModel(Trial):
    """A fit by continuation of one model of the catalogue.

    ``tie`` weight of the ties between windows at which it ended; ``log_evidence`` the marginal likelihood there;
    ``inside`` root mean square of the residual inside the windows in units of the noise; ``rest`` by how much the criterion is
    above that of a model like this that leaves noise alone; ``stops`` the fits on the way. The others are those of `Trial`.
    """

    tie: float = TIGHTEST
    log_evidence: float = -np.inf
    inside: float = np.inf
    rest: float = 0.0
    stops: tuple[Stop, ...] = field(default=(), repr=False)

    @property
    def criterion(self) -> float:
        """Bayesian information criterion: minus twice the log evidence, ln N a parameter (Schwarz 1978), and minus twice the log
        prior of the laws. Less is better."""
        return self.penalty - 2.0 * self.log_evidence

    @property
    def deflation(self) -> float:
        """By what evidence is divided where the residual inside the windows is larger than noise, or correlated: so many samples
        count for one."""
        return max(1.0, self.inside**2) * self.correlation
