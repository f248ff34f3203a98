"""Rollers with friction on contact-fixed cells and coarse meshes; ten minutes.

Steady rolling and sliding (`rolling_steady`, `rolling_bodies`), and histories (`rolling_changes`).
"""

from __future__ import annotations

from typing import Any

from studies.rolling import rolling_bodies, rolling_changes, rolling_steady

PARTS = (rolling_steady, rolling_bodies, rolling_changes)
HEAD = """# Rollers with friction on contact-fixed cells

Two equal hollow rollers (R 50, bore 15, width 20 mm unless said), everything prescribed at their bores.

"""


def compute() -> list[dict[str, Any]]:
    """The figures of the parts."""
    return [part.compute() for part in PARTS]


def page(found: list[dict[str, Any]]) -> str:
    """The whole page."""
    return HEAD + "".join(part.section(figures) for part, figures in zip(PARTS, found, strict=True))
