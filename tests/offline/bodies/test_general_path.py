"""The general path: solvers agree, observers, tangential fields, bounded memory, and runs that are interrupted."""

from __future__ import annotations

import logging
import multiprocessing
import os
import signal
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse as sp
from offline_bodies import STEEL

import warpffrf.offline.general.unit_loads as unit_loads
from scenes.flat_settings import reduce_flat
from warpffrf.model.errors import InputError
from warpffrf.model.mesh import roller
from warpffrf.model.mesh.facets import rigid_modes
from warpffrf.model.surfaces import Cylinder
from warpffrf.offline.bases import FreeFree
from warpffrf.offline.elastic import free_model
from warpffrf.offline.fe import assign, fe_matrices
from warpffrf.offline.general.checkpoint import Checkpoint
from warpffrf.offline.general.observers import Observer, node_observer
from warpffrf.offline.general.path import reduce_general
from warpffrf.offline.general.unit_loads import GeneralSurface
from warpffrf.offline.interfaces import rigid_interfaces
from warpffrf.offline.products import Limits, SurfaceProduct
from warpffrf.offline.progress import Progress
from warpffrf.offline.solvers import installed

AGREE = 1e-9
SINGLE = 2e-6  # transfers are stored in single precision
BLOCK = 12


def body_mesh():
    return replace(roller(0.05, 0.015, 0.02, sectors=30, layers=5, axial=4, order=1), cyclic=None)


def general(mesh, *, interfaces=("bore",), modes=4, memory_limit=None, spacing=None, **settings):
    shape = Cylinder().fitted(mesh.points[mesh.facets("rim").node_set])
    return reduce_general(
        mesh,
        assign(mesh, STEEL),
        rigid_interfaces(mesh, list(interfaces)),
        [("rim", shape)],
        FreeFree(),
        Limits(modes, None),
        {"rim": spacing},
        memory_limit,
        Progress(False),
        **settings,
    )


def arrays(product) -> list[np.ndarray]:
    s = product.surfaces[0]
    return [
        product.omega,
        product.skin_modes,
        s.lags,
        s.mode_normal,
        s.recovery.transfer,
        *(i.modes for i in product.interfaces.values()),
    ]


def surface_of(product) -> SurfaceProduct:
    (s,) = product.surfaces
    assert isinstance(s, SurfaceProduct)
    return s


def relative(a, b) -> float:
    return float(np.abs(a - b).max() / np.abs(b).max())


@pytest.fixture(scope="module")
def mesh():
    return body_mesh()


@pytest.fixture(scope="module")
def reference(mesh):
    return general(mesh)


@pytest.fixture
def small_blocks(monkeypatch):
    monkeypatch.setattr(unit_loads, "BLOCK", BLOCK)


@pytest.mark.parametrize("solver", installed())
def test_solvers_agree(mesh, reference, solver):
    found = general(mesh, solver=solver)
    assert found.facts["solver"] == solver and reference.facts["solver"] == "multifrontal"
    assert relative(found.omega, reference.omega) < AGREE
    assert relative(found.surfaces[0].lags, reference.surfaces[0].lags) < AGREE
    assert relative(found.surfaces[0].recovery.transfer, reference.surfaces[0].recovery.transfer) < SINGLE
    assert found.facts["backward_error"] < 1e-14


def test_observers_see_modes_and_responses(mesh, reference):
    """Against full responses of a model solved here, and an operator of random entries on them."""
    operator = sp.csr_matrix(np.random.default_rng(0).standard_normal((7, 3 * len(mesh.points))))
    double = np.dtype(np.float64)
    everything = replace(node_observer("all", np.arange(len(mesh.points)), len(mesh.points)), dtype=double)
    found = general(mesh, interfaces=(), observers=[everything, Observer("some", operator, double)])
    s = surface_of(found)
    K, M = fe_matrices(mesh, assign(mesh, STEEL))
    model = free_model(K, M, rigid_modes(mesh.points, np.zeros(3)), solver="superlu")
    shape = Cylinder().fitted(mesh.points[mesh.facets("rim").node_set])
    surface = GeneralSurface(mesh, "rim", shape, None)
    B, Phi = surface.loads().toarray(), found.observed_modes["all"]
    residual = model.flexibility(B) - Phi @ (Phi.T @ B / found.omega[:, None] ** 2)
    transfer = surface.fields[0].without_gram(residual.T).T
    assert relative(s.observed["all"].transfer[0], transfer) < AGREE
    assert relative(s.observed["some"].transfer[0], operator @ transfer) < AGREE
    assert relative(found.observed_modes["some"], operator @ Phi) < AGREE
    assert relative(s.lags[0], surface.fields[0].without_gram(B.T @ transfer)) < AGREE
    assert relative(general(mesh, observers=[everything]).surfaces[0].lags, reference.surfaces[0].lags) < AGREE


def test_observers_that_do_not_fit_are_refused(mesh):
    one = node_observer("one", np.array([3]), len(mesh.points))
    with pytest.raises(InputError, match="observer 'one' exists twice"):
        general(mesh, observers=[one, one])
    with pytest.raises(InputError, match="observer 'one': the operator has 15 columns, the mesh"):
        general(mesh, observers=[node_observer("one", np.array([3]), 5)])


@pytest.mark.parametrize("kind", ["nodes", "cells"])
def test_tangential_fields(mesh, reference, kind):
    """One symmetric positive definite operator of all three directions; the normal part is what it was alone; a
    uniform tangential traction around the axis of a held roller moves the rim around only (torsion)."""
    s = surface_of(general(mesh, tangential=kind))
    t = s.tangential
    assert t is not None
    assert relative(s.lags, reference.surfaces[0].lags) < AGREE
    columns = np.arange(s.grid.columns)
    tt, nt = t.compliance(columns), t.coupling(columns, columns)
    whole = np.block([[s.lags[0], nt], [nt.T, tt]])
    assert np.linalg.eigvalsh(whole)[0] > -1e-12 * np.abs(whole).max()
    areas = np.kron(t.grid.gram_theta().sum(axis=1), t.grid.gram_z(Cylinder().fitted(rim(mesh))).sum(axis=1))
    around = np.concatenate([areas, np.zeros_like(areas)])
    assert np.abs(nt @ around).max() < 1e-6 * np.abs(tt @ around).max()
    u = t.recover(around.reshape(2, s.grid.columns, -1))
    assert u.shape == (len(mesh.outer_facets().node_set), 3)


def rim(mesh):
    return mesh.points[mesh.facets("rim").node_set]


# --- memory ---


def test_little_memory_gives_small_blocks_and_the_same_result(mesh, reference):
    grid_nodes = reference.surfaces[0].lags.shape[1]
    needed = needed_memory(mesh)
    found = general(mesh, memory_limit=needed + (1 << 19))
    assert found.facts["block"] < grid_nodes / 4 and found.facts["block"] < reference.facts["block"]
    assert relative(found.surfaces[0].lags, reference.surfaces[0].lags) < AGREE


def test_too_little_memory_says_how_much_is_needed(mesh):
    needed = needed_memory(mesh)
    with pytest.raises(InputError, match="memory_limit of .* is too small.*raise memory_limit to"):
        general(mesh, memory_limit=needed - (1 << 20))
    with pytest.raises(InputError, match="the dense compliance of 150 functions of contact grids needs"):
        general(mesh, memory_limit=1 << 18)


def needed_memory(mesh) -> int:
    """The limit that the error of a block that does not fit asks for [byte]."""
    for limit in range(4 << 20, 64 << 20, 1 << 20):
        try:
            general(mesh, memory_limit=limit, modes=0)
        except InputError as error:
            if "raise memory_limit to" in str(error):
                return int(str(error).split("raise memory_limit to ")[1].split(" MiB")[0]) << 20
    raise AssertionError("no limit was refused for its blocks")


# --- interrupted runs ---


class Stopped(Exception):
    pass


def stop_after(monkeypatch, blocks: int, error: BaseException):
    """Raise `error` in place of the block after so many."""
    compute, done = unit_loads.ResponseSolver._block, []

    def counted(self, surface, start):
        if len(done) >= blocks:
            raise error
        done.append(start)
        return compute(self, surface, start)

    monkeypatch.setattr(unit_loads, "worker_count", lambda: 1)
    monkeypatch.setattr(unit_loads.ResponseSolver, "_block", counted)
    return done


def test_a_resumed_run_gives_the_same_bits(mesh, tmp_path, monkeypatch, small_blocks):
    path = tmp_path / "body.part"
    with Checkpoint(path, seconds=0.0) as checkpoint:
        whole = general(mesh, checkpoint=checkpoint)
    assert not path.exists()
    with monkeypatch.context() as patch:
        first = stop_after(patch, 5, KeyboardInterrupt())
        with pytest.raises(KeyboardInterrupt, match=f"6 finished parts are kept in {path}.*same input to continue"):
            with Checkpoint(path, seconds=0.0) as checkpoint:
                general(mesh, checkpoint=checkpoint)
    assert path.exists() and len(first) == 5
    with monkeypatch.context() as patch:
        patch.setattr("warpffrf.offline.general.path.build_basis", None)  # kept as well: not called again
        second = stop_after(patch, 1000, Stopped())
        with Checkpoint(path, seconds=0.0) as checkpoint:
            resumed = general(mesh, checkpoint=checkpoint)
    assert not set(first) & set(second) and len(second) + 5 == -(-150 // BLOCK)
    assert all(np.array_equal(a, b) for a, b in zip(arrays(resumed), arrays(whole), strict=True))
    assert not path.exists()


def slow_run(path: Path) -> None:
    """In a process of its own: a reduction whose blocks take their time."""
    compute = unit_loads.ResponseSolver._block

    def slowly(self, surface, start):
        time.sleep(0.05)
        return compute(self, surface, start)

    unit_loads.BLOCK = BLOCK
    unit_loads.ResponseSolver._block = slowly
    with Checkpoint(path, seconds=0.0) as checkpoint:
        general(body_mesh(), checkpoint=checkpoint)


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs a signal that cannot be caught")
def test_a_killed_run_goes_on(mesh, tmp_path, small_blocks):
    whole = general(mesh)
    path = tmp_path / "body.part"
    process = multiprocessing.get_context("spawn").Process(target=slow_run, args=(path,))
    process.start()
    deadline = time.monotonic() + 60.0
    while process.is_alive() and time.monotonic() < deadline:
        if path.exists() and path.stat().st_size > 500_000:  # the modes and some blocks
            break
        time.sleep(0.002)
    assert process.pid is not None
    os.kill(process.pid, signal.SIGKILL)
    process.join()
    assert process.exitcode == -signal.SIGKILL
    with Checkpoint(path) as checkpoint:
        resumed = general(mesh, checkpoint=checkpoint)
        assert checkpoint.found >= 2
    assert all(np.array_equal(a, b) for a, b in zip(arrays(resumed), arrays(whole), strict=True))


def filled(path: Path, parts: int = 4) -> None:
    checkpoint = Checkpoint(path, seconds=0.0)
    checkpoint.begin({"solver": "one"})
    for i in range(parts):
        checkpoint.put(f"part {i}", {"a": np.full((3, 2), float(i)), "b": np.array(["text"])})
    checkpoint.flush()


def again(path: Path, solver: str = "one") -> Checkpoint:
    checkpoint = Checkpoint(path)
    checkpoint.begin({"solver": solver})
    return checkpoint


def test_parts_come_back(tmp_path):
    path = tmp_path / "folder" / "body.part"
    filled(path)
    found = again(path)
    part = found.get("part 2")
    assert found.found == 4 and part is not None
    assert np.array_equal(part["a"], np.full((3, 2), 2.0)) and part["b"][0] == "text"
    assert found.get("part 7") is None


def test_a_cut_file_keeps_what_is_whole(tmp_path, caplog):
    path = tmp_path / "body.part"
    filled(path)
    content = path.read_bytes()
    for cut in range(0, len(content), 97):
        path.write_bytes(content[:cut])
        found = again(path)
        assert found.found <= cut * 4 // len(content)
        found.put("part 9", {"a": np.ones(2)})
        found.flush()
        assert again(path).get("part 9") is not None
    path.write_bytes(content[:-20] + b"x" * 20)
    with caplog.at_level(logging.WARNING):
        assert again(path).found == 3
    assert "damaged after 3 parts" in caplog.text


@pytest.mark.parametrize("content", [b"", b"rubbish", b"WFP1" + bytes(200), bytes(range(256)) * 12])
def test_a_damaged_file_is_dropped_with_a_warning(tmp_path, caplog, content):
    path = tmp_path / "body.part"
    path.write_bytes(content)
    with caplog.at_level(logging.WARNING):
        assert again(path).found == 0
    assert "restarts from the beginning" in caplog.text and not path.exists()


def test_another_solver_starts_anew(tmp_path, caplog):
    path = tmp_path / "body.part"
    filled(path)
    with caplog.at_level(logging.WARNING):
        assert again(path, "two").found == 0
    assert "another solver" in caplog.text and not path.exists()


def test_a_file_that_cannot_be_written_is_given_up(tmp_path, caplog):
    blocked = tmp_path / "file"
    blocked.write_text("")
    with caplog.at_level(logging.WARNING), Checkpoint(blocked / "body.part", seconds=0.0) as checkpoint:
        checkpoint.begin({})
        checkpoint.put("part", {"a": np.ones(2)})
        checkpoint.put("other", {"a": np.ones(2)})
    assert caplog.text.count("cannot be written") == 1


def test_a_short_run_writes_no_file(mesh, tmp_path):
    path = tmp_path / "body.part"
    with Checkpoint(path, seconds=1000.0) as checkpoint:
        general(mesh, checkpoint=checkpoint)
        assert not path.exists()


@pytest.mark.slow
def test_reduce_goes_on_after_an_interruption(tmp_path, monkeypatch):
    """The file of an interrupted and resumed reduction is that of an uninterrupted one, bit for bit."""
    mesh = replace(roller(0.05, 0.015, 0.02, sectors=16, layers=2, axial=2, order=1), cyclic=None)
    monkeypatch.setattr(unit_loads, "BLOCK", BLOCK)
    monkeypatch.setattr("warpffrf.offline.general.checkpoint.SECONDS", 0.0)
    given = {"interfaces": {"bore": "rigid"}, "contact": {"rim": Cylinder()}, "modes": 4, "periodic": False}
    monkeypatch.setenv("WARPFFRF_CACHE", str(tmp_path / "whole"))
    whole = reduce_flat(mesh, STEEL, progress=False, **given)

    monkeypatch.setenv("WARPFFRF_CACHE", str(tmp_path / "cut"))
    put, seen = Checkpoint.put, []

    def interrupted(self, name, arrays):
        put(self, name, arrays)
        self.flush()
        seen.append(name)
        if len(seen) == 4:
            raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(Checkpoint, "put", interrupted)
        with pytest.raises(KeyboardInterrupt, match="call reduce with the same input to continue"):
            reduce_flat(mesh, STEEL, progress=False, **given)
    assert list((tmp_path / "cut").glob("*.part"))
    with monkeypatch.context() as patch:
        patch.setattr("warpffrf.offline.general.path.build_basis", None)  # not computed again
        resumed = reduce_flat(mesh, STEEL, progress=False, **given)
    assert resumed.content_hash() == whole.content_hash()
    assert not list((tmp_path / "cut").glob("*.part"))
