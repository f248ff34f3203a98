"""Tractions by products over strips: the products against sums over pairs of cells, their preconditioner, and
runs against those with a matrix of all cells, whose solution has nothing but the law in common with them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import warpffrf as wf
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.online import Engine, run
from warpffrf.online.compile import pairs, strips
from warpffrf.online.compile.strips import period_of, pressure_tables, strip_tables, waves
from warpffrf_kernels.rolling.shear import RINGS

RADIUS, WIDTH, BALL, APPROACH, MU, SPEED = 0.05, 0.02, 0.03, 20e-6, 0.3, 10.0
ROUND_OFF = 1e-13  # of the largest entry: sums of some hundred terms
CONDITION = 8.0  # of the preconditioned compliance, whatever the cells
SAME = 2e-7  # of the largest traction: steps converge to 1e-9 of the force, tractions at edges to 200 times that
# of the largest force: two runs, whose steps end below 1e-9 of it each, and whose tractions remember what they end with
BALANCED = 5e-9
STEEL, ALUMINIUM = wf.Material(210e9, 0.3, 7800.0), wf.Material(70e9, 0.34, 2700.0)


# --- products


def table(columns: int, z: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Kinds by distance in strips, loaded row, receiving row: smooth kernels of cells of unlike length, symmetric as
    those of half-spaces."""
    d = np.arange(columns + RINGS)[:, None, None]
    apart = z[None, None, :] - z[None, :, None]
    both = length[None, :, None] * length[None, None, :]
    far = np.sqrt(0.3 + d**2 + apart**2)
    return np.stack([both / far, 1.3 * both / far**1.1, 0.3 * both * d * apart / far**3])


def direct(kinds: np.ndarray, q: np.ndarray) -> np.ndarray:
    """What tractions q (2, columns, rows) displace, cell by cell."""
    found = np.zeros_like(q)
    for c, e in np.ndindex(q.shape[1], q.shape[1]):
        h, sign = kinds[:, abs(c - e)], -1.0 if c < e else 1.0
        found[0, c] += q[0, e] @ h[0] + sign * q[1, e] @ h[2]
        found[1, c] += q[1, e] @ h[1] + sign * q[0, e] @ h[2]
    return found


def multiplied(blocks: np.ndarray, wave: np.ndarray, q: np.ndarray) -> np.ndarray:
    """The product of the kernel, in NumPy: transforms about the middle; of two components, the first over i."""
    parts, columns, rows = q.shape
    line, half = blocks.shape[1] // parts, (columns + 1) // 2
    x = np.zeros((columns, parts, line))
    x[:, :, :rows] = np.swapaxes(q, 0, 1)
    x = x.reshape(columns, parts * line)
    low, high = x[:half], x[::-1][:half]
    even, odd = low + high, high - low
    if columns % 2:
        even[-1] = low[-1]
    first = np.arange(parts * line) < (parts - 1) * line
    C, S = wave[0] @ even, wave[1] @ odd
    re, im = np.where(first, -S, C), np.where(first, -C, -S)
    C, S = np.einsum("ki,kij->kj", re, blocks), np.einsum("ki,kij->kj", im, blocks)
    C, S = wave[2].T @ np.where(first, -S, C), wave[3].T @ np.where(first, C, S)
    y = np.zeros_like(x)
    y[::-1][:half] = C - S
    y[:half] = C + S
    return np.swapaxes(y.reshape(columns, parts, line)[:, :, :rows], 0, 1)


def pressed(near: np.ndarray, q: np.ndarray) -> np.ndarray:
    """What pressures q (1, columns, rows) displace, cell by cell."""
    apart = np.abs(np.subtract.outer(np.arange(q.shape[1]), np.arange(q.shape[1])))
    return np.einsum("cdij,di->cj", near[apart], q[0])[None]


@pytest.mark.parametrize("parts", [1, 2])
@pytest.mark.parametrize(("columns", "rows"), [(7, 4), (8, 11), (13, 10)])
def test_products_over_strips_are_those_over_cells(columns: int, rows: int, parts: int) -> None:
    """Of pressures and of tractions, rows of unlike length; and with the preconditioner the condition is small, of all
    cells and of some."""
    length = np.geomspace(1.0, 3.0, rows)
    z = np.cumsum(length) - 0.5 * length
    kinds = table(columns, z, length)
    line, period = -(-rows // 8) * 8, period_of(columns)
    half, split = (columns + 1) // 2, 4 * (columns + 1) * ((columns + 1) // 2)
    of_K, of_W = waves(columns)[:split].reshape(4, -1, half), waves(columns)[split:].reshape(4, period // 2 + 1, half)
    if parts == 1:
        K, W = pressure_tables(kinds[0][None, :columns], line)
    else:
        K, W = strip_tables(kinds[None], columns, 0, line)

    def exactly(q: np.ndarray) -> np.ndarray:
        return pressed(kinds[0], q) if parts == 1 else direct(kinds, q)

    q = np.random.default_rng(columns).normal(size=(parts, columns, rows))
    exact = exactly(q)
    assert np.abs(multiplied(K[0], of_K, q) - exact).max() < ROUND_OFF * np.abs(exact).max()
    unit = np.eye(q.size).reshape(q.size, *q.shape)
    full = np.stack([exactly(e).ravel() for e in unit], axis=1)
    inverse = W[0, parts * line :].reshape(-1, parts * line, parts * line)
    near = np.stack([multiplied(inverse, of_W, e).ravel() for e in unit], axis=1)
    assert np.abs(near - near.T).max() < ROUND_OFF * np.abs(near).max()
    own = np.diag(near).reshape(q.shape)
    np.testing.assert_allclose(own[:, 0], W[0, : parts * line].reshape(parts, line)[:, :rows], rtol=1e-10)
    for share in (1.1, 0.6):
        some = np.flatnonzero(np.random.default_rng(rows).random(q.size) < share)
        value = np.linalg.eigvals(near[np.ix_(some, some)] @ full[np.ix_(some, some)]).real
        assert 0.0 < value.max() / value.min() < CONDITION


# --- runs


@pytest.fixture(scope="module")
def bodies() -> dict[str, ReducedBody]:
    """Elements of 8 mm on the rim."""
    mesh = wf.mesh.roller(RADIUS, 0.015, WIDTH, sectors=40, layers=4, axial=3, order=1)
    return {
        name: wf.reduce(
            mesh, material, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=2,
            grid=wf.ContactGrid(contact_fixed=True, tangential=True), cache=False, progress=False,
        )
        for name, material in (("steel", STEEL), ("aluminium", ALUMINIUM))
    }  # fmt: skip


def rollers(
    bodies: dict[str, ReducedBody], upper: str, creepage: float, *, friction: Any = MU, skew: float = 0.0, free: bool
) -> wf.Scene:
    """Two rollers that turn against each other at a distance, the upper one driven or free to turn."""
    scene = wf.Scene(gravity=(0, 0, 0))
    half = 0.5 * skew
    for name, kind, speed in (("lower", "steel", SPEED), ("upper", upper, -SPEED * (1.0 + creepage))):
        at = (0, 0, 2 * RADIUS - APPROACH if name == "upper" else 0.0)
        turn = (0, 0, np.sin(half), np.cos(half)) if name == "upper" else (0, 0, 0, 1)
        along = (-np.sin(skew), np.cos(skew), 0.0) if name == "upper" else (0, 1, 0)
        body = scene.add_body(
            bodies[kind], name=name, position=at, rotation=turn, angular_velocity=tuple(speed * np.array(along)),
            inertia="constant",
        )  # fmt: skip
        axle = scene.add(wf.joints.Revolute(scene.ground, body["bore"], axis=along))
        if name == "lower" or not free:
            scene.add(wf.joints.Drive(axle, speed, quantity="velocity"))
    lower, other = scene.bodies
    scene.add(
        wf.Contact(lower["rim"], other["rim"], friction=friction, grid="contact_fixed", cells=(9, 8), name="pair")
    )
    return scene


def on_ball(bodies: dict[str, ReducedBody]) -> wf.Scene:
    """A roller that turns and creeps on a rigid ball, whose rows follow the patch, with spin."""
    scene = wf.Scene(gravity=(0, 0, 0))
    body = scene.add_body(bodies["steel"], name="lower", angular_velocity=(0, SPEED, 0.4 * SPEED), inertia="constant")
    axle = scene.add(wf.joints.Revolute(scene.ground, body["bore"], axis=(0, SPEED, 0.4 * SPEED)))
    scene.add(wf.joints.Drive(axle, float(np.hypot(1.0, 0.4)) * SPEED, quantity="velocity"))
    ball = scene.add_rigid_body(
        1.0, (1e-3,) * 3, name="ball", position=(0, 0, RADIUS + BALL - APPROACH), angular_velocity=(0, -1.7 * SPEED, 0)
    )
    held = scene.add(wf.joints.Revolute(scene.ground, ball.at((0, 0, 0)), axis=(0, 1, 0)))
    scene.add(wf.joints.Drive(held, -1.7 * SPEED, quantity="velocity"))
    sphere = ball.surface(wf.surfaces.Sphere(radius=BALL, axis_point=(0, 0, 0), axis_direction=(0, 1, 0)), name="face")
    scene.add(wf.Contact(body["rim"], sphere, friction=MU, grid="contact_fixed", cells=(9, 8), name="pair"))
    return scene


def three(bodies: dict[str, ReducedBody]) -> wf.Scene:
    """Three rollers on top of each other, the last one free to turn: two patches on the one between."""
    scene = wf.Scene(gravity=(0, 0, 0))
    placed = []
    for i in range(3):
        spin = SPEED * (-1.0) ** i * (1.0 + 2e-3 * i)
        at = (0, 0, i * (2 * RADIUS - APPROACH))
        placed.append(
            scene.add_body(bodies["steel"], name=f"roller {i}", position=at, angular_velocity=(0, spin, 0),
                           inertia="constant")
        )  # fmt: skip
        axle = scene.add(wf.joints.Revolute(scene.ground, placed[-1]["bore"], axis=(0, 1, 0)))
        if i < 2:
            scene.add(wf.joints.Drive(axle, spin, quantity="velocity"))
    for i, (a, b) in enumerate(zip(placed[:-1], placed[1:], strict=True)):
        name = "pair" if i == 0 else "other"
        scene.add(wf.Contact(a["rim"], b["rim"], friction=MU, grid="contact_fixed", cells=(9, 8), name=name))
    return scene


SCENES = {
    "creeping": lambda b: rollers(b, "steel", 2e-3, free=False),
    "unlike": lambda b: rollers(b, "aluminium", 8e-3, free=False),
    "skewed": lambda b: rollers(b, "aluminium", 8e-3, skew=5e-3, free=False),
    "free to turn": lambda b: rollers(b, "steel", 0.05, free=True),
    "on a ball": lambda b: on_ball(b),
    "three rollers": lambda b: three(b),
    "regularised": lambda b: rollers(b, "steel", 2e-3, friction=wf.laws.RegularisedCoulomb(MU, 1e-3), free=False),
}


@pytest.mark.parametrize("name", list(SCENES))
def test_runs_are_those_with_a_matrix(
    bodies: dict[str, ReducedBody], name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Tractions and pressures by products over strips, and both by matrices."""
    step = 0.7 * 1.1e-3 / 9 / (SPEED * RADIUS)
    monkeypatch.setattr(strips, "FEWEST", 60)
    monkeypatch.setattr(pairs, "MATRIX_CELLS", 0)
    found = run(SCENES[name](bodies), 20 * step, step=step, start="equilibrium", progress=False)
    assert Engine(SCENES[name](bodies)).compiled.elements.rolling.strips == 1
    monkeypatch.setattr(strips, "FEWEST", 10**6)
    monkeypatch.setattr(pairs, "MATRIX_CELLS", 10**6)
    assert Engine(SCENES[name](bodies)).compiled.elements.rolling.strips == 0
    exact = run(SCENES[name](bodies), 20 * step, step=step, start="equilibrium", progress=False)
    assert found.status == exact.status == "completed"
    mine, theirs = found.contacts["pair"].friction, exact.contacts["pair"].friction
    assert mine is not None and theirs is not None
    assert {1, 2} <= set(np.unique(theirs.state)) or name in ("free to turn", "regularised")
    assert np.abs(mine.traction - theirs.traction).max() < SAME * np.abs(theirs.traction).max()
    force, expected = found.contacts["pair"].force, exact.contacts["pair"].force
    assert np.abs(force - expected).max() < BALANCED * np.linalg.norm(expected, axis=1).max()


def test_a_run_is_continued_bit_for_bit(bodies: dict[str, ReducedBody], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(strips, "FEWEST", 60)
    scene, step = SCENES["unlike"](bodies), 0.7 * 1.1e-3 / 9 / (SPEED * RADIUS)
    whole = run(scene, 16 * step, step=step, start="equilibrium", progress=False)
    part = run(scene, 7 * step, step=step, start="equilibrium", progress=False)
    found = run(scene, 9 * step, step=step, start=part, progress=False).checkpoint
    assert [name for name, array in whole.checkpoint.items() if array.tobytes() != found[name].tobytes()] == []


def test_only_scenes_of_large_patches_with_constant_coefficients_have_strips(bodies: dict[str, ReducedBody]) -> None:
    def has_strips(friction: Any, cells: tuple[int, int]) -> bool:
        scene = rollers(bodies, "steel", 2e-3, friction=friction, free=False)
        scene.contacts[0].cells = cells
        return bool(Engine(scene).compiled.elements.rolling.strips)

    assert has_strips(MU, (25, 10)) and not has_strips(MU, (19, 13))
    assert not has_strips(wf.laws.Stribeck(0.3, 0.2, 5e-3), (25, 10))
