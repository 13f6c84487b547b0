"""Compiled programs as files: the machine's code itself, by way of `jax.experimental.serialize_executable`."""

from __future__ import annotations

import contextlib
import functools
import os
import pickle
import time
import zlib
from pathlib import Path
from typing import Any

import jax
import numpy as np
from jax.experimental import serialize_executable
from jax.stages import Compiled

from .private_files import is_private_folder, make_private_folder, read_private
from .whole_file import write_whole

SUFFIX = ".program"
MAGIC = b"jaxbacklash program 1\n"
"""How a file of ours begins; its own name and a checksum follow, so that no program is taken for another."""
CHECK = 4
"""Bytes of the checksum."""
MONTH = 30 * 24 * 3600.0


def read(path: Path) -> Compiled:
    """What calls a kept program. Raises whatever is wrong with its file."""
    _, kept = pickle.loads(_content(path))
    text, devices, ins, outs = pickle.loads(zlib.decompress(kept))
    if b"lapack_" in text:
        _find_lapack()
    known = {device.id: device for device in jax.devices()}
    return serialize_executable.deserialize_and_load(text, ins, outs, execution_devices=[known[d] for d in devices])


def read_frame(path: Path) -> Any:
    """What was kept beside a program, which now counts as used. Raises whatever is wrong with its file."""
    frame, _ = pickle.loads(_content(path))
    os.utime(path)
    return pickle.loads(frame)


def _content(path: Path) -> memoryview:
    """What the file of this name holds, if only this user can have written it, and under this name.

    Raises
    ------
    OSError, ValueError
        The file or its folder can be written by others, or it holds another program or half of one.
    """
    if not is_private_folder(path.parent):
        raise PermissionError(1, "others can write to this folder", str(path.parent))
    whole = memoryview(read_private(path))
    head = _head(path.name)
    content = whole[len(head) + CHECK :]
    if whole[: len(head)] != head or whole[len(head) : len(head) + CHECK] != _check(content):
        raise ValueError(f"{path.name}: not the program of this name")
    return content


def _head(name: str) -> bytes:
    return MAGIC + name.encode() + b"\n"


def _check(content: bytes | memoryview) -> bytes:
    return zlib.crc32(content).to_bytes(CHECK, "big")


def write(path: Path, call: Compiled, frame: Any) -> None:
    """Keep a program that was compiled in this process and ``frame``; programs that nobody used for a month go.

    Nothing is kept in a folder that others can write to. Raises what ``pickle`` and JAX raise for what cannot be written down.
    One that came out of JAX's own cache must not be given: written down once more, it lacks some of its code.
    """
    text, ins, outs = serialize_executable.serialize(call)
    kept = zlib.compress(pickle.dumps((text, devices_of(call), ins, outs)), 1)
    # The frame apart: reading it loads the modules of its classes.
    content = pickle.dumps((pickle.dumps(frame), kept))
    if not make_private_folder(path.parent):
        return
    with contextlib.suppress(OSError):  # a full disk costs time, nothing else
        write_whole(path, _head(path.name) + _check(content) + content, private=True)
    _purge(path.parent)


def _purge(folder: Path) -> None:
    """Remove programs that nobody used for a month, and nothing that is not a program of ours."""
    with contextlib.suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            with contextlib.suppress(OSError):
                old = time.time() - entry.stat(follow_symlinks=False).st_mtime > MONTH
                # Under another ending where it was being written when the process was killed.
                if old and SUFFIX in entry.name and read_private(entry.path, len(MAGIC)) == MAGIC:
                    os.unlink(entry.path)


def devices_of(call: Compiled) -> list[int]:
    """The devices that a program was made for, by number."""
    shardings = jax.tree.leaves((call.input_shardings, call.output_shardings))
    most = max((sharding.device_set for sharding in shardings), key=len, default=set(jax.devices()[:1]))
    return sorted(device.id for device in most)


@functools.cache
def _find_lapack() -> None:
    """Have JAX look up LAPACK's routines, as it does when it lowers a call of them: a program out of a file has none to lower."""
    with contextlib.suppress(Exception):  # a JAX that has renamed this lowers a call, which takes ten times as long
        from jaxlib import lapack

        lapack.prepare_lapack_call("potrf_ffi", np.dtype(np.float64))
        return
    jax.jit(jax.lax.linalg.cholesky).lower(jax.ShapeDtypeStruct((1, 1), np.float64))
