"""Text tables: from the bytes of a file to the columns it holds, however a logger, scope, spreadsheet or controller wrote them.

`opening` finds the encoding, `layout` the separator and where the table begins, `header` the names and units; `plain` reads
what is a table of numbers throughout with NumPy's reader, `by_cell` all others, with `numbers` for the marks inside numbers.
`read_text` puts these together.
"""

from .read import read_text

__all__ = ["read_text"]
