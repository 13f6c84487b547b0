"""Compiled programs that the next process finds ready.

JAX's own cache spares the compiler, not the tracing: a program of the size of a fit takes a second or two of Python before
that cache can even be asked. Here the machine's code itself (`jaxbacklash.program_file`) is kept under a name that can be told
without tracing: what is called, the fixed parts of its arguments, the shapes and kinds of their arrays, this package's source,
the versions of what traces and compiles it, and the processor it is for.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import io
import os
import pickle
import platform
import sys
import threading
import uuid
from collections.abc import Callable
from concurrent.futures import Future
from importlib.metadata import version
from pathlib import Path
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jax.stages import Compiled, Lowered

from . import read_ahead
from .program_file import SUFFIX, devices_of, read_frame, write

Key = tuple[Any, ...]
LASTING: dict[str, str | bool] = {"xla_cpu_use_fusion_emitters": True}
"""How a program is compiled that computes for long, even where `jaxbacklash.program.BRIEF` is how all others are."""
KNOWN = ("jaxbacklash", "jax", "jaxlib", "equinox", "diffrax", "optimistix", "lineax", "numpy")
"""Packages whose code is told by their version or, for this one, by its source."""
UNKEPT = (pickle.PicklingError, AttributeError, TypeError, ValueError, NotImplementedError, ImportError)
"""What pickle and JAX raise of arguments or programs that cannot be written down: such a program serves its own process alone."""


MOST = 24
"""Programs of one function that a process holds at a time, more than one record ever asks for: the rest is read again where it is
asked for again. A process that goes through many kinds of records would run out of room for code otherwise."""


class _Foreign(Exception):
    """The arguments hold code whose text is not part of a program's name, like a user's own law."""


def kept_jit(function: Callable[..., Any], lasting: Callable[..., bool] = lambda *args: False) -> Callable[..., Any]:
    """`equinox.filter_jit` whose compiled programs outlive the process, once `jaxbacklash.start` has named a cache.

    Arguments are positional. A program is not kept, only jitted, where its arguments hold classes or functions of other
    packages (a user's own law may change without changing its name), and where it is called within another traced
    function. A kept file that cannot be read is made anew. What the result's ``programs`` holds is what this process uses. Its
    ``ready`` takes the same arguments and does all but the computing: threads can have the compiler at work side by side;
    ``fetch`` does so only where the program is kept. Where ``lasting`` says of the same arguments that they will be computed with
    for long, a program is compiled for that even in a process that is to compile fast.
    """
    together: Any = None
    jit: Any = eqx.filter_jit  # its types leave out what it hands on to `jax.jit`
    jitted, jitted_to_last = jit(function), jit(function, compiler_options=LASTING)
    programs: dict[Key, Future[Any]] = {}
    lock = threading.Lock()

    def made(args: Any) -> tuple[Any, list[Any]]:
        """What to call, and the arrays to call it with."""
        setting: Any = jax.config
        folder = setting.jax_compilation_cache_dir
        leaves, structure = jax.tree.flatten(args)
        if any(isinstance(leaf, jax.core.Tracer) for leaf in leaves):
            return jitted, []  # the outermost program says how all of it is compiled
        lasts = lasting(*args)
        unkept = jitted_to_last if lasts else jitted
        if folder is None:
            return unkept, []
        arrays = [leaf for leaf in leaves if _is_array(leaf)]
        kinds = _kinds(leaves)
        key = (structure, tuple(_Here if _is_array(leaf) else leaf for leaf in leaves), kinds)
        try:
            with lock:
                mine = key not in programs
                coming = programs[key] = Future() if mine else programs.pop(key)  # the one used last stands last
                for old in [k for k in programs if programs[k].done()][: max(len(programs) - MOST, 0)]:
                    del programs[old]
        except TypeError:  # a fixed part that cannot be told from others
            return unkept, []
        if mine:  # another thread that asks for the same program waits for this one
            try:
                coming.set_result(_find(function, args, kinds, folder, lasts) or unkept)
            except BaseException as error:
                programs.pop(key, None)
                coming.set_exception(error)
                raise
        return coming.result(), arrays

    @functools.wraps(function)
    def call(*args: Any) -> Any:
        if lane.ask is not None and not any(isinstance(leaf, jax.core.Tracer) for leaf in jax.tree.leaves(args)):
            return lane.ask(call, args)
        program, arrays = made(args)
        return program(arrays) if isinstance(program, _Program) else program(*args)

    def ready(*args: Any) -> None:
        made(args)

    def fetch(*args: Any) -> None:
        setting: Any = jax.config
        folder = setting.jax_compilation_cache_dir
        with contextlib.suppress(_Foreign, OSError, *UNKEPT):
            if folder is not None and _path(function, args, _kinds(jax.tree.leaves(args)), folder).exists():
                made(args)

    def on_lanes(args: Any, count: Any) -> Any:
        """The same of several arguments in one program, whose arrays are stacked on a leading axis; ``count`` are there."""
        nonlocal together
        if together is None:
            over: Any = functools.partial(_over_lanes, function)
            over.__module__, over.__qualname__ = function.__module__, f"{function.__qualname__}.on_lanes"
            over.__name__ = over.__qualname__
            together = kept_jit(over, lambda args, count: lasting(*args))
        return together(args, count)

    call.programs, call.ready, call.fetch, call.on_lanes = programs, ready, fetch, on_lanes  # type: ignore[attr-defined]
    return call


class _Lane(threading.local):
    """What a thread is told that works beside others on the same: ``ask``, called with a kept function and its arguments in
    place of computing at once, see `jaxbacklash.lockstep`."""

    ask: Callable[[Any, Any], Any] | None = None


lane = _Lane()


def _over_lanes(function: Callable[..., Any], args: Any, count: Any) -> Any:
    """``function`` of each lane in turn: every one takes as many steps as it needs, and of lanes no more than there are."""
    leaves, structure = jax.tree.flatten(args)
    arrays = [leaf for leaf in leaves if _is_array(leaf) or isinstance(leaf, jax.core.Tracer)]
    size = arrays[0].shape[0]

    frame: Any = None

    def of_one(own: list[Any]) -> list[Any]:
        nonlocal frame
        taken = iter(own)
        whole = [next(taken) if _is_array(leaf) or isinstance(leaf, jax.core.Tracer) else leaf for leaf in leaves]
        found = function(*jax.tree.unflatten(structure, whole))
        frame = jax.tree.structure(found)
        return jax.tree.leaves(found)

    one = jax.jit(of_one)  # traced once, for the shapes and for the loop
    shapes = jax.eval_shape(one, [jax.ShapeDtypeStruct(a.shape[1:], a.dtype) for a in arrays])
    empty = [jnp.zeros((size, *s.shape), s.dtype) for s in shapes]

    def turn(k: Any, found: list[Any]) -> list[Any]:
        new = one([jax.lax.dynamic_index_in_dim(a, k, 0, keepdims=False) for a in arrays])
        return [jax.lax.dynamic_update_index_in_dim(f, value, k, 0) for f, value in zip(found, new)]

    return jax.tree.unflatten(frame, jax.lax.fori_loop(jnp.asarray(0, jnp.int32), count, turn, empty))


lasting_jit = functools.partial(kept_jit, lasting=lambda *args: True)
"""`kept_jit` of what always computes for long."""


class _Here:
    """Marks an array's place in a tree."""


def _kinds(leaves: list[Any]) -> tuple[Any, ...]:
    return tuple((a.shape, _called(a.dtype), bool(getattr(a, "weak_type", False))) for a in leaves if _is_array(a))


@functools.cache
def _called(dtype: Any) -> str:
    """The name of a kind of numbers; numpy takes longer to make it up than to look it up."""
    return str(dtype)


def _is_array(leaf: Any) -> bool:
    return isinstance(leaf, jax.Array | np.ndarray | np.generic)


class _Program:
    """A program from arrays to arrays, and the tree that its results make up."""

    def __init__(self, call: Compiled, frame: Any, name: str):
        self.call, self.frame, self.name = call, frame, name
        self.plain = len(devices_of(call)) > 1 or jax.default_backend() == "cpu"

    def __call__(self, arrays: list[Any]) -> Any:
        in_main = threading.current_thread() is threading.main_thread()
        (read_ahead.used if in_main else read_ahead.used_aside)[self.name] = None
        # An array that sits on one device cannot be handed to a program for several. On a CPU numpy's view of it costs nothing.
        results = iter(self.call([np.asarray(a) for a in arrays] if self.plain else arrays))
        return jax.tree.map(lambda leaf: next(results) if leaf is _Here else leaf, self.frame)


def _path(function: Callable[..., Any], args: Any, kinds: Any, folder: str) -> Path:
    return Path(folder) / "programs" / f"{_name(function, args, kinds)}{SUFFIX}"


def _find(function: Callable[..., Any], args: Any, kinds: Any, folder: str, lasting: bool) -> _Program | None:
    """The program from its file, or traced and kept there; nothing where it cannot be kept."""
    try:
        path = _path(function, args, kinds, folder)
        found = _load(path)
        if found is None:
            found = _make(function, args, path.name, lasting)
            with contextlib.suppress(*UNKEPT, jax.errors.JaxRuntimeError):  # this process has it
                write(path, found.call, found.frame)
    except (_Foreign, *UNKEPT):
        return None
    return found


def _make(function: Callable[..., Any], args: Any, name: str, lasting: bool) -> _Program:
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

    # A name that JAX's own cache cannot know: what comes out of that cache, written down once more, lacks some of its code.
    flat.__name__ = f"{function.__name__}_{uuid.uuid4().hex}"
    lowered = jax.jit(flat).lower([leaf for leaf in leaves if _is_array(leaf)])
    _forget_origins(lowered)
    return _Program(lowered.compile(LASTING if lasting else None), frame, name)


def _forget_origins(lowered: Lowered) -> None:
    """Take out of a program what says of every operation where it came from: half of its text, and up to a fifth of the
    time that reading it takes."""
    with contextlib.suppress(ImportError, AttributeError, ValueError):  # a JAX without this pass keeps them
        from jaxlib.mlir.passmanager import PassManager

        module: Any = lowered.compiler_ir("stablehlo")
        with module.context:
            PassManager.parse("builtin.module(strip-debuginfo)").run(module.operation)


def _load(path: Path) -> _Program | None:
    try:
        return _Program(read_ahead.read(path), read_frame(path), path.name)
    except Exception:  # missing, half written, or of another making: it is made anew
        return None


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
    """This package's source, the versions of what it runs on, the processor, and what is set while tracing and compiling."""
    here = Path(__file__).parent
    source = hashlib.sha256()
    for path in sorted(here.rglob("*.py")):
        source.update(path.read_bytes())
    versions = [f"{name} {version(name)}" for name in KNOWN[1:]]
    devices = [f"{d.platform} {d.device_kind}" for d in jax.devices()]
    setting: Any = jax.config
    flags = os.environ.get("XLA_FLAGS", "")
    return repr((source.hexdigest(), versions, devices, setting.jax_enable_x64, sys.version, flags, processor()))


def processor() -> str:
    """What tells a processor's set of instructions from another's: code made for one may not run on the other."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    features = next((line for line in lines if line.lower().startswith(("flags", "features"))), "")
    return f"{platform.machine()} {platform.processor()} {features}"
