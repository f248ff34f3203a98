"""Pressures on contact-fixed cells of a pair: half-space near field, far fields of both bodies."""
