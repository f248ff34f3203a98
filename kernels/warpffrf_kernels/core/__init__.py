"""Basis of all kernels: scalars, rotations, the model, control words, declarations, time-integration formulas."""
