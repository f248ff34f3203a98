"""Errors of nips of rubber covers that the error budget states, compared with those against a fine mesh."""

from __future__ import annotations

import pytest

import warpffrf as wf
from warpffrf.output.budget.budget import worst_lines
from warpffrf.output.budget.contacts import ALONG
from warpffrf.output.budget.figures import total

RADIUS, WIDTH, LOAD = 0.05, 0.02, 60.0  # m, m, N
FACTOR = 3.0
CHANCE = 3e-3  # errors of several meshes that are smaller are chance, of either sign
RUBBER = wf.Material(4e6, 0.49, 1100.0)


def cover(thickness: float, sectors: int, layers: int, axial: int, order: int) -> wf.ReducedBody:
    mesh = wf.mesh.roller(
        RADIUS, RADIUS - thickness, WIDTH, sectors=sectors, layers=layers, axial=axial, order=order
    )  # fmt: skip
    return wf.reduce(
        mesh, RUBBER, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=0,
        grid=wf.ContactGrid(contact_fixed=True), cache=False, progress=False,
    )  # fmt: skip


def nip(body: wf.ReducedBody, cells: tuple[int, int] | None = None) -> wf.Result:
    """A cover pressed on a rigid plane by a load."""
    scene = wf.Scene(gravity=(0, 0, 0))
    plane = scene.ground.surface(wf.surfaces.Plane(origin=(0, 0, -RADIUS), outward=(0, 0, 1)), name="plane")
    roll = scene.add_body(body, name="roll", position=(0.0, 0.0, -1e-5))
    scene.add(wf.Contact(roll["rim"], plane, grid="contact_fixed", cells=cells, name="pair"))
    scene.add(wf.joints.Prismatic(scene.ground, roll["bore"], axis=(0, 0, 1)))
    scene.add(wf.forces.PointForce(roll["bore"], (LOAD, (0, 0, -1))))
    return wf.equilibrium(scene, progress=False)


@pytest.mark.parametrize(
    ("thickness", "mesh"),
    [
        (2.5e-3, (96, 3, 8, 1)),
        pytest.param(5e-3, (96, 2, 6, 2), marks=pytest.mark.slow),
        pytest.param(1e-2, (96, 3, 12, 1), marks=pytest.mark.slow),
    ],
)
def test_pressures_of_a_layer_follow_its_stiffness_at_a_given_load(thickness: float, mesh: tuple[int, ...]) -> None:
    """Coarse cells are too soft or too stiff for a thin wall: of a half-space the peak would be that of the load."""
    own, exact = nip(cover(thickness, *mesh)), nip(cover(thickness, 160, 3, 8, 2), (21, 31))
    found, true = own.contact("pair"), exact.contact("pair")
    for kind, error in (
        ("peak pressure", found.peak_pressure[-1] / true.peak_pressure[-1] - 1.0),
        ("half-widths", found.half_widths[-1, 0] / true.half_widths[-1, 0] - 1.0),
    ):
        stated = total([line for line in own.error_budget() if line.of == f"{kind} of contact 'pair'" and line.found])
        print(f"{1e3 * thickness:g} mm, {kind}: true {error:+.2%}, stated {stated:.2%}")
        assert abs(error) / FACTOR < stated < FACTOR * max(abs(error), CHANCE), kind


def test_long_cells_along_a_layer_are_the_largest_error() -> None:
    """Cells 2.7 times as long as a cover is thick: the same with half and with a quarter of their length."""
    own, exact = nip(cover(2.5e-3, 160, 2, 3, 2)), nip(cover(2.5e-3, 160, 2, 9, 2))
    error = abs(own.contact("pair").peak_pressure[-1] / exact.contact("pair").peak_pressure[-1] - 1.0)
    lines = own.error_budget()
    stated = total([line for line in lines if line.of == "peak pressure of contact 'pair'" and line.found])
    print(f"true {error:.2%}, stated {stated:.2%}")
    assert error / FACTOR < stated < FACTOR * error
    assert max((line for line in worst_lines(lines) if line.found), key=lambda line: line.size).source == ALONG
