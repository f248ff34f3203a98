"""Structural finite elements: shells, beams, point masses and springs, with six degrees of freedom a node."""
