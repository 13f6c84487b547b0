"""Records: what was measured, read from a file and refused at birth when it cannot be used."""

from .measured_series import MeasuredSeries as MeasuredSeries
from .measured_series import read_series as read_series
from .orientation import oriented as oriented
from .reader import read_record as read_record
from .record import Record as Record
from .units import parse_columns as parse_columns
from .units import parse_scales as parse_scales
from .units import parse_units as parse_units
from .writer import write_record as write_record
