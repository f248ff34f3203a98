"""Cases C4 and C5 by the engine: a patch that is loaded tangentially, on an exact half-plane and half-space.

The bodies leave out the coupling of normal and tangential, as Cattaneo and Mindlin do: against a rigid partner it is
not zero.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from references.closed_forms import (
    LineContact,
    MindlinLine,
    MindlinPoint,
    PointContact,
    contact_modulus,
    tangential_compliance,
)
from references.half_space.bodies import half_plane, half_space
from scenes.half_space import PAIR, STEEL, STEP, ball, cylinder, pushed, simulated
from warpffrf.model.mesh import block
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.surfaces import Plane
from warpffrf.offline import ContactGrid, reduce
from warpffrf.output.result import Result
from warpffrf.output.simulate import static

FRICTION = 0.3
STICK = 1.0  # grid spacings, promised
DISPLACEMENT, LOSS = 0.02, 0.03  # promised
QUARTER = 4  # steps to the peak: with like steps in between, tractions do not depend on their number


def stick_size(result: Result, i: int) -> float:
    """Half-width or radius [m] of the stick zone by its measure, and of the grid's columns."""
    scene: Any = result.history.scene
    grid = scene.contacts[0].a.surface.grid
    friction = result.history.contacts[PAIR].friction
    assert friction is not None
    stick = friction.state[i] == 1
    if grid.rows == 2:
        return 0.5 * float(stick[:, 0].sum()) * grid.pitch
    return float(np.sqrt(stick.sum() / np.pi)) * grid.pitch


def check(
    result: Result,
    exact: MindlinLine | MindlinPoint,
    width: float,
    *,
    loss: bool = True,
    displaced: float = DISPLACEMENT,
) -> None:
    """First loading at half and whole shift, the cycle, and what friction may never do."""
    history = result.history
    c = history.contacts[PAIR]
    scene: Any = history.scene
    pitch = scene.contacts[0].a.surface.grid.pitch
    shift = history.bodies["partner"].position[:, 0]
    Q = c.force[:, 0] / width
    a = exact.contact.half_width
    for i in (QUARTER // 2, QUARTER):
        stick = (stick_size(result, i) - exact.stick_ratio(Q[i]) * a) / pitch
        error = shift[i] / float(exact.loading(Q[i])) - 1.0
        print(f"Q/muP {Q[i] / exact.limit:.3f}: stick {stick:+.2f} spacings, displacement {error:+.2%}")
        assert abs(stick) < STICK
        assert abs(error) < displaced
    work = history.energy["friction"]
    lost = float(work[QUARTER] - work[5 * QUARTER]) / width
    expected = exact.cycle_loss(0.5 * (Q[QUARTER] - Q[3 * QUARTER]))
    print(f"loss {lost / expected - 1.0:+.2%}")
    assert np.all(np.diff(work) <= 1e-9 * lost * width)
    if loss:
        assert abs(lost / expected - 1.0) < LOSS


@pytest.mark.parametrize("cells", [16, 32])
def test_line(cells: int) -> None:
    """Half-plane, Q = 0.5 mu P; the slip zone has 0.29 of the cells."""
    radius, a, width = 0.05, 1.5e-3, 0.01
    E = contact_modulus(STEEL)
    line = LineContact(a * a * np.pi * E / (4.0 * radius), radius, E)
    exact = MindlinLine(line, FRICTION, 20.0 * a)
    body = half_plane(2 * int(1.3 * cells + 3) + 1, a / cells, width, STEEL, exact.depth)
    shift = float(exact.loading(0.5 * exact.limit))
    scene, steps = pushed(body, cylinder(radius), line.load * width, shift, QUARTER, FRICTION)
    check(simulated(scene, steps * 1e-3, 1e-3), exact, width)


POINT = PointContact(100.0, 0.01, contact_modulus(STEEL))  # case C3
COARSE = 0.03  # of the displacement at 8 cells in the radius: first order in the cell
MINDLIN = MindlinPoint(POINT, FRICTION, tangential_compliance(STEEL))


@pytest.mark.parametrize(
    ("cells", "share", "loss"),
    [
        (8, 0.5, False),  # 1.7 cells in the slip zone: too few for the loss
        pytest.param(12, 0.5, True, marks=pytest.mark.slow),
        pytest.param(12, 0.9, True, marks=pytest.mark.slow),
        pytest.param(14.5, 0.75, True, marks=pytest.mark.slow),
    ],
)
def test_point(cells: float, share: float, loss: bool) -> None:
    """Half-space, both components of traction."""
    count = 2 * int(cells + 3) + 1
    body = half_space(count, count, POINT.half_width / cells, STEEL)
    shift = float(MINDLIN.loading(share * MINDLIN.limit))
    scene, steps = pushed(body, ball(POINT.radius), POINT.load, shift, QUARTER, FRICTION)
    check(simulated(scene, steps * 1e-3, 1e-3), MINDLIN, 1.0, loss=loss, displaced=DISPLACEMENT if loss else COARSE)


@pytest.mark.parametrize("by_force", [False, True], ids=["by displacement", "by force"])
@pytest.mark.parametrize("cells", [8, pytest.param(12, marks=pytest.mark.slow)])
def test_point_in_load_steps(cells: int, by_force: bool) -> None:
    """The same without inertia, to 0.9 of sliding."""
    count = 2 * int(cells + 3) + 1
    body = half_space(count, count, POINT.half_width / cells, STEEL)
    most = 0.9 * MINDLIN.limit
    if not by_force:
        most = float(MINDLIN.loading(most))
    scene, steps = pushed(body, ball(POINT.radius), POINT.load, most, QUARTER, FRICTION, by_force=by_force)
    result = static(scene, steps * STEP, step=STEP, progress=False)
    assert result.status == "completed", result.message
    check(result, MINDLIN, 1.0, displaced=DISPLACEMENT if cells > 8 else COARSE)


def uncoupled(body: ReducedBody) -> ReducedBody:
    """The body without tangential displacement by pressures and the other way round."""
    (name,) = body.contact_surfaces
    surface = body.contact_surfaces[name]
    assert surface.tangential is not None
    shear = replace(surface.tangential, lags_nt=0.0 * surface.tangential.lags_nt)
    return replace(body, contact_surfaces={name: replace(surface, tangential=shear)})


@pytest.mark.slow
def test_point_on_a_finite_element_block() -> None:
    """Case C4 on a mesh with 6 nodes in the patch's radius: stick radius and displacement."""
    a = POINT.half_width
    mesh = block((0.08, 0.08, 0.04), patch_half_width=1.45 * a, cell=a / 3.0, growth=1.6, depth=0.8 * a)
    body = reduce(
        mesh, STEEL, interfaces={"bottom": "rigid"}, contact={"patch": Plane()}, modes=0,
        grid=ContactGrid(tangential=True, contact_fixed=False),
        progress=False,
    )  # fmt: skip
    shift = float(MINDLIN.loading(0.5 * MINDLIN.limit))
    scene, steps = pushed(uncoupled(body), ball(POINT.radius), POINT.load, shift, QUARTER, FRICTION)
    check(simulated(scene, steps * 1e-3, 1e-3), MINDLIN, 1.0, loss=False)
