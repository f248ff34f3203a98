"""The preconditioner of pressures without a matrix: compared with the inverse of the compliance that products give."""

# pyright: reportInvalidTypeForm=false, reportAssignmentType=false, reportIndexIssue=false, reportGeneralTypeIssues=false

from typing import Any

import numpy as np
import pytest
import warp as wp

import warpffrf as wf
from warpffrf.online import run
from warpffrf.online.arrays.declaration import as_taken, topic_of
from warpffrf.online.checkpoint import restore
from warpffrf.online.compile import pairs
from warpffrf.online.engine import Engine
from warpffrf_kernels.core.contact_scratch import ContactGeometry, ContactSolve, PatchScratch
from warpffrf_kernels.core.declaration import kernel
from warpffrf_kernels.core.run import Run
from warpffrf_kernels.core.scalars import MODULE_OPTIONS, real
from warpffrf_kernels.core.scratch import ImpulsiveContact
from warpffrf_kernels.normal.pressure_products import ACTIVE, add_cells
from warpffrf_kernels.patch.preconditioner import precondition_patch

wp.set_module_options(MODULE_OPTIONS)

RADIUS, LOAD, STEP = 0.05, 1e4, 1e-5
ROUND_OFF = 1e-12
# eigenvalues of M G: 0.97 to 3.3 measured, far fields included; from 0.34 on with a layer, whose factors S are those of
# the diagonal
LEAST, MOST = 0.3, 4.0
LAYER = wf.laws.LinearLayer(3e14)  # as soft as the bodies
RETAINED = {"unilateral": 3e-3, LAYER.kind: 0.1}  # of the stiffness L^T G^-1 L; 1e-3 and 0.06 measured


@kernel
def apply_both(
    run: Run, normal: ContactSolve, patch: PatchScratch, geometry: ContactGeometry, impulses: ImpulsiveContact,
    given: wp.array(dtype=real), preconditioned: wp.array(dtype=real), opened: wp.array(dtype=real),
):  # fmt: skip
    """M and G times n vectors of the n active cells."""
    w, lane = wp.tid()
    model = run.models[w]
    n = normal.block[w, 0, 1]
    for i in range(n):
        precondition_patch(model, w, 0, 0, n, patch, normal, given, i * n, preconditioned, i * n, 1)
        add_cells(model, w, lane, ACTIVE, 1, 0, normal, patch, geometry, impulses, given, i * n, opened, i * n)


@pytest.mark.parametrize("law", [wf.laws.Unilateral(), LAYER], ids=lambda law: law.kind)
def test_it_is_symmetric_and_near_the_inverse(law: wf.laws.Law, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pairs, "MATRIX_CELLS", 0)
    mesh = wf.mesh.roller(RADIUS, 0.015, 0.02, sectors=40, layers=4, axial=3, order=1)
    body = wf.reduce(
        mesh, wf.Material(210e9, 0.3, 7800.0), interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()},
        modes=0, grid=wf.ContactGrid(contact_fixed=True), progress=False,
    )  # fmt: skip
    scene = wf.Scene(gravity=(0, 0, 0))
    lower, upper = (scene.add_body(body, name=n, position=(0, 0, z)) for n, z in (("lower", 0), ("upper", 2 * RADIUS)))
    scene.add(wf.joints.Fixed(scene.ground, lower["bore"]))
    scene.add(wf.joints.Prismatic(scene.ground, upper["bore"], axis=(0, 0, 1)))
    scene.add(wf.forces.PointForce(upper["bore"], (0, 0, -LOAD)))
    scene.add(wf.Contact(lower["rim"], upper["rim"], grid="contact_fixed", cells=(15, 12), law=law))
    engine = Engine(scene)
    done = restore(engine, run(scene, STEP, step=STEP, start="equilibrium", progress=False).checkpoint, STEP)
    engine.control(every=1, target=done + 1)
    engine.replay(2)
    normal: Any = engine.scratch
    n = int(normal.block.numpy()[0, 0, 1])
    assert n > 100
    words = engine.state.ctl.numpy().copy()
    words["run"] = 1
    engine.state.ctl.assign(words)
    own = {"given": wp.array(np.eye(n).ravel(), dtype=wp.float64)}
    own |= {name: wp.zeros(n * n, dtype=wp.float64) for name in ("preconditioned", "opened")}
    arrays = engine.graph.program.arrays
    inputs = [
        own[a.label] if a.label in own else as_taken(arrays[topic_of(a.type) or a.label], a.type)
        for a in apply_both.adj.args
    ]
    wp.launch_tiled(apply_both, dim=(1,), inputs=inputs, block_dim=1, device="cpu")
    M, G = (np.array(own[name].numpy(), dtype=float).reshape(n, n) for name in ("preconditioned", "opened"))
    for symmetric in (M, G):
        assert np.abs(symmetric - symmetric.T).max() < ROUND_OFF * np.abs(symmetric).max()
    eigenvalues = np.linalg.eigvals(M @ G).real
    assert LEAST < eigenvalues.min() and eigenvalues.max() < MOST
    L = normal.borders.numpy().reshape(-1, normal.L.shape[-1])[:n]
    exact = L.T @ np.linalg.solve(G, L)
    assert np.abs(L.T @ M @ L - exact).max() < RETAINED[law.kind] * np.abs(exact).max()
