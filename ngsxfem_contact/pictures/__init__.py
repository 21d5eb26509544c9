"""Pictures and VTK files of functions that jump: of any function in V_h, however it was found."""

from .plotting import draw, plot_body, plot_mesh, plot_profile, save_vtk

__all__ = ["draw", "plot_body", "plot_mesh", "plot_profile", "save_vtk"]
