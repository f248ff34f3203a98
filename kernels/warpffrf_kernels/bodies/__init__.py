"""Motion and inertia of bodies, their modes and interfaces."""
