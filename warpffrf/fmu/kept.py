"""Names of scripts of FMUs that are held.

pythonfmu 0.7 releases the global names of the script of an FMU once too often each time that an instance is made: the
second one would find none.
"""

from __future__ import annotations

from typing import Any

_kept: list[dict[str, Any]] = []


def keep(names: dict[str, Any]) -> None:
    """Hold these names as long as Python runs."""
    _kept.append(names)
