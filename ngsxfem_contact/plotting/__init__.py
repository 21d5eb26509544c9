"""Pictures and VTK files of functions that jump: of any function in V_h, however it was found."""

from . import solid_files, solid_plots  # noqa: F401  (what is drawn of bodies in space)
from .front_plots import plot_front
from .plots import draw, plot_body, plot_mesh, plot_profile, save_vtk, von_mises

__all__ = ["draw", "plot_body", "plot_front", "plot_mesh", "plot_profile", "save_vtk", "von_mises"]
