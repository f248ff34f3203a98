"""Scenes as a document with arrays, and files of arrays: what comes back is what was given, or is refused in a line."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import sparse

import warpffrf as wf
from warpffrf.model.errors import InputError
from warpffrf.model.files.object_arrays import from_arrays, to_arrays
from warpffrf.model.files.sealed_file import ARRAYS, HEAD, read_arrays, seal, write_arrays


def machine() -> wf.Scene:
    """A reduced block in contact with the ground, and a driven arm with a spring."""
    mesh = wf.mesh.box((0.1, 0.05, 0.02), (4, 3, 2))
    steel = wf.Material(210e9, 0.3, 7850.0)
    body = wf.reduce(mesh, steel, interfaces={"x_min": "rigid"}, progress=False)
    scene = wf.Scene()
    block = scene.add_body(body, name="block")
    arm = scene.add_rigid_body(1.0, (0.1, 0.1, 0.1), name="arm", position=(0.5, 0.0, 0.0))
    scene.add(wf.joints.Fixed(scene.ground.at((0, 0, 0)), block["x_min"], name="wall"))
    scene.add(wf.joints.Revolute(scene.ground.at((0, 0, 0)), arm.at((-0.5, 0, 0)), axis=(0, 1, 0), name="hinge"))
    scene.add(wf.forces.JointSpringDamper(scene.joints[1], 20.0, name="spring"))
    return scene


def test_a_scene_comes_back_with_what_it_shares(tmp_path: Path) -> None:
    scene, file = machine(), tmp_path / "scene.arrays"
    document, arrays = to_arrays(scene)
    write_arrays(file, {"document": document}, {name: [array] for name, array in arrays.items()})
    about, read = read_arrays(file, "the file", "write it again")
    found: Any = from_arrays(about["document"], read)
    assert found.content_hash() == scene.content_hash() and found is not scene
    assert found.forces[0].joint is found.joints[1]
    assert found.joints[1].a.body is found.ground and found.joints[1].b.body is found.bodies[1]
    assert [body.name for body in found.bodies] == ["block", "arm"]


def test_sparse_matrices_come_back() -> None:
    given = sparse.csr_matrix(np.diag([1.0, 0.0, 3.0]))
    document, arrays = to_arrays([given, given.tocsc()])
    rows, columns = from_arrays(document, arrays)
    assert type(rows) is sparse.csr_matrix and type(columns) is sparse.csc_matrix
    assert np.array_equal(rows.toarray(), given.toarray()) and rows.nnz == columns.nnz == 2


def test_what_is_no_plain_data_of_warpffrf_is_refused() -> None:
    with pytest.raises(InputError, match="it holds a builtins.function"):
        to_arrays({"law": lambda x: x})
    with pytest.raises(InputError, match="it holds arrays of objects"):
        to_arrays([np.array([None])])
    for name in ("os:system", "pathlib:Path", "warpffrf.model.files.paths:os", "warpffrf.model.scene:nothing"):
        with pytest.raises(InputError, match="of another version of warpffrf"):
            from_arrays([{"class": name, "has": {}}], {})
    for document in ([], [{"list": [{"at": 7}]}], [{"array": "0"}], [3.0], [{"tuple": [{"at": 0}]}]):
        with pytest.raises(InputError, match="of another version of warpffrf"):
            from_arrays(document, {})


def test_arrays_come_back_in_blocks_of_any_type(tmp_path: Path) -> None:
    file = tmp_path / "some.arrays"
    words = np.zeros(2, dtype=np.dtype([("step", "<i4"), ("outer", [("a", "<f8"), ("b", "<f8", (3,))])], align=True))
    words["outer"]["b"] = np.arange(6.0).reshape(2, 3)
    blocks = [np.arange(6.0).reshape(2, 3), np.zeros((0, 3)), np.ones((1, 3))]
    given = {"rows": blocks, "words": [words], "number": [np.array(2.5)], "none": [np.zeros((0, 4), dtype=np.int32)]}
    write_arrays(file, {"part": 1}, given)
    about, found = read_arrays(file, "the file", "write it again")
    assert about == {"part": 1} and list(found) == list(given)
    assert np.array_equal(found["rows"], np.concatenate(blocks)) and found["number"].shape == ()
    assert found["words"].dtype == words.dtype and found["words"].tobytes() == words.tobytes()
    assert found["none"].shape == (0, 4) and found["none"].dtype == np.int32


def test_damage_is_seen_wherever_it_is(tmp_path: Path) -> None:
    file = tmp_path / "some.arrays"
    write_arrays(file, {}, {"rows": [np.arange(4.0)]})
    whole = file.read_bytes()
    damaged = [whole[:n] for n in range(len(whole))] + [whole + b"x"]
    damaged += [whole[:n] + bytes([whole[n] ^ 1]) + whole[n + 1 :] for n in range(len(whole))]
    for data in damaged:
        file.write_bytes(data)
        with pytest.raises(InputError, match=r"^the file is damaged \(.*\); write it again$"):
            read_arrays(file, "the file", "write it again")


@pytest.mark.parametrize(
    "entry",
    [
        {"name": "x", "type": "<f8", "shape": [10**15]},
        {"name": "x", "type": "<f8", "shape": [-1, -4]},
        {"name": "x", "type": "|O", "shape": [4]},
        {"name": "x", "type": "<f8"},
        {"name": "x", "type": "|V0", "shape": [10**15]},
    ],
)
def test_sizes_are_compared_before_anything_is_allocated(entry: dict[str, Any], tmp_path: Path) -> None:
    """A seal that is right does not make a header right."""
    file = tmp_path / "some.arrays"
    header = json.dumps({"about": {}, "arrays": [entry]}).encode()
    pieces = [HEAD.pack(ARRAYS, len(header)), header, np.zeros(4).tobytes()]
    file.write_bytes(b"".join(pieces))
    seal(file)
    with pytest.raises(InputError, match=r"^the file is damaged"):
        read_arrays(file, "the file", "write it again")
