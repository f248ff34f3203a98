"""Laps offline: faces and their overlap, cells, unit loads, and the compliance among all cells of a body."""
