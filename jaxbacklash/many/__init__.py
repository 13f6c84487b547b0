"""Many records, each fitted or refined by itself: one joint over months, or a fleet; rows, their table, and what changed."""

from .each import fit_each as fit_each
from .each import refine_each as refine_each
from .table import Each as Each
