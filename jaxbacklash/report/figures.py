"""The figures of a report. Each takes arrays or entries of result.json and returns a `matplotlib.figure.Figure`."""

from .drawing import to_png_data_uri as to_png_data_uri
from .drawing import to_svg as to_svg
from .figures_criticism import missing_torque_curve as missing_torque_curve
from .figures_criticism import missing_torque_in_time as missing_torque_in_time
from .figures_criticism import missing_torque_surface as missing_torque_surface
from .figures_criticism import where_it_fails as where_it_fails
from .figures_frf import frequency_response as frequency_response
from .figures_joint import force_loop as force_loop
from .figures_joint import phase_plane as phase_plane
from .figures_joint import restoring_force as restoring_force
from .figures_model import candidate_ranking as candidate_ranking
from .figures_model import error_by_stage as error_by_stage
from .figures_model import misfit_profile as misfit_profile
from .figures_skeleton import backbone_and_damping as backbone_and_damping
from .figures_skeleton import envelopes as envelopes
from .figures_skeleton import instantaneous_frequency as instantaneous_frequency
from .figures_skeleton import ridge_over_scalogram as ridge_over_scalogram
from .figures_skeleton import skeleton_force as skeleton_force
from .figures_time import measured_against_model as measured_against_model
from .figures_time import residual_in_time as residual_in_time
