"""Compiled programs as files: the machine's code itself, by way of `jax.experimental.serialize_executable`."""

from __future__ import annotations

import contextlib
import functools
import os
import pickle
import tempfile
import time
import zlib
from pathlib import Path
from typing import Any

import jax
import numpy as np
from jax.experimental import serialize_executable
from jax.stages import Compiled

SUFFIX = ".program"
MONTH = 30 * 24 * 3600.0


def read(path: Path) -> Compiled:
    """What calls a kept program. Raises whatever is wrong with its file."""
    _, kept = pickle.loads(path.read_bytes())
    text, devices, ins, outs = pickle.loads(zlib.decompress(kept))
    if b"lapack_" in text:
        _find_lapack()
    known = {device.id: device for device in jax.devices()}
    return serialize_executable.deserialize_and_load(text, ins, outs, execution_devices=[known[d] for d in devices])


def read_frame(path: Path) -> Any:
    """What was kept beside a program, which now counts as used. Raises whatever is wrong with its file."""
    frame, _ = pickle.loads(path.read_bytes())
    os.utime(path)
    return pickle.loads(frame)


def write(path: Path, call: Compiled, frame: Any) -> None:
    """Keep a program that was compiled in this process and ``frame``; programs that nobody used for a month go.

    Raises what ``pickle`` and JAX raise for what cannot be written down. One that came out of JAX's own cache must not be given:
    written down once more, it lacks some of its code.
    """
    text, ins, outs = serialize_executable.serialize(call)
    kept = zlib.compress(pickle.dumps((text, devices_of(call), ins, outs)), 1)
    # The frame apart: reading it loads the modules of its classes.
    text = pickle.dumps((pickle.dumps(frame), kept))
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
            file.write(text)
        os.replace(file.name, path)
        for old in path.parent.iterdir():
            if time.time() - old.stat().st_mtime > MONTH:
                old.unlink()
    except OSError:  # a full disk or a read-only home costs time, nothing else
        return


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
