"""Oil films between two surfaces: Reynolds' equation with cavities, on the grid of the first, and their forces."""
