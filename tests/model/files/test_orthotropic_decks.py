"""Orthotropic materials and orientations of Abaqus and CalculiX decks, against materials made in Python."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.material import Orthotropic

E, NU, G = (135e9, 10e9, 8e9), (0.3, 0.25, 0.45), (5e9, 4e9, 3.4e9)  # Pa
CONSTANTS = "135000., 10000., 8000., 0.3, 0.25, 0.45, 5000., 4000.,\n3400."  # MPa
FIRST, SECOND = np.array([1.0, 2.0, 0.5]), np.array([0.0, 1.0, -1.0])


def stiffness_lines() -> str:
    """D_1111, ... of the same material [MPa], of its compliance."""
    S = np.diag(1.0 / np.array(E))
    for i, j, nu in ((0, 1, NU[0]), (0, 2, NU[1]), (1, 2, NU[2])):
        S[i, j] = S[j, i] = -nu / E[i]
    D = np.linalg.inv(S) * 1e-6
    values = [D[0, 0], D[0, 1], D[1, 1], D[0, 2], D[1, 2], D[2, 2], 5000.0, 4000.0]
    return ", ".join(f"{v:.15g}" for v in values) + ",\n3400."


def deck(
    path: Path,
    *,
    elastic: str = f"*ELASTIC, TYPE=ENGINEERING CONSTANTS\n{CONSTANTS}",
    orientation: str | None = "1., 2., 0.5, 0., 1., -1.",
    header: str = "*ORIENTATION, NAME=Fibre",
    placed: str | None = None,
) -> Path:
    """A box of hex8 cells in mm; `placed`: as an instance with these lines of translation and rotation."""
    box = wf.mesh.box((0.2, 0.02, 0.01), (4, 1, 1), order=1)
    lines = ["*NODE"] + [f"{n}, {x:.12g}, {y:.12g}, {z:.12g}" for n, (x, y, z) in enumerate(1e3 * box.points, start=1)]
    lines += ["*ELEMENT, TYPE=C3D8, ELSET=All"]
    lines += [f"{n}, {', '.join(map(str, cell))}" for n, cell in enumerate(box.cells["hex8"] + 1, start=1)]
    if orientation is not None:
        lines += [header, orientation]
    of = "" if orientation is None else ", ORIENTATION=fibre"
    lines += [f"*SOLID SECTION, ELSET=All, MATERIAL=Ply{of}"]
    if placed is not None:
        lines = ["*PART, NAME=Bar", *lines, "*END PART", "*ASSEMBLY, NAME=A", "*INSTANCE, NAME=One, PART=Bar"]
        lines += [placed, "*END INSTANCE", "*END ASSEMBLY"]
    path.write_text("\n".join([*lines, "*MATERIAL, NAME=Ply", elastic, "*DENSITY", "1.6e-9", ""]))
    return path


def read(path: Path) -> tuple[Any, Orthotropic]:
    mesh = wf.mesh.read(path, length_unit="mm")
    material = mesh.materials["All"]
    assert isinstance(material, Orthotropic), mesh.notes
    return mesh, material


def same(material: Orthotropic, first: Any, second: Any) -> None:
    wanted = wf.Material.orthotropic(E, NU, G, 1600.0, axes=(first, second))
    assert np.allclose(material.stiffness, wanted.stiffness, rtol=0.0, atol=1e-12 * wanted.stiffness.max())
    assert material.density == pytest.approx(1600.0, rel=1e-14) and material.name == "Ply"


@pytest.mark.parametrize("kind", ["engineering", "ortho"])
def test_constants_and_axes(tmp_path: Path, kind: str) -> None:
    elastic = {} if kind == "engineering" else {"elastic": f"*ELASTIC, TYPE=ORTHO\n{stiffness_lines()}"}
    mesh, material = read(deck(tmp_path / "bar.inp", **elastic))
    same(material, FIRST, SECOND)
    wanted = wf.Material.orthotropic(E, NU, G, 1600.0, axes=(FIRST, SECOND))
    bodies = [wf.reduce(mesh, m, modes=3, cache=False, progress=False) for m in (mesh.materials, wanted)]
    assert np.allclose(bodies[0].frequencies, bodies[1].frequencies, rtol=1e-9)


def test_origin_and_a_further_turn(tmp_path: Path) -> None:
    """Points from a third one, and 90 degrees about axis 3: axis 1 becomes 2, axis 2 becomes -1."""
    points = "6., 7., 5.5, 5., 6., 4., 5., 5., 5."
    _, material = read(deck(tmp_path / "bar.inp", orientation=f"{points}\n3, 90."))
    e_1 = FIRST / np.linalg.norm(FIRST)
    e_2 = SECOND - (SECOND @ e_1) * e_1
    same(material, e_2, -e_1)


def test_axes_turn_with_an_instance(tmp_path: Path) -> None:
    _, material = read(deck(tmp_path / "bar.inp", placed="0., 0., 30.\n0., 0., 0., 0., 0., 1., 90."))
    Q = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    same(material, Q @ FIRST, Q @ SECOND)


def test_without_orientation_along_the_coordinates(tmp_path: Path) -> None:
    mesh, material = read(deck(tmp_path / "bar.inp", orientation=None))
    same(material, (1, 0, 0), (0, 1, 0))
    assert any("its axes are those of the coordinates" in note for note in mesh.notes)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"header": "*ORIENTATION, NAME=Fibre, SYSTEM=CYLINDRICAL"}, "of system CYLINDRICAL"),
        ({"header": "*ORIENTATION, NAME=Other"}, "there is no *Orientation 'fibre'"),
        ({"orientation": "1., 0., 0., 2., 0., 0."}, "its points lie on one line"),
        ({"orientation": "1., 0., 0."}, "it needs a line of two or three points"),
        ({"orientation": "1., 0., 0., 0., 1., 0.\n4, 10."}, "about the axis 4"),
        ({"elastic": "*ELASTIC, TYPE=ANISOTROPIC\n1.,1.,1.,1.,1.,1.,1.,1."}, "neither isotropic nor orthotropic"),
        ({"elastic": f"*ELASTIC, TYPE=ENGINEERING CONSTANTS\n{CONSTANTS.replace('0.45', '1.3')}"}, "energy of some"),
        ({"elastic": "*ELASTIC, TYPE=ORTHO\n1.,2.,1.,0.,0.,1.,1.,1.,\n1."}, "not positive definite"),
    ],
)
def test_what_cannot_be_used_is_noted(tmp_path: Path, changed: dict[str, str], said: str) -> None:
    mesh = wf.mesh.read(deck(tmp_path / "bar.inp", **changed), length_unit="mm")
    assert not mesh.materials and any(said in note and "'Ply'" in note for note in mesh.notes), mesh.notes


def test_missing_constants_are_refused(tmp_path: Path) -> None:
    with pytest.raises(wf.InputError, match=r"needs eight constants on a line and the ninth on the next"):
        wf.mesh.read(deck(tmp_path / "bar.inp", elastic="*ELASTIC, TYPE=ORTHO\n1,2,3,4,5,6,7,8"), length_unit="mm")


def test_shells_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "shell.inp"
    lines = ["*NODE", "1, 0, 0, 0", "2, 9, 0, 0", "3, 9, 9, 0", "4, 0, 9, 0", "*ELEMENT, TYPE=S4, ELSET=All"]
    lines += ["1, 1, 2, 3, 4", "*SHELL SECTION, ELSET=All, MATERIAL=Ply", "1.", "*MATERIAL, NAME=Ply"]
    lines += ["*ELASTIC, TYPE=ENGINEERING CONSTANTS", CONSTANTS, "*DENSITY", "1.6e-9", ""]
    path.write_text("\n".join(lines))
    with pytest.raises(wf.InputError, match="needs a material with isotropic"):
        wf.mesh.read(path, length_unit="mm")
