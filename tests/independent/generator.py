"""Practice records with a known answer, made by a program that shares nothing with the package.

    rng = np.random.default_rng(1)
    rig, excitation = make_rig(rng), make_excitation(rng, "multisine")
    truth = simulate_truth(rig, {"gravity": {"G": -30.0}}, excitation, rate=500.0, duration=20.0)
    record = measure(truth, rng, sigma_x=3e-5, sigma_z=3e-5)          # t, x, z

The laws are those of the catalogue of missing effects, and one outside it: speed_stiffness, a contact stiffness k + s |z'| (s in
N m s/rad^2). unknown_disturbance is what the catalogue has as disturbance, under the name from before it was there.
Dry friction is set-valued, the dead zone sharp, switches are located: see `kernel.py`. It needs numba.
"""

from __future__ import annotations

from dataclasses import asdict

import numpy as np

from tests.independent import kernel
from tests.independent.motions import Motion, Rest
from tests.independent.rigs import Excitation, Rig
from tests.independent.rigs import make_effects as make_effects
from tests.independent.rigs import make_excitation as make_excitation
from tests.independent.rigs import make_rig as make_rig

# name -> parameter -> column of the kernel's parameter vector
_COLUMNS = {
    "gravity": {"G": kernel.G, "phi0": kernel.PHI0},
    "preload": {"T0": kernel.T0},
    "gap_spring": {"k1": kernel.K1, "z0": kernel.K1_REST},
    "asymmetric_gap": {"z0": kernel.Z0},
    "asymmetric_stiffness": {"a": kernel.ASYM},
    "cubic_stiffness": {"k3": kernel.K3},
    "contact_damping": {"cc": kernel.CC, "pulls": kernel.CC_PULLS},
    "hunt_crossley": {"chi": kernel.CHI, "pulls": kernel.CHI_PULLS},
    "coulomb_joint": {"Tc": kernel.TC},
    "stribeck": {"Tc": kernel.S_TC, "Ts": kernel.S_TS, "vs": kernel.S_VS},
    "coulomb_ground": {"Tc": kernel.TG},
    "quadratic_drag": {"q": kernel.DRAG},
    "torque_ripple": {"A": kernel.RIPPLE, "N": kernel.RIPPLE_N, "phi": kernel.RIPPLE_PHI},
    "dahl": {"sigma": kernel.D_SIGMA, "Fc": kernel.D_FC},
    "lugre": {
        "sigma0": kernel.L_S0, "sigma1": kernel.L_S1, "sigma2": kernel.L_S2,
        "Fc": kernel.L_FC, "Fs": kernel.L_FS, "vs": kernel.L_VS,
    },
    "bouc_wen": {"sigma": kernel.W_SIGMA, "Fc": kernel.W_FC, "n": kernel.W_N, "beta": kernel.W_BETA},
    "flexible_link": {"J2": kernel.J2, "k2": kernel.K2, "c2": kernel.C2},
    "second_play": {"J2": kernel.J2, "k2": kernel.K2, "c2": kernel.C2, "b2": kernel.B2},
    "gap_drift": {"r": kernel.GAP_RATE},
    "stiffness_drift": {"r": kernel.K_RATE},
    "transmission_error": {"e": kernel.ERROR, "M": kernel.ERROR_M, "psi": kernel.ERROR_PSI},
    "load_friction": {"mu": kernel.MU},
    "relaxation": {"kr": kernel.KR, "tau_r": kernel.TAU_R},
    "contact_exponent": {"p": kernel.POWER, "d0": kernel.POWER_D0},
    "damping_drift": {"r": kernel.C_RATE},
    "friction_drift": {"r": kernel.DRY_RATE},
    "disturbance": {"A": kernel.DIST, "omega": kernel.DIST_W, "phi": kernel.DIST_PHI},
    "unknown_disturbance": {"A": kernel.DIST, "w": kernel.DIST_W, "phi": kernel.DIST_PHI},
    "speed_stiffness": {"s": kernel.SPEED_K},
    "pulsing_stiffness": {"a": kernel.PULSE, "w": kernel.PULSE_W},
    "end_stop": {"K": kernel.STOP_K, "y1": kernel.STOP_AT},
    "detent": {"A": kernel.DETENT, "width": kernel.DETENT_W},
    "rumble": {"A": kernel.RUMBLE},
    "play_step": {"a": kernel.STEP, "t1": kernel.STEP_T},
    "one_way_damping": {"c1": kernel.ONE_WAY},
    "squeeze_film": {"c1": kernel.FILM, "h": kernel.FILM_H},
}  # fmt: skip
_SENSORS = {
    "sensor_delay": {"tau"}, "sensor_gain": {"g"}, "sensor_offset": {"z_s"}, "sensor_filter": {"tau_f"}, "clock_drift": {"r"},
}  # fmt: skip
_GRID = 2.5e-4  # s, between the knots of the quintic that stands for the motion in the kernel


def pack(rig: Rig, effects: dict[str, dict[str, float]]) -> np.ndarray:
    """The kernel's parameter vector (SIZE,), the shape parameters that divide set to 1 where they are not used."""
    p = np.zeros(kernel.SIZE)
    p[[kernel.S_VS, kernel.L_VS, kernel.D_FC, kernel.L_FC, kernel.W_FC, kernel.W_N, kernel.J2]] = 1.0
    p[[kernel.TAU_R, kernel.POWER, kernel.POWER_D0, kernel.CC_PULLS, kernel.CHI_PULLS]] = 1.0
    p[kernel.FILTER] = effects.get("sensor_filter", {}).get("tau_f", 0.0)
    p[kernel.W_BETA] = 0.5
    p[[kernel.J, kernel.B, kernel.K, kernel.C]] = rig.inertia, rig.backlash, rig.stiffness, rig.damping
    for name, values in effects.items():
        known = _COLUMNS.get(name, _SENSORS.get(name))
        if known is None:
            raise ValueError(f"no effect is called {name!r}: there are {', '.join((*_COLUMNS, *_SENSORS))}")
        if unknown := set(values) - set(known):
            raise ValueError(f"{name} has no parameter {', '.join(sorted(unknown))}: it has {', '.join(known)}")
        for key, value in values.items():
            if name in _COLUMNS:
                p[known[key]] = value
    if "lugre" in effects and "Fs" not in effects["lugre"]:
        p[kernel.L_FS] = p[kernel.L_FC]
    return p


def start_of(excitation: Excitation) -> np.ndarray:
    """The kernel's state (STATES,) at t = 0, all that remembers at rest."""
    start, at = np.zeros(kernel.STATES), (excitation.y0, excitation.v0)
    start[:4], start[8] = (*at, *at), excitation.y0 - float(excitation.base.x(0.0))
    return start


def _pieces(motion: Motion, duration: float) -> np.ndarray:
    """Quintic coefficients (m, 6), rising powers, through the motion's exact values and derivatives on the grid."""
    if isinstance(motion, Rest):
        return np.zeros((1, 6))
    h = _GRID
    x, dx, ddx = motion.derivatives(np.arange(int(duration / h) + 3) * h)
    jump = x[1:] - x[:-1] - dx[:-1] * h - ddx[:-1] * h**2 / 2
    slope, bend = (dx[1:] - dx[:-1] - ddx[:-1] * h) * h, (ddx[1:] - ddx[:-1]) * h**2
    cubic = (10 * jump - 4 * slope + bend / 2) / h**3
    quartic = (7 * slope - 15 * jump - bend) / h**4
    quintic = (6 * jump - 3 * slope + bend / 2) / h**5
    columns = x[:-1], dx[:-1], ddx[:-1] / 2, cubic, quartic, quintic
    return np.ascontiguousarray(np.stack(columns, axis=1))


def simulate_truth(
    rig: Rig, effects: dict[str, dict[str, float]], excitation: Excitation, rate: float, duration: float, step=2e-5
) -> dict[str, np.ndarray]:
    """What the joint does, free of noise.

    Args: effects {name: {parameter: value}}; rate [Hz]; duration [s]; step, the kernel's longest step [s].
    Returns (n,) arrays: t [s]; x, dx base; y, v link; z = y - x; z_seen, z as its sensor's effects show it;
    F [N m]; contact (-1, 0, +1).
    """
    t = np.arange(round(duration * rate) + 1) / rate
    p, base = pack(rig, effects), excitation.base
    if isinstance(base, Rest):  # z' = y': dry friction against the ground is friction in the joint
        p[kernel.TC], p[kernel.TG] = p[kernel.TC] + p[kernel.TG], 0.0
    delay, clock = effects.get("sensor_delay", {}).get("tau", 0.0), effects.get("clock_drift", {}).get("r", 0.0)
    late = np.maximum(t / (1.0 + clock) - delay, 0.0)
    times, where = np.unique(np.concatenate([t, late]), return_inverse=True)
    pieces = _pieces(base, times[-1]), _pieces(excitation.force, times[-1])
    states, contact = kernel.run(start_of(excitation), times, step, p, *pieces, _GRID)
    now, then = where[: len(t)], where[len(t) :]
    x, dx, _ = base.derivatives(t)
    y, v = states[now, 0], states[now, 1]
    gain = effects.get("sensor_gain", {}).get("g", 1.0)
    offset = effects.get("sensor_offset", {}).get("z_s", 0.0)
    shown = states[then, 8] if p[kernel.FILTER] else states[then, 0] - base.x(late)
    seen = gain * shown + offset
    force = excitation.force.x(t)
    return {"t": t, "x": x, "dx": dx, "y": y, "v": v, "z": y - x, "z_seen": seen, "F": force, "contact": contact[now]}


def _noisy(values, rng, sigma, quantisation):
    """Values with white noise of standard deviation sigma, then rounded to whole counts of `quantisation` if given."""
    values = values + sigma * rng.standard_normal(len(values))
    return values if quantisation is None else np.round(values / quantisation) * quantisation


def measure(truth, rng, sigma_x: float, sigma_z: float, quantisation: float | None = None) -> dict[str, np.ndarray]:
    """A base-motion or free-decay record t, x, z as measured: noise and then encoder counts on both channels [rad]."""
    x = _noisy(truth["x"], rng, sigma_x, quantisation)
    return {"t": truth["t"], "x": x, "z": _noisy(truth["z_seen"], rng, sigma_z, quantisation)}


def force_record(
    rig: Rig, effects, excitation: Excitation, rate: float, duration: float, rng, sigma_force: float, sigma_y: float,
    quantisation: float | None = None,
) -> dict[str, np.ndarray]:  # fmt: skip
    """A force-driven record t, F [N m], y [rad]: the base still, noise on both channels, encoder counts on y."""
    truth = simulate_truth(rig, effects, excitation, rate, duration)
    y = _noisy(truth["z_seen"], rng, sigma_y, quantisation)
    return {"t": truth["t"], "F": _noisy(truth["F"], rng, sigma_force, None), "y": y}


def answer(rig: Rig, effects, sigma: float) -> dict:
    """What a record's answer file holds: the effects' names, the joint's numbers (SI, total play), the noise of z."""
    return {"effects": sorted(effects), "truth": {**asdict(rig), "effects": effects}, "sigma": sigma}
