"""Set up before any test module is imported: one Warp kernel cache for all workers, one BLAS thread per process.

Whoever loads a module, a test that launches a kernel itself too, has it alone (`warpffrf.online.step.kernel_cache`), so
that a module is compiled once and no worker reads what another one is writing. The folder stays between runs so that a
second run starts warm; remove `.warp_cache` for a cold one. Arrays and launches of tests that name no device are where
runs that name none are: on the CPU, also where there is a GPU, unless `WARPFFRF_DEVICE` says otherwise.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ["WARP_CACHE_PATH"] = str(Path(__file__).resolve().parents[1] / ".warp_cache" / "tests")

import hypothesis
import pytest
import warp as wp

from launch_order.check import complaints
from warpffrf.online.device import chosen_device
from warpffrf.online.step.kernel_cache import sound
from warpffrf.online.step.program import WHOLE, Program
from warpffrf.online.warp_start import start_warp

hypothesis.settings.register_profile("no clock", deadline=None)  # no test depends on how busy the machine is
hypothesis.settings.load_profile("no clock")

DATA = Path(__file__).resolve().parent / "data"

_load = wp.Module.load
_loaded: set[tuple[Any, ...]] = set()


def _load_alone(module: wp.Module, device: Any, block_dim: int | None = None, *rest: Any, **options: Any) -> Any:
    what = (module, str(device), block_dim)
    if what in _loaded:  # every launch asks
        return _load(module, device, block_dim, *rest, **options)
    with sound(module):
        found = _load(module, device, block_dim, *rest, **options)
    _loaded.add(what)
    return found


_begin = Program.__init__
_in_order: set[frozenset[str]] = set()


def _begin_in_order(program: Program, compiled: Any, sizes: Any, *rest: Any) -> None:
    """The order of launches is right in each kind of scene that a test makes."""
    _begin(program, compiled, sizes, *rest)
    kind = frozenset(name for name, size in sizes.items() if size)
    if kind not in _in_order:
        wrong = complaints([(phase, program.parts[phase]) for phase in WHOLE], sizes)
        assert not wrong, "\n".join(wrong)
        _in_order.add(kind)


setattr(wp.Module, "load", _load_alone)  # noqa: B010
setattr(Program, "__init__", _begin_in_order)  # noqa: B010

start_warp()
wp.set_device(chosen_device(None))

SLOW = frozenset(Path(__file__).with_name("slow_tests.txt").read_text(encoding="utf-8").splitlines())


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests that `tests/slow_tests.py` has found slow are marked so, as those whose authors did it."""
    for item in items:
        if item.nodeid in SLOW and "WARPFFRF_TEST_TIMES" not in os.environ:
            item.add_marker("slow")
