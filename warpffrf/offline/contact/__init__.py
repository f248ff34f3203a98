"""Contact surfaces offline: grids of tractions, their loads on the mesh, and how fine they may be."""
