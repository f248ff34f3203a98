"""What a .rrd file holds, read back."""

from __future__ import annotations

from pathlib import Path
from typing import Any


def columns(path: Path, entity: str, component: str) -> list[Any]:
    """All values logged for one component of one entity, in order, flattened over chunks."""
    from rerun.chunk import RrdReader

    values = []
    for chunk in RrdReader(str(path)).stream().filter(content=entity):
        batch = chunk.to_record_batch()
        for name in batch.schema.names:
            if name.endswith(component):
                values += batch.column(name).to_pylist()
    return [v for v in values if v is not None]
