"""Solvers of our own: many located panels in one step, and the same as diffrax solvers in `panel_solver`."""

from .panels import Cubic as Cubic
from .panels import advance as advance
from .panels import advance_smooth as advance_smooth
from .substeps import one_panel as one_panel
from .substeps import run_panels as run_panels
