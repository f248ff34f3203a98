"""Few cells along the axis of a nearly incompressible cover: what they add to the line load, and what is said of it."""

from __future__ import annotations

import pytest

import warpffrf as wf

WITHIN = 3.0  # of the stated error
TOO_FEW = "few cells along the axis"


def cover(axial: int, order: int, nu: float = 0.49) -> wf.ReducedBody:
    mesh = wf.mesh.roller(0.05, 0.04, 0.1, sectors=120, layers=3, axial=axial, order=order, grading=1.0)
    return wf.reduce(
        mesh, wf.Material(4e6, nu, 1200), interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()},
        modes=0, cache=False, progress=False,
    )  # fmt: skip


def line_load(body: wf.ReducedBody) -> float:
    """[N/m] at mid-width under a rigid plane, 0.1 mm deep."""
    scene = wf.Scene(gravity=(0, 0, 0))
    roll = scene.add_body(body, name="roll", position=(0, 0, -1e-4))
    floor = scene.ground.surface(wf.surfaces.Plane(origin=(0, 0, -0.05), outward=(0, 0, 1)), name="floor")
    scene.add(wf.Contact(roll["rim"], floor, name="nip", grid="body_fixed", overlap=3e-3))
    scene.add(wf.joints.Fixed(scene.ground, roll["bore"]))
    rest = wf.equilibrium(scene)
    assert rest.status == "completed", rest.message
    return float(rest.contact("nip").line_load[-1])


@pytest.fixture(scope="module")
def fine() -> float:
    return line_load(cover(16, 2))


LINEAR = [pytest.param(n, 1, error, marks=pytest.mark.slow) for n, error in ((4, 0.05), (8, 0.0195))]


@pytest.mark.slow
@pytest.mark.parametrize(("axial", "order", "stated"), [(4, 2, 0.0195), *LINEAR])
def test_few_axial_cells_are_named_with_their_error(fine: float, axial: int, order: int, stated: float) -> None:
    """The error is that compared with sixteen quadratic cells; linear ones are softer or stiffer as a whole, too."""
    body = cover(axial, order)
    said = [text for text in body.report["warnings"] if TOO_FEW in text]
    assert len(said) == 1 and f"about {stated:.0%}" in said[0]
    reference = fine if order == 2 else line_load(cover(24, 1))
    error = abs(line_load(body) / reference - 1.0)
    assert error / WITHIN < stated < error * WITHIN


@pytest.mark.parametrize(("axial", "nu"), [(8, 0.49), (4, 0.3)])
def test_of_enough_axial_cells_and_other_materials_nothing_is_said(axial: int, nu: float) -> None:
    assert not any(TOO_FEW in text for text in cover(axial, 2, nu).report["warnings"])
