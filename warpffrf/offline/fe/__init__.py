"""Finite-element matrices: quadrature, materials of cells, assembly."""
