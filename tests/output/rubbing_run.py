r"""The synthetic run with friction: Carter's tractive rolling of two alike cylinders, known in closed form.

F. W. Carter, Proc. R. Soc. A 112 (1926) 151; K. L. Johnson, Contact Mechanics, 1985, section 8.3. With material moving
through the patch along +x, half-width a, stick zone of half-width c at the leading edge, d = a - c, 1/R the relative
curvature,

    tau = mu p0/a (sqrt(a^2 - x^2) - sqrt(c^2 - (x + d)^2)),      Q/(mu P) = 1 - (c/a)^2,
    creepage = -mu d/R,      |w| = V mu/R sqrt((x + d)^2 - c^2) in the slip zone x > c - d.

The traction on the first body points along +x, so that its slip goes along -x.
"""

from __future__ import annotations

import numpy as np
from synthetic_run import DURATION, HALF_WIDTH, PEAK, PITCH, ROWS, STEPS, TURN, WIDTH, WINDOW, R, make_history

from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online.history.history import FrictionHistory, History
from warpffrf.output.geometry.scene_view import PairView, SceneView

MU = 0.3
STICK = 0.6 * HALF_WIDTH  # c
SHIFT = HALF_WIDTH - STICK  # d
RELATIVE = 0.5 * R
SPEED = R * TURN / DURATION  # m/s through the patch
CREEPAGE = -MU * SHIFT / RELATIVE
COLUMNS_PER_STEP = 0.25


def carter_traction(x: np.ndarray, peak: float) -> np.ndarray:
    """tau [Pa] at x [m] from the middle of the patch, at the largest pressure `peak` [Pa]."""
    whole = np.sqrt(np.maximum(HALF_WIDTH**2 - x**2, 0.0))
    return MU * peak / HALF_WIDTH * (whole - np.sqrt(np.maximum(STICK**2 - (x + SHIFT) ** 2, 0.0)))


def carter_slip(x: np.ndarray) -> np.ndarray:
    """Slip velocity [m/s] along +x of the first body against the second, zero where it sticks or is open."""
    slips = (np.abs(x) < HALF_WIDTH) & (x > STICK - SHIFT)
    return np.where(slips, -SPEED * MU / RELATIVE * np.sqrt(np.maximum((x + SHIFT) ** 2 - STICK**2, 0.0)), 0.0)


def add_friction(history: History, *, cells: float = COLUMNS_PER_STEP) -> History:
    """`history` of `make_history` with Carter's friction in its pair, advancing `cells` columns a step."""
    (name, contact), *_ = history.contacts.items()
    offset = (contact.first_column - contact.center_column + 90.0) % 180.0 - 90.0
    x = R * PITCH * (offset[:, None] + np.arange(WINDOW))  # (T, columns)
    peak = PEAK * (1.0 + history.time / DURATION)
    traction, slip = np.zeros((STEPS, 2, WINDOW, ROWS)), np.zeros((STEPS, 2, WINDOW, ROWS))
    for i in range(STEPS):
        traction[i, 0] = carter_traction(x[i], peak[i])[:, None]
        slip[i, 0] = carter_slip(x[i])[:, None]
    inside = np.abs(x) < HALF_WIDTH
    state = np.where(inside, np.where(x > STICK - SHIFT, 2, 1), 0).astype(np.int8)
    fine = np.linspace(-HALF_WIDTH, HALF_WIDTH, 20001)
    power = -peak * np.trapezoid(carter_traction(fine, 1.0) * carter_slip(fine), fine) * WIDTH
    contact.friction = FrictionHistory(
        traction=traction,
        slip_velocity=slip,
        state=np.repeat(state[:, :, None], ROWS, axis=2),
        power=power,
        creep_velocity=np.tile([CREEPAGE * SPEED, 0.0], (STEPS, 1)),
        rolling_velocity=np.full(STEPS, SPEED),
        cells_per_step=np.full(STEPS, cells),
    )
    view = history.scene
    assert isinstance(view, SceneView)
    old = view.pairs[name]
    pair = PairView(name, old.first_body, old.first_surface_name, old.second_body, old.second_surface_name, friction=MU)
    history.scene = SceneView(view.content_hash, view.bodies, {name: pair}, view.joints, view.anchors)
    history.energy["friction"] = -np.cumsum(power * np.diff(history.time, prepend=0.0))
    return history


def make_rubbing_history(body: ReducedBody) -> History:
    """A run with friction."""
    return add_friction(make_history(body))
