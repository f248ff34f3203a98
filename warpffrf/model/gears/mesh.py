"""Gears of a scene in mesh: one contact for each pair of teeth that meet.

The bodies are those of `mesh.gear`, reduced with `Gear.surfaces()`, or half-spaces with them: their axis is the user's
+y, through the origin, and tooth 1 points to +x. Gear 2 is placed at the centre distance from gear 1, in the direction
given, and rotated by the least angle at which flanks touch: its own rotation determines which teeth meet. The place g
of a tooth k of gear 1 on the path of contact, and its tooth of gear 2, are those of `GearPair`: with s = 1 for right
flanks and -1 for left ones,

    g_k = r_b1 (s (psi - angle) - 2 pi s (k - 1)/z_1),   psi = s s_w1/d_w1,

angle that of tooth 1 from the line of centres; a pair of teeth touches where A <= g <= E, up to ENTRY before and after,
as loaded teeth bend. When gear 1 rotates in the direction of its flank, -s, g grows.

Sections of helical gears at y = z are rotated by tau_1 z: there contact is at g - s tan beta_b1 z. A pair of teeth is
in mesh while that of any section of the common width is.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.bodies import Body, Port
from warpffrf.model.checks.plausibility import warn
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError, require_array, unknown_name
from warpffrf.model.friction import FrictionLike
from warpffrf.model.gears.gear import FLANKS
from warpffrf.model.gears.pair import GearPair
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.placement.nearest import FacingPlace

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene

ENTRY = 0.15  # base pitches: teeth that bend by 1 % of the module meet that much earlier
ALONG = 1e-9  # of a direction along the axis: sine of the angle between them

Teeth = tuple[str, int, int]  # flank, tooth of gear 1, tooth of gear 2


@dataclass(eq=False, repr=False)
class GearMesh(reprs.Shown):
    """Two gears in mesh, as made by `scene.add_gear_pair`: the `GearPair`, the hubs, and the contacts by flank and
    teeth, `("right", 1, 13)`. axes (3, 3): rows are the directions of the line of centres, across it, and the axis."""

    name: str
    pair: GearPair
    hubs: tuple[Port, Port]
    axes: np.ndarray
    contacts: dict[Teeth, Contact] = field(default_factory=dict)

    def _facts(self) -> dict[str, Any]:
        return {"name": self.name, "gears": [hub.label for hub in self.hubs], "contacts": len(self.contacts)}

    def describe(self) -> dict[str, Any]:
        """Plain data for results."""
        return {
            "name": self.name,
            "gears": [asdict(gear) for gear in (self.pair.gear_1, self.pair.gear_2)],
            "center_distance": self.pair.center_distance,
            "bodies": [hub.body.name for hub in self.hubs],
            "interfaces": [hub.interface_name for hub in self.hubs],
            "centers": [hub.body.position.tolist() for hub in self.hubs],
            "axes": self.axes.tolist(),
            "contacts": [[*teeth, contact.name] for teeth, contact in self.contacts.items()],
        }


@named_arguments
def add_gear_pair(
    scene: Scene,
    gear_1: Port,
    gear_2: Port,
    pair: GearPair,
    *,
    name: str,
    flank: Literal["right", "left", "both"] = "right",
    direction: Any = None,
    rotation: Any = None,
    friction: FrictionLike = 0.0,
    cells: tuple[int, int] | None = None,
) -> GearMesh:
    """Bring two gears into mesh: place gear 2, and add a contact for each pair of teeth that meets; returns them.

    scene: with both bodies; name: of the pair, for `result.gear(name)` and the names of its contacts.
    gear_1, gear_2: the hubs, ports of bodies whose axis is the user's +y and whose flanks are `Gear.surfaces()`. pair:
    their geometry. flank: of gear 1, that pushes: the right one where gear 1 drives about -y of its frame, the left one
    about +y; "both": with backlash. direction (3,): from gear 1 to gear 2, world, the opposite of an internal gear 2;
    None: that of tooth 1. rotation: (from, to) [rad] of gear 1 about +y from its initial position in the run; (0, 0)
    for equilibria near it; None: any rotation, all pairs of teeth that ever meet. friction, cells: as for `Contact`.
    Gear 2 is moved, and rotated by the least angle at which flanks touch; joints and loads of the shafts are yours.
    Raises `InputError` for ports that are no hubs of bodies with these flanks.
    """
    hubs = [_hub(port, label) for port, label in ((gear_1, "gear_1"), (gear_2, "gear_2"))]
    if flank not in (*FLANKS, "both"):
        raise unknown_name(f"gear pair {name!r}: flank", flank, (*FLANKS, "both"))
    sides = FLANKS if flank == "both" else (flank,)
    angles, axes = _placed(hubs[0].body, hubs[1].body, pair, direction, sides[0], name)
    mesh = GearMesh(name, pair, (hubs[0], hubs[1]), axes)
    lean = float(np.tan(pair.base_helix_angle))
    bends = [1.0 / float(rho) / np.hypot(1.0, lean) for rho in pair.curvature_radii(0.0)]
    meeting = FacingPlace((sum(bends), 0.0), (max(map(abs, bends)), 0.0), 0.0, abs(lean))
    ends = _ends(mesh.hubs, name) if lean else (0.0, 0.0)
    for side in sides:
        for k, t in teeth_in_mesh(pair, angles, side, rotation, name, ends):
            a, b = (_surface(hub.body, f"flank_{side}_{tooth}", name) for hub, tooth in zip(hubs, (k, t), strict=True))
            label = f"{name} {side} {k}-{t}"
            contact = Contact(a, b, friction=friction, cells=cells, name=label)
            contact.meeting = meeting
            mesh.contacts[side, k, t] = scene.add(contact)
    scene.gears.append(mesh)
    warn(_uncovered(mesh))
    return mesh


def places(pair: GearPair, angle: Any, side: str, teeth: Any) -> Any:
    """g [m] of `teeth` of gear 1 rotated by `angle` [rad], in the turn of gear 1 nearest to the pitch point; of helical
    gears in the section y = 0."""
    s, one = (1.0 if side == "right" else -1.0), pair.gear_1
    width = one.tooth_thickness(pair.working_diameters[0]) / pair.working_diameters[0]
    turned = s * (s * width - np.asarray(angle) - 2.0 * np.pi / one.teeth * (np.asarray(teeth) - 1))
    middle = 0.5 * (pair.path["A"] + pair.path["E"]) / one.base_radius
    return one.base_radius * (middle + np.remainder(turned - middle + np.pi, 2.0 * np.pi) - np.pi)


def advance(pair: GearPair, side: str, y: Any) -> Any:
    """g [m] of the sections of helical gears at y [m] less that at y = 0."""
    return (-1.0 if side == "right" else 1.0) * np.tan(pair.base_helix_angle) * np.asarray(y)


def teeth_in_mesh(
    pair: GearPair, angles: tuple[float, float], side: str, rotation: Any, name: str, ends: tuple[float, float]
) -> list[tuple[int, int]]:
    """Teeth of gears 1 and 2 that meet while gear 1 rotates by rotation[0] to rotation[1] from `angles`, those of both
    gears [rad], at which flanks touch; None: any rotation. ends: of the common width, y [m]."""
    z_1, z_2 = pair.gear_1.teeth, pair.gear_2.teeth
    pitch = pair.gear_1.base_pitch
    first = int(np.argmin(np.abs(places(pair, angles[0], side, np.arange(1, z_1 + 1)))))
    start = float(places(pair, angles[0], side, first + 1))
    opposite = _opposite(pair, angles[1], side, start)
    # tooth `first` + n is at g = start - s n p, n of either sign, and meets the tooth `opposite` - sigma s n
    s = 1 if side == "right" else -1
    early = advance(pair, side, ends)
    low, high = pair.path["A"] - ENTRY * pitch - early.max(), pair.path["E"] + ENTRY * pitch - early.min()
    if rotation is None:
        numbers = range(int(np.lcm(z_1, z_2)))
    else:
        moved = -s * require_array(rotation, f"gear pair {name!r}: rotation", (2,)) * pair.gear_1.base_radius
        ends = (start - high + moved.min()) / pitch, (start - low + moved.max()) / pitch
        numbers = range(int(np.ceil(ends[0])), int(np.floor(ends[1])) + 1)
    found = [((first + s * n) % z_1 + 1, (opposite - 1 - s * pair.side * n) % z_2 + 1) for n in numbers]
    return list(dict.fromkeys(found))


def _opposite(pair: GearPair, angle_2: float, side: str, g: float) -> int:
    """The tooth of gear 2, rotated by `angle_2` [rad], that touches gear 1 at g."""
    s, alpha = (1.0 if side == "right" else -1.0), pair.working_pressure_angle
    place = np.array([0.5 * pair.working_diameters[0], 0.0]) + g * np.array([np.sin(alpha), -s * np.cos(alpha)])
    away = place - pair.side * np.array([pair.center_distance, 0.0])
    turned = -angle_2 - 2.0 * np.pi * np.arange(pair.gear_2.teeth) / pair.gear_2.teeth
    c, sn = np.cos(turned), np.sin(turned)
    points = np.stack([c * away[0] - sn * away[1], sn * away[0] + c * away[1]], axis=-1)
    return int(np.argmin(np.abs(pair.gear_2.flank(side).gap(points)))) + 1


def _placed(
    one: Body, two: Body, pair: GearPair, direction: Any, side: str, name: str
) -> tuple[tuple[float, float], np.ndarray]:
    """Moves gear 2 to its place; returns the angles of both gears from the line of centres [rad], and the axes."""
    axes = rot.matrix(one.rotation)
    axis, tooth = axes[:, 1], axes[:, 0]
    towards = tooth if direction is None else require_array(direction, f"gear pair {name!r}: direction", (3,))
    towards = towards - (towards @ axis) * axis
    if np.linalg.norm(towards) < ALONG:
        raise InputError(f"gear pair {name!r}: direction must not be along the axis of gear_1")
    e_0 = pair.side * towards / np.linalg.norm(towards)
    e_1 = np.cross(axis, e_0)
    own = rot.matrix(two.rotation)[:, 0]
    angle, present = (float(np.arctan2(x @ e_1, x @ e_0)) for x in (tooth, own))
    pitch, turned = 2.0 * np.pi / pair.gear_2.teeth, pair.mating_angle(angle, side)
    turned += pitch * float(np.round((present - turned) / pitch))
    x = np.cos(turned) * e_0 + np.sin(turned) * e_1
    two.position = one.position + pair.center_distance * pair.side * e_0
    two.rotation = rot.quaternion(np.stack([x, axis, np.cross(x, axis)], axis=1))
    return (angle, turned), np.stack([e_0, e_1, axis])


def _hub(port: Any, label: str) -> Port:
    if not isinstance(port, Port) or not isinstance(port.body, Body):
        raise InputError(f"gear pair: {label} must be the hub of a body, body['bore'], got {port!r}")
    return port


def _ends(hubs: tuple[Port, Port], name: str) -> tuple[float, float]:
    """The ends [m] of the common width of helical gears, along y; rigid flanks have none."""
    found = []
    for body in (hub.body for hub in hubs):
        surfaces = {} if body.reduced is None else body.reduced.contact_surfaces
        found += [np.asarray(s.grid.z)[[0, -1]] for label, s in surfaces.items() if label.startswith("flank_")]
    if not found:
        raise InputError(f"gear pair {name!r}: one of two helical gears must be elastic; use wf.half_space_body")
    low, high = np.array(found).T
    return float(low.max()), float(high.min())


def _surface(body: Body, surface: str, name: str) -> Any:
    known = body.surfaces if body.reduced is None else body.reduced.contact_surfaces
    if surface not in known:
        raise InputError(
            f"gear pair {name!r}: body {body.name!r} has no surface {surface!r}, which meets in this range of "
            "rotation; reduce it with contact=gear.surfaces(), or limit rotation"
        )
    return body[surface]


def _uncovered(mesh: GearMesh) -> list[str]:
    """A doubt where the contact grids of flexible flanks end within the path of contact: what teeth touch with beyond
    is concentrated at the ends of the grids."""
    pair, ends = mesh.pair, dict[tuple[float, float], None]()
    for contact in mesh.contacts.values():
        low, high = pair.path["A"], pair.path["E"]
        for port, gear, pitch, sign in zip(
            contact.ports, (pair.gear_1, pair.gear_2), pair.pitch_rho, (1.0, -float(pair.side)), strict=True
        ):
            if port.rigid or port.surface.half_space:
                continue
            curve, grid = port.surface.shape.curve, port.surface.grid
            radius = np.linalg.norm(curve.at(grid.theta[[0, -1]]), axis=1)
            rho = np.sqrt(np.maximum(radius**2 - gear.base_radius**2, 0.0))
            first, last = sorted(sign * (rho - pitch))
            low, high = max(low, first), min(high, last)
        ends[round(low, 6), round(high, 6)] = None
    path = round(pair.path["A"], 6), round(pair.path["E"], 6)
    return [
        f"gear pair {mesh.name!r}: contact grids of flanks end at {low * 1e3:.2f} and {high * 1e3:.2f} mm on the path "
        f"of contact, which reaches from {path[0] * 1e3:.2f} to {path[1] * 1e3:.2f} mm: beyond them pressures and "
        "deflections are too large; use finer cells along the flanks, or wf.half_space_body"
        for low, high in ends
        if (low, high) != path
    ]
