"""Opposite points of two surfaces: gaps, their weak form, and windows."""
