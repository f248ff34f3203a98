"""The roller bearing, whole; its references against closed forms and a thick ring that is as good as a housing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from checks import Check, both_sizes, left_behind, missed
from scipy.optimize import brentq

import warpffrf as wf
from demos import roller_bearing as demo
from demos.roller_bearing import (
    BORE,
    CLEARANCE,
    COUNT,
    FEET_SET,
    FULL,
    LENGTH,
    LOAD,
    NAME,
    ROLLER,
    STEEL,
    WALL,
    Size,
    outer_ring,
)
from references.finite_elements.ring_on_feet import RingOnFeet, compliance

LOADS, DEFLECTION = 0.03, 0.02  # of the largest load; of the largest deflection
PUBLISHED = 1e-2


def palmgren(Q: np.ndarray) -> np.ndarray:
    """Approach [m] of a roller and the inner ring under loads [N]: 3.84e-5 Q^0.9/l^0.8 in mm."""
    return 3.84e-8 * np.maximum(Q, 0.0) ** 0.9 / (1e3 * LENGTH) ** 0.8


def rigid_loads() -> np.ndarray:
    """(COUNT,) N, in a stiff housing: two contacts in series."""
    phi = 2.0 * np.pi * np.arange(COUNT) / COUNT

    def loads(shift: float) -> np.ndarray:
        together = np.maximum(shift * np.cos(phi) - 0.5 * CLEARANCE, 0.0)
        return (together / (2.0 * palmgren(np.ones(1))[0])) ** (10.0 / 9.0)

    shift: Any = brentq(lambda s: float(loads(s) @ np.cos(phi)) - LOAD, 0.0, 1e-3, xtol=1e-15)
    return loads(shift)


def reference(size: Size = FULL) -> RingOnFeet:
    """The ring on feet by full finite elements."""
    phi = 2.0 * np.pi * np.arange(COUNT) / COUNT
    C = compliance(outer_ring(size), STEEL, (BORE, BORE + WALL), FEET_SET, phi - 0.5 * np.pi, LENGTH)
    return RingOnFeet(C, phi, WALL, LENGTH, 1.0 / (2.0 / ROLLER - 1.0 / BORE), CLEARANCE, STEEL, palmgren)


def sinks(result: wf.Result) -> np.ndarray:
    """(COUNT,) m: how far rollers sink into the undeformed outer ring, negative where they are apart from it."""
    place = np.array([result.body(f"{NAME} roller {i + 1}").position[-1] for i in range(COUNT)])
    return np.hypot(place[:, 0], place[:, 2]) + 0.5 * ROLLER - BORE


def checks(results: dict[str, wf.Result], ring: RingOnFeet) -> list[Check]:
    """Loads and deflections compared with the references."""
    Q = results["feet"].bearing(NAME).outer_load[-1]
    stiff = results["stiff"].bearing(NAME).outer_load[-1]
    shift, exact = ring.solve(LOAD, 1e-4)
    deep, deepest = sinks(results["feet"]), ring.sinks(exact)
    moved = -float(results["feet"].body(f"{NAME} inner ring").position[-1, 2])
    source, largest = "full finite elements", float(exact.max())
    loads = [
        Check(f"on feet: {name}", float(Q[i]), float(exact[i]), source, LOADS, "N", scale=largest)
        for i, name in enumerate(("roller under the load", "the next one", "the third one"))
    ]
    return [
        Check("stiff housing: roller under the load", float(stiff[0]), 1956.0, "published", PUBLISHED, "N"),
        Check("stiff housing: the next one", float(stiff[1]), 1384.0, "published", PUBLISHED, "N"),
        *loads,
        Check("on feet: all loads along the load", float(Q @ np.cos(ring.phi)), LOAD, "statics", 1e-3, "N"),
        Check("on feet: a roller sinks into the ring", float(deep[0]), float(deepest[0]), source, DEFLECTION, "um",
              1e6),
        Check("on feet: the next one sinks", float(deep[1]), float(deepest[1]), source, DEFLECTION, "um", 1e6,
              scale=float(deepest[0])),
        Check("on feet: the inner ring moves", moved, shift, source, DEFLECTION, "um", 1e6),
    ]  # fmt: skip


@both_sizes
def test_the_whole_demo(tmp_path: Path, quick: bool) -> None:
    feet, stiff = demo.main(tmp_path, quick=quick, progress=False)
    left_behind(tmp_path, "roller_bearing", "stiff")
    found = checks({"feet": feet, "stiff": stiff}, reference(demo.QUICK))
    assert not missed(found)
    computed = {check.name: check.computed for check in found}
    # in a stiff housing the first carries the most
    assert computed["on feet: roller under the load"] < 0.75 * computed["on feet: the next one"]


def test_loads_in_a_stiff_housing_are_the_published_ones() -> None:
    loads = rigid_loads()
    np.testing.assert_allclose(loads[:2], (1956.0, 1384.0), rtol=PUBLISHED)
    assert np.count_nonzero(loads) == 3


def test_a_ring_without_compliance_is_a_stiff_housing() -> None:
    """Whose local approach is Palmgren's, once more."""
    phi = 2.0 * np.pi * np.arange(demo.COUNT) / demo.COUNT

    class Stiff(RingOnFeet):
        def local(self, Q: np.ndarray) -> np.ndarray:
            return palmgren(Q)

    ring = Stiff(np.zeros((14, 14)), phi, 6e-3, 0.012, 5.8e-3, demo.CLEARANCE, demo.STEEL, palmgren)
    shift, loads = ring.solve(demo.LOAD, 1e-4)
    np.testing.assert_allclose(loads, rigid_loads(), atol=1e-6 * demo.LOAD)
    assert shift > 0.5 * demo.CLEARANCE


def test_the_compliance_is_symmetric_and_bends_the_ring_between_its_feet() -> None:
    """A coarse ring, one layer of one cell along the axis: bore and outside differ by what the wall gives."""
    C = reference(demo.Size(sectors=28, axial=1, layers=1)).compliance
    assert np.abs(C - C.T).max() < 0.01 * np.abs(C).max()
    assert C[0, 0] == np.diag(C)[:2].max() and C[0, 1] > 0.0 > C[0, 4]
