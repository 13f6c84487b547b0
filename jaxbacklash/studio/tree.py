"""The tree of models that were tried: each grew out of another by an effect that was added or taken out; undo, redo, branches."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..errors import BadInput


@dataclass(frozen=True, eq=False)
class Model:
    """One model that was fitted.

    Attributes: ``number`` its own, counted from 0; ``parent`` the number of the model it grew out of, None for the first;
    ``effects`` beside play, stiffness and damping; ``fit`` of `jaxbacklash.fit`; ``findings`` of `jaxbacklash.where_it_fails`,
    ``ranking`` of `jaxbacklash.rank_effects` and ``causes`` of `jaxbacklash.find_causes`, None as long as they are not known.
    """

    number: int
    parent: int | None
    effects: tuple[str, ...]
    fit: Any
    findings: Any = None
    ranking: Any = None
    causes: Any = None
    refused: str = ""

    @property
    def name(self) -> str:
        """The model in words."""
        return " + ".join(["base model", *self.effects])

    @property
    def rms(self) -> float:
        """Prediction error over the noise."""
        return float(self.fit.score.rms)

    @property
    def heldout_rms(self) -> float | None:
        """The same on the held-out record, None without one."""
        return None if self.fit.heldout is None else float(self.fit.heldout.rms)


class Tree:
    """Models, which of them is looked at, and the way there.

    Examples
    --------
    >>> tree = Tree()
    >>> base = tree.add(None, (), None)
    >>> wrong = tree.add(base.number, ("preload",), None)
    >>> tree.undo()
    >>> tree.current.name
    'base model'
    >>> right = tree.add(base.number, ("gravity",), None)
    >>> [model.name for model in tree.path(right.number)]
    ['base model', 'base model + gravity']
    >>> [model.name for model in tree.children(base.number)]
    ['base model + preload', 'base model + gravity']
    """

    def __init__(self) -> None:
        self._models: list[Model] = []
        self._at: int | None = None
        self._past: list[int] = []
        self._future: list[int] = []

    def __len__(self) -> int:
        return len(self._models)

    def __iter__(self) -> Iterator[Model]:
        return iter(self._models)

    def __getitem__(self, number: int) -> Model:
        if not 0 <= number < len(self._models):
            raise BadInput(f"model {number}: there is no such model, wanted one of 0 to {len(self._models) - 1}")
        return self._models[number]

    @property
    def current(self) -> Model:
        """The model that is looked at."""
        if self._at is None:
            raise BadInput("no model has been fitted yet")
        return self._models[self._at]

    def add(self, parent: int | None, effects: Sequence[str], fit: Any) -> Model:
        """Add a fitted model and look at it."""
        model = Model(len(self._models), parent, tuple(effects), fit)
        self._models.append(model)
        self.go(model.number)
        return model

    def go(self, number: int) -> Model:
        """Look at another model; what is added next branches off there."""
        model = self[number]
        if self._at is not None and self._at != number:
            self._past.append(self._at)
        self._at, self._future = number, []
        return model

    def undo(self) -> None:
        """Back to the model looked at before; the other one stays in the tree."""
        if not self.can_undo:
            raise BadInput("nothing to undo")
        assert self._at is not None
        self._future.append(self._at)
        self._at = self._past.pop()

    def redo(self) -> None:
        """Undo the last `undo`."""
        if not self.can_redo:
            raise BadInput("nothing to do again")
        assert self._at is not None
        self._past.append(self._at)
        self._at = self._future.pop()

    @property
    def can_undo(self) -> bool:
        """Whether there is a model to go back to."""
        return bool(self._past)

    @property
    def can_redo(self) -> bool:
        """Whether an `undo` can be undone."""
        return bool(self._future)

    def path(self, number: int) -> list[Model]:
        """The models from the first to this one."""
        path = [self[number]]
        while path[0].parent is not None:
            path.insert(0, self[path[0].parent])
        return path

    def children(self, number: int) -> list[Model]:
        """The models that grew out of this one."""
        return [model for model in self._models if model.parent == number]

    def depth(self, number: int) -> int:
        """How many models lead to this one."""
        return len(self.path(number)) - 1

    def find(self, effects: Sequence[str]) -> Model | None:
        """A model with just these effects, None where none was fitted."""
        return next((model for model in self._models if set(model.effects) == set(effects)), None)

    def learn(self, number: int, **known: Any) -> None:
        """Keep what has been found out about a model: ``findings``, ``ranking``, ``causes``, or why not (``refused``)."""
        self._models[number] = replace(self[number], **known)
