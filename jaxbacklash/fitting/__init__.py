"""From records to parameters: starts, the search, intervals and scores, on the windows of `jaxbacklash.shooting`."""

from .compare import Comparison as Comparison
from .compare import compare as compare
from .estimates import Estimate as Estimate
from .fit import fit as fit
from .fit import predict_record as predict_record
from .result import Fit as Fit
from .score import Score as Score
from .score import error_in_words as error_in_words
from .score import measures as measures
from .score import percent as percent
