"""Oil films between two surfaces: Reynolds' equation with cavitation, on the grid of the first, and their forces."""
