r"""The complex Morlet wavelet (paper, 2.5 and 2.6) in bounded memory, and its atoms along a ridge.

:math:`\psi(t) = (\pi f_b)^{-1/2} e^{2\pi j f_c t} e^{-t^2/f_b}`; the paper prints :math:`\sqrt{\pi f_b}`, which does not
normalise it. With the factor 1/s instead of :math:`1/\sqrt{s}` in (2.5) the modulus on the ridge is half the amplitude at
every scale; a factor of two is put in, so that here it *is* the amplitude.

Why not a kept library: PyWavelets' cwt looks the wavelet up in a table of its integral and holds all scales of the whole
record at once; both show in ``benchmarks/skeleton_peers.py``. What is needed beyond one FFT convolution a frequency is
little: blocks that overlap, and output at fewer times than samples.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .fourier import fast_length

REACH = 4.5
"""Standard deviations of the Gaussian at which an atom is cut off: 4e-5 of its peak."""
CONE = 3.5
"""Cone of influence: an atom whose centre lies closer to an end than so many standard deviations is masked."""
PER_CYCLE = 32
"""Samples a cycle, at least, that an atom sees: of a faster record it sees means over 2, 4, 8, ... samples."""


@dataclass(frozen=True)
class Morlet:
    """The mother wavelet: bandwidth ``f_b`` and centre frequency ``f_c``, in units of the period at scale 1."""

    f_b: float = 1.5
    f_c: float = 1.0

    def width(self, frequency: np.ndarray | float) -> np.ndarray:
        """Standard deviation of the Gaussian [s] at a frequency [Hz]."""
        return self.f_c * np.sqrt(0.5 * self.f_b) / np.asarray(frequency, float)


@dataclass(frozen=True)
class Scalogram:
    """``values`` complex (F, M): amplitude and phase at ``frequencies`` (F,) [Hz] and times ``t`` (M,) [s]."""

    t: np.ndarray
    frequencies: np.ndarray
    values: np.ndarray
    wavelet: Morlet


def frequency_grid(low: float, high: float, voices: int = 16) -> np.ndarray:
    """Frequencies [Hz] with so many a factor of two, from low to high, both reached or passed."""
    steps = int(np.ceil(voices * np.log2(high / low)))
    return low * 2.0 ** (np.arange(steps + 1) / voices)


def scalogram(
    t: np.ndarray,
    values: np.ndarray,
    frequencies: np.ndarray,
    *,
    wavelet: Morlet | None = None,
    columns: int = 1500,
    block: int = 1 << 17,
) -> Scalogram:
    """Morlet transform at given frequencies and at most ``columns`` times.

    Blocks of about ``block`` samples overlap by the longest atom (overlap-save), so memory is a few blocks and the output,
    whatever the length of the record.

    Parameters
    ----------
    t, values : uniform samples, shape (N,)
    frequencies : [Hz], shape (F,), ascending
    """
    wavelet = wavelet or Morlet()
    dt = (t[-1] - t[0]) / (t.size - 1)
    stride = max(1, -(-t.size // columns))
    reach = -(-int(np.ceil(REACH * float(wavelet.width(frequencies[0])) / dt)) // stride) * stride
    step = max(stride, max(block - 2 * reach, block // 4, reach) // stride * stride)
    out = np.zeros((frequencies.size, -(-t.size // stride)), complex)
    for begin in range(0, t.size, step):
        length = min(step, t.size - begin)
        low, high = begin - reach, begin + length + reach
        piece = np.pad(values[max(low, 0) : min(high, t.size)], (max(-low, 0), max(high - t.size, 0)))
        few = fast_length(-(-piece.size // stride))
        spectrum = np.fft.fft(piece, few * stride)
        spacing = 2.0 * np.pi / (few * stride * dt)
        shown = slice(reach // stride, reach // stride + -(-length // stride))
        for row, frequency in enumerate(frequencies):
            width, omega = float(wavelet.width(frequency)), 2.0 * np.pi * frequency
            first = max(int((omega - 6.0 / width) / spacing), 0)
            last = min(int((omega + 6.0 / width) / spacing) + 1, few * stride)
            band = np.arange(first, last)
            gained = spectrum[first:last] * np.exp(-0.5 * (width * (spacing * band - omega)) ** 2)
            # Every stride-th sample of a signal has the spectrum folded so many times: the transform back is as short.
            folded = np.zeros(-(-gained.size // few) * few, complex)
            folded[: gained.size] = gained
            folded = np.roll(folded.reshape(-1, few).sum(axis=0), first % few)
            out[row, begin // stride : begin // stride + shown.stop - shown.start] = (2.0 / stride) * np.fft.ifft(folded)[shown]
    return Scalogram(t[::stride], frequencies, out, wavelet)


class Atoms:
    r"""Morlet atoms with given centres and frequencies: linear maps from samples to complex amplitudes.

    ``of(u, n)`` is :math:`\langle u^{(n)}, \psi_k \rangle`, with the derivatives carried by the atom (integration by parts):
    no sample is ever differenced, and a linear equation of motion holds between these numbers exactly, however fast
    amplitude and frequency change. An atom that is slow against the sample rate sees means over so many samples that
    `PER_CYCLE` of them or a few more make a cycle; a mean is linear, too, so the equation still holds between the amplitudes.
    An atom then costs the same memory at any frequency, at any sample rate and in a record of any length.

    Parameters
    ----------
    t : uniform sample times [s], shape (N,)
    centres, frequencies : of the atoms [s], [Hz], shape (M,)
    """

    def __init__(self, t: np.ndarray, centres: np.ndarray, frequencies: np.ndarray, wavelet: Morlet) -> None:
        dt = (t[-1] - t[0]) / (t.size - 1)
        widths = wavelet.width(frequencies)
        self.complete = np.minimum(centres - t[0], t[-1] - centres) > CONE * widths
        halvings = np.floor(np.log2(1.0 / (PER_CYCLE * dt * frequencies)))
        levels = np.clip(halvings, 0, int(np.log2(t.size)) - 3).astype(int)
        self._points = centres.size
        self._levels: list[tuple[int, np.ndarray, _Rows]] = []
        for level in np.unique(levels):
            rows, count = np.flatnonzero(levels == level), t.size >> level
            first, spacing = t[0] + 0.5 * dt * ((1 << level) - 1), dt * (1 << level)
            # A mean over a stretch lowers a sine; the atom makes up for it, so that amplitudes do not depend on the level.
            gain = np.sinc(frequencies[rows] * dt) / np.sinc(frequencies[rows] * spacing)
            orders = _atoms(first, spacing, count, centres[rows], frequencies[rows], widths[rows], gain)
            self._levels.append((int(level), rows, orders))

    def of(self, values: np.ndarray, order: int = 0) -> np.ndarray:
        """Complex amplitudes (M,) of the signal (N,) or of its first or second derivative."""
        out, at = np.zeros(self._points, complex), 0
        for level, rows, orders in self._levels:
            for _ in range(level - at):
                values = 0.5 * (values[: values.size // 2 * 2 : 2] + values[1::2])
            at = level
            out[rows] = orders.of(values, order)
        return out


def _atoms(
    t0: float,
    dt: float,
    count: int,
    centres: np.ndarray,
    frequencies: np.ndarray,
    widths: np.ndarray,
    gain: np.ndarray,
) -> _Rows:
    """What makes amplitudes of means over dt of a signal, of its first and of its second derivative."""
    first = np.clip(np.ceil((centres - REACH * widths - t0) / dt).astype(int), 0, count - 1)
    last = np.clip(np.floor((centres + REACH * widths - t0) / dt).astype(int), 0, count - 1)
    sizes = last - first + 1
    ends = np.cumsum(sizes)
    row = np.repeat(np.arange(centres.size), sizes)
    column = np.arange(ends[-1]) - np.repeat(ends - sizes - first, sizes)
    s, w = widths[row], 2.0 * np.pi * frequencies[row]
    tau = t0 + dt * column - centres[row]
    values = np.exp(-0.5 * (tau / s) ** 2 - 1j * w * tau)
    values *= 2.0 * dt * gain[row] / (s * np.sqrt(2.0 * np.pi))
    slope = tau / s**2 + 1j * w
    return _Rows(column, ends - sizes, (values, values * slope, values * (slope**2 - 1.0 / s**2)))


@dataclass(frozen=True)
class _Rows:
    """Rows of weights on samples next to one another: ``column`` the sample of each weight, ``begins`` where the weights of a row
    begin, ``orders`` the weights for a signal, its first and its second derivative."""

    column: np.ndarray
    begins: np.ndarray
    orders: tuple[np.ndarray, ...]

    def of(self, values: np.ndarray, order: int) -> np.ndarray:
        """Sum of weights times samples of each row, (M,)."""
        return np.add.reduceat(self.orders[order] * values[self.column], self.begins)
