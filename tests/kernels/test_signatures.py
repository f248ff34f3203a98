"""Signatures of kernels say what they do: constants first, then what is read, then what is written, marked so."""

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
from kernel_access import access_of

import warpffrf_kernels
from warpffrf_kernels.core.access import is_read, is_written
from warpffrf_kernels.core.model import Elements, Model

MODULES = [
    importlib.import_module(m.name) for m in pkgutil.walk_packages(warpffrf_kernels.__path__, "warpffrf_kernels.")
]
CONSTANTS = ("models", "patterns")  # of the scene, in structs
KERNELS: dict[str, Any] = {
    f"{module.__name__.split('.')[-1]}.{name}": kernel
    for module in MODULES
    for name, kernel in vars(module).items()
    if isinstance(kernel, wp.Kernel)
}


def marks(kernel: Any) -> dict[str, Any]:
    """Annotations of the arrays of a kernel, in order, but for the constants of the scene."""
    parameters = inspect.signature(kernel.func).parameters
    found = {name: p.annotation for name, p in parameters.items() if isinstance(p.annotation, wp.array)}
    return {name: annotation for name, annotation in found.items() if name not in CONSTANTS}


def complaints(kernel: Any) -> list[str]:
    """What the signature says that the source does not do, and the other way round."""
    access, found = access_of(kernel), []
    arrays = marks(kernel)
    for name, annotation in arrays.items():
        if is_written(annotation) != (name in access.written):
            found.append(f"{name} is written" if name in access.written else f"{name} is marked, but not written")
        elif not is_written(annotation) and name not in access.read:
            found.append(f"{name} is not used")
        elif is_written(annotation) and is_read(annotation) and name not in access.read:
            found.append(f"{name} is set, not read")
    order = [is_written(annotation) for annotation in arrays.values()]
    if order != sorted(order):
        found.append("arrays that are written stand before some that are read")
    if not any(order):
        found.append("nothing is marked as written")
    return found


@pytest.mark.parametrize("name", KERNELS)
def test_signatures_say_what_kernels_do(name: str) -> None:
    kernel = KERNELS[name]
    assert not complaints(kernel)
    parameters = list(inspect.signature(kernel.func).parameters)
    assert parameters[0] == "models" or "models" not in parameters
    for parameter in parameters:
        assert len(re.findall(rf"\b{parameter}\b", inspect.getsource(kernel.func))) > 1, f"{parameter} is not used"


def test_the_check_can_fail() -> None:
    """Directly, through a function, and in C++."""
    assert (
        not complaints(sample_kernels.right)
        and not complaints(sample_kernels.indirect)
        and not complaints(sample_kernels.atomic)
    )
    assert complaints(sample_kernels.unmarked) == ["y is written", "nothing is marked as written"]
    assert complaints(sample_kernels.not_read) == ["y is set, not read"]
    assert complaints(sample_kernels.early) == ["arrays that are written stand before some that are read"]
    access = access_of(sample_kernels.indirect)
    assert (access.read, access.written) == ({"x", "z"}, {"y", "z"})


def test_kernels_and_what_they_write_are_found() -> None:
    """What is known of some of them, so that the search itself is not empty."""
    assert len(KERNELS) > 100
    written = access_of(KERNELS["line_of_centres_weights.weigh"]).written
    assert written == {"ctl", "weak_gap", "area", "wrench", "stencil", "stencil_at"}
    assert {"bordered_rhs", "work", "solution", "pressure", "z"} <= access_of(
        KERNELS["pair_elimination.solve_pressures"]
    ).written


@pytest.mark.parametrize("struct", [Model, Elements])
def test_structs_are_small_enough_for_cuda(struct: Any) -> None:
    """Of the model kernels take a copy; above 8 KiB, of its elements, too, a module took minutes to compile for sm_90
    instead of seconds."""
    assert ctypes.sizeof(struct.ctype) <= 8192
