"""Which devices share a computation that is dealt out, and which one is left for all else.

A CPU device runs so many computations at a time and no more. Those that other threads have begun wait for a shared computation
that was launched before them, and if they take up all that the device may run, its part of that never begins: a deadlock that
nothing ends. So what is dealt out keeps off the device on which everything else is computed.
"""

from __future__ import annotations

from typing import Any


def sharing() -> list[Any]:
    """The devices among which a computation is dealt out: of several CPU devices all but the first, which is the default."""
    import jax

    found = jax.devices()
    return found[1:] if len(found) > 1 and found[0].platform == "cpu" else found
