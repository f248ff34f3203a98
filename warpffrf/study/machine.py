"""The unit U of step times: one LAPACK Cholesky factorisation and solution of size 128, float64, one thread.

Step times in seconds depend on the machine more than on the program. U is dense arithmetic of the size and kind of the
contact solution, so that `step / U` can be compared between machines. It is timed in a separate process, because the
thread count of a BLAS is fixed when it is loaded.
"""

from __future__ import annotations

import os
import platform
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

from warpffrf.model.reduced.body import library_versions

SIZE = 128
REPEATS = 50  # per sample: 5 ms, far above the clock's resolution
SAMPLES = 20  # the fastest is used: disturbances only increase times
ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")


def unit_seconds() -> float:
    """Seconds of one `potrf` + `potrs` (one right-hand side) of size 128 on one thread of this machine, now."""
    environment = {**os.environ, **dict.fromkeys(ONE_THREAD, "1")}
    command = [sys.executable, "-m", "warpffrf.study.machine"]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return float(done.stdout)


def timed_here() -> float:
    """The same in this process, with the present number of BLAS threads."""
    import numpy as np
    from scipy.linalg import get_lapack_funcs

    x = np.random.default_rng(0).standard_normal((SIZE, SIZE))
    A = np.asfortranarray(x @ x.T + SIZE * np.eye(SIZE))
    b = np.ones((SIZE, 1))
    potrf, potrs = get_lapack_funcs(("potrf", "potrs"), (A, b))
    best = np.inf
    for _ in range(SAMPLES):
        begin = time.perf_counter()
        for _ in range(REPEATS):
            factor, _ = potrf(A)
            potrs(factor, b)
        best = min(best, (time.perf_counter() - begin) / REPEATS)
    return best


def processor() -> str:
    """The model of the processor, as reported by the system."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    models = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return (models or [platform.processor() or platform.machine()])[0]


def machine() -> dict[str, Any]:
    """Description of the machine of the timings."""
    return {
        "machine": {
            "platform": platform.platform(),
            "processor": processor(),
            "cores": os.cpu_count(),
            "python": platform.python_version(),
        },
        "versions": library_versions(("warpffrf", "warp-lang", "numpy", "scipy")),
        "unit_seconds": unit_seconds(),
    }


if __name__ == "__main__":
    print(repr(timed_here()))
