"""How far windows and stencils reach: against bodies placed in the plane of the section."""

from __future__ import annotations

import sys
from pathlib import Path as FilePath
from typing import Any

import numpy as np
import pytest

from warpffrf.model import surfaces
from warpffrf.model.rigid_surface import RigidSurface
from warpffrf.online.compile.windows import MAX_HALF_WINDOW, Extent, facing, half_window, second_reach

sys.path.insert(0, str(FilePath(__file__).parents[1]))
from made_bodies import made_body

Z = np.linspace(-0.01, 0.01, 5)
SIZES = {"shaft": 30.0, "large shaft": 2.0, "plane": 0.0, "bore": -15.0}  # curvatures, 1/m


def surface(curvature: float, columns: int = 180):
    """A contact surface of that curvature; grids all around, on a plane 41 columns."""
    place: dict[str, Any] = {"axis_point": (0.0, 0.0, 0.0), "axis_direction": (0.0, 1.0, 0.0)}
    if curvature == 0.0:
        shape = surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0), direction=(0.0, 1.0, 0.0))
        return made_body(shape, Z, pitch=1e-3, columns=41).contact_surfaces["face"]
    kind = surfaces.Cylinder if curvature > 0.0 else surfaces.Bore
    return made_body(kind(radius=1.0 / abs(curvature), **place), Z, pitch=0.0, columns=columns, periodic=True
                     ).contact_surfaces["face"]  # fmt: skip


@pytest.mark.parametrize(
    ("first", "second"),
    [(a, b) for a in SIZES for b in SIZES if SIZES[a] + SIZES[b] > 0.0],  # a bore does not lie in a wider shaft
)
def test_facing_places(first: str, second: str) -> None:
    """The opposite place is the nearest point of B's circle or line, found among many of its points."""
    a, b = SIZES[first], SIZES[second]
    A, B = (Extent(k, 1.0, 1e-3, 0.02, 0.01, False) for k in (a, b))
    s = np.linspace(-8e-3, 8e-3, 9)
    x = np.sin(a * s) / a if a else s
    y = -(1.0 - np.cos(a * s)) / a if a else 0.0 * s
    t = np.linspace(-0.02, 0.02, 40001)  # arc length on B, whose material lies above
    on_b = np.stack([np.sin(b * t) / b if b else t, (1.0 - np.cos(b * t)) / b if b else 0.0 * t])
    nearest = np.array([t[np.argmin(np.hypot(on_b[0] - u, on_b[1] - v))] for u, v in zip(x, y, strict=True)])
    found = facing(A, B, s) / (abs(b) or 1.0)
    assert np.abs(found - nearest).max() < 1e-6


def test_windows_follow_the_effective_radius() -> None:
    """The window is a part of the effective radius, capped, at most a quarter turn or the whole arc; two that hug each
    other get all."""
    shaft, plane = surface(SIZES["shaft"]), surface(0.0)
    extents = {name: Extent.of(surface(curvature)) for name, curvature in SIZES.items()}
    spacing = shaft.grid.pitch / SIZES["shaft"]
    half, wanted = half_window(shaft, extents["shaft"], extents["plane"], 0.0, 0.2)
    assert half == wanted and half * spacing == pytest.approx(0.2 / 30.0, abs=4.0 * spacing)
    wider = half_window(shaft, extents["shaft"], extents["bore"], 0.0, 0.2)[0]
    assert wider * spacing == pytest.approx(0.2 / 15.0, abs=4.0 * spacing)
    fine = surface(SIZES["shaft"], columns=720)
    capped, wanted = half_window(fine, Extent.of(fine), extents["bore"], 0.0, 1.0)
    assert capped == MAX_HALF_WINDOW < wanted
    close = Extent.of(surface(-29.9))
    assert half_window(fine, Extent.of(fine), close, 0.0, 0.07)[0] == 720 // 4 - 2
    whole = half_window(plane, extents["plane"], extents["plane"], 0.0, 0.07)[0]
    assert 2 * whole + 1 >= plane.grid.columns


def test_a_rotated_grid_needs_longer_stencils() -> None:
    """Crossed axes: a node's length along its axis lies across the other's columns."""
    shaft, other = surface(SIZES["shaft"]), surface(SIZES["large shaft"])
    A, B = Extent.of(shaft), Extent.of(other)
    side, columns, rows = second_reach(other, A, B, 0.0, 10)
    turned = second_reach(other, A, B, 0.5 * np.pi, 10)
    assert turned[0] >= side and turned[1] >= columns and turned[2] >= rows
    pitch = other.grid.pitch / SIZES["large shaft"]
    assert columns >= 2.0 * A.spacing / pitch + 1.0
    assert turned[1] >= A.reach / pitch + 1.0
    flat = RigidSurface("flat", surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1)))
    assert second_reach(flat, A, B, 0.0, 10) == (1, 1, 1)
