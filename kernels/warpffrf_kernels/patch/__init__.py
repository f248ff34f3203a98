"""Pressures on cells that travel with the patch of a pair: half-space near field, far fields of both bodies."""
