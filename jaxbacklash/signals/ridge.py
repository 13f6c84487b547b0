r"""The ridge of a scalogram: one continuous path, finer than the grid (paper, 2.7).

The largest modulus of each column jumps to a harmonic, to noise or to a neighbour as it pleases. Here the path as a whole
maximises :math:`\sum_m \log |W(f_m, t_m)|^2 - \lambda \sum_m (\Delta_m)^2`, :math:`\Delta` in bins of the grid, by dynamic
programming; a parabola through the three bins around it, exact for a Gaussian, then finds the place between bins.
"""

from __future__ import annotations

import numpy as np

from .morlet import Scalogram


def ridge(scalogram: Scalogram, *, penalty: float = 0.5, reach: int = 3, cone: bool = True) -> np.ndarray:
    """Frequency of the ridge [Hz] at the scalogram's times, shape (M,).

    Parameters
    ----------
    penalty : cost of a step of one bin, in units of the logarithm of energy
    reach : bins that the ridge may move from one column to the next
    cone : shun places where the atom sticks out of the record by more than half of itself
    """
    energy = np.abs(scalogram.values) ** 2
    level = np.log(energy + 1e-12 * float(energy.max() or 1.0))
    if cone:
        inside = np.minimum(scalogram.t - scalogram.t[0], scalogram.t[-1] - scalogram.t)
        width = scalogram.wavelet.width(scalogram.frequencies)
        level = level - 4.0 * np.maximum(width[:, None] - inside[None, :], 0.0) / width[:, None]
    bins, columns = level.shape
    steps = np.arange(-reach, reach + 1)
    cost = penalty * steps**2
    padded, came, every = np.full(bins + 2 * reach, -np.inf), np.zeros((columns, bins), np.int8), np.arange(bins)
    best = padded[reach : reach + bins]
    best[:] = level[:, 0]
    choices = np.lib.stride_tricks.sliding_window_view(padded, bins)
    for column in range(1, columns):
        scores = choices - cost[:, None]
        pick = np.argmax(scores, axis=0)
        came[column] = steps[pick]
        best[:] = scores[pick, every] + level[:, column]
    path = np.empty(columns, int)
    path[-1] = int(np.argmax(best))
    for column in range(columns - 1, 0, -1):
        path[column - 1] = path[column] + came[column, path[column]]
    return _between(np.log(energy + 1e-300), path, scalogram.frequencies)


def _between(level: np.ndarray, path: np.ndarray, frequencies: np.ndarray) -> np.ndarray:
    """The top of the parabola through the path's bin and its two neighbours, at most half a bin away.

    At equal relative width a Gaussian is a parabola over the frequency itself; over the geometric grid it is one to the
    second order of a bin.
    """
    middle = np.clip(path, 1, level.shape[0] - 2)
    at = np.arange(path.size)
    below, here, above = (level[middle + shift, at] for shift in (-1, 0, 1))
    bend = below - 2.0 * here + above
    shift = np.where(bend < 0.0, 0.5 * (below - above) / np.where(bend < 0.0, bend, -1.0), 0.0)
    place = np.clip(middle + np.clip(shift, -0.5, 0.5), 0, level.shape[0] - 1)
    return np.exp(np.interp(place, np.arange(frequencies.size), np.log(frequencies)))
