"""A process that works on some of many records: asked through its standard input, answering through its standard output.

It is a plain Python process that loads this package and nothing of the caller's, so that a script need not be written for being
loaded a second time, and it ends by itself when the process that asked is gone.
"""

from __future__ import annotations

import gc
import os
import pickle
import struct
import sys
import threading
from typing import IO, Any

HEAD = struct.Struct("<Q")
BEGIN = "from jaxbacklash.many.worker import serve; serve()"
"""What a process is started with."""


def send(pipe: IO[bytes], told: Any) -> None:
    """Write one message."""
    data = pickle.dumps(told, protocol=pickle.HIGHEST_PROTOCOL)
    pipe.write(HEAD.pack(len(data)) + data)
    pipe.flush()


def receive(pipe: IO[bytes]) -> Any:
    """Read one message.

    Raises
    ------
    EOFError
        The other side is gone.
    """
    head = pipe.read(HEAD.size)
    if len(head) < HEAD.size:
        raise EOFError
    (size,) = HEAD.unpack(head)
    data = pipe.read(size)
    if len(data) < size:
        raise EOFError
    return pickle.loads(data)


def serve() -> None:
    """Answer one request after another until there is no more."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever prints does not print into the answers
    asked: list[Any] = []
    there = threading.Semaphore(0)

    def listen() -> None:
        requests = sys.stdin.buffer
        while True:
            try:
                asked.append(receive(requests))
            except BaseException:  # also what cannot be read: there is nobody left to tell
                os._exit(0)  # at once, whatever is being computed
            there.release()

    cache = receive(sys.stdin.buffer)
    from ..program import start

    start(cache=cache, devices=1)
    threading.Thread(target=listen, daemon=True).start()
    from .chunk import begin, rows_of

    # What is loaded by now stays: looking through it for garbage is a fifth of the time.
    gc.collect()
    gc.freeze()
    gc.set_threshold(100_000, 50, 100)
    while True:
        there.acquire()
        wanted, items = asked.pop(0)
        begin(wanted)
        for answer in rows_of(wanted, items):
            send(answers, answer)
        send(answers, None)
