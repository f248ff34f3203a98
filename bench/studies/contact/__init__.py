"""Normal contact: Hertz, ends, coarse meshes, contact grids, sampling points, impacts."""
