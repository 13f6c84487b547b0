"""Independent parts of one computation, shared out over the cores."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from .program import cores

Part = TypeVar("Part")
Result = TypeVar("Result")


def side_by_side(work: Callable[[Part], Result], parts: Iterable[Part]) -> list[Result]:
    """What ``work`` makes of each part, in order.

    Threads suffice: searching neighbours, sorting and multiplying matrices leave Python free. Whatever is random is drawn
    before, so that the result does not depend on who comes first.
    """
    with ThreadPoolExecutor(cores()) as pool:
        return list(pool.map(work, parts))
