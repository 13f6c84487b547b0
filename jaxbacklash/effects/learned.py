"""A torque learned from a record: a table over one or two coordinates. A stopgap for physics that has no name yet."""

from __future__ import annotations

from itertools import pairwise
from typing import Any, ClassVar

import equinox as eqx
import jax.numpy as jnp

from ..mechanics import AbstractEffect, Instant
from ..parameters import Scalar

COORDINATES = ("z", "dz", "y", "dy", "t", "deflection", "side")
"""What a learned torque may depend on; ``side`` is -1, 0, 1 for contact below, play, contact above."""
UNITS = {"t": "s", "dz": "rad/s", "dy": "rad/s", "dx": "rad/s", "side": "1"}


def coordinate(name: str, now: Any) -> Any:
    """One of `COORDINATES` at a moment, or at many (anything with the attributes of `Instant`)."""
    if name == "side":
        return now.contact * jnp.sign(now.deflection)
    return getattr(now, name)


def hats(u: Any, knots: Any) -> Any:
    """Piecewise linear basis on ``knots`` (K,), ascending: (..., K) for ``u`` (...), constant beyond the first and last."""
    k = jnp.asarray(knots)
    inside = jnp.clip(jnp.asarray(u)[..., None], k[0], k[-1])
    width = jnp.diff(k)
    rising = (inside - k[:-1]) / width
    up = jnp.concatenate([jnp.ones_like(inside), rising], axis=-1)
    down = jnp.concatenate([1.0 - rising, jnp.ones_like(inside)], axis=-1)
    return jnp.clip(jnp.minimum(up, down), 0.0, 1.0)


def basis(coordinates: tuple[str, ...], knots: tuple[tuple[float, ...], ...], now: Any) -> Any:
    """The table's basis at a moment (or many): products of `hats`, the last coordinate running fastest."""
    return basis_at(tuple(coordinate(name, now) for name in coordinates), knots)


def basis_at(values: tuple[Any, ...], knots: tuple[Any, ...]) -> Any:
    """`basis` at values of its coordinates, each with its row of knots."""
    weights = hats(values[0], knots[0])
    for value, row in zip(values[1:], knots[1:]):
        more = hats(value, row)
        weights = (weights[..., :, None] * more[..., None, :]).reshape(*more.shape[:-1], -1)
    return weights


class LearnedTorque(AbstractEffect):
    r"""A torque read from a table, :math:`T = \sum_i \beta_i B_i(u)` with piecewise linear :math:`B_i`.

    ``coordinates`` names one or two of `COORDINATES`; ``knots`` a row of ascending knots for each; ``table`` the values at the
    knots [N m], the last coordinate running fastest. Its numbers are data, not parameters: a fit leaves them alone. It is
    no physics, is reported apart from it, and takes no part in the search for missing effects.
    """

    coordinates: tuple[str, ...] = eqx.field(default=("y",), static=True)
    knots: tuple[tuple[float, ...], ...] = eqx.field(default=((-1.0, 1.0),), static=True)
    table: tuple[float, ...] = eqx.field(default=(0.0, 0.0), static=True)
    port: ClassVar[str] = "ground"
    catalogued: ClassVar[bool] = False

    def __check_init__(self) -> None:
        size = 1
        for row in self.knots:
            size *= len(row)
            if len(row) < 2 or any(b <= a for a, b in pairwise(row)):
                raise ValueError("knots must be rows of two or more ascending numbers")
        if not 1 <= len(self.coordinates) == len(self.knots) <= 2 or not set(self.coordinates) <= set(COORDINATES):
            raise ValueError(f"coordinates must be one or two of {', '.join(COORDINATES)}, with a row of knots each")
        if len(self.table) != size:
            raise ValueError(f"the table has {len(self.table)} values, its knots want {size}")

    def torque(self, now: Instant) -> Scalar:
        return basis(self.coordinates, self.knots, now) @ jnp.asarray(self.table)
