"""The half-space's response to the functions of a contact grid, computed with the mesh of the body."""
