"""What the report's tests draw: a made-up record, a result of `refine` with nulls and odd text, every figure once."""

import numpy as np

from jaxbacklash.plot import joints, models, times
from jaxbacklash.plot.drawing import on_page

HOSTILE = "</script><script>alert('x')</script><img src=x onerror=alert(1)>&\".csv"
NOISE, RATE, WINDOW = 3e-5, 500.0, 0.2
EDGES = (-0.01309, 0.01309)


def motion(seconds=6.0, miss=4e-4):
    """A record, a model that misses its first half, and windows, as a fit hands them over."""
    t = np.arange(0.0, seconds, 1.0 / RATE)
    model = 0.03 * np.sin(2 * np.pi * (1.0 + 0.1 * t) * t)
    measured = model + miss * np.sin(40.0 * t) * (t < seconds / 2)
    measured = measured + NOISE * np.random.default_rng(3).normal(size=t.size)
    starts = np.arange(0.0, seconds, WINDOW)
    residual = (measured - model) / NOISE
    rms = np.array([np.sqrt(np.mean(residual[(t >= s) & (t < s + WINDOW)] ** 2)) for s in starts])
    return t, measured, model, starts, residual, rms


def parameter(value, stderr, unit, **more):
    ends = None if value is None else [value - 1.96 * stderr, value + 1.96 * stderr]
    return {"value": value, "stderr": stderr, "ci95": ends, "unit": unit, **more}


def stages():
    """Two stages of a refinement, the second with something that could not be found."""
    first = {
        "backlash": parameter(0.0258, 8.8e-6, "rad", verdict="found"),
        "stiffness": parameter(13003.8, 2.3, "N m/rad"),
        "damping": parameter(12.116, 0.019, "N m s/rad"),
    }
    second = first | {
        "backlash": parameter(0.02618, 1.1e-5, "rad"),
        "gravity.G": parameter(-45.21, 0.12, "N m"),
        "gap_spring.k1": parameter(None, None, "N m/rad", verdict="not determined", why="z stays inside <the> play"),
    }
    ranking = [
        {"name": "gravity", "predicted_rms_over_noise": 1.02, "evidence": 812.0},
        {"name": "dahl", "predicted_rms_over_noise": None, "evidence": None, "why": "costs $3 & more"},
    ]
    return [
        {
            "added": None,
            "effects": [],
            "rms_over_noise": 12.9,
            "nrmse": 0.021,
            "heldout_rms_over_noise": 13.4,
            "heldout_nrmse": 0.0225,
            "median_over_noise": 11.8,
            "heldout_median_over_noise": 12.0,
            "parameters": first,
            "candidates": ranking,
        },
        {
            "added": "gravity",
            "effects": ["gravity"],
            "rms_over_noise": 1.01,
            "nrmse": 0.0016,
            "heldout_rms_over_noise": None,
            "heldout_nrmse": None,
            "median_over_noise": 0.99,
            "heldout_median_over_noise": None,
            "parameters": second,
            "candidates": [],
        },
    ]


def result(path="bench/arm.csv"):
    return {
        "schema": 1,
        "command": "refine",
        "command_line": "jaxbacklash refine bench/arm.csv --inertia 3.16",
        "version": "0.1.0",
        "record": {"path": path, "samples": 3000, "rate_hz": 500.0, "channels": ["t", "x", "z"]},
        "noise": {"z": NOISE},
        "stages": stages(),
        "effects": ["gravity"],
        "alternatives": [["preload", "asymmetric_gap"]],
        "alternatives_text": "This record cannot tell gravity from: preload + asymmetric_gap; the intervals allow for either.",
        "verdict": "complete",
        "verdict_text": "Gravity was missing; with it, noise alone is left.",
        "cross_check": {
            "hilbert": {"backlash": 0.0259},
            "wavelet": {"backlash": {"value": None, "why": "too short"}},
            "agrees": True,
        },
    }


def all_figures():
    t, measured, model, starts, residual, rms = motion()
    z = measured
    dz = np.gradient(model, t)
    law = np.linspace(-0.03, 0.03, 101)
    dead = 13000.0 * (law - np.clip(law, *EDGES))
    torque = 13000.0 * (z - np.clip(z, *EDGES)) + np.random.default_rng(4).normal(size=z.size)
    kept = {"window_starts": starts, "label": "z", "unit": "rad"}
    return {
        "model": on_page(times.measured_against_model, t, measured, model, noise=NOISE, **kept),
        "residual": on_page(times.residual_in_time, t, residual, window_edges=starts, window_rms=rms),
        "phase": on_page(joints.phase_plane, z, dz, edges=EDGES, model_z=model, model_dz=dz),
        "force": on_page(joints.restoring_force, z, torque, model_z=law, model_torque=dead, edges=EDGES, unit="N m"),
        "stages": on_page(models.error_by_stage, stages()),
        "ranking": on_page(models.candidate_ranking, stages()[0]["candidates"], current=12.9),
        "loop": on_page(joints.force_loop, z, torque, torque, level=10.0, unit="N m", length_unit="rad"),
    }


def numbers(node):
    """All floats of a result, however deep."""
    if isinstance(node, dict):
        for value in node.values():
            yield from numbers(value)
    elif isinstance(node, list):
        for value in node:
            yield from numbers(value)
    elif isinstance(node, float):
        yield node
