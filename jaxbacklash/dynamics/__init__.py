"""What a model does: exponents, sections, bifurcation diagrams, basins, and maps over parameters."""

from .basins import Attractor as Attractor
from .basins import Basins as Basins
from .basins import basins as basins
from .bifurcation import bifurcation as bifurcation
from .family import NamedParameters as NamedParameters
from .family import PaperCase as PaperCase
from .lyapunov import Exponents as Exponents
from .lyapunov import field_spectrum as field_spectrum
from .lyapunov import lyapunov_spectrum as lyapunov_spectrum
from .maps import paper_map as paper_map
from .maps import run_map as run_map
from .netcdf import write_netcdf as write_netcdf
from .request import request as request
from .sections import Section as Section
from .sections import poincare as poincare
from .sections import stroboscopic as stroboscopic
