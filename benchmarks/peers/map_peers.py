"""The map by other means: the C program, numba, diffrax step by step, and scipy with events on a sample of cells."""

from __future__ import annotations

import ctypes
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

Array = Any
OMEGA = 0.2


def c_program() -> Callable[..., tuple[np.ndarray, np.ndarray]]:
    """Compile and load `rk4_map.c`; the function takes 1/alpha, zeta, the starts (2, N), periods, skip and
    steps a period."""
    folder = Path(tempfile.mkdtemp())
    source, library = Path(__file__).with_name("rk4_map.c"), folder / "rk4_map.so"
    flags = ["-O3", "-march=native", "-mprefer-vector-width=512", "-ffast-math", "-fopenmp", "-shared", "-fPIC"]
    subprocess.run(["gcc", *flags, str(source), "-o", str(library), "-lm"], check=True)
    routine = ctypes.CDLL(str(library)).rk4_map
    pointer = np.ctypeslib.ndpointer(dtype=np.float64, flags="C_CONTIGUOUS")
    long = ctypes.c_long
    routine.argtypes = [long, pointer, pointer, pointer, pointer, ctypes.c_double, long, long, long, pointer, pointer]
    routine.restype = None

    def run(
        inverse_alpha: Array, zeta: Array, start: Array, periods: int, skip: int, steps: int
    ) -> tuple[np.ndarray, np.ndarray]:
        found, last = np.empty(len(zeta)), np.empty(len(zeta))
        routine(len(zeta), inverse_alpha, zeta, *start, OMEGA, periods, skip, steps, found, last)
        return found, last

    return run


def numba_program() -> Callable[..., np.ndarray]:
    """The same Runge-Kutta in numba, cells spread over threads."""
    import numba

    @numba.njit(fastmath=True, parallel=True)
    def run(inverse_alpha: Array, zeta: Array, periods: int, skip: int, steps: int) -> Array:
        found = np.empty(zeta.size)
        h = 2.0 * np.pi / OMEGA / steps
        cosine = np.cos(np.pi * np.arange(2 * steps + 1) / steps)
        for cell in numba.prange(zeta.size):
            p, v, a, b, total = 0.0, 0.0, 1.0, 0.0, 0.0
            g, alpha = 2.0 * zeta[cell], 1.0 / inverse_alpha[cell]
            for k in range(periods):
                for s in range(steps):
                    f0, f1, f2 = alpha * cosine[2 * s], alpha * cosine[2 * s + 1], alpha * cosine[2 * s + 2]
                    k1, l1 = f0 - g * v - (p - min(1.0, max(-1.0, p))), -g * b - (a if abs(p) > 1.0 else 0.0)
                    q, w, x, y = p + 0.5 * h * v, v + 0.5 * h * k1, a + 0.5 * h * b, b + 0.5 * h * l1
                    k2, l2 = f1 - g * w - (q - min(1.0, max(-1.0, q))), -g * y - (x if abs(q) > 1.0 else 0.0)
                    w2, y2 = w, y
                    q, w, x, y = p + 0.5 * h * w, v + 0.5 * h * k2, a + 0.5 * h * y, b + 0.5 * h * l2
                    k3, l3 = f1 - g * w - (q - min(1.0, max(-1.0, q))), -g * y - (x if abs(q) > 1.0 else 0.0)
                    w3, y3 = w, y
                    q, w, x, y = p + h * w, v + h * k3, a + h * y, b + h * l3
                    k4, l4 = f2 - g * w - (q - min(1.0, max(-1.0, q))), -g * y - (x if abs(q) > 1.0 else 0.0)
                    p, a = p + h / 6.0 * (v + 2.0 * (w2 + w3) + w), a + h / 6.0 * (b + 2.0 * (y2 + y3) + y)
                    v, b = v + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4), b + h / 6.0 * (l1 + 2.0 * (l2 + l3) + l4)
                size = np.sqrt(a * a + b * b)
                if k >= skip:
                    total += np.log(size)
                a, b = a / size, b / size
            found[cell] = total / ((periods - skip) * 2.0 * np.pi / OMEGA)
        return found

    return run


def diffrax_program() -> Callable[..., np.ndarray]:
    """Plain diffrax: Tsit5 with one solver step per step, all cells as lanes of one solve, the tangent as part of the state."""
    import diffrax
    import jax
    import jax.numpy as jnp

    def field(t: Any, y: Any, args: Any) -> Any:
        (p, v, a, b), (g, alpha) = y, args
        push = jnp.where(jnp.abs(p) > 1.0, a, 0.0)
        return v, alpha * jnp.cos(OMEGA * t) - g * v - (p - jnp.clip(p, -1.0, 1.0)), b, -g * b - push

    def run(inverse_alpha: Any, zeta: Any, periods: int, skip: int, steps: int) -> Any:
        length, args = 2.0 * jnp.pi / OMEGA, (2.0 * zeta, 1.0 / inverse_alpha)

        def one(carry: Any, k: Any) -> Any:
            y, total = carry
            done = diffrax.diffeqsolve(
                diffrax.ODETerm(field), diffrax.Tsit5(), k * length, (k + 1) * length, length / steps, y, args,
                saveat=diffrax.SaveAt(t1=True), max_steps=steps + 2, adjoint=diffrax.ForwardMode(),
                stepsize_controller=diffrax.ConstantStepSize(),
            )  # fmt: skip
            p, v, a, b = (part[0] for part in done.ys)
            size = jnp.sqrt(a * a + b * b)
            return ((p, v, a / size, b / size), total + jnp.where(k >= skip, jnp.log(size), 0.0)), None

        zero = jnp.zeros_like(zeta)
        (_, total), _ = jax.lax.scan(one, ((zero, zero, zero + 1.0, zero), zero), jnp.arange(float(periods)))
        return total / ((periods - skip) * length)

    return jax.jit(run, static_argnames=("periods", "skip", "steps"))
