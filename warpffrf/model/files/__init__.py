"""Files of any kind: regular, sealed, HDF5, arrays of objects, and paths that are written to."""
