"""Contact in the monolithic system: against the separated solver, its variants, its two laws, dynamic local modes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from references import monolithic
from references.monolithic.core.linear import VARIANTS
from references.monolithic.line_of_centres.pair import default_layer
from scenes.rollers import PAIR, Path, guided_pair, prescribed_pair, roller_body
from warpffrf.model import signals
from warpffrf.model.contact import Contact
from warpffrf.model.reduced.local_modes import dynamic_modes
from warpffrf.model.scene import Scene
from warpffrf.online import GeneralizedAlpha, Settings, run

INTEGRATOR = GeneralizedAlpha(0.8)
# the separated solver leaves the grids where they are while an iteration turns them by less than 2e-7 columns, and a
# column changes the force of a patch of two nodes by a tenth
AGREE = 2e-8
MEETING = 5e-3  # of the largest force, at 1/25 of the time that it takes to grow


def rigid_inertia(scene: Scene) -> Scene:
    """The scene with constant inertia, as the separated solver's `auto` would choose it."""
    for body in scene.bodies:
        body.level = "constant"
    return scene


def pressing(first: Any, second: Any, **more: Any) -> Scene:
    """Rollers that are pressed together harder while they begin to roll."""
    load = signals.SmoothStep(4e3, 8e3, duration=1e-3)
    return rigid_inertia(guided_pair(first, second, **{"load": load, "speed": 40.0, "ramp": 2e-3, **more}))


@pytest.mark.parametrize("pair", ["equal", "crowned", "crowned first"])
def test_nodes_agree_with_the_separated_solver(pair: str, roller, other_roller) -> None:
    bodies = {"crowned": (roller, other_roller), "crowned first": (other_roller, roller)}.get(pair, (roller, roller))
    scene, options = pressing(*bodies), {"step": 1e-4, "start": "equilibrium", "integrator": INTEGRATOR}
    a = run(
        scene,
        1e-3,
        progress=False,
        settings=Settings(residual_tolerance=1e-11, window_strain=0.3, gain_limit=0.0),
        **options,
    )
    b = monolithic.run(scene, 1e-3, progress=False, tolerance=1e-11, **options)
    assert a.status == b.status == "completed", a.message + b.message
    assert not a.counters["rejected_steps"]
    size = np.abs(a.contacts[PAIR].force).max()
    assert size > 1e3
    assert np.abs(a.contacts[PAIR].force - b.contacts[PAIR].force).max() < AGREE * size
    assert np.abs(a.contacts[PAIR].torque - b.contacts[PAIR].torque).max() < AGREE * size * 0.05
    assert np.array_equal(a.contacts[PAIR].active_nodes, b.contacts[PAIR].active)
    pressure = a.contacts[PAIR].pressure[-1].ravel()
    carried = np.array(list(b.contacts[PAIR].pressures[-1].values()))
    assert np.abs(np.sort(pressure[pressure > 0.0]) - np.sort(carried)).max() < 10.0 * AGREE * carried.max()
    for name, motion in a.bodies.items():
        other = b.bodies[name]
        assert np.abs(motion.position - other.position).max() < 1e-12  # of 0.1 m
        if motion.modal.size:
            assert np.abs(motion.modal - other.modal).max() < AGREE * np.abs(motion.modal).max()


@pytest.mark.slow
def test_bodies_that_meet(roller) -> None:
    """The two solvers take the step that closes by different means: what they differ by falls with the square
    of the step."""
    scene, missed = pressing(roller, roller, gap=2e-6, load=20e3), []
    for count in (25, 50):
        options: dict[str, Any] = {"step": 2.5e-4 / count, "integrator": INTEGRATOR, "progress": False}
        a, b = run(scene, 2.5e-4, **options), monolithic.run(scene, 2.5e-4, **options)
        assert a.status == b.status == "completed", a.message + b.message
        force = [h.contacts[PAIR].force for h in (a, b)]
        missed.append(np.abs(force[0] - force[1]).max() / np.abs(force[0]).max())
    assert missed[0] < MEETING and missed[1] < 0.5 * missed[0]


@pytest.mark.parametrize("law", ["hats", "nodes"])
def test_variants_agree(law: str, roller) -> None:
    """The same equations, solved in three ways."""
    scene, found = pressing(roller, roller), {}
    for variant in VARIANTS:
        history = monolithic.run(scene, 8e-4, step=1e-4, start="equilibrium", variant=variant, law=law, progress=False)
        assert history.status == "completed", history.message
        found[variant] = history
    size = np.abs(found["full"].contacts[PAIR].force).max()
    for variant in VARIANTS[1:]:
        off = np.abs(found[variant].contacts[PAIR].force - found["full"].contacts[PAIR].force).max()
        assert off < 1e-7 * size  # tolerance 1e-9 of every step, and round-off of a stiff layer, over eight of them
    assert found["modified"].counters["factorisations"] < found["full"].counters["factorisations"]


def pressed(first: Any, approach: float, **options: Any) -> float:
    """Contact force [N] of a pair at a prescribed approach [m], at rest."""
    scene = rigid_inertia(prescribed_pair(first, first, Path.of([approach, approach], 0.01)))
    history = monolithic.run(scene, 1e-6, step=1e-6, start="equilibrium", progress=False, **options)
    assert history.status == "completed", history.message
    return float(np.linalg.norm(history.contacts[PAIR].force[0]))


@pytest.mark.slow
def test_force_of_nodes_converges_with_the_layer_and_to_that_of_nodes() -> None:
    """A patch of ten elements: a layer three times as stiff changes a third, the default less than 0.5 %."""
    body = roller_body(150, layers=4, axial=2, grading=1.6, order=1, max_frequency=15e3, cache=False)
    k = default_layer(body.contact_surfaces["rim"])
    approach = 1.2e-3  # m: far beyond steel, so that a coarse mesh has many nodes in contact
    soft, normal, stiff, stiffest = (
        pressed(body, approach, law="nodes", layer_stiffness=f * k) for f in (0.3, 1, 3, 30)
    )
    errors = np.array([soft, normal, stiff]) / stiffest - 1.0
    assert abs(errors[1]) < 5e-3
    assert errors[0] / errors[1] == pytest.approx(3.3, rel=0.4) and errors[1] / errors[2] == pytest.approx(3.3, rel=0.4)
    assert stiffest == pytest.approx(pressed(body, approach, law="hats"), rel=0.02)


@pytest.fixture(scope="module")
def dynamic_roller() -> Any:
    """A roller with the mass of its local modes."""
    from warpffrf.model.material import Material
    from warpffrf.model.mesh import roller
    from warpffrf.model.surfaces import Cylinder
    from warpffrf.offline import ContactGrid, ReductionOptions, reduce

    mesh = roller(0.05, 0.015, 0.02, sectors=60, layers=3, axial=2, grading=1.6, order=1)
    return reduce(
        mesh, Material(210e9, 0.3, 7850.0), interfaces={"bore": "rigid"}, contact={"rim": Cylinder()},
        max_frequency=15e3, cache=False, progress=False, options=ReductionOptions(local_dynamics=True),
        grid=ContactGrid(contact_fixed=False),
    )  # fmt: skip


def test_dynamic_local_modes_are_exact_at_rest_at_any_cut(dynamic_roller) -> None:
    exact = pressed(dynamic_roller, 5e-4, tolerance=1e-10)
    for count in (0, 20, None):
        modes = dynamic_modes(dynamic_roller.contact_surfaces["rim"], count=count)
        given = {("lower", "rim"): modes, ("upper", "rim"): modes}
        force = pressed(dynamic_roller, 5e-4, local="hht", local_modes=given, tolerance=1e-10)
        assert force == pytest.approx(exact, rel=1e-8)


def test_dynamic_local_modes_follow_slow_loads(dynamic_roller) -> None:
    """A load that rises in 5 ms, 100 times slower than the lowest local mode: force as with quasi-static ones."""
    scene = pressing(dynamic_roller, dynamic_roller, load=signals.SmoothStep(4e3, 8e3, duration=5e-3), speed=None)
    found = [
        monolithic.run(scene, 5e-3, step=2.5e-4, start="equilibrium", local=local, progress=False)
        for local in ("quasi_static", "hht")
    ]
    assert all(h.status == "completed" for h in found)
    forces = [h.contacts[PAIR].force for h in found]
    assert np.abs(forces[0] - forces[1]).max() < 2e-4 * np.abs(forces[0]).max()
    assert np.any(found[1].contacts[PAIR].local[0][-1] != 0.0)


def test_a_run_goes_on_where_another_has_ended(roller) -> None:
    scene = pressing(roller, roller)
    more: dict[str, Any] = {"step": 1e-4, "variant": "low_rank", "progress": False}
    whole = monolithic.run(scene, 6e-4, start="equilibrium", **more)
    half = monolithic.run(scene, 3e-4, start="equilibrium", **more)
    rest = monolithic.run(scene, 3e-4, start=half, **more)
    assert rest.time[-1] == pytest.approx(whole.time[-1], rel=1e-12)
    off = np.abs(rest.contacts[PAIR].force[-1] - whole.contacts[PAIR].force[-1]).max()
    assert off < 1e-9 * np.abs(whole.contacts[PAIR].force).max()


def test_two_bodies_without_a_joint_come_together(roller) -> None:
    """Nothing but contact between two bodies: action equals reaction, so their momentum stays."""
    scene = Scene()
    scene.add_body(roller, name="lower", inertia="constant")
    scene.add_body(roller, name="upper", position=(0, 0, 0.1), velocity=(0, 0, -0.2), inertia="constant")
    scene.add(Contact(scene.body("lower")["rim"], scene.body("upper")["rim"], name=PAIR))
    history = monolithic.run(scene, 2e-4, step=4e-6, variant="low_rank", progress=False)
    assert history.status == "completed", history.message
    assert np.abs(history.contacts[PAIR].force).max() > 10.0
    total = history.bodies["lower"].velocity + history.bodies["upper"].velocity
    assert np.abs(total - total[0]).max() < 1e-9 * 0.2
