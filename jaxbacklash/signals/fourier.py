"""Lengths of discrete Fourier transforms, of which the analytic signal and the scalogram take many."""

from __future__ import annotations

FACTORS = (2, 3, 5, 7)


def fast_length(least: int) -> int:
    """The smallest number from ``least`` on that has no prime factor above seven, whose transform is quick.

    Examples
    --------
    >>> fast_length(1009)
    1024
    """
    return next(n for n in range(least, 2 * least + 1) if _rest(n) == 1)


def _rest(number: int) -> int:
    """What is left of a number without its small prime factors."""
    for factor in FACTORS:
        while number % factor == 0:
            number //= factor
    return number
