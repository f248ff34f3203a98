"""Small sliding (joint interfaces) of a `Contact` between faces of two bodies or within one: its options, its cells.

Cells of the first face have fixed partners on the other; rolling and large sliding are excluded: bolted and riveted
sheets, leaves of a spring, a hub on its shaft. Contact is unilateral, friction is Coulomb's with its history, and cells
have the static compliance of their relative motion (`surfaces.Matched`), coupled over all matched faces of a body.

Preload. Interfaces with initial interference or gap: how the preload is equilibrated, and which interfaces hardly
touch.

Interference presses faces apart. A hub on its shaft is self-equilibrated, as the pressures cancel around the
circumference; two plates require a bolt, a joint or a load. Bodies that no joint, spring or contact connects make a
*part*; for each part the pressures of its contacts with small sliding, assumed uniform, have the resultant

    r = |sum n A|/sum A,

n the outward normals of the cells in the world, A their areas: 1 of a plane face, 0 of a closed one. A part with r
above `ONE_SIDED` is accelerated away unless it is loaded.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model import rotation as rot
from warpffrf.model.bodies import GROUND_INDEX, SurfacePort
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.laws import Law
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.small_sliding.facing import Pairing, pair_faces

if TYPE_CHECKING:
    from warpffrf.model.contact import Contact

SLIDING = ("finite", "small")
ROUND_OFF = 1e-12  # of the extent of a face: smaller gaps count as zero


@dataclass(frozen=True, eq=False)
class MatchedCells:
    """Cells of a small-sliding contact at the initial pose, c of them: `cell` (c,) their numbers on the first face,
    `points` (c, 3) [m] and `frames` (c, 3, 3) in user axes of the first body, `area` (c,) [m2], `gap` (c,) [m] less the
    interference; of a second flexible face `weights` (c, its cells)."""

    cell: np.ndarray
    points: np.ndarray
    frames: np.ndarray
    area: np.ndarray
    gap: np.ndarray
    weights: sp.csr_matrix | None
    shares: tuple[float, float]


@named_arguments
@dataclass(frozen=True)
class SmallSliding:
    """Options of a contact with small sliding: `Contact(a, b, sliding=SmallSliding(interference=2e-6))`.

    interference [m]: initial penetration of the second face into the first, as in a press fit (half the difference of
    the diameters), added to that of the geometry. tangential_stiffness [Pa/m]: that of a layer (`laws.LinearLayer`)
    along the face, None for its normal stiffness; without a layer the value is tangential only, and None means rigid.
    Raises `InputError` for numbers that are not admissible.
    """

    interference: float = 0.0
    tangential_stiffness: float | None = None

    def __post_init__(self) -> None:
        label = "SmallSliding"
        object.__setattr__(self, "interference", require_number(self.interference, f"{label}: interference [m]"))
        if self.tangential_stiffness is not None:
            stiffness = require_number(
                self.tangential_stiffness, f"{label}: tangential_stiffness [Pa/m]", positive=True
            )
            object.__setattr__(self, "tangential_stiffness", stiffness)


def as_sliding(value: Any) -> SmallSliding | None:
    """The options of small sliding, None of finite sliding. Raises `InputError` for anything else."""
    if isinstance(value, SmallSliding):
        return value
    if value not in SLIDING:
        raise InputError(
            f"contact: sliding must be 'finite', 'small', or SmallSliding(interference=..., tangential_stiffness=...), "
            f"got {value!r}"
        )
    return SmallSliding() if value == "small" else None


def check_ports(a: Any, b: Any, name: str | None) -> str:
    """The name of a contact between two faces, or within one body if `b` is None. Raises `InputError` for ports that
    cannot be used."""
    if not isinstance(a, SurfacePort) or not a.matched:
        raise InputError(
            f"contact: the first surface, a, must be a face of a flexible body reduced as Matched, body['face'] "
            f"with 'face' named in reduce(contact={{'face': surfaces.Matched()}}), got {_said(a)}"
        )
    name = name or (f"{a.body.name}-{a.name}" if b is None else f"{a.body.name}-{getattr(b, 'body', b).name}")
    label, pair = f"contact {name!r}", a.surface.pair
    if pair and b is not None:
        raise InputError(f"{label}: {a.label} has both of its faces in one body already; leave the second port out")
    if not pair and b is None:
        raise InputError(f"{label}: {a.label} is one face; name the face that it lies on as the second port")
    if b is None:
        return name
    if not isinstance(b, SurfacePort) or not (b.rigid or b.matched):
        raise InputError(
            f"{label}: the second surface, b, must be a face of a flexible body reduced as Matched, named in "
            f"reduce(contact={{'face': surfaces.Matched()}}), or a surface of a rigid body or of the ground, got "
            f"{_said(b)}"
        )
    if b.body is a.body:
        raise InputError(
            f"{label}: both faces are on body {a.body.name!r}; reduce it with contact={{{a.name!r}: "
            "surfaces.Matched(second=...)} and give that surface alone"
        )
    if b.matched and b.surface.pair:
        raise InputError(f"{label}: {b.label} has both of its faces in one body; name a single face")
    return name


def _said(port: Any) -> str:
    return getattr(port, "label", None) or repr(port)


def check_law(law: Law, label: str) -> None:
    """Raises `InputError` for laws that small sliding does not support."""
    if law.bent is not None or law.chi:
        raise InputError(
            f"{label}: law {law.kind!r} does not yield in proportion to the pressure; take laws.UNILATERAL, or "
            "laws.LinearLayer with the stiffness at the pressures of the joint"
        )


def yields(contact: Contact) -> tuple[float, float]:
    """Compliance of a layer, normal and tangential [m/Pa]."""
    normal, stiffness = contact.law.compliance, options(contact).tangential_stiffness
    return normal, normal if stiffness is None else 1.0 / stiffness


def options(contact: Contact) -> SmallSliding:
    """The options of a contact with small sliding."""
    assert contact.sliding is not None
    return contact.sliding


def cells_of(contact: Contact) -> MatchedCells:
    """Its cells at the current initial pose. Raises `InputError` for faces that do not face each other."""
    surface = contact.a.surface
    if contact.b is None:
        every = np.arange(surface.cells)
        return MatchedCells(
            every, surface.points, surface.frames, surface.area,
            _from_touch(contact, surface.gap), None,
            surface.covered,
        )  # fmt: skip
    if contact.b.rigid:
        return _on_rigid(contact)
    found = _pairing(contact)
    cell = found.cell
    return MatchedCells(
        cell, surface.points[cell], surface.frames[cell], surface.area[cell] * found.covered,
        _from_touch(contact, found.gap), found.weights, found.shares,
    )  # fmt: skip


def _from_touch(contact: Contact, distance: np.ndarray) -> np.ndarray:
    """Gaps (c,) [m] of faces at this distance, minus the interference; zero where they are round-off of positions."""
    gap = distance - options(contact).interference
    extent = float(np.linalg.norm(np.ptp(contact.a.surface.triangles.reshape(-1, 3), axis=0)))
    return np.where(np.abs(gap) < ROUND_OFF * extent, 0.0, gap)


def _pairing(contact: Contact) -> Pairing:
    first, second = contact.a.surface, contact.b.surface
    body, other = contact.a.body, contact.b.body
    world = first.frames[:, 0] @ rot.matrix(body.rotation).T
    return pair_faces(
        contact.label, body.to_world(first.triangles), first.cell, world, other.to_world(second.triangles), second.cell
    )


def _on_rigid(contact: Contact) -> MatchedCells:
    """Cells opposite a rigid surface: all of the first face, each with the distance of its centre."""
    surface, shape = contact.a.surface, contact.b.surface.shape
    world = contact.a.body.to_world(surface.points)
    theta, z, distance = shape.chart(contact.b.body.to_user(world))
    outwards = np.asarray(shape.normal(theta, z)) @ rot.matrix(contact.b.body.rotation).T
    normals = surface.frames[:, 0] @ rot.matrix(contact.a.body.rotation).T
    if np.any(np.einsum("ci,ci->c", outwards, normals) > -0.5):
        raise InputError(
            f"{contact.label}: {contact.a.label} does not look at {contact.b.label}: their outward normals are not "
            "opposite everywhere; place the body so that the face lies on the surface"
        )
    return MatchedCells(
        np.arange(surface.cells), surface.points, surface.frames, surface.area,
        _from_touch(contact, np.asarray(distance)), None, (1.0, 1.0),
    )  # fmt: skip


Array = np.ndarray
ONE_SIDED = 0.5  # of r
APART = 1e-3  # of the extent of a small-sliding contact: gaps that elastic bodies hardly close
DEEP = 1e-2  # of it: interference beyond small strains
COVERED = 0.5  # of the smaller face


def refuse_pushed_apart(scene: Any) -> None:
    """Raises `InputError` where interference pushes away a part of the scene that is neither constrained nor loaded."""
    if not any(options(contact).interference > 0.0 for contact in scene.small_sliding) or np.any(scene.gravity):
        return
    part = _parts(scene)
    for number in set(part.values()) - {part[GROUND_INDEX]}:
        members = [contact for contact in scene.small_sliding if _sides(contact, part, number) == 1]
        pressing = [contact for contact in members if options(contact).interference > 0.0]
        if not pressing or any(part[port.body.index] == number for item in _loads(scene) for port in item.ports):
            continue
        sums = [_resultant(contact, first=part[contact.a.body.index] == number) for contact in members]
        total = np.linalg.norm(sum(n for n, _ in sums)) / sum(area for _, area in sums)
        if total > ONE_SIDED:
            contact = pressing[0]
            names = ", ".join(repr(body.name) for body in scene.bodies if part[body.index] == number)
            raise InputError(
                f"{contact.label}: its interference of {options(contact).interference:.3g} m pushes {names} away, a "
                "preload without a load path: no joint, spring or contact holds both sides together and no force "
                "presses them; add a bolt (JointSpringDamper(preload=)), a joint or a force, or leave the interference "
                "out"
            )


def small_sliding_notes(contact: Contact, cells: MatchedCells) -> list[str]:
    """Notes on implausible initial gaps of a small-sliding contact."""
    extent = float(np.linalg.norm(np.ptp(contact.a.surface.points, axis=0))) + float(np.sqrt(cells.area.max()))
    notes = []
    if (gap := float(cells.gap.min())) > APART * extent:
        notes.append(
            f"{contact.label}: its faces are {gap:.3g} m apart where they are nearest, {gap / extent:.2g} of their "
            "extent, and carry nothing until they meet; move a body, with scene.place(), or give interference"
        )
    if (depth := -float(cells.gap.min())) > DEEP * extent:
        notes.append(
            f"{contact.label}: one face begins {depth:.3g} m inside the other, {depth / extent:.2g} of their extent, "
            "beyond small strains unless a layer yields; check the places of the bodies and the unit of interference, m"
        )
    if max(cells.shares) < COVERED:
        notes.append(
            f"{contact.label}: {cells.shares[0]:.2g} and {cells.shares[1]:.2g} of the areas of its faces overlap, the "
            "rest carries nothing; move a body, or name smaller facet sets"
        )
    return notes


def _loads(scene: Any) -> list[Any]:
    return [item for item in scene.forces if len(item.ports) == 1]


def _parts(scene: Any) -> dict[int, int]:
    """Part number of each body by index, and of the ground."""
    part = {index: index for index in (GROUND_INDEX, *(body.index for body in scene.bodies))}
    linking = (*scene.joints, *scene.forces, *scene.finite_sliding, *scene.lumped_contacts, *scene.films)
    for item in linking:
        first, *others = (part[port.body.index] for port in item.ports)
        for other in others:
            part = {index: first if number == other else number for index, number in part.items()}
    return part


def _sides(contact: Contact, part: dict[int, int], number: int) -> int:
    """Number of faces of a small-sliding contact on a part."""
    return 0 if contact.b is None else sum(part[port.body.index] == number for port in contact.ports)


def _resultant(contact: Contact, *, first: bool) -> tuple[Array, float]:
    """sum n A (3,) in the world, outwards of the contact's first face or of its second, and sum A [m2]."""
    cells = cells_of(contact)
    n = rot.matrix(contact.a.body.rotation) @ (cells.area @ cells.frames[:, 0])
    return n if first else -n, float(cells.area.sum())
