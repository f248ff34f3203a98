"""Rows that run as worlds of one graph: `simulate_worlds` of their scenes.

Their numbers are those of single runs, bit for bit on a CPU. Rows run one by one where they cannot run so: where a
scene is of another kind than the first or is wrong, where all of them fail, and with options that worlds do not have.
The table says in how many worlds each row ran.
"""

from __future__ import annotations

import inspect
import logging
from collections.abc import Mapping, Sequence
from typing import Any

from warpffrf.output.result import Result
from warpffrf.output.worlds import simulate_worlds

OTHERS = {"scenes", "device", "progress", "results", "overwrite"}  # arguments that no row has a say in
HAVE = frozenset(inspect.signature(simulate_worlds).parameters) - OTHERS  # options that worlds have


def results_together(
    scenes: Sequence[Any], options: Sequence[Mapping[str, Any]], device: str | None
) -> list[Result] | None:
    """The results of `simulate` of scenes with their options; None where they have to run one by one."""
    first = options[0]
    if not set(first) <= HAVE or "duration" not in first or any(other != first for other in options):
        return None
    try:
        return simulate_worlds(scenes, **first, device=device, progress=False)
    except Exception:  # which of them is at fault, and how, single runs say
        logging.getLogger("warpffrf").debug("sweep: %d worlds failed", len(scenes), exc_info=True)
        return None
