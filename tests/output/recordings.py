"""What a .rrd file holds, read back."""

from __future__ import annotations

from datetime import timedelta
from operator import itemgetter
from pathlib import Path
from typing import Any


def columns(path: Path, entity: str, component: str) -> list[Any]:
    """All values logged for one component of one entity, in the order of their times: that of chunks depends on the
    clock."""
    from rerun.chunk import RrdReader

    found = []
    for chunk in RrdReader(str(path)).stream().filter(content=entity):
        batch = chunk.to_record_batch()
        times = batch.column("time").to_pylist() if "time" in batch.schema.names else [timedelta()] * batch.num_rows
        for name in batch.schema.names:
            if name.endswith(component):
                found += zip(times, batch.column(name).to_pylist(), strict=True)
    return [value for _, value in sorted(found, key=itemgetter(0)) if value is not None]
