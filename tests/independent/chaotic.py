"""Series whose nature is known: chaotic systems with their exponents, and signals that only look like them.

Many realisations are integrated at once, as the last axis of the arrays. The exponent of a system is found from a shadow of
each trajectory, pulled back to a tiny distance again and again (Benettin et al., 1980), so it needs no Jacobian and
shares nothing with what estimates it from a series.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from scipy.signal import lfilter

Rate = Callable[[float, np.ndarray, dict], np.ndarray]
NEAR = 1e-8  # distance of the shadow


@dataclass(frozen=True, eq=False)
class Chaotic:
    """A chaotic system and how it is observed.

    ``rule`` is the rate of change of a flow or the next state of a map; ``dt`` time between samples [units of the system],
    1 for maps; ``start`` a state near the attractor; ``observe`` the coordinate measured; ``published`` the largest
    exponent of the literature per unit of time, with its source, where there is one; ``period`` of the drive, if any.
    """

    name: str
    rule: Rate
    start: tuple[float, ...]
    dt: float = 1.0
    observe: int = 0
    published: float | None = None
    source: str = ""
    period: float | None = None
    constants: dict = field(default_factory=dict)
    steps: int = 8
    transient: int = 500
    is_map: bool = False

    def advance(self, t: float, state: np.ndarray) -> np.ndarray:
        """The state (d, ...) one sample later."""
        if self.is_map:
            return self.rule(t, state, self.constants)
        h = self.dt / self.steps
        for step in range(self.steps):
            at = t + step * h
            k1 = self.rule(at, state, self.constants)
            k2 = self.rule(at + h / 2, state + h / 2 * k1, self.constants)
            k3 = self.rule(at + h / 2, state + h / 2 * k2, self.constants)
            k4 = self.rule(at + h, state + h * k3, self.constants)
            state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        return state

    def series(self, samples: int, realisations: int = 1, seed: int = 0) -> np.ndarray:
        """Measured without noise, shape (realisations, samples)."""
        rng = np.random.default_rng([seed, len(self.name), *self.name.encode()])
        state = np.asarray(self.start)[:, None] * (1.0 + 0.01 * rng.uniform(-1.0, 1.0, (len(self.start), realisations)))
        out = np.empty((samples, realisations))
        for k in range(-self.transient, samples):
            if k >= 0:
                out[k] = state[self.observe]
            state = self.advance((k + self.transient) * self.dt, state)
        return out.T.copy()

    def exponent(self, samples: int = 20000, realisations: int = 16) -> tuple[float, float]:
        """Largest exponent per unit of time from the equations, and its standard error."""
        return _exponent(self, samples, realisations)


@lru_cache
def _exponent(system: Chaotic, samples: int, realisations: int) -> tuple[float, float]:
    rng = np.random.default_rng(1)
    state = np.asarray(system.start)[:, None] * (1.0 + 0.01 * rng.uniform(-1.0, 1.0, (len(system.start), realisations)))
    for k in range(system.transient):
        state = system.advance(k * system.dt, state)
    shadow = state + NEAR * rng.standard_normal(state.shape) / np.sqrt(len(state))
    grown = np.zeros(realisations)
    for k in range(samples):
        at = (k + system.transient) * system.dt
        both = system.advance(at, np.concatenate([state, shadow], axis=1))
        state, shadow = both[:, :realisations], both[:, realisations:]
        apart = np.sqrt(np.sum((shadow - state) ** 2, axis=0))
        apart = np.maximum(apart, 1e-300)
        if k >= samples // 20:
            grown += np.log(apart / NEAR)
        shadow = state + (shadow - state) * (NEAR / apart)
    rates = grown / ((samples - samples // 20) * system.dt)
    return float(rates.mean()), float(rates.std(ddof=1) / np.sqrt(realisations))


def _lorenz(t, s, c):
    x, y, z = s
    return np.stack([10.0 * (y - x), x * (28.0 - z) - y, x * y - 8.0 / 3.0 * z])


def _rossler(t, s, c):
    x, y, z = s
    return np.stack([-y - z, x + c["a"] * y, c["b"] + z * (x - c["c"])])


def _henon(t, s, c):
    return np.stack([1.0 - 1.4 * s[0] ** 2 + s[1], 0.3 * s[0]])


def _logistic(t, s, c):
    # Round-off would reach the fixed point 0 from exactly 1/2; the clip keeps rounding inside the interval.
    return np.clip(4.0 * s * (1.0 - s), 1e-12, 1.0 - 1e-12)


def _mackey_glass(t, s, c):
    # The delay as a chain of grid points, solved to second order (Farmer, 1982).
    h, n = c["tau"] / (len(s) - 1), len(s) - 1
    values, new = s, np.empty_like(s)
    new[0] = values[n]
    a = 0.5 * h
    for k in range(1, n + 1):
        f0 = 0.2 * values[k - 1] / (1.0 + values[k - 1] ** 10)
        f1 = 0.2 * values[k] / (1.0 + values[k] ** 10)
        new[k] = ((1.0 - 0.1 * a) * new[k - 1] + a * (f0 + f1)) / (1.0 + 0.1 * a)
    return new


def _dead_zone(p):
    return np.maximum(p - 1.0, 0.0) + np.minimum(p + 1.0, 0.0)


def _case_1(t, s, c):
    p, v = s
    return np.stack([v, np.cos(0.2 * t) / c["inverse_alpha"] - 0.04 * v - _dead_zone(p)])


def _duffing(t, s, c):
    return np.stack([s[1], s[0] - s[0] ** 3 - 0.25 * s[1] + c.get("f", 0.3) * np.cos(t)])


def _chua(t, s, c):
    x, y, z = s
    f = -0.714 * x + 0.5 * (-1.143 + 0.714) * (np.abs(x + 1.0) - np.abs(x - 1.0))
    return np.stack([15.6 * (y - x - f), x - y + z, -28.0 * y])


def _pendulum(t, s, c):
    return np.stack([s[1], -0.5 * s[1] - np.sin(s[0]) + 1.2 * np.cos(2.0 / 3.0 * t)])


def _ikeda(t, s, c):
    x, y = s
    turn = 0.4 - 6.0 / (1.0 + x**2 + y**2)
    return np.stack([1.0 + 0.9 * (x * np.cos(turn) - y * np.sin(turn)), 0.9 * (x * np.sin(turn) + y * np.cos(turn))])


def _coupled_logistic(t, s, c):
    f = 3.8 * s * (1.0 - s)
    return 0.93 * f + 0.07 * f[::-1]


TWO_PI = 2.0 * np.pi


def case_1(inverse_alpha: float) -> Chaotic:
    """The paper's forced oscillator with a dead zone, 2 zeta = 0.04, Omega = 0.2 (2.14); 1/alpha as given. Time in tau."""
    return Chaotic(
        f"CASE 1, 1/alpha = {inverse_alpha:g}", _case_1, (0.3, 0.1), dt=TWO_PI / 0.2 / 40, period=TWO_PI / 0.2,
        constants={"inverse_alpha": inverse_alpha}, steps=16, transient=4000,
    )  # fmt: skip


LORENZ = Chaotic("Lorenz", _lorenz, (1.0, 2.0, 20.0), dt=0.02, published=0.906, source="Sprott 2003")
ROSSLER = Chaotic(
    "Rossler", _rossler, (1.0, 1.0, 0.1), dt=0.12, published=0.0714, source="Sprott 2003",
    constants={"a": 0.2, "b": 0.2, "c": 5.7}, transient=2000,
)  # fmt: skip
HENON = Chaotic("Henon", _henon, (0.1, 0.1), published=0.419, source="Sprott 2003", is_map=True)
LOGISTIC = Chaotic("logistic", _logistic, (0.3,), published=np.log(2.0), source="exact", is_map=True)
MACKEY_GLASS = Chaotic(
    "Mackey-Glass", lambda t, s, c: _mackey_glass_step(s, c), (1.2,) * 61, dt=1.5, is_map=True, observe=-1,
    constants={"tau": 30.0}, transient=1500,
)  # fmt: skip


def _mackey_glass_step(s, c):
    """Advance by three of sixty grid intervals of the delay."""
    h = c["tau"] / (len(s) - 1)
    a, state = 0.5 * h, s
    for _ in range(3):
        f0, f1 = 0.2 * state[0] / (1.0 + state[0] ** 10), 0.2 * state[1] / (1.0 + state[1] ** 10)
        new = ((1.0 - 0.1 * a) * state[-1] + a * (f0 + f1)) / (1.0 + 0.1 * a)
        state = np.concatenate([state[1:], new[None]])
    return state


KNOWN = (LORENZ, ROSSLER, HENON, LOGISTIC, MACKEY_GLASS)

# Held back: nothing in the package was chosen with these in view.
DUFFING = Chaotic("Duffing", _duffing, (0.5, 0.1), dt=TWO_PI / 40, period=TWO_PI, steps=8)
CHUA = Chaotic("Chua", _chua, (0.7, 0.0, 0.0), dt=0.05, transient=3000)
PENDULUM = Chaotic("forced pendulum", _pendulum, (0.2, 0.1), dt=0.2, observe=1, period=3.0 * np.pi)
IKEDA = Chaotic("Ikeda", _ikeda, (0.1, 0.1), is_map=True)
COUPLED = Chaotic("coupled logistic", _coupled_logistic, (0.31, 0.72), is_map=True)
HELD_BACK = (DUFFING, CHUA, PENDULUM, IKEDA, COUPLED)


def with_noise(series: np.ndarray, share: float, seed: int = 0) -> np.ndarray:
    """White noise added, its standard deviation ``share`` times the series' own; shape kept."""
    rng = np.random.default_rng([seed, 77])
    return series + share * series.std(axis=-1, keepdims=True) * rng.standard_normal(series.shape)


# ---- Signals that are not chaotic; each gives shape (realisations, samples) ----


def ar2(samples: int, realisations: int, seed: int = 0) -> np.ndarray:
    """AR(2) noise: resonances of random frequency and damping."""
    rng = np.random.default_rng([seed, 1])
    out = np.empty((realisations, samples))
    for row in out:
        radius, turn = rng.uniform(0.8, 0.995), rng.uniform(0.03, 0.5) * np.pi
        drive = rng.standard_normal(samples + 2000)
        row[:] = lfilter([1.0], [1.0, -2.0 * radius * np.cos(turn), radius**2], drive)[2000:]
    return out


def noisy_limit_cycle(samples: int, realisations: int, seed: int = 0) -> np.ndarray:
    """Van der Pol oscillators: half with noise on the sensor alone (1 to 10 %), half also shaken by noise."""
    rng = np.random.default_rng([seed, 2])
    mu, h = rng.uniform(0.2, 2.0, realisations), 0.02
    shake = np.where(np.arange(realisations) % 2, rng.uniform(0.02, 0.2, realisations), 0.0)
    x, v = rng.standard_normal((2, realisations))
    every = rng.integers(3, 12)
    out = np.empty((samples, realisations))
    for k in range(-2000, samples):
        for _ in range(every):
            a = mu * (1 - x**2) * v - x
            x1, v1 = x + h * v, v + h * a
            a1 = mu * (1 - x1**2) * v1 - x1
            x, v = x + h * (v + v1) / 2, v + h * (a + a1) / 2 + shake * np.sqrt(h) * rng.standard_normal(realisations)
        if k >= 0:
            out[k] = x
    motion = out.T
    sensor = rng.uniform(0.01, 0.1, (realisations, 1)) * motion.std(axis=1, keepdims=True)
    return motion + sensor * rng.standard_normal(motion.shape)


def torus(samples: int, realisations: int, seed: int = 0, frequencies: int = 2, noise: float | None = None) -> np.ndarray:
    """Quasi-periodic motion with so many incommensurate frequencies, distorted, with 0 to 5 % noise."""
    rng = np.random.default_rng([seed, 3, frequencies])
    t = np.arange(samples)[None, :]
    base = rng.uniform(0.05, 0.4, (realisations, 1))
    ratios = [1.0, (np.sqrt(5.0) - 1.0) / 2.0, np.sqrt(2.0) - 0.9]
    phases = [base * r * t + rng.uniform(0.0, TWO_PI, (realisations, 1)) for r in ratios[:frequencies]]
    sizes = [rng.uniform(0.3, 1.0, (realisations, 1)) for _ in phases]
    total = sum(size * np.sin(phase) for size, phase in zip(sizes, phases))
    total = total + 0.3 * np.prod([np.sin(phase) for phase in phases], axis=0)
    shares = rng.uniform(0.0, 0.05, (realisations, 1)) if noise is None else noise
    return total + shares * total.std(axis=1, keepdims=True) * rng.standard_normal(total.shape)


def squared_ar(samples: int, realisations: int, seed: int = 0) -> np.ndarray:
    """Noise from an AR(2) process seen through a curve that is not monotonic."""
    linear = ar2(samples, realisations, seed + 10)
    linear = linear / linear.std(axis=1, keepdims=True)
    return linear + 0.5 * linear**2


def exponential_ar(samples: int, realisations: int, seed: int = 0) -> np.ndarray:
    """Noise from an AR(2) process seen through a steep monotonic curve."""
    linear = ar2(samples, realisations, seed + 20)
    return np.exp(linear / linear.std(axis=1, keepdims=True))


def arma(samples: int, realisations: int, seed: int = 0) -> np.ndarray:
    """ARMA(2, 2) noise."""
    rng = np.random.default_rng([seed, 4])
    out = np.empty((realisations, samples))
    for row in out:
        radius, turn = rng.uniform(0.5, 0.98, 2), rng.uniform(0.05, 0.9, 2) * np.pi
        (a, b) = ([1.0, -2.0 * r * np.cos(w), r**2] for r, w in zip(radius, turn))
        row[:] = lfilter(b, a, rng.standard_normal(samples + 1000))[1000:]
    return out


def telegraph(samples: int, realisations: int, seed: int = 0) -> np.ndarray:
    """Random telegraph signal with 5 % noise."""
    rng = np.random.default_rng([seed, 5])
    flips = rng.uniform(size=(realisations, samples)) < rng.uniform(0.01, 0.1, (realisations, 1))
    return np.where(np.cumsum(flips, axis=1) % 2, 1.0, -1.0) + 0.05 * rng.standard_normal((realisations, samples))


def pink(samples: int, realisations: int, seed: int = 0) -> np.ndarray:
    """1/f noise, power falling as f to the minus one to two."""
    rng = np.random.default_rng([seed, 6])
    f = np.fft.rfftfreq(2 * samples)
    f[0] = np.inf
    spectrum = rng.standard_normal((realisations, f.size)) + 1j * rng.standard_normal((realisations, f.size))
    return np.fft.irfft(spectrum * f ** (-rng.uniform(0.5, 1.0, (realisations, 1))))[:, :samples]


def period_three(samples: int, realisations: int, seed: int = 0) -> np.ndarray:
    """Logistic map in its window of period three, with 1 to 5 % noise."""
    rng = np.random.default_rng([seed, 7])
    x = rng.uniform(0.2, 0.8, realisations)
    out = np.empty((samples, realisations))
    for k in range(-1000, samples):
        x = 3.835 * x * (1.0 - x)
        if k >= 0:
            out[k] = x
    return out.T + rng.uniform(0.01, 0.05, (realisations, 1)) * out.T.std(axis=1, keepdims=True) * rng.standard_normal(
        (realisations, samples)
    )


def noisy_duffing_cycle(samples: int, realisations: int, seed: int = 0) -> np.ndarray:
    """The forced Duffing oscillator in a periodic regime, with 2 % noise.

    It may jump between its wells for hundreds of samples before it settles in one, so the transient left out is long.
    """
    quiet = Chaotic(
        "Duffing, periodic", _duffing, (0.5, 0.1), dt=TWO_PI / 40, period=TWO_PI, constants={"f": 0.2}, transient=8000
    )
    return with_noise(quiet.series(samples, realisations, seed), 0.02, seed)


NOT_CHAOTIC = {"AR(2) noise": ar2, "noisy limit cycles": noisy_limit_cycle, "two-frequency torus": torus}
NOT_CHAOTIC_HELD_BACK = {
    "ARMA(2, 2) noise": arma,
    "AR(2) through a monotonic curve": exponential_ar,
    "AR(2) through a parabola": squared_ar,
    "random telegraph": telegraph,
    "1/f noise": pink,
    "period three with noise": period_three,
    "noisy Duffing cycle": noisy_duffing_cycle,
    "three-frequency torus": lambda n, r, seed=0: torus(n, r, seed, frequencies=3),
}
