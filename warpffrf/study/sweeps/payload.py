"""A job in transit to workers. Schedulers unpickle it: only modules available there are imported."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Payload:
    """A pickled job, or None if it is in the `folder` by its `digest`; and the versions of the sender."""

    content: bytes
    digest: str
    folder: str
    versions: Mapping[str, str]
