"""Windows in chunks: as many as the record fills, shared among the processor's cores.

A program is compiled for a number of windows that hardly ever changes; how many of them hold data is a number it is told.
A chunk's intermediate arrays stay in the processor's cache, and where JAX sees several CPU devices (see
`jaxbacklash.start`) each takes every other chunk.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.flatten_util import ravel_pytree
from jax.sharding import Mesh, PartitionSpec

from ..sharing import sharing

Array = Any
CHUNK = 32
"""Windows that are worked on side by side."""


def by_chunks(work: Callable[[Any, Any], Any], shared: Any, lead: Any, used: Array) -> Any:
    """``work(shared, lead)`` where only the first ``used`` windows hold data.

    Parameters
    ----------
    work : maps ``shared`` and arrays with some windows on their leading axis to arrays with the same leading axis
    shared : what all windows have in common
    lead : arrays with all W windows on the leading axis
    used : number of windows that hold data; chunks without any are zero in the result
    """
    count = jax.tree.leaves(lead)[0].shape[0]
    if count % CHUNK:
        return work(shared, lead)
    cores = len(sharing())
    if count % (CHUNK * cores):
        cores = 1
    arrays, rest = eqx.partition(shared, eqx.is_array)
    turns = count // (CHUNK * cores)
    dealt = jax.tree.map(lambda a: jnp.swapaxes(a.reshape(turns, cores, CHUNK, *a.shape[1:]), 0, 1), lead)

    # Compiled within, so that it is traced once: for the shapes and for the loop.
    one = jax.jit(lambda arrays, part: work(eqx.combine(arrays, rest), part))

    def run(core: Array, arrays: Any, own: Any, used: Array) -> Any:
        shapes = jax.eval_shape(one, arrays, jax.tree.map(lambda a: a[0], own))
        empty = jax.tree.map(lambda s: jnp.zeros((turns, *s.shape), s.dtype), shapes)

        def turn(k: Array, found: Any) -> Any:
            put = lambda f, new: jax.lax.dynamic_update_index_in_dim(f, new, k, 0)  # noqa: E731
            return jax.tree.map(put, found, one(arrays, jax.tree.map(lambda a: a[k], own)))

        todo = jnp.clip(-(-(-(-used // CHUNK) - core) // cores), 0, turns)
        return jax.lax.fori_loop(jnp.asarray(0, jnp.int32), todo.astype(jnp.int32), turn, empty)

    if cores == 1:
        found = run(jnp.asarray(0, jnp.int32), arrays, jax.tree.map(lambda a: a[0], dealt), used)
        return jax.tree.map(lambda a: a.reshape(count, *a.shape[2:]), found)

    shapes: Any = None

    def on_core(arrays: Any, own: Any, used: Array) -> Any:
        nonlocal shapes
        found = run(jax.lax.axis_index("cores"), arrays, jax.tree.map(lambda a: a[0], own), used)
        shapes = jax.tree.map(lambda f: jax.ShapeDtypeStruct(f.shape[1:], f.dtype), found)
        # One array, so that the cores wait for one another once.
        return jax.lax.all_gather(jax.vmap(lambda f: ravel_pytree(f)[0])(found), "cores", axis=1)

    everywhere, split = PartitionSpec(), PartitionSpec("cores")
    mesh = Mesh(np.asarray(sharing()), ("cores",))
    spread = jax.shard_map(on_core, mesh=mesh, in_specs=(everywhere, split, everywhere), out_specs=everywhere, check_vma=False)
    gathered = spread(arrays, dealt, used)
    # Tracing the call has told the shapes; asking for them beforehand would trace the work a second time.
    _, unravel = ravel_pytree(jax.tree.map(lambda s: jnp.zeros(s.shape, s.dtype), shapes))
    found = jax.vmap(jax.vmap(unravel))(gathered)
    return jax.tree.map(lambda a: a.reshape(count, *a.shape[3:]), found)


def scan_used(step: Callable[[Any, Any], tuple[Any, Any]], first: Any, along: Any, used: Array, reverse: bool = False) -> Any:
    """The stacked outputs of a `jax.lax.scan` over the first ``used`` entries, zero beyond; ``reverse`` begins with the last."""
    take = lambda k: jax.tree.map(lambda a: jax.lax.dynamic_index_in_dim(a, k, 0, keepdims=False), along)  # noqa: E731
    length = jax.tree.leaves(along)[0].shape[0]
    shapes = jax.eval_shape(lambda: step(first, take(0))[1])
    empty = jax.tree.map(lambda s: jnp.zeros((length, *s.shape), s.dtype), shapes)

    def turn(k: Array, carry: Any) -> Any:
        state, found = carry
        at = used - 1 - k if reverse else k
        state, out = step(state, take(at))
        return state, jax.tree.map(lambda f, o: jax.lax.dynamic_update_index_in_dim(f, o, at, 0), found, out)

    return jax.lax.fori_loop(0, used, turn, (first, empty))[1]
