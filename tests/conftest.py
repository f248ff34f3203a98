"""Set up before any test module is imported: one Warp kernel cache per xdist worker, one BLAS thread per process.

Workers that compile the same kernel into one folder at the same time damage each other's files. The folder stays
between runs so that a second run starts warm; remove `.warp_cache` for a cold one.
"""

from __future__ import annotations

import os
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
_worker = os.environ.get("PYTEST_XDIST_WORKER", "main")
os.environ["WARP_CACHE_PATH"] = str(Path(__file__).resolve().parents[1] / ".warp_cache" / _worker)

DATA = Path(__file__).resolve().parent / "data"
