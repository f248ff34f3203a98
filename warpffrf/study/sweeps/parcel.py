"""What is sent to workers: a parcel, and the function that opens it there.

Schedulers read what passes through them. So nothing is imported here but what they have, and the seconds that the rest
takes are the worker's.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Parcel:
    """A pickled job or nothing, where it is in the `folder` by its `digest`; and the versions that packed it."""

    content: bytes
    digest: str
    folder: str
    versions: Mapping[str, str]


def answers(parcel: Parcel, rows: Sequence[tuple[int, dict[str, Any]]], device: str | None) -> list[Any]:
    """Run the rows of a parcel in this process; a list of `Answer`."""
    from warpffrf.study.sweeps.packing import answers_of

    return answers_of(parcel, rows, device)
