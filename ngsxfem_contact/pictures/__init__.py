"""Pictures and VTK files of functions that jump: of any function in V_h, however it was found."""
