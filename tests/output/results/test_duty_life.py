"""Load spectra: load steps of a static run compared with single equilibria, and lives that add up."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from scenes.published_bearings import E206, MM, p7
from warpffrf.model import joints, laws
from warpffrf.model.bearings import Flanges, RollerGeometry, RollingContact
from warpffrf.model.bearings.modified_life import life_of_points
from warpffrf.model.errors import InputError
from warpffrf.model.forces import PointForce
from warpffrf.model.scene import Scene
from warpffrf.model.signals import Table, short_path
from warpffrf.output.bearings.bearing_result import BearingResult
from warpffrf.output.bearings.patches import Patches, shear_below
from warpffrf.output.contact.hertz import HertzPoint, largest_below
from warpffrf.output.result import Result
from warpffrf.output.simulate import equilibrium, static

RADIAL, AXIAL = (1e3, 3e3, 500.0, 2e3), (200.0, 0.0, 800.0, 1e3)  # N, of the points
SHARES, SPEEDS = np.array([0.1, 0.2, 0.3, 0.4]), np.array([100.0, 50.0, -200.0, 0.0])  # -, rad/s
SAME = 1e-6  # of the largest load


def spectrum() -> Result:
    """P7 under the points."""
    number = np.arange(len(RADIAL), dtype=float)
    loads: Any = (Table(number, RADIAL), Table(number, AXIAL))
    return static(p7(10e-6, *loads)[0], number[-1], step=1.0, progress=False)


@pytest.fixture(scope="module")
def run() -> Result:
    return spectrum()


@pytest.fixture(scope="module")
def found(run: Result) -> BearingResult:
    return run.bearing("bearing")


def test_load_steps_are_single_equilibria(found: BearingResult) -> None:
    """Whatever came before."""
    assert found.inner_load.shape == (len(RADIAL), 7)
    for i, loads in enumerate(zip(RADIAL, AXIAL, strict=True)):
        alone = equilibrium(p7(10e-6, *loads)[0], progress=False).bearing("bearing")
        np.testing.assert_allclose(found.inner_load[i], alone.inner_load[-1], atol=SAME * alone.inner_load.max())
        np.testing.assert_allclose(found.displacement[i], alone.displacement[-1], atol=1e-10)
        np.testing.assert_allclose(
            found.inner_patches.peak_pressure[i], alone.inner_patches.peak_pressure[-1], rtol=1e-4, atol=1e6
        )
        assert found.reference_life(row=i).revolutions == pytest.approx(alone.reference_life().revolutions, rel=1e-5)


def test_rollers_in_any_order() -> None:
    """An unloading roller takes no more iterations than others, and each point has the same loads in the order of the
    shortest steps."""
    rng = np.random.default_rng(1)
    angle, load = rng.uniform(-0.6, 0.6, 60), rng.uniform(1e3, 9e3, 60)
    forces = load[:, None] * np.stack([np.sin(angle), np.cos(angle)], axis=1)
    geometry = RollerGeometry(
        elements=20, roller_diameter=0.01, roller_length=0.01, pitch_diameter=0.08, clearance=15e-6
    )

    def run(points: np.ndarray) -> Result:
        scene, number = Scene(gravity=(0, 0, 0)), np.arange(60.0)
        contact = RollingContact(law=laws.IsoLamina(geometry.roller_length))
        ring: Any = scene.add_bearing("b", geometry, first=(0, 0, 1), outer=scene.ground, contact=contact).inner
        scene.add(joints.Planar(scene.ground.at((0, 0, 0)), ring, axis=(0, 1, 0)))
        x, z = (Table(number, column) for column in points.T)
        scene.add(PointForce(ring, (x, 0.0, z)))
        return static(scene, 59.0, step=1.0, progress=False)

    drawn, order = run(forces), short_path(forces)
    assert drawn.history.counters["mean_iterations"] < 10.0  # 14 with the tangent of the law alone
    near = run(forces[order])
    assert near.history.counters["mean_iterations"] < drawn.history.counters["mean_iterations"] - 1.0
    one, other = drawn.bearing("b"), near.bearing("b")
    np.testing.assert_allclose(other.inner_load, one.inner_load[order], atol=SAME * one.inner_load.max())
    np.testing.assert_allclose(other.displacement, one.displacement[order], atol=1e-10)


def test_damages_of_the_points_add_up(found: BearingResult) -> None:
    """Revolutions per second over the life of each point; the last one is at rest, the third turns backwards."""
    per_second = SHARES * np.abs(SPEEDS) / (2e6 * np.pi)
    damage = per_second / [found.reference_life(row=i).revolutions for i in range(4)]
    life = found.duty_life(SHARES, SPEEDS)
    assert life.time == pytest.approx(1.0 / damage.sum(), rel=1e-12)
    assert life.revolutions == pytest.approx(per_second.sum() / damage.sum(), rel=1e-12)
    np.testing.assert_allclose(life.shares, damage / damage.sum(), rtol=1e-12)
    assert found.duty_life(SHARES, SPEEDS, reliability=95.0).time == pytest.approx(0.64 * life.time, rel=5e-3)
    kappa = np.array([0.5, 1.0, 2.0, 3.0])  # the last one does not matter
    modified = [
        found.modified_life(23.4e3, 11e3, kappa=float(k), contamination=0.4, row=i).revolutions
        for i, k in enumerate(kappa)
    ]
    kappa[-1] = 0.0
    life = found.duty_life(SHARES, SPEEDS, 23.4e3, 11e3, kappa=kappa, contamination=0.4)
    assert life.time == pytest.approx(1.0 / np.sum(per_second / modified), rel=1e-12)


def test_points_without_load_do_no_damage() -> None:
    life = life_of_points(np.array([0.5, 0.5]), np.array([100.0, 100.0]), np.array([50.0, np.inf]))
    assert life.revolutions == pytest.approx(100.0) and life.shares.tolist() == [1.0, 0.0]


def test_capacities_are_those_of_the_geometry(found: BearingResult) -> None:
    own = found.geometry
    given = found.modified_life(own.dynamic_rating, own.static_rating, kappa=1.0, contamination=0.5)
    assert found.modified_life(kappa=1.0, contamination=0.5) == given
    F_r, F_a = np.hypot(*found.force[1, :2]), abs(found.force[1, 2])
    assert found.static_safety(row=1) == pytest.approx(own.static_rating / max(F_r, 0.6 * F_r + 0.5 * F_a), rel=1e-9)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"shares": SHARES[:3], "speed": 100.0}, r"shares must have shape \(4\), got \(3,\)"),
        ({"shares": SHARES - 0.1, "speed": 100.0}, "add up to 0.6; make their sum 1"),
        ({"shares": [-0.1, 0.5, 0.3, 0.3], "speed": 100.0}, "shares of the time must not be negative, got -0.1"),
        ({"shares": SHARES, "speed": [1.0, 2.0]}, r"speed \[rad/s\] must have shape \(4\)"),
        ({"shares": SHARES, "speed": 100.0, "kappa": 1.0}, "give kappa and contamination"),
    ],
)
def test_bad_spectra(found: BearingResult, arguments: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=f"bearing 'bearing': duty_life: .*{said}|duty_life: .*{said}"):
        found.duty_life(**arguments)


def test_equilibria_of_no_path_have_no_error_of_energy(run: Result) -> None:
    """Works by the trapezoidal rule over load steps of any length are no error of anything; with friction they are."""
    assert not {line.source for line in run.error_budget()} & {"energy ledger", "time step"}
    assert not any("works of the load steps" in note for note in run.history.notes)
    rubbing = p7(10e-6, 1e3, 0.0)[0]
    for contact in rubbing.lumped_contacts:
        contact.friction = laws.Coulomb(0.1)
    lines = static(rubbing, 1.0, step=1.0, progress=False).error_budget()
    assert "time step" in {line.source for line in lines}


def test_shear_below_many_patches_is_that_of_each() -> None:
    across, around = np.array([[2e-3, 1e-3], [3e-4, 0.0]]), np.array([[2e-4, 3e-4], [9e-4, 0.0]])
    peak = np.array([[1e9, 2e9], [3e9, 0.0]])
    shear = shear_below(Patches(across, around, peak), 0.3)
    for a, b, p, stress, depth in zip(
        across.flat, around.flat, peak.flat, shear.stress.flat, shear.depth.flat, strict=True
    ):
        if not p:
            assert np.isnan(stress) and np.isnan(depth)
            continue
        one = largest_below(HertzPoint((max(a, b), min(a, b)), 0.0, p, 0.0, 0.0, (0.0, 0.0), 0.0), 0.3)[1]
        assert (stress, depth) == pytest.approx((one.stress, one.depth), rel=1e-4)


@pytest.mark.parametrize("tilt", [1e-3, -1e-3])
def test_pressure_at_the_ends_of_misaligned_rollers(tilt: float) -> None:
    """An inner ring that is tilted about x presses the ends at +y of the rollers at +z; Hertz's pressure of a line in
    each lamina, and the largest of them in the table."""
    length, n = 10 * MM, 30
    geometry = RollerGeometry(
        elements=14, roller_diameter=10 * MM, roller_length=length, pitch_diameter=64 * MM, clearance=10e-6
    )
    scene = Scene(gravity=(0, 0, 0))
    bearing = scene.add_bearing(
        "NU", geometry, first=(0, 0, 1), outer=scene.ground, materials=E206, flanges=Flanges(0.1 * MM),
        contact=RollingContact(law=laws.IsoLamina(length, n)),
    )  # fmt: skip
    bearing.inner.rotation = np.array([np.sin(0.5 * tilt), 0.0, 0.0, np.cos(0.5 * tilt)])
    scene.add(joints.Planar(scene.ground.at((0, 0, 0)), bearing.inner, axis=(0, 1, 0)))
    scene.add(PointForce(bearing.inner, (0.0, 0.0, 4000.0)))
    found = equilibrium(scene, progress=False).bearing("NU")
    q, p = found.lamina_load["inner"], found.lamina_pressure["inner"]
    assert q.shape == p.shape == (1, 14, n)
    np.testing.assert_allclose(q.sum(axis=-1), found.inner_load, rtol=1e-12)
    R = 1.0 / (1.0 / (5 * MM) + 1.0 / geometry.bottom("inner"))
    exact = np.sqrt(q * n / length * 0.5 * E206.plane_strain_modulus / (np.pi * R))
    np.testing.assert_allclose(p, exact, rtol=1e-6)
    np.testing.assert_allclose(found.inner_patches.peak_pressure, p.max(axis=-1), rtol=1e-12)
    lever = np.sum(q[0, 0] * (np.arange(n) - 0.5 * (n - 1)))
    assert np.sign(lever) == np.sign(tilt)
    assert p[0, 0, 0 if tilt > 0.0 else -1] == 0.0 and p.max() > 1.02 * p[0, 0, n // 2]
