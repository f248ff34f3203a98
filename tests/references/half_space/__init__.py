"""Contact on exact elastic half-planes and half-spaces, in hats and in cells: references without a body around them."""
