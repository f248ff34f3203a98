"""Workers of dask.distributed: the same bits, a worker that is killed, a scheduler that does not answer."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sweep_scenes import IN_TIME, bob, deadly_bob

import warpffrf as wf
from warpffrf.model.errors import InputError

NAME = "body_position_z[bob]"
STIFFNESS = {"stiffness": "1000:6000:6"}
FOLDER = Path(__file__).resolve().parent


def run(store: Path, scene: Any = bob, **options: Any) -> Any:
    return wf.study.sweep(scene, STIFFNESS, outputs=[NAME], store=store, run=IN_TIME, progress=False, **options)


@pytest.fixture
def scheduler(tmp_path: Path) -> Iterator[str]:
    """A scheduler and two workers, started as on a command line; gives the file with its address."""
    file = tmp_path / "scheduler.json"
    environment = {**os.environ, "PYTHONPATH": f"{FOLDER}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"}
    start = partial(subprocess.Popen, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    dask = [sys.executable, "-m", "dask"]
    bare = ["--host", "127.0.0.1", "--no-dashboard"]
    processes = [start([*dask, "scheduler", "--port", "0", "--scheduler-file", str(file), *bare])]
    alone = ["--no-nanny", "--nthreads", "1", "--preload", "warpffrf.study.sweeps.job"]
    at = ["--scheduler-file", str(file), "--local-directory", str(tmp_path), *alone]
    processes += [start([*dask, "worker", *at, *bare]) for _ in range(2)]
    try:
        while not file.exists():
            assert processes[0].poll() is None
            time.sleep(0.05)
        yield str(file)
    finally:
        for process in reversed(processes):
            process.kill()
            process.wait()


@pytest.mark.slow  # four processes that each load the package
def test_a_cluster_gives_the_same_bits_also_where_a_worker_is_killed(scheduler: str, tmp_path: Path) -> None:
    """One of two workers from the command line is killed by a row; the other one runs all that is left."""
    from distributed import Client

    alone = run(tmp_path / "alone")[NAME]
    (tmp_path / "death 0").touch()
    with Client(scheduler_file=scheduler, set_as_default=False) as client:
        client.wait_for_workers(2)
        scene = partial(deadly_bob, folder=str(tmp_path), times=2)
        found = run(tmp_path / "killed", scene, workers=client)
        assert (tmp_path / "death 1").exists()
        assert found.counts == {"completed": 6} and np.array_equal(found[NAME], alone)
        address = client.scheduler_info()["address"]
        found = run(tmp_path / "address", workers=address)
        assert np.array_equal(found[NAME], alone)


def test_a_scheduler_that_does_not_answer_is_named(tmp_path: Path, monkeypatch: Any) -> None:
    from warpffrf.study.sweeps import cluster

    monkeypatch.setattr(cluster, "ANSWERS_IN", 1)
    with pytest.raises(InputError, match="no scheduler answers at 'tcp://127.0.0.1:1'.*dask scheduler"):
        run(tmp_path / "s", workers="tcp://127.0.0.1:1")
    with pytest.raises(InputError, match="no scheduler answers at 'nonsense"):
        run(tmp_path / "t", workers="nonsense://x")
