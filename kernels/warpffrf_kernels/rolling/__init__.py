"""Friction on cells that travel with the patch: places, near and far fields along the surface, history, compliance."""
