"""A file of the user's own laws: run once, its classes checked, known to the catalogue from then on.

The file is the user's program and is run as such; but it may not end the command, write into its output or run forever, and what
is wrong with a law is said in the words of the one who wrote it, before anything is fitted.
"""

from __future__ import annotations

import builtins
import contextlib
import importlib.util
import io
import os
import shlex
import sys
import threading
import types
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NoReturn

from ..errors import BadInput
from ..mechanics import AbstractEffect, canonical_name, catalogue
from ..stopping import end_now
from .law_errors import line_in, named

MODULE = "own_laws_file_"
"""Beginning of the names under which such files are modules: not like a package's, whose text is known by its version."""
LONGEST = 40.0
"""Seconds that running and checking such a file may take: an infinite loop would never end."""
LARGEST = 10_000_000
"""Bytes of such a file at most."""


def load_laws(path: Path | None) -> None:
    """Run a file of the user's own effect classes and check each; from then on the catalogue knows them.

    Parameters
    ----------
    path : a Python file with subclasses of `jaxbacklash.AbstractEffect`; None: nothing is done

    Raises
    ------
    BadInput
        The file is missing, fails, defines no effect, or one that cannot be fitted: naming file, line, law and remedy.

    Examples
    --------
    >>> from pathlib import Path
    >>> load_laws(Path("own_effect.py"))  # doctest: +SKIP
    """
    if path is None:
        return
    where = f"--laws {shlex.quote(str(path))}"
    text = _text(path, where)
    before = {name: cls for name, cls in catalogue().items() if not cls.__module__.startswith(MODULE)}
    with _within(LONGEST, f"error: {where}: is still running after {LONGEST:g} s, wanted a file that only defines effects"):
        module, told = _run(path, text, where)
        own = [cls for cls in vars(module).values() if isinstance(cls, type) and cls.__module__ == module.__name__]
        laws = [cls for cls in own if issubclass(cls, AbstractEffect) and not cls.__name__.startswith("Abstract")]
        if not laws:
            raise BadInput(f"{where}: defines no effect, wanted a subclass of jaxbacklash.AbstractEffect")
        from .law_check import check_law  # it traces, and with that loads what a plain command loads later

        seen: dict[str, type] = {}
        for cls in dict.fromkeys(laws):
            name = canonical_name(cls)
            if name in before:
                raise BadInput(f"{where}: the name {name} of class {cls.__name__} is taken by a law of the catalogue; rename it")
            if name in seen:
                raise BadInput(f"{where}: the classes {seen[name].__name__} and {cls.__name__} are both named {name}; rename one")
            seen[name] = cls
            with contextlib.redirect_stdout(told), _no_way_out():
                check_law(cls, path, where)
    sys.stderr.write(told.getvalue())


def _text(path: Path, where: str) -> bytes:
    try:
        if not path.is_file():
            raise BadInput(f"{where}: found no such file, wanted a Python file with effect classes")
        if path.stat().st_size > LARGEST:
            raise BadInput(f"{where}: is larger than {LARGEST // 10**6} MB, wanted a Python file with effect classes")
        return path.read_bytes()
    except (OSError, ValueError) as why:
        if isinstance(why, BadInput):
            raise
        raise BadInput(f"{where}: cannot be read ({getattr(why, 'strerror', None) or why})") from None


def _run(path: Path, text: bytes, where: str) -> tuple[types.ModuleType, io.StringIO]:
    """The file as a module, which is known by a name that no other file has, and what it printed."""
    name = f"{MODULE}{abs(hash(os.path.abspath(path))):x}"
    module = types.ModuleType(name)
    module.__file__, module.__spec__ = str(path), importlib.util.spec_from_loader(name, loader=None)
    told = io.StringIO()  # shown if all goes well: an error is one sentence
    module.__dict__["print"] = _aside
    sys.modules[name] = module  # dataclasses look their own module up
    try:
        with contextlib.redirect_stdout(told), _no_way_out():
            exec(compile(text, str(path), "exec", dont_inherit=True), module.__dict__)  # the user's own program
    except SyntaxError as error:
        raise BadInput(f"{where}, line {error.lineno}: is not Python ({error.msg}); correct that line") from None
    except BaseException as error:
        raise BadInput(f"{where}{line_in(error, path)}: running it failed with {named(error)}; correct the file") from None
    from ..precision import enable_double_precision

    enable_double_precision()  # which such a file may have switched off
    return module, told


def _aside(*words: object, **how: Any) -> None:
    """What ``print`` is within a file of laws: beside what a command tells on stdout, also from within a law later on."""
    told = sys.stdout if isinstance(sys.stdout, io.StringIO) else sys.stderr
    builtins.print(*words, **{"file": told, **how})


@contextlib.contextmanager
def _no_way_out() -> Iterator[None]:
    """Within it the process cannot be left at once from Python."""

    def refused(*how: object) -> NoReturn:
        raise SystemExit("os._exit")

    leave = os._exit
    os._exit = refused  # type: ignore[assignment]
    try:
        yield
    finally:
        os._exit = leave


@contextlib.contextmanager
def _within(seconds: float, sentence: str) -> Iterator[None]:
    """Ends the process with the sentence if what stands within takes longer."""
    timer = threading.Timer(seconds, end_now, (sentence, 2))
    timer.daemon = True
    with contextlib.suppress(RuntimeError):  # no more threads: it may take as long as it takes
        timer.start()
    try:
        yield
    finally:
        timer.cancel()
