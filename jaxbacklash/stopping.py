"""How a command ends when it is told to: at once, with one line and the exit code that shells expect.

Python runs signal handlers between two of its own steps, in the main thread alone. While the compiler or a computation is at work
there, that can be a minute later. So a thread of its own waits for the byte that the interpreter's C code writes when a signal
arrives, and ends the process: files that are being written are removed, finished ones (a map's tiles among them) stay.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import signal
import socket
import sys
import threading

from .whole_file import remove_unfinished

EXIT = {"SIGINT": 130, "SIGTERM": 143, "SIGHUP": 129}
"""What the process ends with after each signal: 128 and the signal's number, as shells have it."""

_leave = os._exit  # kept from code of a user that puts something in its place
_pair: tuple[socket.socket, socket.socket] | None = None


def end_when_told() -> None:
    """From now on an interrupt (Ctrl-C), a request to terminate or a closed terminal ends this process within a moment.

    Signals that the process was started to ignore (``nohup``, background jobs) stay ignored. Nothing changes outside the main
    thread, or where no thread can be started: Python's own interrupt then works as far as it goes.
    """
    global _pair
    if threading.current_thread() is not threading.main_thread() or _pair is not None:
        return
    codes = {getattr(signal, name): code for name, code in EXIT.items() if hasattr(signal, name)}
    wanted = [number for number in codes if signal.getsignal(number) not in (signal.SIG_IGN, None)]
    reads, writes = socket.socketpair()  # not a pipe: on Windows only a socket can be woken by a signal
    writes.setblocking(False)
    watcher = threading.Thread(target=_wait, args=(reads, {int(number): codes[number] for number in wanted}), daemon=True)
    try:
        watcher.start()
    except RuntimeError:  # no more threads for this user
        reads.close()
        writes.close()
        return
    _pair = (reads, writes)
    for number in wanted:
        signal.signal(number, _taken)
    signal.set_wakeup_fd(writes.fileno(), warn_on_full_buffer=False)
    # Registered before the libraries load, so that it runs after what they do at the end.
    atexit.register(_no_longer, writes, watcher, wanted)


def end_now(sentence: str, code: int) -> None:
    """End the process from any thread, whatever others are doing: one line on stderr, nothing half written left behind."""
    remove_unfinished()
    with contextlib.suppress(OSError, ValueError, AttributeError):
        # A progress bar may stand on the line and have hidden the cursor.
        clear = b"\r\x1b[2K\x1b[?25h" if sys.stderr.isatty() else b""
        os.write(2, clear + sentence.encode("utf-8", "backslashreplace") + b"\n")
    remove_unfinished()  # another thread may have begun one meanwhile
    _leave(code)


def _taken(number: int, frame: object) -> None:
    """Takes the place of Python's own handler; the thread that waits does all there is to do."""


def _wait(reads: socket.socket, codes: dict[int, int]) -> None:
    with reads:
        while told := reads.recv(1):
            if told[0] in codes:
                end_now("stopped", codes[told[0]])


def _no_longer(writes: socket.socket, watcher: threading.Thread, numbers: list[int]) -> None:
    """At the end of the process: the thread ends and both sockets are closed; a signal ends what is left as the system does."""
    for number in numbers:
        signal.signal(number, signal.SIG_DFL)
    signal.set_wakeup_fd(-1)
    writes.close()  # the other end then reads its end
    watcher.join(1.0)
