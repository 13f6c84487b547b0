"""What a fit by shooting asks: windows, a system with parameters that are free, and the unknowns to be found."""

from __future__ import annotations

from typing import Any, TypeVar

import equinox as eqx

from ..parameters import unravel
from ..system import System
from .windows import Windows

Array = Any


class Unknowns(eqx.Module):
    """``theta`` (q,) free parameters in units of their scale; ``starts`` (n, W); ``coefficients`` (W, m)."""

    theta: Array
    starts: Array
    coefficients: Array


Part = TypeVar("Part", bound=eqx.Module)


def changed(module: Part, **fields: Any) -> Part:
    """The same module with other fields: what `equinox.tree_at` does, without the milliseconds that its checks take.

    Examples
    --------
    >>> changed(Unknowns(1.0, 2.0, 3.0), theta=4.0).theta
    4.0
    """
    new: Part = object.__new__(type(module))
    for name, value in (vars(module) | fields).items():
        object.__setattr__(new, name, value)
    return new


class Problem(eqx.Module):
    """Windows, a system, and which of its parameters are free.

    ``base`` (p,) all parameter values; ``directions`` (p, q) how they move with the free ones (column j: scale of free
    parameter j at its place); ``lower``, ``upper`` (q,) bounds in the same units; ``shrink`` (q,) True where a value must
    keep its sign, so that no step may take it below a third or above three times; ``tie`` overall weight of the ties;
    ``active`` how many of the q directions are not zero, those first.
    """

    windows: Windows
    system: System
    base: Array
    directions: Array
    lower: Array
    upper: Array
    shrink: Array
    tie: Array
    active: Array

    def parameters(self, theta: Array) -> Array:
        """All parameter values, shape (p,)."""
        return self.base + self.directions @ theta

    def rebuild(self, theta: Array) -> System:
        """The system with the free parameters at ``theta``."""
        return unravel(self.system, self.parameters(theta))
