"""The cyclic path: rotationally periodic bodies, one harmonic after the other."""
