"""Lumped contacts of rigid surfaces: nearest places, laws of approach, friction, forces and their tangent."""
