"""The experiment that would separate two models which a record cannot tell apart.

One of them is simulated under sines that the rig has shown it can do and measured with the record's own noise; both then
predict that with their parameters frozen, as `compare` would on the real thing. What the record at hand has left open in the
parameters counts for both.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import jax
import numpy as np

from ..errors import BadInput
from ..excitation import SteppedSine
from ..fitting.score import score
from ..fitting.settings import PARTED, SECONDS
from ..fitting.setup import first_guess
from ..mechanics import told_apart
from ..records import Record
from ..simulation import measured_base, simulate
from ..system import System
from .fitted_model import FittedModel
from .model_builder import ModelBuilder


@dataclass(frozen=True)
class Sine:
    """A steady sine: ``amplitude`` [rad or N m, m or N], ``frequency`` [Hz], the rival's ``misfit`` over the other's."""

    amplitude: float
    frequency: float
    misfit: float


@dataclass(frozen=True)
class Experiment:
    """The sine under which two models part most.

    Attributes: ``kept`` and ``rival``, the effects of the two models; ``drive``, the channel that is driven, ``unit`` its unit;
    ``samples`` it gives; ``tried``, all sines; ``best`` of them; ``seconds`` it lasts.
    """

    kept: tuple[str, ...]
    rival: tuple[str, ...]
    drive: str
    unit: str
    samples: int
    tried: tuple[Sine, ...]
    seconds: float = SECONDS

    @property
    def best(self) -> Sine:
        return max(self.tried, key=lambda s: s.misfit)

    @property
    def parts(self) -> bool:
        """Whether the best sine would tell the models apart."""
        return self.samples * (self.best.misfit**2 - 1.0) > PARTED

    def __str__(self) -> str:
        best, kept, rival = self.best, " + ".join(self.kept), " + ".join(self.rival)
        beside = needed(self.kept, self.rival)
        if not self.parts:
            return (
                f"No sine within what this rig has done here separates {rival} from {kept} in {self.seconds:g} s: "
                f"at best {rival} would miss by {best.misfit:.3f} times what {kept} does."
            ) + beside
        return (
            f"To tell {rival} from {kept}: let a sine of {best.frequency:.3g} Hz grow from rest to {best.amplitude:.3g} "
            f"{self.unit} in {self.drive} and hold it for {self.seconds:g} s; {rival} would then miss by {best.misfit:.3g} times "
            f"what {kept} does."
        ) + beside


def needed(kept: Iterable[str], rival: Iterable[str]) -> str:
    """What a record must hold to tell two sets of effects apart, as far as the laws say so: sentences, each after a space."""
    kept, rival = set(kept), set(rival)
    both = [(a, b) for a in sorted(kept - rival) for b in sorted(rival - kept)]
    pairs = [(a, b, apart) for a, b in both if (apart := told_apart(a, b)) is not None]
    return "".join(f" To tell {b} from {a} a record needs {apart}." for a, b, apart in pairs)


def separate(builder: ModelBuilder, kept: FittedModel, rival: FittedModel, *, translational: bool = False) -> Experiment | None:
    """Look for the sine that separates two fitted models; None where nothing drives the record.

    Parameters
    ----------
    builder : of the record; its compiled programs serve again
    kept, rival : two models fitted to the record
    translational : units of a translating mass
    """
    if builder.record.kind not in ("base_motion", "force"):
        return None
    model = kept.pruned
    tried = []
    for amplitude, frequency in within_reach(builder.record):
        try:
            twin = measured_twin(model, builder, amplitude, frequency)
        except BadInput:  # such a sine moves nothing
            continue
        twins = ModelBuilder(twin, builder.base, builder.base_free, builder.window, beside=builder.record)
        twins.take_laws(builder.laws)
        missed = [error(twins, builder, one) for one in (kept, rival)]
        tried.append(Sine(amplitude, frequency, missed[1] / missed[0]))
    if not tried:
        return None
    drive = builder.record.input_name or ""
    unit = {"x": ("rad", "m"), "F": ("N m", "N")}[drive][translational]
    return Experiment(tuple(sorted(kept.names)), tuple(sorted(rival.names)), drive, unit, twin.samples, tuple(tried))


def error(twins: ModelBuilder, builder: ModelBuilder, model: FittedModel) -> float:
    """How far a model of one record misses another one, its parameters frozen, in units of the noise."""
    problem, _ = twins.problem(builder.effects(model), model.system)
    return score(problem, first_guess(problem), twins.layout, group=twins.group)[0][0].rms


def within_reach(record: Record) -> Iterator[tuple[float, float]]:
    """Amplitudes and frequencies [Hz] of sines that ask for no more travel, speed and acceleration than the record has shown."""
    drive = measured_base(record)
    if record.kind == "force":
        signal, rates = np.asarray(drive.force), []
    else:
        signal, speed = np.asarray(drive.x), np.asarray(drive.dx)
        rates = [speed, np.gradient(speed, record.dt)]
    # A hundredth of the samples may be a start or a knock.
    bounds = [float(np.quantile(np.abs(s), 0.99)) for s in (signal - np.mean(signal), *rates)]
    energy = np.cumsum(np.abs(np.fft.rfft(np.gradient(signal - np.mean(signal)))) ** 2)
    hertz = np.fft.rfftfreq(record.samples, record.dt)
    low, high = (float(hertz[np.searchsorted(energy, share * energy[-1])]) for share in (0.1, 0.9))
    for frequency in np.geomspace(max(low, 2.0 / SECONDS), max(high, 4.0 / SECONDS), 3):
        omega = 2.0 * np.pi * frequency
        amplitude = min(bound / omega**order for order, bound in enumerate(bounds))
        yield amplitude, float(frequency)
        yield amplitude / 3.0, float(frequency)


def measured_twin(model: System, builder: ModelBuilder, amplitude: float, frequency: float) -> Record:
    """What the rig would record of this model under a sine that grows from rest, with the noise of the record at hand."""
    record, rng = builder.record, np.random.default_rng(0)
    forced = record.kind == "force"
    # The smoothed step from no drive to the full one lasts a tenth of the dwell, half of it before the dwell ends.
    drive = SteppedSine(np.array([0.0, amplitude]), np.full(2, frequency), SECONDS, as_force=forced)
    begin = 0.95 * SECONDS
    path = simulate(model, drive, duration=SECONDS, rate=record.rate_hz, t0=begin)
    times = np.asarray(path.t) - begin
    lag = model.lag(times)
    # A channel that lags shows the motion under an equally late drive, which has gone on meanwhile.
    late = np.broadcast_to(0.0 if lag is None else np.asarray(lag), times.shape)
    seen = jax.vmap(drive.signal)(path.t + late)
    channels = {
        "F" if forced else "x": np.asarray(seen) + builder.layout.input_noise[0] * rng.standard_normal(path.t.size),
        record.observed_name: np.asarray(path.observed) + builder.layout.noise[0] * rng.standard_normal(path.t.size),
    }
    return Record(times + late - late[0], channels, "the twin of an experiment", confirmed=frozenset({"t", "x", "y", "z"}))
