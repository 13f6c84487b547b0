"""What is wanted of every one of many records, as data that another process understands."""

from __future__ import annotations

import hashlib
import os
import pickle
from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from .. import __version__
from ..mechanics import AbstractEffect
from ..model_file import dump_model
from ..records import Record, read_record
from ..system import System

Source = Record | Path
"""A record, or the file that it is in."""


@dataclass(frozen=True)
class Wanted:
    """What is done with every record.

    Attributes: ``command``, ``"fit"`` or ``"refine"``; ``read`` makes a record of a file; ``before`` is called once in every
    process, such as what loads a user's own laws; the others are those of `jaxbacklash.fit` and `jaxbacklash.refine`.
    """

    command: str
    model: str = "joint"
    inertia: float | None = None
    effects: tuple[AbstractEffect | str, ...] = ()
    system: System | None = None
    heldout: Record | None = None
    window: float | None = None
    starts: int = 4
    seed: int = 0
    translational: bool = False
    read: Callable[[Any], Record] = read_record
    before: Callable[[], object] | None = None

    def fingerprint(self) -> bytes:
        """What tells this from anything else that could be wanted."""
        told = [__version__]
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, System):
                value = dump_model(value)
            elif isinstance(value, Record):
                value = digest(value).hex()
            elif callable(value):
                value = _code(value)
            told.append(f"{field.name}={value!r}")
        return hashlib.blake2b("\n".join(told).encode("utf-8", "backslashreplace"), digest_size=16).digest()


def _code(function: Callable[..., Any]) -> str:
    """What tells a function from another one: how another process would find it, else what it does."""
    try:
        return pickle.dumps(function).hex()
    except Exception:  # defined in a function or a notebook
        code = getattr(function, "__code__", None)
        return f"{getattr(function, '__qualname__', function)} {code and code.co_code.hex()}"


def digest(source: Source) -> bytes:
    """What tells a record's content from any other; of a file that cannot be read, its name."""
    found = hashlib.blake2b(digest_size=16)
    if isinstance(source, Record):
        for name, values in (("t", source.t), *sorted(source.channels.items())):
            found.update(name.encode())
            found.update(np.ascontiguousarray(values).tobytes())
        found.update(repr((source.path, source.ratio, source.per_kt)).encode())
        return found.digest()
    found.update(os.fsencode(source))
    try:
        for part in sorted(p for p in source.rglob("*") if p.is_file()) if source.is_dir() else [source]:
            with part.open("rb") as file:
                while block := file.read(1 << 20):
                    found.update(block)
    except OSError as error:
        found.update(repr(error.errno).encode())
    return found.digest()


def keys_of(wanted: Wanted, sources: list[Source]) -> list[str]:
    """By which name the row of each record is kept: that of what is wanted, and of what is in it."""
    lead = wanted.fingerprint()
    return [hashlib.blake2b(lead + digest(source), digest_size=16).hexdigest() for source in sources]


def path_of(source: Source) -> str:
    """Where a record came from."""
    return source.path if isinstance(source, Record) else str(source)
