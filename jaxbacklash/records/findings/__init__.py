"""What in a record may be other than it seems: `find` looks for every row of the table in `rules`, `mend` repairs what was asked.

A reader calls, in this order: `find_in_times` on the times as they stand in the file; `mend.before` on the channels in SI, which
does what the user asked for; `find` on what comes of it; raises the first finding that refuses or asks, warns of the others; and
`mend.after`, which bridges and leaves out what those warnings say.
"""

from .find import find as find
from .find import find_in_times as find_in_times
