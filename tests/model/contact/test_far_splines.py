"""Splines of the far field: what they reproduce, what they do not see, and that forces are the adjoint of fields."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from warpffrf.model.half_space import FarSplines
from warpffrf.model.reduced.contact_grid import SurfaceGrid
from warpffrf.model.surfaces import CrownedCylinder, Plane

ROUNDING = 1e-11  # of fields of order 1, after the solution with Gram matrices whose condition is below 100
UNEVEN = np.array([-9.0, -7.5, -5.0, -1.0, 2.0, 6.0, 9.0]) * 1e-3


def splines(*, turn: int = 12, z=UNEVEN, columns: int = 12, crowned: bool = False) -> FarSplines:
    """On a roller of 50 mm, `turn` 0: on a plane."""
    if turn:
        crown = 0.3 if crowned else 1e9
        shape = CrownedCylinder(radius=0.05, crown_radius=crown, axis_point=(0, 0, 0), axis_direction=(0, 0, 1))
        pitch, start = 2.0 * np.pi / turn, 0.1
    else:
        shape = Plane(origin=(0, 0, 0), outward=(1, 0, 0), direction=(0, 0, 1))
        pitch, start = 2e-3, -0.011
    grid = SurfaceGrid(
        np.array(shape.e_0), start, pitch, columns, bool(turn) and turn == columns, np.asarray(z), columns
    )
    return FarSplines(grid, shape, turn)


def node_coefficients(s: FarSplines, field) -> np.ndarray:
    """Coefficients (columns rows,) of the L2 projection of `field(theta, z)` on the nodes."""
    g = s.grid
    x, w = np.polynomial.legendre.leggauss(8)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    theta = (g.theta[:, None] + g.pitch * np.concatenate([x - 1.0, x])).ravel()
    around = g.pitch * np.concatenate([w * x, w * (1.0 - x)])
    step = np.diff(g.z)
    z = (g.z[:-1, None] + step[:, None] * x).ravel()
    along = np.array([np.interp(z, g.z, row) for row in np.eye(g.rows)])
    along = along * (step[:, None] * w).ravel() * s.shape.measure_at(z)
    values = field(theta[:, None], z[None, :]).reshape(g.columns, len(around), len(z))
    weak = np.einsum("q,jqp,kp->jk", around, values, along)
    return np.linalg.solve(g.gram_theta(), np.linalg.solve(g.gram_z(s.shape), weak.T).T).ravel()


def evaluate(s: FarSplines, values: np.ndarray, theta, z) -> np.ndarray:
    c = s.of_nodes(values).reshape(s.grid.columns, s.grid.rows)
    return np.einsum("nj,nk,jk->n", s.around(theta), s.along(z), c)


@pytest.mark.parametrize("z", [UNEVEN, UNEVEN[::2], UNEVEN[[0, 2, 6]], UNEVEN[[0, 6]]])
@pytest.mark.parametrize("crowned", [False, True])
def test_parabolas_come_back(z, crowned) -> None:
    """Between two ends every parabola along z, of two rows every straight line, is exact, whatever the measure."""
    s = splines(z=z, crowned=crowned)
    at = np.linspace(z[0], z[-1], 41)
    theta = np.linspace(0.0, 7.0, 41)
    for power in range(min(len(z), 3)):
        found = evaluate(s, node_coefficients(s, lambda t, x, p=power: (x / 9e-3) ** p + 0.0 * t), theta, at)
        assert np.max(np.abs(found - (at / 9e-3) ** power)) < ROUNDING


def test_parabolas_on_a_plane() -> None:
    """Likewise along both directions of a plane, up to its outermost nodes."""
    s = splines(turn=0)
    theta, z = np.linspace(-0.011, 0.011, 30), np.linspace(-9e-3, 9e-3, 30)

    def field(t, x):
        return 1.0 + 30.0 * t - 40.0 * x + 3e3 * t * t - 5e3 * t * x + 1e5 * t * t * x * x

    assert np.max(np.abs(evaluate(s, node_coefficients(s, field), theta, z) - field(theta, z))) < ROUNDING


def test_what_alternates_is_not_seen() -> None:
    """A field that alternates from column to column gives nothing, and so does one along evenly spaced rows."""
    even = splines(z=np.linspace(-9e-3, 9e-3, 9))
    g = even.grid
    for sign in ((-1.0) ** np.arange(g.columns)[:, None] * np.ones(g.rows),):
        assert np.max(np.abs(even.of_nodes(sign.ravel()))) < ROUNDING
    # along the rows the L2 projection of the alternation has end effects: means alternate, so nodes are made from these
    means = np.ones(g.columns)[:, None] * (-1.0) ** np.arange(g.rows)
    area = g.gram_z(even.shape).sum(axis=1)
    grid_nodes = np.linalg.solve(g.gram_z(even.shape), (area * means).T).T
    assert np.max(np.abs(even.of_nodes(grid_nodes.ravel()))) < ROUNDING


def test_full_turn_converges() -> None:
    """A smooth field around a full turn: the error falls with the third power of the pitch."""
    errors = []
    for columns in (24, 48):
        s = splines(turn=columns, columns=columns)
        theta = np.linspace(0.0, 2.0 * np.pi, 97)
        found = evaluate(s, node_coefficients(s, lambda t, x: np.sin(2.0 * t) + 0.0 * x), theta, np.zeros(97))
        errors.append(np.max(np.abs(found - np.sin(2.0 * theta))))
    assert errors[0] / errors[1] > 7.0  # 8 for the third power


def test_slope_is_continuous() -> None:
    s = splines(turn=0)
    field = node_coefficients(s, lambda t, x: np.sin(500.0 * t) * np.cos(300.0 * x))
    knot = s.theta_knots[4]
    step = 1e-7
    slopes = [
        np.diff(evaluate(s, field, np.array([knot + a, knot + a + step]), np.zeros(2)))[0] / step for a in (-2e-7, 1e-7)
    ]
    assert abs(slopes[0] - slopes[1]) < 1e-2  # curvature 500^2 over 3e-7 m, and differences over 1e-7 m


@pytest.mark.parametrize(("turn", "sectors"), [(12, 12), (12, 4), (12, 1), (0, 1)])
def test_compliance_in_sectors(turn, sectors) -> None:
    """Z D Z^T block by block is that of the whole matrix, whatever the layout."""
    s = splines(turn=turn)
    g = s.grid
    c = g.columns // sectors
    grid = SurfaceGrid(g.e_0, g.theta_start, g.pitch, g.columns, g.periodic, g.z, c)
    s = FarSplines(grid, s.shape, turn)
    rng = np.random.default_rng(0)
    block = c * g.rows
    lags = rng.standard_normal((sectors, block, block))
    lags = lags + np.roll(lags[::-1], 1, axis=0).transpose(0, 2, 1)
    body = SimpleNamespace(grid=grid, lags=lags)
    whole = _dense(body, lags)
    Z = np.kron(s.theta_transform, s.z_transform)
    assert np.max(np.abs(_dense(body, s.compliance(lags)) - Z @ whole @ Z.T)) < ROUNDING * np.abs(whole).max()


def _dense(body, lags) -> np.ndarray:
    from warpffrf.model.reduced.contact_surface import ContactSurface

    surface = ContactSurface.__new__(ContactSurface)
    object.__setattr__(surface, "grid", body.grid)
    object.__setattr__(surface, "lags", lags)
    return surface.compliance(np.arange(body.grid.columns))


def test_arc_of_a_turn() -> None:
    """On an arc of a full turn the splines are those of the turn: a field whose nodes are the turn's is the same."""
    whole = splines(turn=24, columns=24)
    g = whole.grid
    part = SurfaceGrid(g.e_0, g.theta_start + 5 * g.pitch, g.pitch, 9, False, g.z, 1)
    arc = FarSplines(part, whole.shape, 24)
    theta = part.theta_start + g.pitch * np.linspace(1.5, 6.5, 20)  # the splines of both ends reach 1.5 columns in
    assert np.max(np.abs(arc.around(theta) - whole.around(theta)[:, 5:14])) < ROUNDING
    values = np.linspace(0.0, 1.0, 9)[:, None] ** 2 * np.ones(g.rows)
    inner = arc.of_nodes(values.ravel()).reshape(9, -1)
    assert np.isfinite(inner).all()
