"""Contact on exact elastic half-planes and half-spaces, with nodal functions and cells: references without a body."""
