"""The cache of reduced bodies: an unchanged input is never reduced twice.

The key is a sha256 over the mesh's content, material, all settings, and the schema and code versions; moving one node
by 1 nm changes it. Entries are ordinary reduced-body files that state their key. An entry that cannot be read, or has
another key, is reported, deleted and recomputed.
"""

from __future__ import annotations

import hashlib
import json
import logging
import os
import sys
from pathlib import Path
from typing import Any

from warpffrf.model.errors import InputError
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.file import SCHEMA
from warpffrf.offline.general.checkpoint import SUFFIX

logger = logging.getLogger("warpffrf.offline")
METHOD = 14  # incremented whenever the reduction gives other numbers for the same input
VARIABLE = "WARPFFRF_CACHE"


def cache_folder() -> Path:
    """Folder of the cache: `WARPFFRF_CACHE` if set, otherwise the platform's cache folder."""
    if chosen := os.environ.get(VARIABLE):
        return Path(chosen)
    if sys.platform == "win32":
        root = Path(os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local")
    elif sys.platform == "darwin":
        root = Path.home() / "Library" / "Caches"
    else:
        root = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    return root / "warpffrf" / "reduced"


def cache_key(settings: dict[str, Any]) -> str:
    """sha256 of the settings (plain data, mesh hash included), schema and method."""
    text = json.dumps({"settings": settings, "schema": SCHEMA, "method": METHOD}, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()


def work_file(key: str) -> Path:
    """File with the finished parts of an interrupted reduction."""
    return cache_folder() / f"{key}{SUFFIX}"


def load_cached(key: str) -> ReducedBody | None:
    """The cached body, or None if it does not exist, cannot be read, or has another key."""
    path = cache_folder() / f"{key}.h5"
    if not path.is_file():
        return None
    try:
        body = ReducedBody.load(path)
        if body.provenance.get("key") != key:
            raise InputError(f"reduced body: {path} is not of the input of its name")
        return body
    except InputError as error:
        logger.warning("cache entry dropped: %s", error)
        try:
            path.unlink(missing_ok=True)
        except OSError:
            pass
        return None


def store(key: str, body: ReducedBody) -> str | None:
    """Store `body` in the cache; returns the reason if that fails (a full or read-only disk must not lose the
    result)."""
    folder = cache_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        body.save(folder / f"{key}.h5", overwrite=True)
    except (OSError, InputError) as error:
        logger.warning("the reduced body could not be cached: %s", error)
        return f"not cached: {error}"
    return None
