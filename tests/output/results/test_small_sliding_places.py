"""Small-sliding contacts laid flat, faces that slide as wholes, and slip zones, compared with what is known of them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from warpffrf.output.small_sliding import ACROSS, cell_chart, rigid_sliding, slip_zone

AROUND, ALONG, RADIUS, LENGTH = 48, 5, 0.02, 0.03
FACET = np.pi / AROUND  # half of the angle of a facet: what is straight between nodes is short of by its cube


def tube(turn: np.ndarray, share: float = 1.0) -> Any:
    """The outside of a shaft, or a share of it: quads as two triangles each, a cell each."""
    angle = share * 2.0 * np.pi * np.arange(AROUND + 1) / AROUND
    z = np.linspace(0.0, LENGTH, ALONG + 1)
    corners = np.stack(np.broadcast_arrays(RADIUS * np.cos(angle)[:, None], RADIUS * np.sin(angle)[:, None], z), -1)
    a, b, c, d = corners[:-1, :-1], corners[1:, :-1], corners[1:, 1:], corners[:-1, 1:]
    middle = share * 2.0 * np.pi * (np.arange(AROUND) + 0.5) / AROUND
    normal = np.stack([np.cos(middle), np.sin(middle), 0.0 * middle], axis=1)
    along = np.stack([-np.sin(middle), np.cos(middle), 0.0 * middle], axis=1)
    frames = np.stack([normal, along, np.tile([0.0, 0.0, 1.0], (AROUND, 1))], axis=1).repeat(ALONG, axis=0)
    triangles = np.stack([np.stack([a, b, c], 2), np.stack([a, c, d], 2)], 2).reshape(-1, 3, 3)
    points = (0.25 * (a + b + c + d)).reshape(-1, 3)
    area = np.full(AROUND * ALONG, np.linalg.norm(b - a, axis=-1)[0, 0] * LENGTH / ALONG)
    return SimpleNamespace(
        triangles=(triangles @ turn.T, np.arange(AROUND * ALONG).repeat(2)), points=points @ turn.T,
        frames=frames @ turn.T, area=area,
    )  # fmt: skip


def spun(axis: tuple[float, float, float], angle: float) -> np.ndarray:
    from scipy.spatial.transform import Rotation

    return Rotation.from_rotvec(angle * np.asarray(axis) / np.linalg.norm(axis)).as_matrix()


TURNS = [np.eye(3), spun((1.0, 2.0, -0.5), 1.1)]


def flat_areas(triangles: np.ndarray) -> np.ndarray:
    a, b = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    return 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("share", [1.0, 0.75])
def test_a_shaft_is_unrolled(turn: np.ndarray, share: float) -> None:
    """Areas stay, and the whole is as wide as its arc; no triangle reaches across the seam."""
    view = tube(turn, share)
    chart = cell_chart(view)
    assert chart.radius == pytest.approx(RADIUS, rel=FACET**2)
    own = np.bincount(chart.cell, weights=flat_areas(chart.triangles))
    np.testing.assert_allclose(own, view.area, rtol=2.0 * FACET**2)
    wide, high = np.ptp(chart.triangles.reshape(-1, 2), axis=0)
    assert high == pytest.approx(LENGTH) and np.ptp(chart.triangles[:, :, 0], axis=1).max() < 0.1 * wide
    if share == 1.0:
        assert wide == pytest.approx(2.0 * np.pi * RADIUS, rel=2.0 / AROUND)


@pytest.mark.parametrize("turn", TURNS)
def test_a_shallow_bend_is_seen_from_above(turn: np.ndarray) -> None:
    chart = cell_chart(tube(turn, 0.2))
    assert chart.radius is None and flat_areas(chart.triangles).sum() < tube(turn, 0.2).area.sum()


def slips_of(view: Any, d: np.ndarray, theta: np.ndarray) -> np.ndarray:
    moved = d + np.cross(theta, view.points - view.points.mean(axis=0))
    return np.einsum("ckd,cd->ck", view.frames[:, 1:], moved)


@pytest.mark.parametrize("turn", TURNS)
def test_a_hub_turns_and_slides_on_its_shaft(turn: np.ndarray) -> None:
    """All rigid motions of a shaft slide its face but none is lost."""
    view = tube(turn)
    d, theta = np.array([1e-5, -2e-5, 3e-5]), np.array([1e-4, 2e-4, -3e-4])
    slips = np.stack([slips_of(view, d, theta), slips_of(view, 0.0 * d, theta)])
    found, turned = rigid_sliding(view.points, view.frames, view.area, slips)
    np.testing.assert_allclose(found, [d, 0.0 * d], atol=1e-16)
    np.testing.assert_allclose(turned, [theta, theta], rtol=1e-9)


def test_plates_turn_about_their_normal_alone() -> None:
    x, y = np.meshgrid(np.linspace(-0.02, 0.05, 8), np.linspace(0.0, 0.03, 5))
    points = np.stack([x.ravel(), y.ravel(), np.full(x.size, 0.4)], axis=1)
    frames = np.tile(np.eye(3)[[2, 0, 1]], (len(points), 1, 1))
    view = SimpleNamespace(points=points, frames=frames)
    slip = slips_of(view, np.array([1e-5, 2e-5, 7.0]), np.array([5.0, -4.0, 3e-4]))
    found, turned = rigid_sliding(points, frames, np.ones(len(points)), slip[None])
    np.testing.assert_allclose(found[0], [1e-5, 2e-5, 0.0], atol=1e-15)
    np.testing.assert_allclose(turned[0], [0.0, 0.0, 3e-4], atol=1e-13)


# --- slip zones


def test_a_zone_is_as_wide_as_its_farthest_cell_from_what_sticks() -> None:
    x, y = np.meshgrid(np.arange(12.0), np.arange(30.0), indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), 0.0 * x.ravel()], axis=1)
    loss = np.where(points[:, 0] < 5.0, 5.0 - points[:, 0], 1e-9)
    pressed = np.ones(len(points), dtype=bool)
    zone = slip_zone(points, np.ones(len(points)), loss, pressed)
    assert (zone.cells, zone.area, zone.across) == (150, 150.0, 5.0) and zone.coarse and ACROSS > 5.0
    free = slip_zone(points, np.ones(len(points)), loss, points[:, 0] < 5.0)  # nothing else presses
    assert np.isnan(free.across) and not free.coarse
    none = slip_zone(points, np.ones(len(points)), 0.0 * loss, pressed)
    assert none.cells == 0 and not none.coarse


def chain_loss(force: float, count: int) -> float:
    """Loss of the second cycle of +-`force` at the end of a chain of springs K = 1 whose places hold up to 1 each:
    every place in turn goes where its springs pull it, as far as its bound lets it, until none moves."""
    u, slider_force, lost = np.zeros(count + 1), np.zeros(count), 0.0
    steps = np.concatenate([np.linspace(0, force, 9), np.linspace(force, -force, 17)[1:]])
    steps = np.concatenate([steps, np.linspace(-force, force, 17)[1:], np.linspace(force, -force, 17)[1:],
                            np.linspace(-force, force, 17)[1:]])  # fmt: skip
    for n, pull in enumerate(steps):
        before = u.copy()
        for _ in range(4000):
            moved = 0.0
            for k in range(count):
                outwards = pull if k == 0 else u[k - 1] - u[k]
                net = outwards + (u[k + 1] - u[k])
                excess = net - np.clip(net, -1.0, 1.0)
                step = excess / (1.0 if k == 0 else 2.0)
                u[k] += step
                moved = max(moved, abs(step))
            if moved < 1e-13:
                break
        for k in range(count):
            net = (pull if k == 0 else u[k - 1] - u[k]) + (u[k + 1] - u[k])
            slider_force[k] = net
        if n >= len(steps) - 32:  # the last cycle
            lost += float(slider_force @ (u - before)[:count])
    return lost


@pytest.mark.parametrize("across", [1, 2, 3])
def test_a_bar_of_few_cells_loses_too_little_by_the_square_of_their_number(across: int) -> None:
    """The closed form of `slip_zone`, held against a chain that is pulled to and fro step by step."""
    force = across + 0.5
    continuous = 2.0 * force**3 / 3.0
    share = 1.0 - 1.0 / (2.0 * across + 1.0) ** 2
    assert chain_loss(force, across + 2) == pytest.approx(share * continuous, rel=1e-9)
