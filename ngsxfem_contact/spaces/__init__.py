"""The spaces V_h and W_h, what they must be told of tips and meshes, and functions in them."""
