"""Displacements of half-spaces and quarter spaces under loads on rectangles, and splines of what a body adds to
them."""
