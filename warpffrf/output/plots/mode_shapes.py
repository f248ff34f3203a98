r"""Pictures of mode shapes: the deformed skins of bodies in colour over the undeformed ones in grey.

A mode of a scene is complex: its motion is Re(u exp(i w t)), and what is drawn is the moment at which the point that
goes farthest is at its farthest, Re(u exp(-i arg u_max)). Displacements are scaled, the largest to a given part of the
extent of all that is drawn; colours show amplitudes |u| over the largest. Rigid bodies have no skin: a box of their
mass and inertia stands for them, of sides l_x^2 = 6 (J_y + J_z - J_x)/m along their principal axes, no longer than
`BOX` of the skins beside it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.reduced.second_order_motion import skin_displacement
from warpffrf.output.plots.colors import ColorScale
from warpffrf.output.plots.mode_picture import MAX_TRIANGLES, MODE_STOPS, draw_skin, eye_axes, mode_skin

DRAWN = 0.06  # largest displacement of a picture, of the largest extent
GREY, THROUGH = (0.62, 0.65, 0.69), 0.35  # of the undeformed skin
BOX = 0.25  # of the extent of the skins, a side of a rigid body's box at the most
COLUMNS, PANEL = 4, (3.6, 3.1)  # of a page of shapes; inches
CORNERS = np.array([[i, j, k] for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)])
SIDES = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4],
     [1, 5, 7], [1, 7, 3]]
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class MovedSkin:
    """A skin, undeformed: points (n, 3) [m], triangles (t, 3) among them, and the displacements (n, 3) of a mode, real
    or complex, all in one frame."""

    points: np.ndarray
    triangles: np.ndarray
    displacement: np.ndarray


def skins_of(modes: Any, i: int) -> list[MovedSkin]:
    """Mode `i` of `Modes` of a scene: skins of the flexible bodies in the state that the modes are about, and boxes of
    the rigid ones, world axes."""
    found, rigid = [], []
    bodies = list(modes.scene.bodies)
    flexible = [body for body in bodies if body.reduced is not None and len(body.reduced.surface.triangles)]
    for body in flexible:
        skin = mode_skin(body.reduced, MAX_TRIANGLES // 2 // len(flexible))
        A, origin = rot.matrix(modes.found.rotation[body.name]), modes.found.position[body.name]
        still = skin.points + skin_displacement(body, modes.found.modal[body.name])[skin.kept]
        found.append(MovedSkin(origin + still @ A.T, skin.triangles, modes.displacement(i, body.name)[skin.kept]))
    every = np.concatenate([skin.points for skin in found]) if found else np.zeros((0, 3))
    longest = BOX * float(np.ptp(every, axis=0).max()) if len(every) else np.inf
    for body in bodies:
        if body.reduced is not None:
            continue
        A, shape = rot.matrix(modes.found.rotation[body.name]), modes.shape(i, body.name)
        corners, triangles = inertia_box(body.mass, body.inertia, longest)
        arms = (corners + body.center_of_mass) @ A.T
        moved = shape.translation + np.cross(shape.rotation, arms)
        rigid.append(MovedSkin(modes.found.position[body.name] + arms, triangles, moved))
    return found + rigid


def inertia_box(mass: float, inertia: np.ndarray, longest: float) -> tuple[np.ndarray, np.ndarray]:
    """Points (8, 3) [m] about the centre of mass, and triangles, of the box of `mass` [kg] and `inertia` (3, 3)
    [kg m2], scaled down to sides of at most `longest` [m]."""
    values, axes = np.linalg.eigh(inertia)
    sides = np.sqrt(np.maximum(6.0 * (values.sum() - 2.0 * values) / mass, 0.0))
    sides = np.maximum(sides, 0.02 * sides.max())  # a plate without thickness is seen edge on, too
    return CORNERS * (sides * min(1.0, longest / max(sides.max(), np.finfo(float).tiny))) @ axes.T, SIDES


def draw_shape(ax: Any, skins: Sequence[MovedSkin], title: str, *, drawn: float = DRAWN) -> None:
    """Draw a mode on the matplotlib axes `ax`; drawn: its largest displacement, of the largest extent."""
    skins = [outward(skin) for skin in skins]
    first = np.cumsum([0, *(len(skin.points) for skin in skins)])
    points = np.concatenate([skin.points for skin in skins])
    triangles = np.concatenate([skin.triangles + n for skin, n in zip(skins, first[:-1], strict=True)])
    u = np.concatenate([np.asarray(skin.displacement, dtype=complex) for skin in skins])
    size = np.linalg.norm(u, axis=1)
    top = float(size.max(initial=0.0))
    if top > 0.0:
        at = u[int(np.argmax(size))]
        u, size = u * (np.exp(-1j * np.angle(at[np.argmax(np.abs(at))])) / top), size / top
    reach = drawn * float(np.ptp(points, axis=0).max())
    low, high = points.min(axis=0) - reach, points.max(axis=0) + reach
    box, axes = low + (CORNERS + 0.5) * (high - low), eye_axes(points)
    grey = np.tile(GREY, (len(points), 1))
    draw_skin(ax, points, triangles, axes, grey, box, alpha=THROUGH)
    colors = ColorScale("", 1.0, 1.0, MODE_STOPS).rgb(size) / 255.0
    draw_skin(ax, points + reach * np.real(u), triangles, axes, colors, box)
    ax.set_title(title, fontsize=10)


def outward(skin: MovedSkin) -> MovedSkin:
    """The skin with triangles turned so that a closed one has its normals outside, by the sign of its volume."""
    corners = skin.points[skin.triangles] - skin.points.mean(axis=0)
    volume = np.einsum("ti,ti->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    return skin if volume >= 0.0 else MovedSkin(skin.points, skin.triangles[:, ::-1], skin.displacement)


def shapes_figure(modes: Sequence[tuple[str, Sequence[MovedSkin]]], title: str, *, drawn: float = DRAWN) -> Any:
    """A matplotlib Figure with a picture of each of `modes`, its title and its skins."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    columns = min(COLUMNS, len(modes))
    rows = -(-len(modes) // columns)
    figure = Figure(figsize=(PANEL[0] * columns, PANEL[1] * rows + 0.4), layout="constrained")
    FigureCanvasAgg(figure)
    for n, (name, skins) in enumerate(modes):
        draw_shape(figure.add_subplot(rows, columns, n + 1), skins, name, drawn=drawn)
    figure.suptitle(title, fontsize=11)
    return figure
