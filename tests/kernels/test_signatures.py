"""Kernels take the run first, then topics, then arrays; what they read and write is found in their source."""

from __future__ import annotations

import ctypes
import importlib
import inspect
import pkgutil
import re
from typing import Any

import pytest
import sample_kernels
import warp as wp

import warpffrf_kernels
from launch_order.access import access_of
from warpffrf.online.arrays.declaration import topic_of
from warpffrf_kernels.core.model import Elements, Model
from warpffrf_kernels.core.run import Run

MODULES = [
    importlib.import_module(m.name) for m in pkgutil.walk_packages(warpffrf_kernels.__path__, "warpffrf_kernels.")
]
KERNELS: dict[str, Any] = {
    f"{module.__name__.split('.')[-1]}.{name}": kernel
    for module in MODULES
    for name, kernel in vars(module).items()
    if isinstance(kernel, wp.Kernel)
}


def parameters(kernel: Any) -> dict[str, Any]:
    return inspect.get_annotations(kernel.func)


@pytest.mark.parametrize("name", KERNELS)
def test_kernels_use_what_they_take(name: str) -> None:
    kernel = KERNELS[name]
    kinds = [topic_of(kind) for kind in parameters(kernel).values()]
    order = [0 if kind is Run else 2 if kind is None else 1 for kind in kinds]
    assert order == sorted(order)
    for parameter in parameters(kernel):
        assert len(re.findall(rf"\b{parameter}\b", inspect.getsource(kernel.func))) > 1, f"{parameter} is not used"
    access = access_of(kernel)
    assert access.written
    given = parameters(kernel).items()
    arrays = {name for name, kind in given if isinstance(kind, wp.array) and topic_of(kind) is None}
    assert arrays - {"patterns"} <= access.read | access.written


def test_access_is_found() -> None:
    """Directly, through a function, in C++, and in topics."""
    names = ("direct", "kept", "idle", "indirect", "atomic", "of_topics")
    found = {name: access_of(getattr(sample_kernels, name)) for name in names}
    assert {name: (a.read, a.written, a.changed) for name, a in found.items()} == {
        "direct": ({"x"}, {"y"}, set()),
        "kept": ({"x", "y"}, {"y"}, set()),
        "idle": (set(), set(), set()),
        "indirect": ({"x", "z"}, {"y", "z"}, {"z"}),
        "atomic": ({"x", "y"}, {"y"}, {"y"}),
        "of_topics": ({".q", ".qd", ".v", ".v_rate"}, {".qd_rate", ".v"}, {".v"}),
    }


def test_kernels_and_what_they_write_are_found() -> None:
    """What is known of some of them, so that the search itself is not empty."""
    assert len(KERNELS) > 100
    written = access_of(KERNELS["line_of_centres_points.weigh"]).written
    assert written == {".ctl", ".weak_gap", ".area", ".stencil", ".stencil_at"}
    assert {"bordered_rhs", ".elimination", ".solution", ".pressure", ".z"} <= access_of(
        KERNELS["pressure_solve.solve_pressures"]
    ).written


@pytest.mark.parametrize("struct", [Model, Elements])
def test_structs_are_small_enough_for_cuda(struct: Any) -> None:
    """Of the model kernels take a copy; above 8 KiB, of its elements, too, a module took minutes to compile for sm_90
    instead of seconds."""
    assert ctypes.sizeof(struct.ctype) <= 8192
