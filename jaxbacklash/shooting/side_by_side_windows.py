r"""The elimination of `jaxbacklash.shooting.block_tridiagonal`, with the windows in stretches that are worked on side by side.

The chain of windows is cut at `LANES` of them. Those between two cuts meet no others, so that all stretches are eliminated at
once, each from its first window to its last, a processor's vectors holding one number of many stretches; each window then also
meets the cut before its stretch. What is left is a chain of the cuts, eliminated one after the other. Twice the arithmetic,
and a third of the time where windows have few unknowns: a small matrix by itself leaves vectors empty.

Source: George, SIAM Journal on Numerical Analysis 10 (1973) 345, on elimination in this order (nested dissection).
"""

from __future__ import annotations

from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp

from .block_tridiagonal import Factor, factorise_with, promise, solve_upper

Array = Any
LANES = 16
"""Stretches side by side."""
MOST = 12
"""Unknowns of a window up to which this is the quicker way."""


class SideBySide(eqx.Module):
    """A system whose windows' unknowns are eliminated, as `jaxbacklash.shooting.block_tridiagonal.Eliminated`.

    ``rows`` (I, B, 3 B + q + 1, S) of the windows inside the S stretches, by place in the stretch: each window's upper factor,
    and the lower one's solution for the next window, the border with the gradient, and the cut before. ``cuts`` and
    ``halfway``: the factor of the chain of cuts and its lower solution; ``length`` of a stretch with its cut; ``used`` windows.
    """

    rows: Array
    cuts: Factor
    halfway: Array
    length: Array
    used: Array
    schur: Array
    score: Array
    gain: Array
    windows: int = eqx.field(static=True)

    def local(self, step: Array) -> Array:
        """The windows' own step (W, B) that goes with a step (q,) of the parameters."""
        with_slope = jnp.append(step, 1.0)
        at_cuts = solve_upper(self.cuts, -(self.halfway @ with_slope)[:, :, None])[:, :, 0].T  # (B, S)
        size, most = at_cuts.shape[0], self.rows.shape[0]
        before = jnp.concatenate([jnp.zeros_like(at_cuts[:, :1]), at_cuts[:, :-1]], axis=1)

        def window(k: Array, carry: tuple[Array, Array]) -> tuple[Array, Array]:
            following, found = carry
            i = self.length - 2 - k
            own, link, edge, fill = _parts(self.rows[i], size)
            right = -jnp.einsum("bes,e->bs", edge, with_slope)
            right = right - sum(link[:, c] * following[c] + fill[:, c] * before[c] for c in range(size))

            def back(j: Array, value: Array) -> Array:
                row = size - 1 - j
                return value.at[row].set((right[row] - jnp.sum(own[row] * value, axis=0)) / own[row, row])

            value = jax.lax.fori_loop(0, size, back, jnp.zeros_like(right))
            return value, found.at[i].set(value)

        empty = jnp.zeros((most, *at_cuts.shape)).at[self.length - 1].set(at_cuts)
        _, found = jax.lax.fori_loop(0, self.length - 1, window, (at_cuts, empty))
        number = jnp.arange(self.windows)
        local = found[number % self.length, :, number // self.length]
        return jnp.where((number < self.used)[:, None], local, 0.0)

    def promise(self, step: Array, information: Array) -> Array:
        """By how much both steps lower the cost, as its second-order expansion tells, with ``information`` (q, q) for S."""
        return promise(self, step, information)

    @property
    def log_determinant(self) -> Array:
        """Logarithm of the determinant of T."""
        own = jnp.diagonal(self.rows, axis1=1, axis2=2)  # (I, S, B), as many columns as rows there are
        inside = (jnp.arange(self.rows.shape[0]) < self.length - 1)[:, None, None]
        return self.cuts.log_determinant + 2.0 * jnp.sum(jnp.log(jnp.where(inside, own, 1.0)))


def eliminate(
    diagonal: Array, below: Array, border: Array, corner: Array, slope: Array, slope_theta: Array, used: Array | int
) -> SideBySide:
    """Eliminate the windows' unknowns; the arguments are those of `jaxbacklash.shooting.block_tridiagonal.eliminate`."""
    (windows, size), used = slope.shape, jnp.asarray(used)
    edges = corner.shape[0] + 1
    length = jnp.maximum(-(-used // LANES), 1)
    first = length * jnp.arange(LANES)
    eye = jnp.eye(size)[:, :, None]

    def take(array: Array, at: Array) -> Array:
        return jnp.moveaxis(jnp.take(array, at, axis=0, mode="clip"), 0, -1)

    def window(at: Array) -> tuple[Array, Array]:
        own = jnp.where(at < used, take(diagonal, at), eye)  # beyond the last window nothing is to be found
        edge = jnp.concatenate([take(border, at), take(slope, at)[:, None]], axis=1)
        return own, jnp.where(at < used, edge, 0.0)

    def pivot(j: Array, rows: Array) -> Array:
        row = rows[j] / jnp.sqrt(rows[j, j])
        later = jnp.where(jnp.arange(size)[:, None] > j, row[:size], 0.0)
        return (rows - later[:, None] * row[None]).at[j].set(row)

    def eliminated(i: Array, carry: Any) -> Any:
        kept, taken, taken_edge, fill, to_cut, products = carry
        own, edge = window(first + i)
        link = jnp.where(first + i + 1 < used, jnp.swapaxes(take(below, first + i), 0, 1), 0.0)
        rows = jnp.concatenate([own - taken, link, edge - taken_edge, fill], axis=1)
        rows = jax.lax.fori_loop(0, size, pivot, rows)
        _, link, edge, fill = _parts(rows, size)
        onward = _times(link, rows[:, size:])
        to_cut = to_cut + _times(fill, rows[:, 2 * size :])
        kept, products = kept.at[i].set(rows), products + _times(edge, edge)
        return kept, onward[:, :size], onward[:, size:-size], -onward[:, -size:], to_cut, products

    # What a window meets of the cut before its stretch.
    fill = jnp.where((first > 0) & (first < used), take(below, first - 1), 0.0)
    zeros = lambda *shape: jnp.zeros((*shape, LANES))  # noqa: E731
    begin = (
        zeros(-(-windows // LANES), size, 3 * size + edges), zeros(size, size), zeros(size, edges), fill,
        zeros(size, edges + size), zeros(edges, edges),
    )  # fmt: skip
    rows, taken, taken_edge, fill, to_cut, products = jax.lax.fori_loop(0, length - 1, eliminated, begin)

    own, edge = window(first + length - 1)
    ahead = lambda a: jnp.concatenate([a[..., 1:], jnp.zeros_like(a[..., :1])], axis=-1)  # noqa: E731
    to_cut = ahead(to_cut)
    lead = lambda a: jnp.moveaxis(a, -1, 0)  # noqa: E731
    edge = edge - taken_edge - to_cut[:, :edges]
    factor, halfway = factorise_with(lead(own - taken - to_cut[:, edges:]), lead(ahead(fill)), lead(edge), LANES)
    both = jnp.sum(products, axis=-1) + jnp.einsum("wbi,wbj->ij", halfway, halfway)
    score = both[:-1, -1] - slope_theta
    return SideBySide(rows, factor, halfway, length, used, corner - both[:-1, :-1], score, 0.5 * both[-1, -1], windows)


def _parts(rows: Array, size: int) -> tuple[Array, Array, Array, Array]:
    """The parts (B, ., S) of the rows of windows, as `SideBySide` has them."""
    return rows[:, :size], rows[:, size : 2 * size], rows[:, 2 * size : -size], rows[:, -size:]


def _times(left: Array, right: Array) -> Array:
    """The product of the transpose of ``left`` (B, I, S) and ``right`` (B, J, S), (I, J, S): written out, it fills vectors."""
    return sum(left[b][:, None] * right[b][None] for b in range(left.shape[0]))
