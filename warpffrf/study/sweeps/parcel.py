"""A job on its way to workers. Schedulers read what passes through them: nothing is imported but what they have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Parcel:
    """A pickled job or nothing, where it is in the `folder` by its `digest`; and the versions that packed it."""

    content: bytes
    digest: str
    folder: str
    versions: Mapping[str, str]
