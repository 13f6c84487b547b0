"""Chunks of many records handed to the workers of a dask.distributed cluster."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from ..errors import BadInput
from .chunk import Item, begin, rows_of
from .rows import Row
from .wanted import Wanted

RETRIES = 2
"""How often a chunk is given to another worker where one has died."""


def connected(address: str) -> Any:
    """A client of the cluster at this address, as ``tcp://host:8786``.

    Raises
    ------
    BadInput
        dask is not installed, or nobody answers there.
    """
    from ..frames import needed

    distributed = needed("distributed", "--cluster", "sweep")
    try:
        return distributed.Client(address, timeout=10)
    except (OSError, ValueError, TimeoutError) as error:
        raise BadInput(
            f"--cluster {address}: no scheduler answers there ({type(error).__name__}), wanted the address that dask-scheduler "
            "prints, as tcp://host:8786"
        ) from None


def by_cluster(wanted: Wanted, chunks: Sequence[Sequence[Item]], client: Any) -> Iterator[tuple[int, Row]]:
    """The rows of all records, chunk by chunk in the order in which they are done; what a worker that dies was doing is given
    to another one."""
    from dask.distributed import as_completed

    # Under a name of its own, never answered from an earlier result.
    futures = [client.submit(_on_worker, wanted, list(chunk), pure=False, retries=RETRIES) for chunk in chunks]
    for future in as_completed(futures):
        yield from future.result()
        future.release()


def _on_worker(wanted: Wanted, items: list[Item]) -> list[tuple[int, Row]]:
    from ..precision import enable_double_precision

    enable_double_precision()
    begin(wanted)
    return list(rows_of(wanted, items))
