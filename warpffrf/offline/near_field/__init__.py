"""Deformation near a contact, below what the mesh resolves: closed forms and tables per unit load."""
