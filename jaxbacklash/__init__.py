"""Backlash, stiffness, damping and the missing physics of a loose joint, from measured motion.

Importing this package changes nothing global. The fits need double precision: call `enable_double_precision` first.
"""

import gc as _gc

# Collecting garbage while a thousand modules load takes a fifth of the time and finds none; what was set is set again below.
_collects = _gc.isenabled()
_gc.disable()

from .criticism import Findings as Findings
from .criticism import Latent as Latent
from .criticism import Ranked as Ranked
from .criticism import Ranking as Ranking
from .criticism import Refinement as Refinement
from .criticism import Surface as Surface
from .criticism import explain_torque as explain_torque
from .criticism import missing_torque as missing_torque
from .criticism import rank_effects as rank_effects
from .criticism import refine as refine
from .criticism import where_it_fails as where_it_fails
from .effects import AsymmetricGap as AsymmetricGap
from .effects import Contact as Contact
from .effects import CoulombGround as CoulombGround
from .effects import CoulombJoint as CoulombJoint
from .effects import CubicStiffness as CubicStiffness
from .effects import Dahl as Dahl
from .effects import Damper as Damper
from .effects import FlexibleLink as FlexibleLink
from .effects import GapSpring as GapSpring
from .effects import Gravity as Gravity
from .effects import LearnedTorque as LearnedTorque
from .effects import LinearGravity as LinearGravity
from .effects import Preload as Preload
from .effects import Spring as Spring
from .errors import BadInput as BadInput
from .errors import NoAnswer as NoAnswer
from .fitting import Fit as Fit
from .fitting import compare as compare
from .fitting import fit as fit
from .fitting import predict_record as predict_record
from .mechanics import AbstractEffect as AbstractEffect
from .mechanics import Instant as Instant
from .mechanics import catalogue as catalogue
from .model_file import dump_model as dump_model
from .model_file import load_model as load_model
from .models import base_motion_joint as base_motion_joint
from .models import case_1 as case_1
from .models import case_2 as case_2
from .models import dimensionless as dimensionless
from .models import forced_oscillator as forced_oscillator
from .models import two_link as two_link
from .parameters import param as param
from .precision import enable_double_precision as enable_double_precision
from .program import start as start
from .records import MeasuredSeries as MeasuredSeries
from .records import Record as Record
from .records import read_record as read_record
from .records import read_series as read_series
from .records import write_record as write_record
from .sensors import SensorDelay as SensorDelay
from .sensors import SensorGain as SensorGain
from .sensors import SensorOffset as SensorOffset
from .simulation import simulate as simulate
from .skeleton import Response as Response
from .skeleton import Skeleton as Skeleton
from .skeleton import Skeletons as Skeletons
from .skeleton import frequency_response as frequency_response
from .skeleton import skeleton as skeleton
from .system import System as System
from .timeseries import ChaosReport as ChaosReport
from .timeseries import chaos as chaos

if _collects:
    _gc.enable()

__version__ = "0.1.0"
