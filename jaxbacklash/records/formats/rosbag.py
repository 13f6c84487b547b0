"""Recordings of robots: ROS 1 (.bag) and ROS 2 (.db3) bags, through rosbags."""

from __future__ import annotations

import contextlib
import tempfile
from collections.abc import Iterator
from pathlib import Path

from ..table import Table
from .guard import guarded, library
from .messages import Topics

WAY_OUT = "a complete bag (rosbag reindex, or ros2 bag reindex, repairs one that was not closed)"

FIRST = b"#ROSBAG V"
"""How a bag of ROS 1 begins."""


def read(path: Path) -> Table:
    """The numbers in the messages of a bag, "topic/field".

    Parameters
    ----------
    path : Path
        A .bag file, a .db3 file, or a folder that ROS 2 recorded.

    Returns
    -------
    Table
        See `messages.Topics`. Topics of types that the bag does not describe are left out by name.

    Raises
    ------
    BadInput
        rosbags is missing, or the bag is damaged or was not closed.
    """
    highlevel = library("rosbags.highlevel", "rosbags", path, "a ROS bag")
    typesys = library("rosbags.typesys", "rosbags", path, "a ROS bag")
    topics = Topics()
    with guarded(path, "a file that is damaged or no ROS bag", WAY_OUT):
        suffix = ".bag" if _begins(path) == FIRST else ".db3"
        default = typesys.get_typestore(typesys.Stores.LATEST)
        with _named(path, suffix) as named, highlevel.AnyReader([named], default_typestore=default) as bag:
            known = [one for one in bag.connections if one.msgtype in bag.typestore.types]
            for one in bag.connections:
                if one not in known:
                    topics.left_out[one.topic.strip("/")] = f"messages of the type {one.msgtype}, which the bag does not describe"
            for connection, received, raw in bag.messages(connections=known) if known else ():
                topics.add(connection.topic, bag.deserialize(raw, connection.msgtype), received)
        return topics.table("ros1 bag" if suffix == ".bag" else "ros2 bag", {"topics": str(len(topics.received))})


def _begins(path: Path) -> bytes:
    if path.is_dir():
        return b""
    with open(path, "rb") as file:
        return file.read(len(FIRST))


@contextlib.contextmanager
def _named(path: Path, suffix: str) -> Iterator[Path]:
    """The file under a name with the suffix by which the library tells kinds of bags apart."""
    if path.suffix == suffix or path.is_dir():
        yield path
        return
    with tempfile.TemporaryDirectory() as folder:
        link = Path(folder) / f"bag{suffix}"
        link.symlink_to(path.resolve())
        yield link
