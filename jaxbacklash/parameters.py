"""A parameter: a scalar with a unit, bounds and the null value at which its law vanishes.

Every leaf of a law or of a whole system is such a scalar, so the leaves of the pytree, in order, are the
parameter vector. Names are the paths to the leaves (``gravity.G``); the base model's three parameters and the
inertia have bare names.
"""

from __future__ import annotations

import dataclasses
import functools
from typing import Any, TypeVar

import equinox as eqx
import jax
import numpy as np

Scalar = Any  # a Python float, or a zero-dimensional float64 array, or a tracer
Tree = TypeVar("Tree")


@dataclasses.dataclass(frozen=True)
class Spec:
    """What is known about a parameter before any data.

    Attributes: ``unit`` for a rotating joint (``translational`` rewrites it), ``null`` the value at which the law
    vanishes (None: a shape parameter, not identified at null), ``lower``/``upper`` physical bounds, ``fixed`` True
    for a numerical setting that is never fitted, ``scale`` a typical size of a change, ``label`` words for reports, ``usual``
    the value of a shape at which a fit holds it: it is free in a law that has another one.
    """

    unit: str = "1"
    null: float | None = None
    lower: float = -np.inf
    upper: float = np.inf
    fixed: bool = False
    scale: float | None = None
    label: str = ""
    usual: float | None = None

    @property
    def positive(self) -> bool:
        """True when the value cannot be zero or change its sign."""
        return self.lower >= 0 and self.null is None


def _scalar(value: Any) -> Any:
    # Numbers become float64 at birth so that a law built from an int compiles to the same program.
    if isinstance(value, int | float | np.ndarray | np.generic):
        return np.asarray(value, dtype=np.float64)
    return value


def param(*, default: float | None = None, required: bool = False, **spec: Any) -> Any:
    """Declare a parameter as a field of a law; see `Spec` for the keywords.

    Without a ``default`` the null or usual value is taken, else the lower bound, else zero, so that a law can be built before
    its values are known; ``required`` parameters must be given.

    Examples
    --------
    >>> class Tide(jb.AbstractEffect):
    ...     amplitude: float = jb.param(unit="N m", null=0.0)
    ...
    ...     def torque(self, now):
    ...         return self.amplitude * jnp.sin(now.t)
    >>> float(Tide(2.0).amplitude), float(Tide().amplitude)
    (2.0, 0.0)
    """
    described = Spec(**spec)
    keywords: dict[str, Any] = {"metadata": {"spec": described}, "converter": _scalar}
    if not required:
        fallback = described.lower if np.isfinite(described.lower) else 0.0
        told = described.null if described.usual is None else described.usual
        known = told if default is None else default
        keywords["default"] = float(fallback if known is None else known)
    return eqx.field(**keywords)


@functools.cache
def _fields(cls: Any) -> tuple[tuple[str, Spec | None, bool], ...]:
    """Name, description and whether it lends no name to what it holds, of each field of a class that may hold parameters."""
    return tuple(
        (field.name, field.metadata.get("spec"), field.metadata.get("bare", False))
        for field in dataclasses.fields(cls)
        if not field.metadata.get("static", False)
    )


def _walk(node: Any, prefix: str) -> list[tuple[str, Spec]]:
    if node is None:
        return []
    if isinstance(node, dict):  # pytrees sort the keys of a dict, so names must follow
        return [pair for key in sorted(node) for pair in _walk(node[key], f"{prefix}{key}.")]
    found: list[tuple[str, Spec]] = []
    kind: Any = node if isinstance(node, type) else node.__class__  # a law's class tells as much as one of its kind
    for name, spec, bare in _fields(kind):
        if spec is not None:
            found.append((prefix + name, spec))
        else:
            found += _walk(getattr(node, name), prefix if bare else f"{prefix}{name}.")
    return found


def specs(tree: Any) -> dict[str, Spec]:
    """Names and descriptions of all parameters of a law or system, in the order of its leaves."""
    return dict(_walk(tree, ""))


def free_specs(tree: Any) -> dict[str, Spec]:
    """The same without those that are not fitted: settings, and shapes that have their usual value."""
    present = values(tree)
    return {name: spec for name, spec in specs(tree).items() if not spec.fixed and spec.usual != present[name]}


def ravel(tree: Any) -> np.ndarray:
    """All parameter values as one vector, shape (number of parameters,), in the order of `specs`."""
    return np.array([float(leaf) for leaf in jax.tree.leaves(tree)])


def values(tree: Any) -> dict[str, float]:
    """Parameter values by name."""
    return dict(zip(specs(tree), (float(leaf) for leaf in jax.tree.leaves(tree))))


def unravel(tree: Tree, vector: Any) -> Tree:
    """The same law or system with the values of ``vector``; works inside jit, grad and vmap."""
    leaves, treedef = jax.tree.flatten(tree)
    return jax.tree.unflatten(treedef, [vector[i] for i in range(len(leaves))])


def replace(tree: Tree, **changes: float) -> Tree:
    """The same system with some parameters changed by name (write dots as double underscores).

    Raises
    ------
    KeyError
        A name that the system does not have.
    """
    return with_values(tree, {name.replace("__", "."): value for name, value in changes.items()})


def with_values(tree: Tree, changes: dict[str, float]) -> Tree:
    """The same system with the named parameters changed; raises KeyError for an unknown name."""
    names = list(specs(tree))
    unknown = sorted(set(changes) - set(names))
    if unknown:
        raise KeyError(f"no parameter {', '.join(unknown)}; there are {', '.join(names)}")
    leaves = [changes.get(name, leaf) for name, leaf in zip(names, jax.tree.leaves(tree))]
    return jax.tree.unflatten(jax.tree.structure(tree), [_scalar(leaf) for leaf in leaves])


_TRANSLATIONAL = {
    "rad": "m", "N m": "N", "N m/rad": "N/m", "N m s/rad": "N s/m", "kg m^2": "kg", "rad/s": "m/s",
    "N m/rad^3": "N/m^3", "N m s/rad^2": "N s/m^2", "N m s^2/rad^2": "N s^2/m^2", "N m s^2/rad": "kg", "1/rad": "1/m",
}  # fmt: skip
_PER_INERTIA = {
    "rad": "rad", "N m": "rad/s^2", "N m/rad": "1/s^2", "N m s/rad": "1/s", "kg m^2": "1", "rad/s": "rad/s",
    "N m/rad^3": "1/(rad^2 s^2)", "N m s/rad^2": "1/(rad s)", "N m s^2/rad^2": "1/rad", "N m s^2/rad": "1",
}  # fmt: skip


def unit_text(unit: str, *, translational: bool = False, per_inertia: bool = False) -> str:
    """A unit as it is to be printed: rewritten for a translating mass, or for values per unit inertia."""
    if per_inertia:
        text = _PER_INERTIA.get(unit, unit)
        return text.replace("rad", "m") if translational else text
    return _TRANSLATIONAL.get(unit, unit) if translational else unit


def per_kt(unit: str) -> str:
    """A unit of a torque, or of what goes with one, where the torque is a current whose N m for an ampere nobody told."""
    return f"{unit} per N m/A" if _PER_INERTIA.get(unit, unit) != unit and unit not in ("rad", "rad/s") else unit


def channel_unit(name: str, *, translational: bool = False) -> str:
    """The unit of a channel of a record: of a force for ``F`` and ``T``, of a motion for the others."""
    return unit_text("N m" if name in ("F", "T", "torque") else "rad", translational=translational)
