"""Contact surfaces: points, normals, charts; local-mode responses shared by several pairs."""
