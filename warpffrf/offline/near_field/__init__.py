"""What the half-space does under the functions of a contact grid, as the mesh of the body sees it."""
