"""Laps of a run: fields over their cells, losses, slip zones, and places for pictures."""
