"""What a program does before the first computation: precision, vector width, and a cache of compiled code.

Importing jaxbacklash does none of this; the command line, the benchmarks and the notebooks call `start`.
"""

from __future__ import annotations

import contextlib
import os
import shlex
import threading
import warnings
from pathlib import Path

from .errors import BadInput, NoAnswer
from .private_files import holds_only_own_files, make_private_folder

THREADS = 16
"""Threads that a computation starts, and so many more for each core: a refinement on two cores was seen to have 25."""
FEW_PROCESSES = 4096
"""A limit on a user's processes and threads from which on it need not be tried whether there are enough."""
MOST_CORES = 8
"""More devices than this do not speed up a fit of usual length."""


# Of a CPU's compiler alone; other devices ignore them.
EXTRA = (
    "xla_cpu_small_while_loop_byte_threshold=4194304",  # a loop over a block is one function: a third of a map's time
    "xla_cpu_disable_loop_unrolling",  # no faster without, and compiled in two thirds of the time
    "xla_cpu_use_multi_output_fusion",  # what several arrays share is computed once, and written down once
)
FLAGS = {
    "xla_backend_extra_options": ",".join(EXTRA),
    "xla_cpu_prefer_vector_width": 512,  # halves the time of a fit on current CPUs
    # A program that is suspended for a while is not stuck.
    "xla_cpu_collective_call_warn_stuck_timeout_seconds": 100_000,
    "xla_cpu_collective_call_terminate_timeout_seconds": 100_000,
}
BRIEF = {"xla_cpu_use_fusion_emitters": "false"}
"""The older way of writing down what XLA has fused: compiled in two thirds of the time, but where several outputs share much
it takes half as long again to compute, or several times as long."""


def cache_folder() -> Path | None:
    """Where compiled programs are kept: ``JAXBACKLASH_CACHE``, else the user's cache folder; None for a user without a home."""
    chosen = os.environ.get("JAXBACKLASH_CACHE")
    if chosen:
        return Path(chosen)
    try:
        return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "jaxbacklash"
    except RuntimeError:
        return None


def cores() -> int:
    """Processor cores that this program may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def on_cpu() -> bool:
    """Whether the processor computes, not an accelerator beside it."""
    import jax

    return jax.default_backend() == "cpu"


def start(*, cache: bool = True, devices: int | None = None, brief: bool = False) -> None:
    """Switch to double precision, ask for wide vectors and one device a core, and keep compiled programs for the next run.

    Linear algebra is told to keep to one thread, unless the environment says otherwise: what this program hands to it is many
    small matrices, over which several threads only wait for one another and take a core from the devices.

    Parameters
    ----------
    cache : keep compiled programs in `cache_folder`
    devices : CPU devices that share a fit's windows; default one a core, at most `MOST_CORES`
    brief : the program computes little and ends, like most commands: compile faster, even if what is compiled is slower, but
        for what is known to compute much (`jaxbacklash.compiled.kept_jit`)

    Examples
    --------
    >>> import jaxbacklash as jb
    >>> jb.start()  # doctest: +SKIP
    """
    # Read when NumPy and SciPy load, which is no later than JAX.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    import jax

    from .precision import enable_double_precision

    # XLA reads its flags when the first computation starts.
    flags = os.environ.get("XLA_FLAGS", "")
    wanted = FLAGS | (BRIEF if brief else {})
    ours = [f"--{name}={value}" for name, value in wanted.items() if name not in flags]
    os.environ["XLA_FLAGS"] = " ".join([flags, *ours]).strip()
    enable_double_precision()
    # Where in the source every operation came from is a sixteenth of a program, and takes as long to read.
    jax.config.update("jax_traceback_in_locations_limit", 0)
    with contextlib.suppress(RuntimeError):  # the program has computed already: it goes on with what it has
        shared = devices or min(cores(), MOST_CORES)
        # One more, on which all else is computed: see `jaxbacklash.sharing`.
        jax.config.update("jax_num_cpu_devices", shared + 1 if shared > 1 else 1)
    _check_platform()
    _check_threads()
    if not cache:
        return
    folder = cache_folder()
    # A read-only home, or none, costs compile time, nothing else.
    if folder is None or not make_private_folder(folder):
        if folder is not None and folder.is_dir() and os.access(folder, os.W_OK):
            warnings.warn(
                f"compiled programs are not kept in {folder}, since others can write to it or to what it is in: "
                f"chmod go-w {shlex.quote(str(folder))}, or name another folder in JAXBACKLASH_CACHE", stacklevel=2,
            )  # fmt: skip
        return
    if not holds_only_own_files(folder):
        return  # what JAX keeps there is code too
    jax.config.update("jax_compilation_cache_dir", str(folder))
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)
    jax.config.update("jax_persistent_cache_min_entry_size_bytes", 0)


def _check_platform() -> None:
    """Refuse a device that the environment asks for and that is not there, before anything is computed."""
    asked = os.environ.get("JAX_PLATFORMS", "")
    if asked in ("", "cpu"):
        return  # always there; looking would wait for it
    import jax

    try:
        jax.devices()
    except Exception as why:  # whatever a plugin raises
        text = next(iter(str(why).splitlines()), "") or type(why).__name__
        raise BadInput(f"JAX_PLATFORMS={shlex.quote(asked)}: found no such device ({text}), wanted cpu or nothing") from None


def _check_threads() -> None:
    """Refuse to compute where too few threads may be started: the compiler would abort without a word for a person."""
    try:
        import resource

        limit = resource.getrlimit(resource.RLIMIT_NPROC)[0]
    except (ImportError, AttributeError, ValueError, OSError):
        return
    if limit == resource.RLIM_INFINITY or limit >= FEW_PROCESSES:
        return
    wanted, go_on, started = THREADS + 8 * cores(), threading.Event(), []
    try:
        for _ in range(wanted):
            one = threading.Thread(target=go_on.wait, daemon=True)
            one.start()
            started.append(one)
    except RuntimeError:
        raise NoAnswer(
            f"this user may start only {len(started)} more threads (ulimit -u is {limit}), and computing takes up to {wanted}; "
            "raise that limit or end other programs"
        ) from None
    finally:
        go_on.set()
        for one in started:
            one.join()
