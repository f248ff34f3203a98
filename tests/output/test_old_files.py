"""Results files and bodies that older versions wrote load, and say what those versions read out of them.

`tests/data/old` holds the files as they were written, and beside each the numbers of the package that wrote it.
"""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

import h5py
import matplotlib.pyplot as plt
import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.files.sealed_file import seal
from warpffrf.model.reduced.file import SCHEMA
from warpffrf.output.files.older import LATER
from warpffrf.output.files.results import SCHEMA_VERSION, SEALED_SINCE

OLD = Path(__file__).parents[1] / "data" / "old"
FILES = sorted(path.name.removesuffix(".h5.gz") for path in OLD.glob("*.h5.gz"))
LACKING = {
    "film_ef98a2e": ["film_asperity", "film_asperity_force", "film_largest_asperity_pressure"],
    "lap_1c9c54a": ["lap_partner", "lap_partner_frame", "lap_share", "lap_share_cell"],
    "lap_8550b66": ["lap_partner_frame", "lap_share", "lap_share_cell"],
    "lumped_5b7e4a4": ["lumped_moment"],
    "lumped_5f4be54": ["lumped_moment"],
}
SCHEMAS = {  # results, bodies
    "rollers_da78f9a": (1, 1), "rubbing_118e139": (1, 4), "lumped_5b7e4a4": (1, None), "film_ef98a2e": (2, 8),
    "lap_1c9c54a": (2, 9), "lap_8550b66": (2, 9), "lumped_5f4be54": (3, None),
}  # fmt: skip


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The files by name, as they were written."""
    folder = tmp_path_factory.mktemp("old")
    for name in FILES:
        (folder / f"{name}.h5").write_bytes(gzip.decompress((OLD / f"{name}.h5.gz").read_bytes()))
    return {name: folder / f"{name}.h5" for name in FILES}


def bodies_in(file: Path, folder: Path) -> list[Path]:
    """The files of the reduced bodies that a results file holds."""
    found = []
    with h5py.File(file) as opened:
        results: Any = opened
        for digest in results.get("reduced", {}):
            found.append(folder / f"{digest}.h5")
            found[-1].write_bytes(results[f"reduced/{digest}"][()].tobytes())
    return found


def schema_of(file: Path, name: str) -> int:
    with h5py.File(file) as opened:
        attributes: Any = opened.attrs
        return int(attributes[name])


def test_the_files_are_of_every_kind_of_age() -> None:
    """So that this test does not end up with new files; the newest are of a schema before today's."""
    assert sorted(SCHEMAS) == FILES
    assert max(results for results, _ in SCHEMAS.values()) < SCHEMA_VERSION
    assert max(bodies or 0 for _, bodies in SCHEMAS.values()) < SCHEMA
    assert {name for names in LACKING.values() for name in names} | {"contact_cell_column_second"} == set(LATER)


@pytest.mark.parametrize("name", FILES)
def test_an_old_file_says_what_its_version_read_out_of_it(unpacked: dict[str, Path], name: str) -> None:
    said = json.loads((OLD / f"{name}.json").read_text(encoding="utf-8"))
    assert schema_of(unpacked[name], "schema_version") == SCHEMAS[name][0]
    result = wf.Result.load(unpacked[name])
    assert result.status == said.pop("status") == "completed"
    assert result.time.tolist() == said.pop("time")
    for path, numbers in said.items():
        kind, owner, quantity = path.split("/")
        assert getattr(getattr(result.history, kind)[owner], quantity).tolist() == numbers, path
    assert len(said) > 1
    (note,) = [note for note in result.history.notes if "lacks" in note] or [""]
    assert all(f"{lacking} (read as " in note for lacking in LACKING.get(name, [])), note
    assert bool(note) == (name in LACKING)


@pytest.mark.parametrize("name", FILES)
def test_an_old_file_is_reported_drawn_and_written_anew(unpacked: dict[str, Path], name: str, tmp_path: Path) -> None:
    result = wf.Result.load(unpacked[name])
    assert "status            completed" in result.report(progress=False)
    result.summary().savefig(tmp_path / "summary.png")
    plt.close("all")
    table = result.to_dataframe()
    for skin in result.skins().values():
        assert np.all(np.isfinite(skin.displacement(-1))) and np.all(np.isfinite(skin.pressure(-1)))
    anew = wf.Result.load(result.save(tmp_path / "anew.h5"))
    assert schema_of(tmp_path / "anew.h5", "schema_version") == SCHEMA_VERSION
    assert anew.to_dataframe().equals(table) and anew.history.notes == result.history.notes


@pytest.mark.parametrize("name", [name for name in FILES if SCHEMAS[name][1]])
def test_bodies_of_older_schemas_load(unpacked: dict[str, Path], name: str, tmp_path: Path) -> None:
    for file in bodies_in(unpacked[name], tmp_path):
        assert schema_of(file, "schema") == SCHEMAS[name][1]
        body = wf.ReducedBody.load(file)
        anew = wf.ReducedBody.load(body.save(tmp_path / "anew.h5", overwrite=True))
        assert anew.content_hash() == body.content_hash()


def test_a_body_of_the_first_schema_still_works(unpacked: dict[str, Path], tmp_path: Path) -> None:
    """The equilibrium that its version found, under 40 kN; what the body was never reduced for is named with a cure.
    The grid is coarse, so that the gaps of today, which see the slopes of the surfaces, make a force 1 % apart at most:
    statics alone fix it, but for the spring of 1e6 N/m."""
    name = "rollers_da78f9a"
    (file,) = bodies_in(unpacked[name], tmp_path)
    roller = wf.ReducedBody.load(file)
    scene = wf.Scene(gravity=(0, 0, 0))
    lower = scene.add_body(roller, name="lower")
    upper = scene.add_body(roller, name="upper", position=(0, 0, 0.02))
    scene.close_gap(scene.add(wf.Contact(lower["rim"], upper["rim"], name="pair")))
    scene.add(wf.joints.Fixed(scene.ground, lower["bore"], axis=(0, 1, 0)))
    guide = scene.add(wf.joints.Prismatic(scene.ground, upper["bore"], axis=(0, 0, 1)))
    scene.add(wf.forces.JointSpringDamper(guide, stiffness=1e6, damping=1e3, preload=-4e4))
    found = wf.equilibrium(scene, progress=False).contact("pair").force[0]
    then = np.array(json.loads((OLD / f"{name}.json").read_text(encoding="utf-8"))["contacts/pair/force"][0])
    assert np.linalg.norm(found - then) < 1e-2 * np.linalg.norm(then)
    with pytest.raises(wf.InputError, match="tangential=True"):
        scene.add(wf.Contact(lower["rim"], upper["rim"], friction=0.3, name="rubbing"))


@pytest.mark.parametrize("missing", ["film_pressure", "film_force", "time"])
def test_what_no_old_file_lacks_is_damage(unpacked: dict[str, Path], missing: str, tmp_path: Path) -> None:
    file = tmp_path / "damaged.h5"
    file.write_bytes(unpacked["film_ef98a2e"].read_bytes())
    with h5py.File(file, "a") as opened:
        del opened[missing]
    seal(file)
    with pytest.raises(wf.InputError, match=f"damaged.*{missing.split('_')[-1]}.*; write it again"):
        wf.Result.load(file)


def test_a_new_file_must_have_what_an_old_one_may_lack(unpacked: dict[str, Path], tmp_path: Path) -> None:
    file = wf.Result.load(unpacked["film_ef98a2e"]).save(tmp_path / "new.h5")
    with h5py.File(file, "a") as opened:
        del opened["film_asperity"]
    seal(file)
    with pytest.raises(wf.InputError, match="damaged.*asperity"):
        wf.Result.load(file)
    assert SCHEMA_VERSION > SEALED_SINCE
