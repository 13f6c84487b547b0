"""From the messages of topics, as robots record them, to columns: what ROS bags and MCAP files have in common."""

from __future__ import annotations

import dataclasses
import functools
from array import array
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from ..checks import listed
from ..table import Table
from .clocks import group_columns, with_common_time
from .guard import MAX_BYTES

MAX_ELEMENTS = 64
"""A longer list within a message is a picture or a scan, not a set of channels."""
MAX_DEPTH = 12
NANO = 1_000_000_000
DAY = 86_400 * NANO
STAMP_FIELDS = ("sec", "nanosec")


class Topics:
    """Columns gathered from messages, one topic after the other or mixed.

    The columns are called "topic/field/field"; elements of a list go by the names in the message's list `name`, as in joint
    states ("joint_states/elbow/position"), else by their number ("imu/gains/0").
    """

    def __init__(self) -> None:
        self.series: dict[str, dict[str, array]] = {}
        self.received: dict[str, list[int]] = {}
        self.stamps: dict[str, list[int]] = {}
        self.left_out: dict[str, str] = {}
        self.values = 0

    def add(self, topic: str, message: Any, received: int) -> None:
        """Take one message; ``received`` is the time at which it was recorded [ns]."""
        topic = topic.strip("/")
        rows = len(self.received.setdefault(topic, []))
        self.received[topic].append(received)
        self.stamps.setdefault(topic, []).append(_stamp(message))
        series = self.series.setdefault(topic, {})
        for name, value in self._fields(message, topic, "", 0):
            column = series.setdefault(name, array("d"))
            if len(column) <= rows:
                column.extend([np.nan] * (rows - len(column)))
                column.append(value)
                self.values += 1
        if 8 * self.values > MAX_BYTES:
            raise MemoryError

    def _fields(self, message: Any, topic: str, path: str, depth: int) -> Iterator[tuple[str, float]]:
        """The numbers in a message by their path."""
        fields = _members(message)
        words = fields.get("name") if "name" in fields else fields.get("joint_names")
        names = [str(one) for one in words] if isinstance(words, Sequence) and not isinstance(words, str) else []
        for field, value in fields.items():
            full = f"{path}{field}"
            if field == "header" and not path:
                continue
            yield from self._value(value, topic, full, depth, names, path, field)

    def _value(
        self, value: Any, topic: str, full: str, depth: int, names: list[str], path: str, field: str
    ) -> Iterator[tuple[str, float]]:
        if isinstance(value, bool | int | float | np.number | np.bool_):
            yield full, float(value)
        elif isinstance(value, str | bytes) or value is None or depth > MAX_DEPTH:
            return
        elif isinstance(value, Sequence | np.ndarray):
            if len(value) > MAX_ELEMENTS:
                self.left_out[f"{topic}/{full}"] = f"a list of {len(value)} elements in each message"
                return
            named = len(names) == len(value)
            for number, one in enumerate(value):
                place = f"{path}{names[number]}/{field}" if named else f"{full}/{number}"
                yield from self._value(one, topic, place, depth + 1, [], "", "")
        else:
            members = _members(value)
            if tuple(members) == STAMP_FIELDS:
                yield full, members["sec"] + 1e-9 * members["nanosec"]
            elif members:
                yield from self._fields(value, topic, f"{full}/", depth + 1)

    def table(self, format: str, details: Mapping[str, str]) -> Table:
        """All columns, with times from the messages' own stamps where they carry one, else from when they were recorded."""
        channels, clocks, sources, apart = [], {}, [], []
        for topic, received in self.received.items():
            stamped = all(self.stamps[topic])
            clocks[topic] = self.stamps[topic] if stamped else received
            if self.series[topic]:
                sources.append(f"{topic}: {'as stamped' if stamped else 'as recorded'}")
        earliest = min((min(each) for each in clocks.values()), default=0)
        for topic, series in self.series.items():
            # Simulated times begin at 0, others in 1970: clocks that far apart are not one, and floats would lose their digits.
            own = min(clocks[topic])
            first = earliest if own - earliest < DAY else own
            if first != earliest:
                apart.append(topic)
            clock = np.array([time - first for time in clocks[topic]], dtype=np.float64) / NANO
            for name, values in series.items():
                column = np.frombuffer(values, dtype=np.float64)
                if column.size < clock.size:
                    column = np.concatenate([column, np.full(clock.size - column.size, np.nan)])
                if column.size < 2:
                    self.left_out[f"{topic}/{name}"] = "a single value"
                    continue
                channels.append((topic, name, column, "", clock))
        columns, rate = tuple(group_columns(channels)), None
        if not apart:
            columns, rate = with_common_time(columns)
        note = f"the times of {listed(apart)} are more than a day from the others: each topic is counted from its own beginning"
        details = {**details, "times": listed(sources)}
        return Table(columns, format, details, (note,) if apart else (), rate, left_out=self.left_out)


def _members(message: Any) -> dict[str, Any]:
    """Fields by name, of an object of JSON or of a message class."""
    if isinstance(message, Mapping):
        return {str(name): value for name, value in message.items()}
    kind: Any = type(message)
    return {name: getattr(message, name) for name in _names(kind)}


@functools.cache
def _names(kind: type) -> tuple[str, ...]:
    """Names of the fields of a message class; none for what is no such class."""
    fields = dataclasses.fields(kind) if dataclasses.is_dataclass(kind) else ()
    return tuple(one.name for one in fields if not one.name.startswith("__"))


def _stamp(message: Any) -> int:
    """The stamp in a message's header [ns]; 0 where it has none."""
    stamp = _members(_members(message).get("header", {})).get("stamp")
    members = _members(stamp) if stamp is not None else {}
    if tuple(members) != STAMP_FIELDS:
        return 0
    return int(members["sec"]) * NANO + int(members["nanosec"])
