"""Mode shapes of the .rst file that ansys-mapdl-reader brings as its example, a free beam of the mesh HexBeam.cdb in
inches, compared with elements of our own on that mesh."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.model.mesh.files.rst_modes import read_rst

INCH = 0.0254  # m
PSI, DENSITY = 6894.757, 1.068690e7  # Pa; lbf s2/in4 in kg/m3
MATERIAL = wf.Material(youngs_modulus=1.69e7 * PSI, poisson_ratio=0.31, density=4.1408e-4 * DENSITY)  # of the file
ELEMENTS = 0.01  # of the frequencies: those of Ansys are integrated by eight points


def example(name: str) -> Path:
    reader = pytest.importorskip("ansys.mapdl.reader")
    return Path(reader.__file__).parent / "examples" / name


@pytest.fixture(scope="module")
def mesh() -> Any:
    return wf.mesh.read(example("HexBeam.cdb"), length_unit="in")


def test_modes_of_a_free_beam_are_those_of_our_elements(mesh: Any) -> None:
    """Bending in two directions at once, twist, and the next ones; criteria and frequencies."""
    body = wf.reduce(mesh, MATERIAL, modes=6, cache=False, progress=False)
    found = body.compare_modes(example("file.rst"), length_unit="in")
    assert dict(found.pairs) == {i: i for i in range(6)} and np.min(found.pair_mac) > 0.999
    assert np.allclose(found.measured_frequencies, body.frequencies[:6], rtol=ELEMENTS)
    assert np.max(found.distances) < 1e-6 and "an .rst file states no damping ratios" in found.notes


def test_nodes_are_the_corners_of_the_surface() -> None:
    found = read_rst(example("file.rst"))
    ours, middle = found.points, np.array([0.5, 0.5, 2.5])  # 1 x 1 x 5 in, in two by two by ten elements
    assert len(ours) == 3 * 3 * 11 - 9 and np.all(np.isclose(np.abs(ours - middle), [0.5, 0.5, 2.5]).any(axis=1))
    assert found.shapes.shape == (6, len(ours), 3)


def test_damaged_files_are_refused_with_their_name(tmp_path: Path) -> None:
    content = example("file.rst").read_bytes()
    for number, damaged in enumerate((content[:5000], b"\0" * 4000, content[:400] + b"\xff" * 4000 + content[4400:])):
        path = tmp_path / f"{number}.rst"
        path.write_bytes(damaged)
        with pytest.raises(InputError, match=f"file of modes {path.name}: .*write it again"):
            read_rst(path)
