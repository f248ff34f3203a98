"""A file whose arrays do not fit together is refused by the name of the array, though its content hash is right."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from warpffrf.model import surfaces
from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.local_mass import LocalMass
from warpffrf.offline import ContactGrid, ReductionOptions, reduce


@pytest.fixture(scope="module")
def body() -> ReducedBody:
    mesh = roller(0.05, 0.03, 0.02, sectors=24, axial=2, layers=2, order=1)
    return reduce(
        mesh, Material(210e9, 0.3, 7850.0), interfaces={"bore": "rigid"}, contact={"rim": surfaces.Cylinder()}, modes=6,
        grid=ContactGrid(tangential=True), options=ReductionOptions(local_dynamics=True), progress=False, cache=False,
    )  # fmt: skip


def with_rim(body: ReducedBody, **changes: Any) -> ReducedBody:
    return replace(body, contact_surfaces={"rim": replace(body.contact_surfaces["rim"], **changes)})


def spoilt(array: np.ndarray) -> np.ndarray:
    array = array.copy()
    array.flat[0] = np.nan
    return array


def shorter(mass: LocalMass | None) -> LocalMass:
    assert mass is not None
    return replace(mass, overlap=mass.overlap[:, 1:])


WRONG: dict[str, tuple[Callable[[ReducedBody], ReducedBody], str]] = {
    "NaN": (
        lambda b: with_rim(b, mode_normal=spoilt(b.contact_surfaces["rim"].mode_normal)),
        "contact_surfaces/rim/mode_normal holds NaN",
    ),
    "NaN that no shape is known of": (
        lambda b: with_rim(b, recovery=replace((r := b.contact_surfaces["rim"].recovery), transfer=spoilt(r.transfer))),
        "body.h5: contact_surfaces/rim/recovery/transfer holds NaN",
    ),
    "an overlap of other modes": (
        lambda b: with_rim(b, local_mass=shorter(b.contact_surfaces["rim"].local_mass)),
        "contact_surfaces/rim/local_mass/overlap must have shape",
    ),
    "a sector less": (
        lambda b: with_rim(b, lags=b.contact_surfaces["rim"].lags[:-1]),
        r"contact_surfaces/rim/lags must have shape \(24, 3, 3\), got \(23, 3, 3\)",
    ),
    "an interface transposed": (
        lambda b: replace(b, interfaces={"bore": replace(b.interfaces["bore"], modes=b.interfaces["bore"].modes.T)}),
        "interfaces/bore/modes must have shape",
    ),
    "a mode less": (lambda b: replace(b, frequencies=b.frequencies[:-1]), "surface/modes must have shape"),
    "no axis": (
        lambda b: with_rim(b, grid=replace(b.contact_surfaces["rim"].grid, e_0=np.array([1.0, 1.0, 0.0]))),
        "contact_surfaces/rim/grid/e_0 .* unit vectors",
    ),
    "inertia": (lambda b: replace(b, inertia=-b.inertia), "inertia is not symmetric and positive"),
    "mass": (lambda b: replace(b, mass=-1.0), "mass must be greater than zero"),
}


@pytest.mark.parametrize("what", list(WRONG))
def test_wrong_arrays_are_named(body: ReducedBody, tmp_path: Path, what: str) -> None:
    change, message = WRONG[what]
    change(body).save(tmp_path / "body.h5")
    with pytest.raises(InputError, match=message):
        ReducedBody.load(tmp_path / "body.h5")


def test_the_right_ones_are_read(body: ReducedBody, tmp_path: Path) -> None:
    body.save(tmp_path / "body.h5")
    assert ReducedBody.load(tmp_path / "body.h5").content_hash() == body.content_hash()
