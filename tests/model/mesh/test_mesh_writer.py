"""Meshes written for other programs, and read again by the readers of those formats: the same cells and sets."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError

MESHES: dict[str, Callable[[], wf.mesh.Mesh]] = {
    "hex8": lambda: wf.mesh.box((3.0, 2.0, 1.0), (3, 2, 2), order=1),
    "hex27": lambda: wf.mesh.box((3.0, 2.0, 1.0), (3, 2, 2), order=2),
    "roller": lambda: wf.mesh.roller(0.05, 0.015, 0.01, sectors=24, layers=2, axial=2, order=1),
}


def marked(name: str) -> wf.mesh.Mesh:
    """A mesh with a cell set and facets that are in two sets."""
    mesh = MESHES[name]()
    first = next(iter(mesh.facet_sets))
    return wf.mesh.Mesh(
        mesh.points, mesh.cells, {**mesh.facet_sets, "again": mesh.facets(first)}, name=name,
        cell_sets={"some": np.arange(0, mesh.cell_count, 2)},
    )  # fmt: skip


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("suffix", [".vtu", ".inp"])
def test_a_mesh_is_read_as_it_was_written(name: str, suffix: str, tmp_path: Path) -> None:
    """Points to the digits of the format, cells and sets alike; the facets of an .inp are those of its node sets."""
    mesh = marked(name)
    if "hex27" in mesh.cells and suffix == ".inp":
        with pytest.raises(InputError, match="has no hex27; write a .vtu"):
            mesh.write(tmp_path / f"part{suffix}")
        return
    file = mesh.write(tmp_path / f"part{suffix}")
    again = wf.mesh.read(file, length_unit="m")
    assert np.abs(again.points - mesh.points).max() < 1e-12 * np.ptp(mesh.points)
    assert list(again.cells) == list(mesh.cells)
    assert all(np.array_equal(again.cells[kind], nodes) for kind, nodes in mesh.cells.items())
    assert again.cell_sets["some"].tolist() == mesh.cell_sets["some"].tolist()
    for label, facets in mesh.facet_sets.items():
        assert np.array_equal(again.facets(label).node_set, facets.node_set), label
        assert len(again.facets(label)) == len(facets), label


def test_files_are_replaced_only_if_asked(tmp_path: Path) -> None:
    mesh = marked("hex8")
    file = mesh.write(tmp_path / "part.vtu")
    with pytest.raises(InputError, match="exists; choose another name"):
        mesh.write(file)
    assert mesh.write(file, overwrite=True) == file
    other = tmp_path / "other.inp"
    other.write_text("*HEADING\n", encoding="utf-8")
    with pytest.raises(InputError, match="was not written by warpffrf"):
        mesh.write(other, overwrite=True)
    with pytest.raises(InputError, match="unknown format '.stp', known: .vtu, .inp"):
        mesh.write(tmp_path / "part.stp")
