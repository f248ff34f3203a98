"""Constants of a scene: the declared arrays of the model, filled topic by topic."""

from __future__ import annotations

from typing import Any

import numpy as np
import warp as wp

from warpffrf.model.errors import InputError
from warpffrf.online.settings import LARGEST_INDEX
from warpffrf_kernels.core.declaration import Declaration, parts

WITHIN = {wp.vec3d: (3,), wp.mat33d: (3, 3)}  # numbers per entry


class Shared:
    """Arrays that scenes have in common, which differ in numbers only: each is on the device once. To be kept no
    longer than until the last of them is compiled, as it keeps their numbers on the host as well.
    """

    def __init__(self) -> None:
        self._first: dict[str, tuple[np.ndarray, Any]] = {}

    def array(self, label: str, data: np.ndarray, dtype: Any, device: str) -> Any:
        """The array of the first scene where it has the same bits, else a new one."""
        known = self._first.get(label)
        if known is not None and _same_bits(known[0], data):
            return known[1]
        made = wp.array(data, dtype=dtype, device=device)
        self._first.setdefault(label, (data, made))
        return made


def _same_bits(a: np.ndarray, b: np.ndarray) -> bool:
    return a is b or (
        a.shape == b.shape and a.dtype == b.dtype and np.array_equal(a.view(np.uint32), b.view(np.uint32))
    )


class Constants:
    """Fills topics of `warpffrf_kernels.core.model`; `sizes`: of all axes so far, with which later arrays have to
    agree.
    """

    def __init__(self, device: str, shared: Shared | None = None) -> None:
        self.device = device
        self.sizes: dict[str, int] = {}
        self.shared = shared

    def fill(self, topic: Any, **values: Any) -> None:
        """Set numbers and arrays of a topic by name; arrays in the declared shapes, or empty.

        Raises TypeError for an array whose length differs from others along the same axis, InputError for one longer
        than the indices of kernels reach.
        """
        for name, value in values.items():
            declaration = topic.declarations.get(name)
            if declaration is None:
                setattr(topic, name, value)
            else:
                setattr(topic, name, self._array(f"{type(topic).__name__}.{name}", declaration, value))

    def _array(self, label: str, declaration: Declaration, values: Any) -> Any:
        kind = np.int32 if declaration.dtype is wp.int32 else np.float64
        data = np.ascontiguousarray(values, dtype=kind)
        if data.size > LARGEST_INDEX:
            raise InputError(
                f"scene: a table of {data.size} numbers is needed, at most {LARGEST_INDEX} can be indexed; reduce with "
                "a coarser contact grid, ContactGrid(spacing=)"
            )
        within = WITHIN.get(declaration.dtype, ())
        if data.size == 0:  # one unused entry, so that it can be passed to kernels
            self._meet(label, declaration.axes[0], 0)
            data = np.zeros((*(n if isinstance(n, int) else 1 for n in declaration.axes), *within), kind)
        else:
            if data.shape[declaration.ndim :] != within:
                raise TypeError(f"{label}: {data.shape} is no array of {declaration.ndim} axes")
            for axis, n in zip(declaration.axes, data.shape, strict=False):
                self._meet(label, axis, n)
        if self.shared is not None:
            return self.shared.array(label, data, declaration.dtype, self.device)
        return wp.array(data, dtype=declaration.dtype, device=self.device)

    def _meet(self, label: str, axis: str | int, n: int) -> None:
        """Take the size of an axis from the first array that has it, and compare those of the others."""
        if isinstance(axis, int):
            known, found = axis, n
        else:
            factor, name, more = parts(axis)
            found = max(n - more, 0) // factor
            known = self.sizes.setdefault(name, found)
        if known != found:
            raise TypeError(f"{label}: {n} entries along {axis!r}, {known} were expected")
