"""The snapping arch, whole; equilibria by load on both sides of the limit; limits and works of a path."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from checks import Check, both_sizes, left_behind, missed

import warpffrf as wf
from demos import snapping_arch as demo
from demos.snapping_arch import LARGEST, MIDDLE, RISE, crown_way
from references.large_deflections.equilibrium_path import EquilibriumPath, pushed_arch

Array = np.ndarray
LIMIT, LOWER, PATH = 2e-3, 5e-3, 0.025  # of both limit loads, of the path over the upper one: at its end, 0.2 rad
LANDS, BEFORE = 5e-3, 5e-3  # of the crown behind the jump and before it, at the same load
LATE, SLOW = 0.012, 8.0  # of the limit loads, s: delay of a jump under a load that grows so long; as rate^(2/3)
WORK = 5.0 * LATE  # of the work of a cycle: jumps that are late
TAKEN = 0.03  # of it: what the integrator takes in the place of damping


def full_model(size: demo.Size) -> EquilibriumPath:
    """The path of the mesh of the demo in full finite elements."""
    top = (0.0, 0.0, RISE + 0.5 * demo.THICKNESS)
    return pushed_arch(demo.mesh(size), demo.STEEL, top, demo.FARTHEST, size.steps)


def path_of(result: wf.Result) -> EquilibriumPath:
    """The path of a run of `driven`."""
    return EquilibriumPath(crown_way(result), -result.joint("rod").force[:, 2])


@dataclass(frozen=True, eq=False)
class Snapped:
    """The run under the load: `result`, way `w` (T,) [m] of the crown and `force` (T,) [N]."""

    result: wf.Result
    seconds: float

    @property
    def w(self) -> Array:
        """(T,) m."""
        return crown_way(self.result)

    @property
    def force(self) -> Array:
        """(T,) N."""
        t = self.result.time
        return LARGEST * np.minimum(t, 2.0 * self.seconds - t) / self.seconds

    @property
    def jumps(self) -> tuple[int, int]:
        """Rows in which the crown first is beyond `MIDDLE`, and above it again for good."""
        beyond = np.flatnonzero(self.w > MIDDLE)
        return int(beyond[0]), int(beyond[-1])

    def way(self, force: float, *, behind: bool) -> float:
        """w [m] at a force: behind the jump as the load comes down, before it as it grows."""
        half = len(self.w) // 2
        w, F = (self.w[half:][::-1], self.force[half:][::-1]) if behind else (self.w[:half], self.force[:half])
        return float(np.interp(force, F, w))


def checks(path: EquilibriumPath, snapped: Snapped, exact: EquilibriumPath) -> list[Check]:
    """The figures of both runs compared with the path of the full model."""
    (F_1, F_2), fe = exact.loads, "full FE model"
    there, back = snapped.jumps
    first = slice(1, None)
    later = (SLOW / snapped.seconds) ** (2.0 / 3.0)
    off = float(np.abs(path.F - exact(path.w))[first].max())
    energy = snapped.result.energy
    return [
        Check("by displacement: limit load", path.loads[0], F_1, fe, LIMIT, "N"),
        Check("by displacement: its place", path.limits[0], exact.limits[0], fe, LANDS, "mm", 1e3),
        Check("by displacement: lower limit load", path.loads[1], F_2, fe, LOWER, "N"),
        Check("by displacement: place of the lower", path.limits[1], exact.limits[1], fe, LANDS, "mm", 1e3),
        Check("by displacement: force off by at most", off, 0.0, f"{fe}, over the limit load", PATH, "N", scale=F_1),
        Check("by load: crown at 0.97 of the limit", snapped.way(0.97 * F_1, behind=False),
              exact.rising(0.97 * F_1, behind=False), fe, BEFORE, "mm", 1e3),
        Check("by load: snaps through at", float(snapped.force[there]), F_1, f"{fe}, limit load", LATE * later, "N"),
        Check("by load: crown at this load, snapped", snapped.way(F_1, behind=True), exact.rising(F_1, behind=True),
              fe, LANDS, "mm", 1e3),
        Check("by load: snaps back at", float(snapped.force[back]), F_2, f"{fe}, lower limit load", LATE * later,
              "N"),
        Check("by load: comes to rest at", float(snapped.w[-1]), 0.0, "no load, over the rise", 1e-3, "mm", 1e3,
              scale=RISE),
        Check("by load: work that a cycle takes", float(energy["force_work"][-1]), exact.work_of_a_cycle,
              f"{fe}, both jumps", WORK * later, "J"),
        Check("by load: taken by damping", float(energy["damping"][-1]), float(energy["force_work"][-1]),
              "work of the force", TAKEN, "J"),
    ]  # fmt: skip


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    size = demo.QUICK if quick else demo.FULL
    snapped, steps = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "snapping_arch", "driven")
    found = checks(path_of(steps), Snapped(snapped, size.seconds), full_model(size))
    assert len(found) == 12 and not missed(found)
    computed = {check.name: check.computed for check in found}
    assert computed["by load: snaps through at"] > computed["by displacement: limit load"]


def test_limits_and_work_of_a_path_that_is_a_cubic() -> None:
    """F = w^3/3 - 3 w^2/2 + 2 w: limits at 1 and 2, loads 5/6 and 2/3; it comes to these again at 5/2 and 1/2, and as
    each jump is by 3/2 from a double root, both leave int (3/2 - s) s^2/3 ds = 9/64."""
    w = np.linspace(0.0, 3.0, 31)
    path = EquilibriumPath(w, w**3 / 3.0 - 1.5 * w**2 + 2.0 * w)
    assert path.limits == pytest.approx((1.0, 2.0), abs=1e-9)
    assert path.loads == pytest.approx((5.0 / 6.0, 2.0 / 3.0), abs=1e-9)
    assert path.rising(5.0 / 6.0, behind=True) == pytest.approx(2.5, abs=1e-9)
    assert path.rising(2.0 / 3.0, behind=False) == pytest.approx(0.5, abs=1e-9)
    assert path.work_of_a_cycle == pytest.approx(2.0 * 9.0 / 64.0, abs=1e-9)


@pytest.fixture(scope="module")
def exact() -> EquilibriumPath:
    return full_model(demo.QUICK)


@pytest.mark.parametrize("share", [0.9, 0.97, 1.03])
def test_equilibrium_finds_the_arch_before_its_limit_and_snapped(exact: EquilibriumPath, share: float) -> None:
    """0.4 % where the tangent is a third of that of the arch at rest, as in the snapped state."""
    force = share * exact.loads[0]
    rest = demo.clamped(demo.QUICK, progress=False)
    height = rest.body("arch")["crown"].point[2]
    rest.add(wf.forces.PointForce(rest.body("arch")["crown"], (0.0, 0.0, -force)))
    found = wf.equilibrium(rest)
    assert found.status == "completed", found.message
    w = height - found.sensor("crown").values[-1, 2]
    assert w == pytest.approx(exact.rising(force, behind=share > 1.0), rel=LANDS)
