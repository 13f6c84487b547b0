"""What in a record may be other than it seems: `find` looks for every row of the table in `rules`, `mend` repairs what was asked.

A reader mends first what the user asked for (`mend.unwrap`, `mend.despiked`, a sign, a ratio), calls `find_in_times` on the times
as they stand in the file and `find` on the channels in SI, raises what refuses or asks, warns of the rest, and lets `mend.after`
leave out what the warnings say is left out.
"""

from .find import find as find
from .find import find_in_times as find_in_times
