"""Pictures and VTK files of functions that jump: of any function in V_h, however it was found."""

from .plots import draw, plot_body, plot_mesh, plot_profile, save_vtk, von_mises

__all__ = ["draw", "plot_body", "plot_mesh", "plot_profile", "save_vtk", "von_mises"]
