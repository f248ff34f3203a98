"""The function that is sent to workers. What it needs takes seconds to import: those of a worker, in the thread that
runs it, and not of the scheduler, which reads the name of the function."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from warpffrf.study.sweeps.parcel import Parcel


def answers(parcel: Parcel, rows: Sequence[tuple[int, dict[str, Any]]], device: str | None) -> list[Any]:
    """Run the rows of a parcel in this process; a list of `Answer`."""
    from warpffrf.study.sweeps.packing import answers_of

    return answers_of(parcel, rows, device)
