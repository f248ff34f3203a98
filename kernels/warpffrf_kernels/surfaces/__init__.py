"""Contact surfaces: points, normals, charts; which of them serve several pairs."""
