"""Recordings in rerun."""
