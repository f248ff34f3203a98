"""Friction on contact-fixed cells: positions, near and far fields along the surface, history, compliance."""
