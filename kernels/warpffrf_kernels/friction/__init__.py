"""Stick and slip of the cells of a contact."""
