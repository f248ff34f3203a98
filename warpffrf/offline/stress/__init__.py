"""Stress at chosen points: operators on displacements, and fields for the reduced body."""
