"""Quantiles of the chi-square distribution: how large a sum of squares of noise may be."""

from __future__ import annotations

from statistics import NormalDist

MANY = 16.0
"""Degrees of freedom from which on the expansion stands in for the exact numbers."""


def chi_square(freedom: float, beyond: float) -> float:
    """What a chi-square number of ``freedom`` degrees of freedom exceeds with the probability ``beyond``.

    From `MANY` degrees of freedom on by the expansion of Cornish and Fisher (Goldberg and Levine, Ann. Math. Stat.
    17, 1946), exact to 1e-4 from 16 and to 5e-6 from 50: `scipy.special`, which knows all of it, takes a tenth of a second to
    import, and nothing else that a fit needs loads it.

    Examples
    --------
    >>> round(chi_square(50.0, 0.5), 4)
    49.3349
    """
    if freedom < MANY:
        from scipy.special import chdtri

        return float(chdtri(freedom, beyond))
    z, root = NormalDist().inv_cdf(1.0 - beyond), (2.0 * freedom) ** 0.5
    terms = (
        root * z,
        2.0 / 3.0 * (z**2 - 1.0),
        (z**3 - 7.0 * z) / (9.0 * root),
        -(6.0 * z**4 + 14.0 * z**2 - 32.0) / (405.0 * freedom),
        (9.0 * z**5 + 256.0 * z**3 - 433.0 * z) / (4860.0 * freedom * root),
    )
    return freedom + sum(terms)
