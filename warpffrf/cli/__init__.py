"""The command line, `warpffrf ...`: a file for each group of commands, put together in `program`."""

from warpffrf.cli.program import app, main

__all__ = ["app", "main"]
