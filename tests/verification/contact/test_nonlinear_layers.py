"""Nonlinear layers between two rollers: closed forms, integrals of one variable, and impacts."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq
from scipy.special import beta

from scenes.rollers import STEEL, roller_body
from warpffrf.model import joints, laws
from warpffrf.model.contact import Contact
from warpffrf.model.forces import PointForce
from warpffrf.model.mesh import box
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.scene import Scene
from warpffrf.model.surfaces import Plane
from warpffrf.offline import reduce
from warpffrf.online.history.history import History
from warpffrf.online.run import find_equilibrium, run

WIDTH, RADIUS = 0.02, 0.05
R = 0.5 * RADIUS  # relative radius
BED = (
    0.01  # of approach and peak: 8 shape functions a half-width; the rollers themselves yield by 0.1 % of the approach
)
FLAT = 1e-3  # of pressure and decay length: the ends are felt as far as the block's thickness, its own yield is 1e-4
FIRST_ORDER = 0.02  # of the restitution: rates are backward differences, 100 steps a contact
SEEN = 1e-2  # of the peak force, above which contact is timed: at its ends the force rises with the square of time
ODE = 0.01  # of peak force and duration: grid and step; the bodies yield by 0.3 % of the depth


@pytest.fixture(scope="module")
def body() -> ReducedBody:
    return roller_body(900, layers=3, axial=2, grading=1.6, order=1, max_frequency=12e3, cache=False)


def stacked(body: ReducedBody, law: Any, *, force: float = 0.0, speed: float = 0.0, gap: float = 0.0) -> Scene:
    """The upper roller on a vertical guide above a fixed one, pressed down or falling."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    lower = scene.add_body(body, name="lower")
    upper = scene.add_body(
        body, name="upper", position=(0.0, 0.0, 2.0 * RADIUS + gap), velocity=(0.0, 0.0, -speed)
    )  # fmt: skip
    scene.add(joints.Fixed(scene.ground, lower["bore"]))
    scene.add(joints.Prismatic(scene.ground, upper["bore"], axis=(0.0, 0.0, 1.0)))
    if force:
        scene.add(PointForce(upper["bore"], (0.0, 0.0, -force)))
    scene.add(Contact(lower["rim"], upper["rim"], law=law, capacity=400, name="pair"))
    return scene


@pytest.fixture(scope="module")
def slab() -> ReducedBody:
    """A long flat block, 60 x 10 x 6 mm, whose lower face is the contact surface."""
    return reduce(
        box((0.06, 0.01, 0.006), (24, 2, 2), order=1), STEEL, interfaces={"z_max": "rigid"},
        contact={"z_min": Plane()}, max_frequency=30e3, cache=False, progress=False,
    )  # fmt: skip


def on_floor(slab: ReducedBody, law: Any, force: float) -> History:
    """The slab pressed flat on a rigid floor: its lower face and the floor touch at rest."""
    scene = Scene(gravity=(0.0, 0.0, 0.0))
    block = scene.add_body(slab, name="block", position=(0.0, 0.0, 0.003))
    scene.add(joints.Prismatic(scene.ground, block["z_max"], axis=(0.0, 0.0, 1.0)))
    scene.add(PointForce(block["z_max"], (0.0, 0.0, -force)))
    floor = scene.ground.surface(Plane(origin=(0.0, 0.0, 0.0), outward=(0.0, 0.0, 1.0)), name="floor")
    scene.add(Contact(block["z_min"], floor, law=law, name="pair"))
    return settled(scene)


def settled(scene: Scene) -> History:
    history = find_equilibrium(scene)
    assert history.status == "completed", history.message
    return history


@pytest.mark.parametrize("exponent", [1.5, 3.0])
def test_a_bed_that_stiffens(body: ReducedBody, exponent: float) -> None:
    """P' = k d^n b B(1/2, n + 1), b = sqrt(2 R d), and the peak k d^n."""
    d = 2e-4
    load = 50e3  # N/m
    k = load / (d**exponent * np.sqrt(2.0 * R * d) * beta(0.5, exponent + 1.0))
    pair = settled(stacked(body, laws.NonlinearLayer(k, exponent), force=load * WIDTH)).contacts["pair"]
    assert pair.approach[0] == pytest.approx(d, rel=BED)
    assert pair.pressure[0].max() == pytest.approx(k * d**exponent, rel=exponent * BED)


def test_a_roller_on_asperities(body: ReducedBody) -> None:
    """The gap g at which int p_0 exp(-(g + 2 (R - R cos xi))/lambda) R dxi carries the load: asperities that yield much
    more than the rollers do (1 um)."""
    law = laws.ExponentialAsperities(1e6, 200e-6)
    for load in (2e3, 40e3):

        def excess(g: float, load: float = load) -> float:
            end = np.arccos(1.0 - (law.end - g) / (2.0 * RADIUS))
            half, _ = quad(lambda xi: float(law.pressure(g + 2.0 * RADIUS * (1.0 - np.cos(xi)))), 0.0, end)
            return 2.0 * RADIUS * half - load

        gap = brentq(excess, -1e-3, 1e-3)
        history = settled(stacked(body, law, force=load * WIDTH))
        pair = history.contacts["pair"]
        assert -pair.approach[0] == pytest.approx(gap, abs=BED * law.decay_length)
        assert pair.pressure[0].max() == pytest.approx(float(law.pressure(gap)), rel=BED)
        assert any("ends at" in note for note in history.notes)


@pytest.mark.parametrize("pressure", [1e3, 1e5, 1e6])
def test_flat_faces_on_asperities(slab: ReducedBody, pressure: float) -> None:
    """The gap lambda ln(p_0/p) of a uniform pressure, away from the ends where the outermost nodes fall to zero."""
    law = laws.ExponentialAsperities(1e6, 20e-6)
    history = on_floor(slab, law, pressure * 0.06 * 0.01)
    p = history.contacts["pair"].pressure[0]
    p = p[np.any(p > 0.0, axis=1)]
    middle = p[len(p) // 3 : 2 * len(p) // 3]
    assert np.ptp(middle) < FLAT * pressure
    gap = history.bodies["block"].position[0, 2] - 0.003
    shift = law.decay_length * np.log1p(1e-6 * law.pressure_at_zero / middle.mean())  # of the cut
    exact = law.decay_length * np.log(law.pressure_at_zero / middle.mean()) - shift
    assert gap == pytest.approx(exact, abs=FLAT * law.decay_length)


def test_the_first_power_on_a_face_with_ends(slab: ReducedBody) -> None:
    """Cells under the outermost nodes count as they do in the linear layer's Gram matrix."""
    linear, power = (on_floor(slab, law, 60.0) for law in (laws.LinearLayer(1e11), laws.NonlinearLayer(1e11, 1.0)))
    p, q = (history.contacts["pair"].pressure for history in (linear, power))
    assert np.abs(p - q).max() < 1e-9 * p.max()


def test_a_load_far_beyond_what_holds_at_touch(body: ReducedBody) -> None:
    """50 kN on a layer that hardly resists at first: the search for the static state begins again with shorter steps,
    and ends at P' = k d^(3/2) sqrt(2 R d) 3 pi/8, but for R - R cos at depths of 3 mm."""
    history = settled(stacked(body, laws.NonlinearLayer(1e12, 1.5), force=50e3))
    d = np.sqrt(50e3 / WIDTH / (1e12 * np.sqrt(2.0 * R) * beta(0.5, 2.5)))
    assert history.contacts["pair"].approach[0] == pytest.approx(d, rel=0.05)


@pytest.mark.parametrize("restitution", [1.0, 0.6])
def test_an_impact_on_a_damped_layer(body: ReducedBody, restitution: float) -> None:
    """Force, duration and restitution of m d'' = -K d^(n + 1/2) (1 + chi d'), K = k w sqrt(2 R) B(1/2, n + 1), and the
    loss in the ledger."""
    k, n, speed = 1e14, 1.5, 0.05
    law = laws.HuntCrossley(k, n, restitution=restitution, impact_speed=speed)
    K = k * WIDTH * np.sqrt(2.0 * R) * beta(0.5, n + 1.0)

    def force(d: Any, rate: Any) -> Any:
        return K * np.maximum(d, 0.0) ** (n + 0.5) * np.maximum(1.0 + law.chi * rate, 0.0)

    def leaves(_: float, y: np.ndarray) -> float:
        return y[0]

    leaves.terminal, leaves.direction = True, -1.0  # type: ignore[attr-defined]
    exact = solve_ivp(
        lambda _, y: [y[1], -force(*y) / body.mass], (0.0, 1.0), (1e-12, speed),
        events=leaves, rtol=1e-9, atol=1e-13, max_step=1e-5,
    )  # fmt: skip
    duration = exact.t[-1]
    history = run(stacked(body, law, speed=speed), 1.5 * duration, step=duration / 100.0, progress=False)
    assert history.status == "completed", history.message
    pair, energy = history.contacts["pair"], history.energy
    assert pair.pressure.min() >= 0.0
    pressed = -pair.force[:, 2]  # on the lower roller
    assert pressed.min() >= 0.0
    assert pressed.max() == pytest.approx(force(*exact.y).max(), rel=ODE)
    touching = history.time[pressed > SEEN * pressed.max()]
    felt = exact.t[force(*exact.y) > SEEN * force(*exact.y).max()]
    assert touching[-1] - touching[0] == pytest.approx(felt[-1] - felt[0], rel=0.02)  # two of 100 steps
    after = history.bodies["upper"].velocity[-1, 2] / speed
    assert after == pytest.approx(restitution, rel=FIRST_ORDER)
    start = energy["kinetic"][0]
    assert energy["damping"][-1] / start == pytest.approx(1.0 - restitution**2, abs=FIRST_ORDER)
    assert np.abs(energy["numerical"] + energy["contact_grid"]).max() < 0.005 * start


def test_a_damped_layer_goes_on_where_it_was_left(body: ReducedBody) -> None:
    """A run continued in the middle of an impact is the run that was not stopped, bit for bit: depths and drags are in
    the checkpoint."""
    law = laws.HuntCrossley(1e14, 1.5, damping=5.0)
    whole = run(stacked(body, law, speed=0.05), 40e-5, step=1e-5, progress=False)
    begun = run(stacked(body, law, speed=0.05), 25e-5, step=1e-5, progress=False)
    rest = run(begun.scene, 15e-5, step=1e-5, start=begun, progress=False)
    assert begun.contacts["pair"].force[-1, 2] < 0.0
    np.testing.assert_array_equal(rest.contacts["pair"].pressure[-1], whole.contacts["pair"].pressure[-1])
    np.testing.assert_array_equal(rest.energy["damping"][-1], whole.energy["damping"][-1])
