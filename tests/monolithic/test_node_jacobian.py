"""The law at nodes of true shapes: its Jacobian against differences of the residuals, action and reaction."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from jacobian import differences, worst_entry
from node_bodies import PAIR, on_ground

from references.monolithic.core.equations import predicted
from references.monolithic.core.integrator import Formula
from references.monolithic.core.linear import dense_jacobian
from references.monolithic.newton import Evaluation, System, evaluate
from references.monolithic.nodal.friction import SLIP, STICK
from references.monolithic.nodal.newton import stiffness_of
from references.monolithic.nodal.pair import FORCE, TRACTION, NodePairState
from references.monolithic.nodal.tangent import LinearisedPair
from references.monolithic.run import build
from references.monolithic.start import standing
from scenes.rollers import roller_body
from warpffrf.model import laws, surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.friction import RegularisedCoulomb
from warpffrf.model.integrators import HHT
from warpffrf.model.material import Material
from warpffrf.model.mesh import sleeve
from warpffrf.model.placement.gap import smallest_gap
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.offline import ContactGrid, reduce

AGREE = 1e-5  # of the largest entry of a row: how the lean turns with the place is left out (`nodal.gap`)
LAYER = laws.LinearLayer(1e13)
DEEP, SHALLOW = 1.5e-3, 3e-5  # m, so that some nodes of these coarse meshes carry: counterformal, conformal
STEP = 1e-4  # s
ACROSS = (0.0, 1.0, 0.0)
TURNED = np.array([1e-3, 0.3, -2e-3, 1.0]) / np.linalg.norm([1e-3, 0.3, -2e-3, 1.0])


@pytest.fixture(scope="module")
def rubbing_roller() -> ReducedBody:
    return roller_body(30, layers=2, axial=2, grading=1.6, modes=4, tangential=True, contact_fixed=False, cache=False)


@pytest.fixture(scope="module")
def rubbing_bore() -> ReducedBody:
    mesh = sleeve(0.0503, 0.08, 0.024, sectors=30, axial=2, layers=2, order=1)
    return reduce(
        mesh, Material(210e9, 0.3, 7850.0), interfaces={"outside": "rigid"}, contact={"bore": surfaces.Bore()}, modes=4,
        grid=ContactGrid(tangential=True, contact_fixed=False), cache=False, progress=False,
    )  # fmt: skip


def closed(scene: Scene, moved: Any, along: Any) -> Scene:
    """`moved` pushed along `along` until the first true surface lies deep in the second."""
    direction = np.asarray(along, float)
    inside = any(port.surface.shape.side < 0.0 for port in scene.contacts[0].ports)
    for _ in range(30):
        gap = smallest_gap(scene.contacts[0])[0] + (SHALLOW if inside else DEEP)
        moved.position = moved.position + gap * direction
    return scene


def pair_of(first: ReducedBody, second: Any, along: Any, *, friction: Any, law: Any = LAYER, **pose: Any) -> Scene:
    """`first` pushed into `second`: a shape of the ground, a rigid body's (a tuple of it), or a flexible body."""
    if isinstance(second, ReducedBody) or isinstance(second, tuple):
        scene = Scene()
        a = scene.add_body(first, name="body", inertia="constant", **pose)
        if isinstance(second, tuple):
            b = scene.add_rigid_body(1.0, (1e-3, 2e-3, 3e-3), name="second", surfaces={"face": second[0]},
                                     center_of_mass=(0.01, -0.005, 0.003))  # fmt: skip
            port: Any = b["face"]
        else:
            b = scene.add_body(second, name="second", inertia="constant")
            port = b[next(iter(second.contact_surfaces))]
        (surface,) = first.contact_surfaces
        scene.add(Contact(a[surface], port, law=law, friction=friction, name=PAIR, overlap=1.0))
    else:
        scene, a = on_ground(first, second, friction=friction, law=law, **pose)
    return closed(scene, a, along)


def stirred(scene: Scene, seed: int = 2) -> tuple[System, Any, Formula, Any, Evaluation]:
    """Both bodies deformed a little, moved a little over the step, the friction with something to remember."""
    system, state = build(scene, stick_stiffness=2e13, at_nodes=True)
    rng = np.random.default_rng(seed)
    n = system.layout.modes
    state.q[:n] = 1e-7 * rng.normal(size=n)
    state.q[n:] = 1e-7 * np.sqrt(1e9) * 1e-6 * rng.normal(size=len(state.q) - n)
    state.nodes = standing(system, state)
    mu, share = scene.contacts[0].friction.static_coefficient, system.pairs[0].a.share
    bound = mu * state.nodes[:, FORCE] / np.where(share > 0.0, share, 1.0)
    angle = rng.uniform(0.0, 2.0 * np.pi, len(bound))
    size = bound * rng.uniform(0.5, 1.5, len(bound))  # some will stick and some slip
    state.nodes[:, TRACTION] = size[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    formula = Formula(HHT(-0.3).coefficients, STEP)
    x = predicted(state, formula)
    x.dx += 2e-7 * rng.normal(size=x.dx.shape)
    x.psi += 4e-6 * rng.normal(size=x.psi.shape)
    e = evaluate(system, state, formula, x, STEP, [None])
    return system, state, formula, x, e


PLANE = surfaces.Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0), direction=ACROSS)


def cases(roller: ReducedBody, bore: ReducedBody) -> dict[str, Scene]:
    """Every kind of partner: plane, cylinder, ball, cone, bore, groove; ground, rigid body, flexible body."""
    high = {"position": (0.0, 0.0, 0.2), "rotation": TURNED}
    down = (0.0, 0.0, -1.0)
    pin = surfaces.Cylinder(radius=0.05, axis_point=(0.0, 0.0, 0.0), axis_direction=ACROSS)
    hole = surfaces.Bore(radius=0.0502, axis_point=(0.0, 0.0, 0.0), axis_direction=ACROSS)
    return {
        "plane of the ground": pair_of(roller, PLANE, down, friction=0.2, **high),
        "ball": pair_of(
            roller, (surfaces.Sphere(radius=0.06, axis_point=(0.0, 0.002, 0.0), axis_direction=ACROSS),), down,
            friction=0.2, **high,
        ),
        "cone": pair_of(
            roller, (surfaces.Cone(radius=0.05, axis_point=(0.0, 0.0, 0.0), axis_direction=ACROSS, half_angle=0.1),),
            down, friction=0.0, law=laws.NonlinearLayer(1e16, 1.5), **high,
        ),
        "groove": pair_of(
            roller,
            (surfaces.Groove(radius=0.05, groove_radius=0.5, axis_point=(0.0, 0.0, 0.0), axis_direction=ACROSS),),
            down, friction=RegularisedCoulomb(0.2, 1e-3), law=laws.HuntCrossley(1e16, 1.5, damping=30.0), **high,
        ),
        "roller": pair_of(roller, roller, down, friction=0.2, **high),
        "pin in the bore": pair_of(bore, (pin,), (0.0, 0.0, 1.0), friction=0.2, rotation=TURNED),
        "in a bore of the ground": pair_of(roller, hole, (0.0, 0.0, 1.0), friction=0.2, rotation=TURNED),
        "roller in a flexible bore": pair_of(
            roller, bore, (0.0, 0.0, 1.0), friction=0.2, law=laws.ExponentialAsperities(5e7, 5e-6), rotation=TURNED
        ),
    }  # fmt: skip


NAMES = (
    "plane of the ground", "ball", "cone", "groove", "roller", "pin in the bore", "in a bore of the ground",
    "roller in a flexible bore",
)  # fmt: skip


@pytest.fixture(scope="module")
def scenes(rubbing_roller: ReducedBody, rubbing_bore: ReducedBody) -> dict[str, Scene]:
    return cases(rubbing_roller, rubbing_bore)


@pytest.mark.parametrize("name", NAMES)
def test_jacobian(name: str, scenes: dict[str, Scene]) -> None:
    """Every derivative: gaps, slips, laws, lever arms, places on the second grid. Tractions are those of the law."""
    scene = scenes[name]
    assert set(NAMES) == set(scenes)
    system, state, formula, x, e = stirred(scene)
    pair: LinearisedPair = e.pairs[0]
    assert len(pair.active) >= 3
    if pair.traction is not None:
        print(f"{name}: {np.sum(pair.traction.state == STICK)} stick, {np.sum(pair.traction.state == SLIP)} slip")
    few = min(6 * len(scene.bodies) + 12, system.layout.size)
    sizes = np.full(system.layout.size, 1e-10)
    reference, _ = differences(system, state, formula, x, STEP, [None], sizes, few)
    found = stiffness_of(pair)
    assert found is not None
    K = dense_jacobian(system.layout, e.balance, [(pair, pair.turning())], [found])[:, :few]
    error = worst_entry(K, reference, sizes[:few], e.residual, AGREE)
    print(f"{name}: {error:.1e}, {len(pair.active)} nodes")
    assert error < AGREE


@pytest.mark.parametrize("name", NAMES)
def test_action_is_reaction(name: str, scenes: dict[str, Scene]) -> None:
    """Forces and moments about a far point of both bodies cancel, with friction, to round-off."""
    system, _, _, _, e = stirred(scenes[name])
    pair: NodePairState = e.pairs[0]
    sight, wrench = pair.sight, pair.wrench()
    far = np.array([3.0, -2.0, 5.0])
    total = np.zeros(3)
    for i, (r, A) in enumerate(((sight.r_a, sight.A_a), (sight.r_b, sight.A_b))):
        total += np.cross(r - far, wrench[6 * i : 6 * i + 3]) + A @ wrench[6 * i + 3 : 6 * i + 6]
    size = float(np.linalg.norm(wrench[:3]))
    assert size > 1.0
    assert np.array_equal(wrench[:3], -wrench[6:9])
    assert np.abs(total).max() < 1e-12 * size * 10.0
    # what B's nodes get is what the nodes give, as far as they lie within its grid
    if pair.over.cells is not None:
        assert pair.second_loads()[0].sum() == pytest.approx(pair.force.sum(), rel=1e-9)
    assert system.nodal
