"""Stress on skins: a bar pulled and bent compared with F/A + M z/I, in VTKHDF files read back; parts of a skin, and
none."""

from __future__ import annotations

import logging
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from recordings import columns

from vtkhdf_reader import read_vtkhdf
from warpffrf.model import joints
from warpffrf.model.errors import InputError
from warpffrf.model.forces import PointForce, PointTorque
from warpffrf.model.material import Material
from warpffrf.model.mesh import box
from warpffrf.model.reduced.stress_field import to_tensor
from warpffrf.model.scene import Scene
from warpffrf.offline import reduce
from warpffrf.output.bodies import stress
from warpffrf.output.bodies.skin import same_places
from warpffrf.output.geometry.places import rotate
from warpffrf.output.plots.colors import UNKNOWN, field_scale
from warpffrf.output.recording.recorder import record
from warpffrf.output.result import Result
from warpffrf.output.simulate import equilibrium

LENGTH, WIDTH, HEIGHT = 0.2, 0.02, 0.01  # m
PULL, MOMENT = 0.01, 5e-5  # N, N m: small, as the pull bends what is deflected, here by 6e-7 of the moment
AREA, INERTIA = WIDTH * HEIGHT, WIDTH * HEIGHT**3 / 12.0
LARGEST = PULL / AREA + MOMENT * 0.5 * HEIGHT / INERTIA  # Pa
STEEL = Material(210e9, 0.0, 7850.0)  # without Poisson's ratio rigid ends do not disturb the beam's stress
EXACT = 1e-5  # of the largest stress: quadratic cells have the beam's field, kept in single precision
LEVEL = 4  # of 255: neighbours in a table of colours, between which single precision decides
TURN = (0.0, 0.0, np.sin(0.3), np.cos(0.3))


@pytest.fixture(scope="module")
def bar():
    mesh = box((LENGTH, WIDTH, HEIGHT), (4, 1, 2))
    return reduce(
        mesh, STEEL, interfaces={"x_min": "rigid", "x_max": "rigid"}, modes=2, stress={"skin": "skin", "root": "x_min"},
        cache=False, progress=False,
    )  # fmt: skip


@pytest.fixture(scope="module")
def bent(bar) -> Result:
    """The bar rotated about z, pulled along its axis and bent about its width."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    body = scene.add_body(bar, name="bar", rotation=TURN)
    axis, across = rotate(np.array(TURN), np.eye(3)[:2])
    scene.add(joints.Fixed(scene.ground, body["x_min"], name="root"))
    scene.add(PointForce(body["x_max"], tuple(PULL * axis), name="pull"))
    scene.add(PointTorque(body["x_max"], tuple(MOMENT * across), name="bend"))
    return equilibrium(scene, progress=False)


def without(result: Result, *dropped: str) -> Result:
    """The same run of a body that was reduced without some of its stress points."""
    scene = result.view
    body = scene.bodies["bar"]
    kept = {name: field for name, field in body.reduced.stress.items() if name not in dropped}
    bare = replace(body, reduced=replace(body.reduced, stress=kept))
    return Result(replace(result.history, scene=replace(scene, bodies={"bar": bare})))


def test_a_bar_that_is_pulled_and_bent_in_vtkhdf_files(bent, tmp_path: Path) -> None:
    """sigma = F/A + M z/I along the axis, which lies aslant in the world, and nothing else; von Mises its size."""
    (block,), _ = read_vtkhdf(bent.to_vtkhdf(tmp_path / "bar.vtkhdf", progress=False), 0)
    skin = bent.skins()["bar"]
    expected = PULL / AREA + MOMENT * skin.points[:, 2] / INERTIA
    axis = rotate(np.array(TURN), np.eye(3)[:1])[0]
    tensor = to_tensor(np.asarray(block["stress"]))
    assert np.abs(tensor - expected[:, None, None] * np.outer(axis, axis)).max() < EXACT * LARGEST
    assert np.abs(np.asarray(block["von_mises"]) - np.abs(expected)).max() < EXACT * LARGEST
    assert np.abs(skin.field("von_mises", -1) - np.abs(expected)).max() < EXACT * LARGEST
    assert skin.fields == ("von_mises",) and not skin.stress.note


def test_parts_of_a_skin_and_none(bent, tmp_path: Path, caplog) -> None:
    """Nodes without stress are NaN, and the file and the logger say how many; a body without has no field."""
    part, bare = without(bent, "skin"), without(bent, "skin", "root")
    skin = part.skins()["bar"]
    at_root = skin.points[:, 0] < -0.5 * LENGTH + 1e-9
    found = skin.stress.von_mises(-1)
    assert np.array_equal(np.isfinite(found), at_root) and 0 < at_root.sum() == skin.stress.count
    assert np.abs(found[at_root] - bent.skins()["bar"].stress.von_mises(-1)[at_root]).max() < EXACT * LARGEST
    for result, said in ((part, f"stress at {at_root.sum()} of {len(at_root)} nodes"), (bare, "no stress on its skin")):
        with caplog.at_level(logging.INFO, "warpffrf"):
            path = result.to_vtkhdf(tmp_path / "bar.vtkhdf", overwrite=True, progress=False)
        written = "with part of the stress" if result is part else "without stress"
        with h5py.File(path) as file:
            (note,) = np.asarray(file["VTKHDF"].attrs["notes"]).tolist()
        assert said in note and f"to_vtkhdf: written {written}: body 'bar' has {said}" in caplog.text
    assert "stress" not in read_vtkhdf(path, 0)[0][0].point_data
    with pytest.raises(InputError, match="von_mises"):
        bare.skins()["bar"].field("von_mises", -1)


def test_von_mises_in_a_recording(bent, tmp_path: Path) -> None:
    """Every node has the colour of its stress, from 0 to the largest; without stress it has one of its own, and the
    recording says where."""
    expected = field_scale("von_mises", LARGEST).rgb(bent.skins()["bar"].stress.von_mises(-1))
    info = record(bent, tmp_path / "bar.rrd", color="von_mises")
    (shown,) = columns(info.path, "/world/bar/surface", "Mesh3D:vertex_colors")
    found = np.array(shown, dtype=">u4").view(np.uint8).reshape(-1, 4)
    assert np.abs(found[:, :3].astype(int) - expected).max() <= LEVEL and len(np.unique(expected, axis=0)) > 2
    part = without(bent, "skin")
    info = record(part, tmp_path / "part.rrd", color="von_mises")
    (shown,) = columns(info.path, "/world/bar/surface", "Mesh3D:vertex_colors")
    grey = int.from_bytes(bytes((*UNKNOWN, 255)), "big")
    assert np.array_equal(np.array(shown) == grey, np.isnan(part.skins()["bar"].stress.von_mises(-1)))
    assert any("nodes of its skin" in note for note in info.notes)
    with pytest.raises(InputError, match=r"color 'von_mises': body 'bar' has no stress on its skin; reduce\("):
        record(without(bent, "skin", "root"), tmp_path / "none.rrd", color="von_mises")


def test_nodes_that_share_a_place_are_distinguished_by_their_order() -> None:
    nodes = np.array([[0.0, 0, 0], [1, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0], [3, 0, 0]])
    points = nodes[[3, 1, 2, 4]]  # one of the two at the end: nobody knows whose
    assert same_places(nodes, points).tolist() == [-1, 1, 2, 0, -1, -1]
    assert same_places(nodes, nodes).tolist() == [0, 1, 2, 3, 4, 5]


def test_a_stress_that_takes_much_memory_says_so(bent, caplog, monkeypatch) -> None:
    monkeypatch.setattr(stress, "MUCH", 8.0)
    bent.stress("bar", "root")
    assert "'root' of 'bar' takes " in caplog.text and "rows=" in caplog.text


def test_stress_of_some_rows(bent) -> None:
    found = bent.stress("bar", "root", rows=[-1])
    assert np.array_equal(found.tensor, bent.stress("bar", "root").tensor) and found.time == bent.time[-1]
    for rows, error in (([1], "saved steps 0 to 0"), ([0.5], "whole numbers"), ([-2], "got -2 to -2")):
        with pytest.raises(InputError, match=error):
            bent.stress("bar", "root", rows=rows)
