"""Contact surfaces: points, normals, charts; surfaces that serve several pairs."""
