"""Readers of mesh files, one file per format."""
