"""A fitted model as the search compares it: parameters, evidence, and how large a torque it leaves out."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..fitting.continuation import Continued, Stop, evidence_at
from ..parameters import values, with_values
from ..shooting.problem import Unknowns
from ..system import System


@dataclass(frozen=True)
class FittedModel:
    """A fit by continuation of one model of the catalogue.

    Attributes: ``system`` with the whole catalogue, what is absent at its null values; ``names`` of the laws in the model;
    ``free`` parameters, ``information`` (q, q) about them and padding columns in units of ``scales`` (q,); ``unknowns`` of the
    fit; ``cost`` half the sum of squares; ``tie``, the weight of the ties between windows at which the fit ended, and ``tied``,
    whether they make one trajectory; ``log_evidence``, the marginal likelihood there; ``penalty`` of the criterion; ``rest``,
    by how much the criterion is above that of a model like this that leaves noise alone; ``freedom``, samples less the unknowns
    of one trajectory; ``misfit``, the root of the reduced chi-square of one trajectory, or of what would leave as much as this
    model leaves out; ``inside``, root mean square of the residual inside the windows in units of the noise; ``correlation``,
    how many samples of it count for one; ``converged``, whether the last fit came to its end, in ``steps``; ``stops``, the fits
    on the way; ``found``, the fit itself; ``seen``, the log evidence by other weights of the ties.
    """

    system: System
    names: frozenset[str]
    free: tuple[str, ...]
    unknowns: Unknowns = field(repr=False)
    cost: float
    misfit: float
    information: np.ndarray = field(repr=False)
    scales: np.ndarray = field(repr=False)
    tied: bool
    converged: bool
    penalty: float
    correlation: float
    steps: int
    tie: float
    log_evidence: float
    inside: float
    rest: float
    freedom: float
    stops: tuple[Stop, ...] = field(default=(), repr=False)
    found: Continued | None = field(default=None, repr=False)
    seen: dict[float, float] = field(default_factory=dict, repr=False)

    @property
    def value(self) -> dict[str, float]:
        """Values of the free parameters by name."""
        present = values(self.system)
        return {name: present[name] for name in self.free}

    @property
    def pruned(self) -> System:
        """The fitted system without the laws that stand at their null values."""
        full = self.system
        kept = {n: full.effects[n] for n in self.names}
        bare = System(full.inertia, full.contact, full.damper, kept, full.observed, motor=full.motor)
        return with_values(bare, values(bare))

    @property
    def criterion(self) -> float:
        """Bayesian information criterion: minus twice the log evidence, ln N a parameter (Schwarz 1978), and minus twice the
        log prior of the laws. Less is better."""
        return self.penalty - 2.0 * self.log_evidence

    def criterion_at(self, tie: float) -> float:
        """The criterion with ties of another weight: what the model is worth if it leaves out a torque of that size."""
        if tie == self.tie or self.found is None:
            return self.criterion
        if tie not in self.seen:
            self.seen[tie] = evidence_at(self.found.problem, self.found.reached, tie)
        return self.penalty - 2.0 * self.seen[tie]

    @property
    def deflation(self) -> float:
        """By what evidence is divided where the residual inside the windows is larger than noise, or correlated: so many
        samples count for one."""
        return max(1.0, self.inside**2) * self.correlation
