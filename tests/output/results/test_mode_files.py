"""Modes in files, read by others: universal files by pyuff and by the reader of meshes, glTF by pygltflib."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.model.mesh.files.unv import read_unv
from warpffrf.output.modes_result import Modes
from warpffrf.output.plots.modes import skins_of

STEEL = wf.Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
SIX_DIGITS = 5e-6  # of the largest displacement: dataset 55 has 6E13.5


def machine(damping: float) -> Modes:
    """A clamped beam that carries a rigid block on a damper."""
    mesh = wf.mesh.box((0.2, 0.02, 0.01), (8, 1, 1), order=1)
    body = wf.reduce(mesh, STEEL, interfaces={"x_min": "rigid", "x_max": "rigid"}, modes=6, cache=False, progress=False)
    scene = wf.Scene(gravity=(0, 0, 0))
    beam = scene.add_body(body, name="beam", damping=0.0)
    block = scene.add_rigid_body(0.2, (1e-4, 1e-4, 1e-4), name="block", position=(0.15, 0.0, 0.0))
    scene.add(wf.joints.Fixed(scene.ground, beam["x_min"]))
    k, c = (1e5,) * 3 + (1e3,) * 3, (damping,) * 3 + (0.01 * damping,) * 3
    scene.add(wf.forces.Bushing(beam["x_max"], block.at((-0.05, 0.0, 0.0)), stiffness=k, damping=c))
    return wf.eigenmodes(scene, 4, progress=False)


@pytest.mark.parametrize("damping", [0.0, 20.0])
def test_shapes_are_read_back_by_pyuff(tmp_path: Path, damping: float) -> None:
    pyuff = pytest.importorskip("pyuff")
    modes = machine(damping)
    path = modes.to_uff(tmp_path / "modes.uff")
    found = pyuff.UFF(str(path)).read_sets()
    shapes = [s for s in found if s["type"] == 55]
    assert [s["type"] for s in found] == [151, 164, 2411, 2412, 55, 55, 55, 55]
    for i, one in enumerate(shapes):
        u = np.concatenate([np.asarray(skin.displacement, complex) for skin in skins_of(modes, i)])
        read = np.stack([one[f"r{axis}"] for axis in (1, 2, 3)], axis=1)
        assert np.max(np.abs(read - (u if damping else np.real(u)))) < SIX_DIGITS * np.max(np.abs(u))
        assert one["analysis_type"] == (3 if damping else 2) and one["mode_n"] == i + 1
        if damping:
            assert one["eig"] == pytest.approx(modes.eigenvalues[i], rel=SIX_DIGITS)
        else:
            assert (one["freq"], one["modal_m"]) == pytest.approx((modes.frequencies[i], 1.0), rel=SIX_DIGITS)


def test_nodes_are_exact_and_triangles_are_those_of_the_skins(tmp_path: Path) -> None:
    modes = machine(0.0)
    raw = read_unv(modes.to_uff(tmp_path / "modes.uff"))
    skins = skins_of(modes, 0)
    assert np.max(np.abs(raw.points - np.concatenate([s.points for s in skins]))) < 1e-15
    ((kind, triangles),) = raw.blocks
    assert kind == "tri3" and np.array_equal(triangles[: len(skins[0].triangles)], skins[0].triangles)
    assert len(raw.groups["property_1"][0]) == len(skins[0].triangles)


def accessor(tree: Any, blob: bytes, number: int) -> np.ndarray:
    found = tree.accessors[number]
    view = tree.bufferViews[found.bufferView]
    width, kind = {"SCALAR": 1, "VEC3": 3}[found.type], {5126: np.float32, 5125: np.uint32}[found.componentType]
    data = np.frombuffer(blob[view.byteOffset : view.byteOffset + view.byteLength], kind)
    assert len(data) == found.count * width
    return data.reshape(found.count, width)


@pytest.mark.parametrize("damping", [0.0, 20.0])
def test_gltf_as_pygltflib_reads_it(tmp_path: Path, damping: float) -> None:
    """Points, targets, and the motion of the animation: that of the mode, over a period."""
    gltf = pytest.importorskip("pygltflib")
    modes = machine(damping)
    path = modes.to_gltf(tmp_path / "modes.glb")
    tree = gltf.GLTF2().load_binary(str(path))
    blob = tree.binary_blob()
    content = path.read_bytes()
    assert struct.unpack("<4sII", content[:12]) == (b"glTF", 2, len(content))
    skins = skins_of(modes, 0)
    assert [node.name for node in tree.nodes] == [skin.name for skin in skins] == ["beam", "block"]
    for n, (mesh, skin) in enumerate(zip(tree.meshes, skins, strict=True)):
        (part,) = mesh.primitives
        points = accessor(tree, blob, part.attributes.POSITION)
        assert np.allclose(points, skin.points, atol=1e-7)
        faces = accessor(tree, blob, part.indices).reshape(-1, 3)
        assert {frozenset(f) for f in faces.tolist()} == {frozenset(f) for f in skin.triangles.tolist()}
        x = points[faces] - points.mean(axis=0)
        assert np.einsum("ti,ti->", x[:, 0], np.cross(x[:, 1], x[:, 2])) > 0.0  # normals point outwards
        targets = np.array([accessor(tree, blob, target["POSITION"]) for target in part.targets])
        for i, animation in enumerate(tree.animations):
            assert animation.name == f"mode {i}: {modes.frequencies[i]:.5g} Hz"
            (sampler,) = animation.samplers
            weights = accessor(tree, blob, sampler.output).reshape(-1, len(targets))
            times = accessor(tree, blob, sampler.input)[:, 0]
            assert len(weights) == len(times) and animation.channels[n].target.node == n
            moved = np.tensordot(weights, targets, 1)
            angle = 2.0 * np.pi * times / times[-1]
            u = np.asarray(skins_of(modes, i)[n].displacement, complex)
            swing = np.exp(1j * angle) if damping else np.sin(angle)
            expected = np.real(swing[:, None, None] * u)
            factor = np.vdot(expected, moved) / np.vdot(expected, expected)
            assert np.max(np.abs(moved - factor * expected)) < 1e-5 * np.max(np.abs(targets))


def test_files_are_refused_where_they_cannot_be(tmp_path: Path) -> None:
    modes = machine(0.0)
    with pytest.raises(InputError, match="must end in .glb"):
        modes.to_gltf(tmp_path / "modes.gltf")
    modes.to_gltf(tmp_path / "modes.glb")
    with pytest.raises(InputError, match="exists"):
        modes.to_gltf(tmp_path / "modes.glb")
    modes.to_gltf(tmp_path / "modes.glb", overwrite=True)
    (tmp_path / "other.uff").write_text("mine")
    with pytest.raises(InputError, match="was not written by warpffrf"):
        modes.to_uff(tmp_path / "other.uff", overwrite=True)
    still = wf.Scene(gravity=(0, 0, 0))
    block = still.add_rigid_body(0.2, (1e-4, 1e-4, 1e-4), name="block")
    still.add(wf.joints.Fixed(still.ground, block))
    with pytest.raises(InputError, match="there are no modes"):
        wf.eigenmodes(still, 1, progress=False).to_uff(tmp_path / "none.uff")
