"""MCAP files: messages in JSON, or of ROS 1 and ROS 2, through mcap; the latter two are decoded by rosbags."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..checks import listed, wrong
from ..table import Table
from .guard import MAX_BYTES, guarded, library
from .messages import Topics

WAY_OUT = "a complete .mcap file (mcap recover repairs one that was cut off)"
MAX_RECORD_BYTES = MAX_BYTES // 8
Decode = Callable[[bytes], Any]


def read(path: Path) -> Table:
    """The numbers in the messages of an MCAP file, "topic/field".

    Parameters
    ----------
    path : Path

    Returns
    -------
    Table
        See `messages.Topics`. Topics in other encodings (protobuf, flatbuffer) are left out by name.

    Raises
    ------
    BadInput
        A library is missing, the file is damaged, or no topic is in an encoding that is understood.
    """
    reader = library("mcap.reader", "mcap", path, "an MCAP file")
    topics = Topics()
    with guarded(path, "a file that is damaged or no MCAP file", WAY_OUT), open(path, "rb") as file:
        decoders: dict[int, Decode | None] = {}
        for schema, channel, message in reader.SeekingReader(file, True, record_size_limit=MAX_RECORD_BYTES).iter_messages():
            if channel.id not in decoders:
                decoders[channel.id] = decode = _decoder(schema, channel, path)
                if decode is None:
                    topics.left_out[channel.topic.strip("/")] = f"messages in the encoding {channel.message_encoding}"
            decode = decoders[channel.id]
            if decode is not None:
                topics.add(channel.topic, decode(message.data), message.publish_time or message.log_time)
        if not topics.received and topics.left_out:
            found = f"only {listed(f'{name}: {what}' for name, what in topics.left_out.items())}"
            raise wrong(str(path), found, "messages in JSON or of ROS (cdr, ros1); export the topic as .csv")
        return topics.table("mcap", {"topics": str(len(topics.received))})


def _decoder(schema: Any, channel: Any, path: Path) -> Decode | None:
    """What turns the bytes of a channel's messages into a message; None for an encoding that is not understood."""
    if channel.message_encoding == "json":
        return json.loads
    if channel.message_encoding not in ("cdr", "ros1") or schema is None:
        return None
    typesys = library("rosbags.typesys", "rosbags", path, "an MCAP file with messages of ROS")
    store = typesys.get_typestore(typesys.Stores.EMPTY)
    kind = schema.name if "/msg/" in schema.name else schema.name.replace("/", "/msg/", 1)
    if schema.encoding in ("ros1msg", "ros2msg"):
        store.register(typesys.get_types_from_msg(schema.data.decode(), kind))
    else:
        return None
    deserialize = store.deserialize_ros1 if channel.message_encoding == "ros1" else store.deserialize_cdr
    return lambda data: deserialize(data, kind)
