"""At nodes: the law of the contact at every node, compared with the same layer in nodes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from references import monolithic
from references.monolithic.line_of_centres.pair import default_layer
from scenes.rollers import PAIR, Path, guided_pair, prescribed_pair, roller_body
from warpffrf.model import laws
from warpffrf.model.errors import InputError
from warpffrf.model.friction import Coulomb
from warpffrf.model.scene import Scene
from warpffrf.online import run

STIFF = 0.3  # of the default layer of nodes, which is 300 times the surface under it


def layered(scene: Scene, stiffness: float) -> Scene:
    """The scene with a linear layer [Pa/m] in its contact."""
    scene.contacts[0].law = laws.LinearLayer(stiffness)
    for body in scene.bodies:
        body.level = "constant"
    return scene


def at_rest(body: Any, approach: float) -> Scene:
    return prescribed_pair(body, body, Path.of([approach, approach], 0.01))


def test_it_is_the_layer_of_the_contact_at_the_nodes(roller) -> None:
    k = STIFF * default_layer(roller.contact_surfaces["rim"])
    found = []
    for at_nodes in (True, False):
        scene = guided_pair(roller, roller, load=6e3, speed=40.0, ramp=2e-3)
        for body in scene.bodies:
            body.level = "constant"
        options: dict[str, Any] = {"law": "nodes", "layer_stiffness": k}
        if at_nodes:
            layered(scene, k)
            options = {"at_nodes": True}
        found.append(monolithic.run(scene, 4e-4, step=1e-4, start="equilibrium", progress=False, **options))
    nodal, nodes = (history.contacts[PAIR] for history in found)
    assert np.abs(nodal.force).max() > 1e3
    np.testing.assert_array_equal(nodal.force, nodes.force)
    size = np.abs(nodal.force).max()
    assert np.abs(nodal.force + nodal.force_second).max() < 1e-9 * size  # action and reaction


@pytest.mark.slow
def test_semi_comes_to_it_as_the_grid_becomes_finer() -> None:
    """The same approach on finer and finer rims: the nodes and the nodes differ by what both discretise."""
    errors, elements = [], []
    for sectors in (100, 200):
        body = roller_body(sectors, layers=5, axial=2, grading=1.5, order=1, max_frequency=10e3, cache=False)
        k = 0.1 * default_layer(body.contact_surfaces["rim"])
        approach = 2e-3  # m: far beyond steel, so that a coarse mesh has many nodes in contact
        nodal = monolithic.run(
            layered(at_rest(body, approach), k), 1e-6, step=1e-6, start="equilibrium", progress=False,
            variant="low_rank", at_nodes=True,
        )  # fmt: skip
        full = run(layered(at_rest(body, approach), k), 1e-6, step=1e-6, start="equilibrium", progress=False)
        assert nodal.status == full.status == "completed", nodal.message + full.message
        forces = [float(np.linalg.norm(h.contacts[PAIR].force[0])) for h in (full, nodal)]
        errors.append(abs(forces[0] / forces[1] - 1.0))
        elements.append(float(np.count_nonzero(full.contacts[PAIR].pressure[0, :, 1])) / 2.0)
    assert elements[-1] > 3.0
    assert errors[1] < 5e-3
    assert errors[1] < errors[0]


def test_what_it_needs(roller) -> None:
    scene = guided_pair(roller, roller, load=1e3)
    options: dict[str, Any] = {"step": 1e-4, "at_nodes": True, "progress": False}
    with pytest.raises(InputError, match="has no unilateral; use laws.LinearLayer"):
        monolithic.run(scene, 1e-3, **options)
    layered(scene, 1e13)
    with pytest.raises(InputError, match="leave layer_stiffness out"):
        monolithic.run(scene, 1e-3, law="nodes", layer_stiffness=1e13, **options)
    scene.contacts[0]._friction = Coulomb(0.1)  # past the check that the bodies have tangential modes
    with pytest.raises(InputError, match="friction needs tangential modes, body 'lower'"):
        monolithic.run(scene, 1e-3, **options)
    scene.contacts[0].friction = Coulomb(0.0)
    scene.contacts[0]._quadrature = "reduced"  # past the check that the first body has points
    with pytest.raises(InputError, match="has no quadrature 'reduced'"):
        monolithic.run(scene, 1e-3, **options)
