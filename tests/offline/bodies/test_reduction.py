"""Settings, bad input, cache, file, frequencies, and a mesh of quadratic tetrahedra through the whole chain."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any

import h5py
import numpy as np
import pytest
from offline_bodies import STEEL, reduced

from scenes.flat_settings import reduce_flat
from warpffrf import examples
from warpffrf.model import mesh as meshes
from warpffrf.model.errors import InputError
from warpffrf.model.files.sealed_file import seal
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh, roller
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline import reduce


@pytest.fixture
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("WARPFFRF_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


# --- modes ---


def test_ring_frequencies_converge_to_thin_ring():
    """VERIFICATION D3: thin ring, n = 2, 4, without Poisson effect.

    f_n = (1/2 pi) sqrt(E I / (rho A R^4)) n (n^2 - 1)/sqrt(n^2 + 1).

    Odd n mix with out-of-plane modes in the sorted list. Quadratic elements: the error falls with the fourth power of
    the element length, from above (Rayleigh); what remains at once is shear and rotary inertia, of order (h/R)^2.
    """
    R, h = 0.1, 2e-3
    ring = Material(210e9, 0.0, 7800.0)
    errors = []
    for sectors in (48, 96):
        mesh = roller(R + h / 2, R - h / 2, 0.01, sectors=sectors, layers=1, axial=1, order=2)
        f = reduce(mesh, ring, modes=8, cache=False, progress=False).frequencies
        worst = []
        for n in (2, 4):
            exact = np.sqrt(210e9 * h**2 / 12.0 / (7800.0 * R**4)) * n * (n**2 - 1) / np.sqrt(n**2 + 1) / (2.0 * np.pi)
            near = f[np.argmin(np.abs(f / exact - 1.0))]
            worst.append(near / exact - 1.0)
        errors.append(max(worst))
        assert min(worst) > 0.0
    assert errors[1] < 5e-3
    assert np.log2(errors[0] / errors[1]) > 3.0


def test_pairs_are_never_split(small_roller):
    body = reduced(small_roller, interfaces={}, modes=1)
    assert len(body.frequencies) == 2 and body.frequencies[0] == pytest.approx(body.frequencies[1], rel=1e-9)
    assert any("split a pair" in note for note in body.report["notes"])


def test_both_limits_give_the_fewer(small_roller):
    f = reduced(small_roller, interfaces={}, modes=30).frequencies
    limit = 0.5 * (f[10] + f[12])
    below = reduced(small_roller, interfaces={}, max_frequency=limit).frequencies
    assert np.allclose(below, f[f <= limit], rtol=1e-9)
    assert len(reduced(small_roller, interfaces={}, max_frequency=limit, modes=3).frequencies) < len(below)
    assert len(reduced(small_roller, interfaces={}, max_frequency=f[-1] * 0.5, modes=30).frequencies) < 30


def test_more_modes_than_the_mesh_has():
    mesh = roller(0.05, 0.03, 0.02, sectors=4, layers=1, axial=1, order=1)
    free = 3 * len(mesh.points) - 6
    for general in (False, True):
        body = reduced(mesh, general=general, interfaces={}, contact={}, modes=free)
        assert len(body.frequencies) == free
        with pytest.raises(InputError, match="more than the model has"):
            reduced(mesh, general=general, interfaces={}, contact={}, modes=10 * free)


# --- a mesh made elsewhere ---


@pytest.mark.slow
def test_tetrahedral_roller_tilted_and_off_center():
    mesh = meshes.read(examples.path("roller") / "roller.msh", length_unit="mm")
    body = reduced(mesh, max_frequency=15e3)
    assert body.report["path"] == "general"
    exact = STEEL.density * np.pi * (0.05**2 - 0.015**2) * 0.02
    assert body.mass == pytest.approx(exact, rel=1e-3)  # quadratic faces on a circle
    s = body.contact_surfaces["rim"]
    axis = s.shape.e_a
    # the joint point lies on the axis; the polar moment is that of a hollow cylinder
    offset = body.interfaces["bore"].point - s.shape.axis_point
    assert np.linalg.norm(offset - (offset @ axis) * axis) < 1e-9
    assert axis @ body.inertia @ axis == pytest.approx(0.5 * exact * (0.05**2 + 0.015**2), rel=1e-3)
    # compliance does not depend on where around the rim a load acts: a line of unit load, several places
    D = s.compliance(np.arange(s.grid.columns))
    assert np.linalg.eigvalsh(D)[0] > 0.0
    line = np.array([np.tile(np.eye(s.grid.columns)[j][:, None], s.grid.rows).ravel() for j in range(s.grid.columns)])
    own = np.einsum("ji,ik,jk->j", line, D, line)
    assert np.ptp(own) < 0.25 * own.mean()  # grid and mesh do not match: local scatter of the discretisation
    # first elastic mode near that of a structured mesh of the same body
    hexa = reduced(roller(0.05, 0.015, 0.02, sectors=24, layers=3, axial=2, order=2), modes=1)
    tetra = reduced(mesh, modes=1, contact={})
    assert tetra.frequencies[0] == pytest.approx(hexa.frequencies[0], rel=0.02)


def test_cut_by_the_axis_of_a_shape_elsewhere(small_roller):
    shape = Cylinder(radius=0.05, axis_point=(0, 0, 0), axis_direction=(0, -1, 0))
    body = reduced(small_roller, contact={"rim": shape})
    assert body.report["path"] == "general" and "other way" in body.report["path_reason"]


# --- bad input ---


@pytest.mark.parametrize(
    "settings, message",
    [
        ({"interfaces": {"hub": "rigid"}}, "facet set 'hub' does not exist; known: 'rim', 'bore', 'ends'"),
        ({"contact": {"tread": None}}, "facet set 'tread' does not exist; known: 'rim', 'bore', 'ends'"),
        ({"interfaces": {"bore": "elastic"}}, "kind 'elastic' does not exist; known: 'rigid', 'average', 'free'"),
        ({"basis": "guyan"}, "basis 'guyan'"),
        ({"traction": "spots"}, "traction 'spots' does not exist"),
        ({"tangential": "spots"}, "tangential must be True, False or a kind of functions: .* known: 'nodes', 'cells'"),
        ({"solver": "magic"}, "solver 'magic' is not available"),
        ({"periodic": True}, "periodic must be None"),
        ({"max_frequency": -1.0}, "max_frequency"),
        ({"max_frequency": float("nan")}, "max_frequency"),
        ({"modes": -2}, "modes"),
        ({"modes": 2.5}, "modes"),
        ({"spacing": 0.0}, "spacing must be greater"),
        ({"memory_limit": -1}, "memory_limit"),
        ({"interfaces": {"rim": "rigid"}}, "'rim' cannot be"),
        ({"interfaces": {"bore": "rigid", "ends": "rigid"}}, "share 36 nodes"),
        ({"contact": {"rim": 5}}, "no surface shape"),
        (
            {"contact": {"rim": Cylinder(radius=0.06)}},
            "contact 'rim'.*do not fit.*largest distance of a node 0.01 m.*fit_tolerance",
        ),
        ({"contact": {"ends": Cylinder()}}, "'ends'"),
    ],
)
def test_bad_settings_name_the_thing(small_roller, settings, message):
    with pytest.raises(InputError, match=message):
        reduced(small_roller, **settings)


def test_dense_operator_beyond_the_memory_limit(small_roller):
    with pytest.raises(InputError, match="memory_limit"):
        reduced(small_roller, general=True, memory_limit=1000)


def test_inverted_cell_is_refused(small_roller):
    cells = small_roller.single[1].copy()
    cells[3] = cells[3][[4, 5, 6, 7, 0, 1, 2, 3]]
    mesh = Mesh(small_roller.points, {"hex8": cells}, small_roller.facet_sets)
    with pytest.raises(InputError, match="1 inverted hex8 cell.*number 3.*repair"):
        reduced(mesh)


def test_two_disconnected_parts_are_refused(small_roller):
    points = np.concatenate([small_roller.points, small_roller.points + 1.0])
    cells = np.concatenate([small_roller.single[1], small_roller.single[1] + len(small_roller.points)])
    with pytest.raises(InputError, match="2 disconnected parts with 72, 72 cells.*merge"):
        reduced(Mesh(points, {"hex8": cells}, small_roller.facet_sets))


def test_things_of_another_kind_are_refused(small_roller):
    with pytest.raises(InputError, match="a material is needed.*got 210"):
        reduce(small_roller, 210e9)  # pyright: ignore[reportArgumentType]
    with pytest.raises(InputError, match="a mesh is needed, .*mesh.read .*got 'roller.msh'"):
        reduce("roller.msh", STEEL)  # pyright: ignore[reportArgumentType]


def test_linear_algebra_runs_on_one_thread(small_roller, monkeypatch):
    from threadpoolctl import threadpool_info

    import warpffrf.offline.reduction as reduction

    def threads():
        return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}

    before, inside = threads(), []
    compute = reduction.reduce_cyclic
    monkeypatch.setattr(
        reduction, "reduce_cyclic", lambda *given, **how: inside.append(threads()) or compute(*given, **how)
    )
    body = reduced(small_roller)
    assert inside == [{1}] and threads() == before
    assert body.report["blas_threads"] == 1


# --- file and cache ---


def test_file_round_trip(small_roller, tmp_path):
    body = reduced(small_roller, modes=4)
    path = body.save(tmp_path / "roller.h5")
    again = ReducedBody.load(path)
    assert again.content_hash() == body.content_hash() == body.provenance["content_hash"]
    a, b = body.contact_surfaces["rim"], again.contact_surfaces["rim"]
    forces = np.ones((a.grid.columns, a.grid.rows))
    assert np.array_equal(a.recover(forces), b.recover(forces))
    assert np.array_equal(a.gram_z, b.gram_z) and b.shape.deviation == a.shape.deviation
    assert again.info() == body.info() and "kg" in again.info()
    assert [p.name for p in tmp_path.iterdir()] == ["roller.h5"]


def test_damaged_files_are_refused(small_roller, tmp_path):
    path = reduced(small_roller).save(tmp_path / "roller.h5")
    content = path.read_bytes()
    with pytest.raises(InputError, match="no file"):
        ReducedBody.load(tmp_path / "missing.h5")
    (tmp_path / "cut.h5").write_bytes(content[: len(content) // 2])
    (tmp_path / "text.h5").write_text("not HDF5")
    for name in ("cut.h5", "text.h5"):
        with pytest.raises(InputError, match="damaged"):
            ReducedBody.load(tmp_path / name)
    with h5py.File(path, "r+") as file:
        frequencies: Any = file["frequencies"]
        frequencies[0] *= 1.0 + 1e-15
    with pytest.raises(InputError, match="another program has changed it"):
        ReducedBody.load(path)
    seal(path)
    with pytest.raises(InputError, match="content hash differs"):
        ReducedBody.load(path)
    with h5py.File(path, "r+") as file:
        file.attrs["schema"] = 999
    seal(path)
    with pytest.raises(InputError, match="schema 999.*run the reduction again with this version"):
        ReducedBody.load(path)
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file.attrs["format"] = "something else"
    seal(tmp_path / "other.h5")
    with pytest.raises(InputError, match="not a reduced body"):
        ReducedBody.load(tmp_path / "other.h5")
    with pytest.raises(InputError, match="cannot be written"):
        reduced(small_roller).save(tmp_path / "text.h5" / "roller.h5")


def test_unchanged_input_comes_from_the_cache(small_roller, own_cache):
    first = reduced(small_roller, cache=True)
    second = reduced(small_roller, cache=True)
    assert (first.report["cached"], second.report["cached"]) == (False, True)
    assert first.content_hash() == second.content_hash()
    assert len(list(own_cache.iterdir())) == 1


def arrays_in(thing: Any, path: str = "") -> Iterator[tuple[str, np.ndarray]]:
    if isinstance(thing, np.ndarray):
        yield path, thing
    elif isinstance(thing, dict):
        for name, value in thing.items():
            yield from arrays_in(value, f"{path}[{name!r}]")
    elif is_dataclass(thing) and not isinstance(thing, type):
        for entry in fields(thing):
            yield from arrays_in(getattr(thing, entry.name), f"{path}.{entry.name}")


@pytest.mark.parametrize("periodic", [None, False])
def test_a_new_body_computes_as_that_from_the_cache(small_roller, own_cache, periodic):
    """Arrays lie in memory in the same order: products of matrices then round alike, and runs agree bit for bit."""
    options = {"tangential": True, "modes": 4, "stress": {"rim": "rim"}, "periodic": periodic}
    first, second = (dict(arrays_in(reduced(small_roller, cache=True, **options))) for _ in range(2))
    assert first.keys() == second.keys() and len(first) > 20
    for name, array in first.items():
        assert array.dtype == second[name].dtype and array.flags.c_contiguous and second[name].flags.c_contiguous, name


@pytest.mark.parametrize("change", ["node", "material", "modes", "spacing", "set"])
def test_any_change_recomputes(small_roller, own_cache, change):
    reduced(small_roller, cache=True)
    mesh, settings = small_roller, {}
    if change == "node":
        points = mesh.points.copy()
        points[40, 1] += 1e-9
        mesh = Mesh(points, mesh.cells, mesh.facet_sets, mesh.cyclic)
    elif change == "set":
        mesh = mesh.select("more", "rim", lambda c: c[:, 0] > 0.0)
    elif change == "modes":
        settings["modes"] = 2
    elif change == "spacing":
        settings["spacing"] = 0.02
    else:
        given = {"interfaces": {"bore": "rigid"}, "contact": {"rim": Cylinder()}, "progress": False}
        body = reduce_flat(mesh, Material(210e9, 0.3, 7850.0 * (1 + 1e-12)), **given)
        assert not body.report["cached"]
        return
    assert not reduced(mesh, cache=True, **settings).report["cached"]


def test_a_damaged_cache_entry_is_made_again(small_roller, own_cache):
    reduced(small_roller, cache=True)
    (entry,) = own_cache.iterdir()
    entry.write_bytes(b"rubbish")
    assert not reduced(small_roller, cache=True).report["cached"]
    assert reduced(small_roller, cache=True).report["cached"]


def test_a_cached_body_under_the_key_of_another_is_made_again(small_roller, own_cache):
    first = reduced(small_roller, cache=True)
    (entry,) = own_cache.iterdir()
    reduced(small_roller, cache=True, modes=1)
    (other,) = set(own_cache.iterdir()) - {entry}
    entry.write_bytes(other.read_bytes())
    again = reduced(small_roller, cache=True)
    assert not again.report["cached"] and again.content_hash() == first.content_hash()


def test_a_cache_that_cannot_be_written_does_not_lose_the_result(small_roller, tmp_path, monkeypatch):
    blocked = tmp_path / "file"
    blocked.write_text("")
    monkeypatch.setenv("WARPFFRF_CACHE", str(blocked))
    body = reduced(small_roller, cache=True)
    assert any("not cached" in w for w in body.report["warnings"])
