"""A property that is worked out when it is first asked for, in whichever threads ask."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, TypeVar, overload

Value = TypeVar("Value")


class once(Generic[Value]):
    """A property that is worked out when it is first asked for.

    As `functools.cached_property`, of which Python 3.11 works out one at a time, whatever it belongs to: pieces of work that wait
    for one another, side by side or in lockstep, would wait for ever.

    Examples
    --------
    >>> class Record:
    ...     length = once(lambda self: print("worked out") or 3)
    >>> record = Record()
    >>> record.length + record.length
    worked out
    6
    """

    def __init__(self, work: Callable[[Any], Value]):
        self.work, self.__doc__ = work, work.__doc__

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, one: None, owner: type) -> once[Value]: ...
    @overload
    def __get__(self, one: object, owner: type) -> Value: ...
    def __get__(self, one, owner):
        if one is None:
            return self
        value = one.__dict__[self.name] = self.work(one)
        return value
