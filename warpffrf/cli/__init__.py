"""The command line, `warpffrf ...`: one module per group of commands, assembled in `program`."""

from warpffrf.cli.program import app, main

__all__ = ["app", "main"]
