"""Small-sliding contact offline: faces and their overlap, cells, unit loads, and the compliance among all cells."""
