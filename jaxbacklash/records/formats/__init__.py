"""Readers of every format that is not a text table: each returns a `Table`, each through a kept library.

One module for a format, imported only when a file of that format is read; `reader_for` chooses.
"""

from .registry import reader_for as reader_for
