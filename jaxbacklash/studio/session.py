"""The work of one page: record, held-out record, tree of models, and what is being computed. It knows no browser.

Every tab of a browser shows the same session, so that a page that is loaded anew finds the work where it was. Methods may be
called from any thread; they raise `BadInput` with a sentence for the page, and return before what they began is done.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..errors import BadInput
from . import work
from .choice import Choice, Opened, opened
from .folder import Folder
from .script import script
from .tree import Model, Tree
from .work import Setup
from .worker import Job, Worker


class Session:
    """The work.

    Attributes: ``folder`` whose files may be chosen; ``record`` and ``heldout`` as they were opened, None where none is chosen;
    ``setup`` of every fit; ``tree`` of the models; ``worker`` that computes; ``version`` goes up with every change;
    ``message`` the last sentence for a person, ``bad`` whether it tells of something that went wrong.

    Examples
    --------
    >>> from tempfile import mkdtemp
    >>> session = Session(Folder(mkdtemp()))
    >>> session.begin()
    Traceback (most recent call last):
    jaxbacklash.errors.BadInput: no record is open; choose a file that can be read
    >>> session.close()
    """

    def __init__(self, folder: Folder) -> None:
        self.folder = folder
        self.record: Opened | None = None
        self.heldout: Opened | None = None
        self.setup = Setup()
        self.tree = Tree()
        self.refinement: Any = None
        self.message, self.bad = "", False
        self.version = 0
        self._asked: set[tuple[int, str]] = set()
        self._lock = threading.RLock()
        self.worker = Worker(self._changed)

    def close(self) -> None:
        """End what is being computed, for good."""
        self.worker.close()

    def open(self, choice: Choice) -> Opened:
        """Read a file as the record to fit; the models of another record are forgotten."""
        found = self._read(choice)
        with self._lock:
            self._halt()
            self.record, self.tree, self.refinement = found, Tree(), None
            self._say("")  # what is wrong with it stands beside the file
        return found

    def open_heldout(self, choice: Choice | None) -> Opened | None:
        """Read a file as the record that is only predicted; None: there is none. Models are fitted anew."""
        found = None if choice is None else self._read(choice)
        with self._lock:
            self._halt()
            self.heldout, self.tree, self.refinement = found, Tree(), None
            self._say("")
        return found

    def choose(self, setup: Setup) -> None:
        """Begin every fit otherwise; the models fitted so far are forgotten."""
        with self._lock:
            if setup == self.setup:
                return
            self._halt()
            self.setup, self.tree, self.refinement = setup, Tree(), None
            self._changed()

    def begin(self) -> None:
        """Fit the base model."""
        with self._lock:
            self._ready()
            base = self.tree.find(())
            if base is None:
                self._fit(None, ())
            else:
                self.go(base.number)

    def add(self, effect: str) -> None:
        """Add an effect to the model looked at and fit it."""
        with self._lock:
            model = self.tree.current
            if effect not in work.addable(model.effects):
                known = ", ".join(work.addable(model.effects))
                raise BadInput(f"{effect}: is no effect that this model lacks, wanted one of {known}")
            self._grow(model, (*model.effects, effect))

    def remove(self, effect: str) -> None:
        """Take an effect out of the model looked at and fit what is left."""
        with self._lock:
            model = self.tree.current
            if effect not in model.effects:
                raise BadInput(f"{effect}: is not in this model, wanted one of {', '.join(model.effects) or 'none: it has none'}")
            self._grow(model, tuple(name for name in model.effects if name != effect))

    def take(self, effects: tuple[str, ...]) -> None:
        """Fit the base model with all of these effects."""
        with self._lock:
            self._grow(self.tree.path(self.tree.current.number)[0], tuple(effects))

    def _grow(self, parent: Model, effects: tuple[str, ...]) -> None:
        known = self.tree.find(effects)
        if known is not None:
            self.go(known.number)
        else:
            self._fit(parent.number, effects)

    def refine(self) -> None:
        """Let `jaxbacklash.refine` find what is missing."""
        with self._lock:
            record, held = self._ready()

            def keep(found: Any) -> None:
                with self._lock:
                    self.refinement = found
                    self._say("the search has ended; what it found stands under What is missing")

            self._say("")
            arguments = record, held, self.setup
            self.worker.submit(Job("search for all that is missing", work.refine, arguments, keep, self._failed))

    def undo(self) -> None:
        """Look at the model before."""
        with self._lock:
            self.tree.undo()
            self._say("")

    def redo(self) -> None:
        """Undo the last `undo`."""
        with self._lock:
            self.tree.redo()
            self._say("")

    def go(self, number: int) -> None:
        """Look at another model of the tree."""
        with self._lock:
            model = self.tree.go(number)
            self._judge(model)
            self._say("")

    def stop(self) -> None:
        """Stop what is being computed, and forget what waits: it is said even of what had not begun."""
        with self._lock:
            busy = self.worker.busy
            self._halt()
            if busy:
                self._say("stopped")

    def judge(self) -> None:
        """Find out where the model looked at fails and what it lacks, as far as that is not known."""
        with self._lock:
            self._judge(self.tree.current)

    def _halt(self) -> None:
        self._asked.clear()
        self.worker.stop()

    def python(self, *, model_file: str = "model.toml") -> str:
        """The program that repeats the way to the model looked at."""
        with self._lock:
            if self.record is None or self.record.record is None:
                raise BadInput("no record is open; choose a file that can be read")
            path = self.tree.path(self.tree.current.number) if len(self.tree) else []
            held = None if self.heldout is None else self.heldout.choice
            return script(self.record.choice, held, self.setup, path, model_file=model_file)

    def save(self, name: str) -> tuple[Path, list[str]]:
        """Write model, report and Python into a new folder within the session's; the folder and the names of the files."""
        from .saving import save

        with self._lock:
            path, python = self.tree.path(self.tree.current.number), self.python()
            assert self.record is not None
            target = self.folder.new(name)
        return target, save(target, path, python)

    def say(self, message: str, *, bad: bool = False) -> None:
        """Show a sentence at every tab."""
        with self._lock:
            self._say(message, bad=bad)

    def touch(self) -> None:
        """Tell every tab to look again."""
        self._changed()

    def _read(self, choice: Choice) -> Opened:
        return opened(choice, self.folder.path(choice.name))

    def _ready(self) -> tuple[Any, Any]:
        """The records, where they can be fitted."""
        if self.record is None or self.record.record is None:
            raise BadInput("no record is open; choose a file that can be read")
        record, held = self.record.record, None if self.heldout is None else self.heldout.record
        if self.heldout is not None and held is None:
            raise BadInput(f"the held-out record cannot be used: {self.heldout.wrong}")
        if held is not None and any(getattr(held, of) != getattr(record, of) for of in ("kind", "input_name", "observed_name")):
            channels = " ".join(record.channels)
            raise BadInput(f"the held-out record has {' '.join(held.channels)}, wanted one of the record's kind, with {channels}")
        return record, held

    def _fit(self, parent: int | None, effects: tuple[str, ...]) -> None:
        record, held = self._ready()
        tree = self.tree

        def keep(fit: Any) -> None:
            with self._lock:
                if tree is self.tree:  # else another record has been opened meanwhile
                    self._judge(tree.add(parent, effects, fit))
                    self._say("")

        self._say("")
        title = "fit " + " + ".join(["base model", *effects])
        self.worker.submit(Job(title, work.fit_model, (record, held, self.setup, effects), keep, self._failed))

    def _judge(self, model: Model) -> None:
        """Find out where a model fails and what it lacks, as far as that is not known."""
        tree = self.tree
        asked: tuple[tuple[str, str, Callable[..., Any]], ...] = (
            ("findings", "see where it fails", work.fails), ("ranking", "rank absent effects", work.rank),
            ("causes", "look for causes in the record", work.causes),
        )  # fmt: skip
        for what, title, function in asked:
            if getattr(model, what) is not None or (model.number, what) in self._asked:
                continue
            self._asked.add((model.number, what))

            def keep(found: Any, what: str = what) -> None:
                with self._lock:
                    if tree is self.tree:
                        tree.learn(model.number, **{what: found})
                        self._changed()

            def give_up(why: str, title: str = title) -> None:
                with self._lock:
                    if tree is self.tree and why != "stopped":
                        tree.learn(model.number, refused=f"{title}: {why}")
                    self._changed()

            self.worker.submit(Job(f"{title}: {model.name}", function, (model.fit,), keep, give_up, aside=True))

    def _failed(self, why: str) -> None:
        self.say(why, bad=why != "stopped")

    def _say(self, message: str, *, bad: bool = False) -> None:
        self.message, self.bad = message, bad
        self._changed()

    def _changed(self) -> None:
        self.version += 1
