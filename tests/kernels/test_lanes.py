"""Reductions over the lanes of a block: sums and maxima, in every lane, of one lane and of many."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from warpffrf_kernels.core.scalars import BLOCK

# kernels need a source file, and the lanes of a block are chosen once in a process
RUN = """
import json, sys
import numpy as np
import warp as wp

wp.config.enable_cpu_blocks = sys.argv[1] == "blocks"
from warpffrf_kernels.core.lanes import most, mosts, total, totals, values
from warpffrf_kernels.core.scalars import BLOCK, real

wp.set_module_options({"enable_backward": False})

@wp.kernel
def fold(x: wp.array2d(dtype=real), found: wp.array3d(dtype=real)):
    w, lane = wp.tid()
    own = x[w, lane]
    found[w, lane, 0] = total(own)
    found[w, lane, 1] = most(own)
    more = totals(values(own, real(1.0), real(lane), -own, own, own, own, real(2.0) * own))
    top = mosts(values(own, real(lane), -real(lane), -own, own, own, own, real(2.0) * own))
    for c in range(8):
        found[w, lane, 2 + c] = more[c]
        found[w, lane, 10 + c] = top[c]

lanes = BLOCK if wp.config.enable_cpu_blocks else 1
x = np.random.default_rng(1).normal(size=(3, lanes))
x[2, lanes // 2 :] = np.nan if lanes > 1 else x[2]
found = wp.zeros((3, lanes, 18), dtype=real, device="cpu")
wp.launch_tiled(fold, dim=(3,), inputs=[wp.array(x, dtype=real, device="cpu"), found], block_dim=BLOCK, device="cpu")
print(json.dumps([x.tolist(), found.numpy().tolist()]))
"""


@pytest.mark.parametrize("mode", ["one", "blocks"])
def test_all_lanes_get_the_sum_and_the_maximum(mode: str, tmp_path: Path) -> None:
    script = tmp_path / f"fold_{mode}.py"
    script.write_text(RUN)
    done = subprocess.run([sys.executable, str(script), mode], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-2000:]
    x, found = (np.array(part) for part in json.loads(done.stdout.splitlines()[-1]))
    count = x.shape[1]
    assert count == (1 if mode == "one" else BLOCK)
    assert np.array_equal(found, np.repeat(found[:, :1], count, axis=1), equal_nan=True)
    lane = np.arange(count)
    for w in range(3):
        own, of_one = x[w], found[w, 0]
        sums = [own.sum(), count, lane.sum(), -own.sum(), own.sum(), own.sum(), own.sum(), 2.0 * own.sum()]
        assert of_one[[0, *range(2, 10)]] == pytest.approx([own.sum(), *sums], abs=1e-14 * count, nan_ok=True)
        high, low = np.nanmax(own), np.nanmin(own)
        tops = [high, count - 1, 0.0, -low, high, high, high, 2.0 * high]
        assert np.array_equal(of_one[[1, *range(10, 18)]], [high, *tops])
