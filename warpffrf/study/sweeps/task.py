"""The function sent to workers. Its imports take seconds: they are made by the worker, in the thread that runs it, and
not by the scheduler, which only reads the name of the function."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from warpffrf.study.sweeps.payload import Payload


def answers(payload: Payload, rows: Sequence[tuple[int, dict[str, Any]]], device: str | None) -> list[Any]:
    """Run the rows of a payload in this process; a list of `Answer`."""
    from warpffrf.study.sweeps.packing import answers_of

    return answers_of(payload, rows, device)
