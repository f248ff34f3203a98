"""Membrane energy on the device: forces and tangent against NumPy's, equilibria and energies of a clamped plate."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from references.large_deflections.body import StVenantKirchhoffBody
from references.large_deflections.statics import by_load
from references.membrane import membrane_energy, membrane_gradient, membrane_tangent
from warpffrf.model import joints
from warpffrf.model.errors import InputError
from warpffrf.model.integrators import EnergyMomentum
from warpffrf.model.material import Material
from warpffrf.model.mesh import FacetSet, Mesh, box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.inertia import membrane_amplitudes
from warpffrf.model.scene import Scene
from warpffrf.offline import ReductionOptions, reduce
from warpffrf.online import Engine
from warpffrf.output.options import RunOptions
from warpffrf.output.simulate import equilibrium, simulate
from warpffrf_kernels.core import control as k

SIDE, THICK = 0.4, 4e-3  # m
MATERIAL = Material(210e9, 0.316, 7850.0)
UNIT = MATERIAL.youngs_modulus * THICK**3 / (SIDE**4 * MATERIAL.density)  # m/s^2 of q a^4/(E t^4) = 1
STEP = 1e6  # s: inertia is nothing compared with
ROUND_OFF = 1e-12
DEFLECTION = 0.005  # of the full model's


@functools.cache
def mesh() -> Mesh:
    plain = box((SIDE, SIDE, THICK), (6, 6, 1))
    sides = [plain.facets(name) for name in ("x_min", "x_max", "y_min", "y_max")]
    rim = FacetSet({kind: np.concatenate([s.blocks[kind] for s in sides]) for kind in sides[0].blocks})
    return Mesh(plain.points, plain.cells, {"rim": rim})


@functools.cache
def plate(membrane_modes: int | None = None) -> ReducedBody:
    return reduce(
        mesh(), MATERIAL, interfaces={"rim": "rigid"}, modes=14,
        options=ReductionOptions(stiffening="membrane", membrane_modes=membrane_modes), progress=False,
    )  # fmt: skip


def forms_of(body: ReducedBody) -> np.ndarray:
    assert body.inertia_terms is not None and body.inertia_terms.stiffening is not None
    assert body.inertia_terms.stiffening.membrane is not None
    return body.inertia_terms.stiffening.membrane


def clamped(load: float, body: ReducedBody | None = None, **settings) -> Scene:
    """The plate with its rim held, under an acceleration of `load` times q a^4/(E t^4) = 1."""
    scene = Scene(gravity=(0.0, 0.0, -load * UNIT))
    held = scene.add_body(body or plate(), name="plate", **{"stiffening": True, "inertia": "constant", **settings})
    scene.add(joints.Fixed(scene.ground, held["rim"], name="rim"))
    return scene


def test_forces_and_tangent_are_those_of_numpy() -> None:
    """Two bodies of other ranks side by side and a linear one between them, at random coordinates."""
    scene = Scene(gravity=(0, 0, 0))
    bodies = [plate(), plate(), plate(6)]
    for i, body in enumerate(bodies):
        scene.add_body(body, name=f"plate {i}", position=(i, 0, 0), stiffening=i != 1, inertia="constant")
    engine = Engine(scene)
    engine.clock(h=STEP)
    engine.coefficients(beta=1.0, acc=1.0 / STEP**2)
    m, rng = engine.compiled.model, np.random.default_rng(3)
    starts = np.cumsum([0, *(len(b.frequencies) for b in bodies)])
    q = np.concatenate([3.0 * rng.normal(size=len(b.frequencies)) / (2 * np.pi * b.frequencies) for b in bodies])
    engine.control(mode=int(k.STATIC))
    engine.scratch.dq.assign(q[None])
    engine.control(mode=int(k.STATIC), run=1, moved=1, refresh=1, iteration=1)
    engine.graph.evaluate()
    engine.graph.assemble()
    force = engine.scratch.modal_residual.numpy()[0]
    tangent = engine.scratch.tangent.numpy()[0]
    B = m.bodies.count
    for i, body in enumerate(bodies):
        part, forms = slice(starts[i], starts[i + 1]), forms_of(body)
        stiffness = (2 * np.pi * body.frequencies) ** 2
        expected = stiffness * q[part] + (membrane_gradient(forms, q[part]) if i != 1 else 0.0)
        np.testing.assert_allclose(force[part], expected, atol=ROUND_OFF * np.abs(expected).max())
        if i == 1:
            continue
        first = 6 * B + m.bodies.dense_start.numpy()[i]
        found = tangent[first : first + len(stiffness), first : first + len(stiffness)]
        expected = np.diag(stiffness) + membrane_tangent(forms, q[part])
        np.testing.assert_allclose(found, expected, atol=ROUND_OFF * np.abs(expected).max())
        squares = m.bodies.square_start.numpy()[i : i + 2]
        e = engine.scratch.membrane_amplitude.numpy()[0][slice(*squares)]
        np.testing.assert_allclose(e, membrane_amplitudes(forms, q[part]), atol=ROUND_OFF * np.abs(e).max())


@pytest.mark.parametrize("load", [134.9, 402.0])
def test_equilibrium_is_that_of_full_finite_elements(load) -> None:
    """At w/t 1 and 1.8; linear, it is 1.6 and nearly 3 times as far."""
    full = StVenantKirchhoffBody(mesh(), MATERIAL)
    middle = full.nearest_node((0.0, 0.0, 0.5 * THICK))
    (state,) = by_load(full, full.held("rim"), full.body_force((0.0, 0.0, -load * UNIT)), [1.0])
    body = plate()
    at = int(np.argmin(np.linalg.norm(body.surface.points - mesh().points[middle], axis=1)))
    shape = body.surface.modes[:, at, 2] - body.interfaces["rim"].modes[:, 2]
    found = []
    for stiffening in (True, False):
        result = equilibrium(clamped(load, stiffening=stiffening))
        assert result.status == "completed"
        found.append(shape @ result.history.bodies["plate"].modal[-1] / state.u[3 * middle + 2])
    assert found[0] == pytest.approx(1.0, abs=DEFLECTION)
    assert found[1] > 1.5


def test_energy_of_a_vibration() -> None:
    """From rest under a load that stretches as much as it bends: nothing is lost but to the integrator, 1 % of the
    energy at thirty steps a period; strain energy is that of modes and membrane."""
    body = plate()
    period = 1.0 / body.frequencies[0]
    result = simulate(clamped(100.0), 3.0 * period, step=period / 30.0, progress=False)
    assert result.status == "completed"
    q = result.history.bodies["plate"].modal
    linear = 0.5 * (q**2) @ (2 * np.pi * body.frequencies) ** 2
    stretched = np.array([membrane_energy(forms_of(body), one) for one in q])
    np.testing.assert_allclose(result.energy["strain"], linear + stretched, atol=1e-9 * linear.max())
    assert stretched.max() > 0.2 * linear.max()
    numerical = np.asarray(result.energy["numerical"])
    assert np.abs(numerical).max() < 0.01 * linear.max()


def test_integrators_of_free_bodies_refuse_it() -> None:
    scene = Scene(gravity=(0, 0, 0))
    scene.add_body(plate(), name="plate", stiffening=True)
    with pytest.raises(InputError, match="body 'plate' has membrane energy, which is not known here"):
        simulate(scene, 1e-3, step=1e-5, options=RunOptions(integrator=EnergyMomentum()), progress=False)
