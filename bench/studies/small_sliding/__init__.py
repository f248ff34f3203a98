"""Small-sliding contact of joints: bases, bolts, sheets, loops, motion."""
