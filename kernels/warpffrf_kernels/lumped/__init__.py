"""Lumped contacts of rigid surfaces: closest points, force laws, friction, forces and their tangent."""
