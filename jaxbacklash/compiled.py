"""Traced programs that the next process finds ready.

JAX's own cache spares the compiler, not the tracing: a program of the size of a fit takes a second or two of Python before
that cache can even be asked. Here what tracing gives (`jax.export`) is kept under a name that can be told without tracing:
what is called, the fixed parts of its arguments, the shapes and kinds of their arrays, this package's source, and the
versions of what traces it.
"""

from __future__ import annotations

import functools
import hashlib
import io
import os
import pickle
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from importlib.metadata import version
from pathlib import Path
from typing import Any

import equinox as eqx
import jax
import jax.export
import numpy as np
from jax.sharding import Mesh, NamedSharding, PartitionSpec

Key = tuple[Any, ...]
Loaded = tuple[jax.export.Exported, Any]
"""A program, and what calls it."""
MONTH = 30 * 24 * 3600.0
KNOWN = ("jaxbacklash", "jax", "jaxlib", "equinox", "diffrax", "optimistix", "lineax", "numpy")
"""Packages whose code is told by their version or, for this one, by its source."""
UNKEPT = (pickle.PicklingError, AttributeError, TypeError, ValueError, NotImplementedError, ImportError)
"""What arguments that cannot be written down, or programs that cannot be exported, raise."""


ahead: dict[str, Future[Loaded | None]] = {}
"""Programs by file name that are being read before they are asked for (`jaxbacklash.read_ahead`); None if they cannot be."""
used: dict[str, None] = {}
used_aside: dict[str, None] = {}
"""File names of the programs that this process's main thread has called, in order, and those called by other threads."""


class _Foreign(Exception):
    """The arguments hold code whose text is not part of a program's name, like a user's own law."""


def kept_jit(function: Callable[..., Any]) -> Callable[..., Any]:
    """`equinox.filter_jit` whose traced programs outlive the process, once `jaxbacklash.start` has named a cache.

    Arguments are positional. A program is not kept, only jitted, where its arguments hold classes or functions of other
    packages (a user's own law may change without changing its name), and where it is called within another traced
    function. A kept file that cannot be read is made anew. What the result's ``programs`` holds is what this process uses. Its
    ``ready`` takes the same arguments and does all but the computing: threads can have the compiler at work side by side.
    """
    jitted = eqx.filter_jit(function)
    programs: dict[Key, Future[Any]] = {}
    lock = threading.Lock()

    def made(args: Any) -> tuple[Any, list[Any]]:
        """What to call, and the arrays to call it with."""
        setting: Any = jax.config
        folder = setting.jax_compilation_cache_dir
        leaves, structure = jax.tree.flatten(args)
        if folder is None or any(isinstance(leaf, jax.core.Tracer) for leaf in leaves):
            return jitted, []
        arrays = [leaf for leaf in leaves if _is_array(leaf)]
        kinds = tuple((a.shape, str(a.dtype), bool(getattr(a, "weak_type", False))) for a in arrays)
        key = (structure, tuple(_Here if _is_array(leaf) else leaf for leaf in leaves), kinds)
        try:
            with lock:
                mine = key not in programs
                coming = programs.setdefault(key, Future())
        except TypeError:  # a fixed part that cannot be told from others
            return jitted, []
        if mine:  # another thread that asks for the same program waits for this one
            try:
                coming.set_result(_find(function, args, kinds, Path(folder) / "programs") or jitted)
            except BaseException as error:
                del programs[key]
                coming.set_exception(error)
                raise
        return coming.result(), arrays

    @functools.wraps(function)
    def call(*args: Any) -> Any:
        program, arrays = made(args)
        return program(arrays) if isinstance(program, _Program) else program(*args)

    def ready(*args: Any) -> None:
        program, _ = made(args)
        if isinstance(program, _Program):
            program.link()

    call.programs, call.ready = programs, ready  # type: ignore[attr-defined]
    return call


class _Here:
    """Marks an array's place in a tree."""


def _is_array(leaf: Any) -> bool:
    return isinstance(leaf, jax.Array | np.ndarray | np.generic)


class _Program:
    """A program from arrays to arrays, and the tree that its results make up."""

    def __init__(self, exported: jax.export.Exported, frame: Any, call: Any = None, name: str = ""):
        self.exported, self.frame, self.call, self.name = exported, frame, call or caller(exported), name
        self.linked, self.lock = call is not None, threading.Lock()
        self.plain = exported.nr_devices > 1 or exported.platforms == ("cpu",)

    def link(self) -> None:
        """Compile it, so that the first call need not."""
        with self.lock:
            if not self.linked:
                link(self.exported, self.call)
            self.linked = True

    def __call__(self, arrays: list[Any]) -> Any:
        self.link()
        (used if threading.current_thread() is threading.main_thread() else used_aside)[self.name] = None
        # An array that sits on one device cannot be handed to several; and for one that came out of another program, a program
        # would be compiled once more. On a CPU numpy's view of it costs nothing.
        results = iter(self.call([np.asarray(a) for a in arrays] if self.plain else arrays))
        return jax.tree.map(lambda leaf: next(results) if leaf is _Here else leaf, self.frame)


def link(exported: jax.export.Exported, call: Any) -> None:
    """Compile what calls a program, or read what was compiled before."""
    call.lower([jax.ShapeDtypeStruct(v.shape, v.dtype) for v in exported.in_avals]).compile()


def caller(exported: jax.export.Exported) -> Any:
    """What calls a program, on as many devices as it was made for."""
    if exported.nr_devices == 1:
        return jax.jit(exported.call)
    mesh = Mesh(np.asarray(jax.devices()[: exported.nr_devices]), ("cores",))
    return jax.jit(exported.call, in_shardings=NamedSharding(mesh, PartitionSpec()))


def _find(function: Callable[..., Any], args: Any, kinds: Any, folder: Path) -> _Program | None:
    """The program from its file, or traced and kept there; nothing where it cannot be kept."""
    try:
        path = folder / f"{_name(function, args, kinds)}.program"
        found = _load(path)
        if found is None:
            found = _trace(function, args)
            found.name = path.name
            _keep(found, path)
    except (_Foreign, *UNKEPT):
        return None
    return found


def _trace(function: Callable[..., Any], args: Any) -> _Program:
    fixed = eqx.filter(args, _is_array, inverse=True)
    leaves, structure = jax.tree.flatten(args)
    frame: Any = None

    def flat(arrays: list[Any]) -> list[Any]:
        nonlocal frame
        held = iter(arrays)
        dynamic = jax.tree.unflatten(structure, [next(held) if _is_array(leaf) else None for leaf in leaves])
        result = function(*eqx.combine(dynamic, fixed))
        frame = jax.tree.map(lambda leaf: _Here if eqx.is_array_like(leaf) else leaf, result)
        return jax.tree.leaves(eqx.filter(result, eqx.is_array_like))

    exported = jax.export.export(jax.jit(flat))([leaf for leaf in leaves if _is_array(leaf)])
    return _Program(exported, frame)


def _load(path: Path) -> _Program | None:
    try:
        text, frame = pickle.loads(path.read_bytes())
        begun = ahead.get(path.name)
        exported, call = (begun and begun.result()) or (jax.export.deserialize(text), None)
        program = _Program(exported, pickle.loads(frame), call, path.name)
        os.utime(path)
    except Exception:  # missing, half written, or of another making: it is made anew
        return None
    return program


def _keep(program: _Program, path: Path) -> None:
    # The frame apart: reading it loads the modules of its classes.
    text = pickle.dumps((bytes(program.exported.serialize()), pickle.dumps(program.frame)))
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


def _name(function: Callable[..., Any], args: Any, kinds: Any) -> str:
    """What tells this program from all others, without tracing it."""
    text = io.BytesIO()
    _Known(text).dump(jax.tree.map(lambda leaf: _Here if _is_array(leaf) else leaf, args))
    parts = (function.__module__, function.__qualname__, kinds, _setting())
    return hashlib.sha256(repr(parts).encode() + text.getvalue()).hexdigest()


class _Known(pickle.Pickler):
    """Refuses classes and functions whose text is not known by a version."""

    def reducer_override(self, thing: Any) -> Any:
        if isinstance(thing, type) or hasattr(thing, "__code__"):
            package = (getattr(thing, "__module__", None) or "").partition(".")[0]
            if package not in KNOWN and package not in sys.stdlib_module_names:
                raise _Foreign(package)
        return NotImplemented


@functools.cache
def _setting() -> str:
    """This package's source, the versions of what it runs on, and what is set while tracing."""
    here = Path(__file__).parent
    source = hashlib.sha256()
    for path in sorted(here.rglob("*.py")):
        source.update(path.read_bytes())
    versions = [f"{name} {version(name)}" for name in KNOWN[1:]]
    devices = [f"{d.platform} {d.device_kind}" for d in jax.devices()]
    setting: Any = jax.config
    return repr((source.hexdigest(), versions, devices, setting.jax_enable_x64, sys.version))
