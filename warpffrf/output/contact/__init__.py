"""Quantities from the pressure and tractions of a contact: patch, Hertz, friction, forces, and accuracy of the
stress."""
