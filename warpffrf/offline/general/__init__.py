"""The general path: any mesh, one factorisation, unit loads in blocks."""
