"""Errors that runs state, compared with true ones."""
