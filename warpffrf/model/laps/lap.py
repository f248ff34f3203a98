"""`Lap`: small-sliding contact (joint interface) between faces of two bodies or within one.

Cells of the first face have fixed partners on the other; rolling and large sliding are excluded: bolted and riveted
sheets, leaves of a spring, a hub on its shaft. Contact is unilateral, friction is Coulomb's with its history, and cells
have the static compliance of their relative motion (`reduce(laps=...)`), coupled over all laps of a body.

Preload. Interfaces with initial interference or gap: how the preload is equilibrated, and which hardly touch.

Interference presses faces apart. A hub on its shaft is self-equilibrated, as the pressures cancel around the
circumference; two plates require a bolt, a joint or a load. Bodies that no joint, spring or contact connects make a
*part*; for each part the pressures of its laps, assumed uniform, have the resultant

    r = |sum n A|/sum A,

n the outward normals of the cells in the world, A their areas: 1 of a plane face, 0 of a closed one. A part with r
above `ONE_SIDED` is accelerated away unless it is loaded.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp

from warpffrf.model import rotation as rot
from warpffrf.model.bodies import GROUND_INDEX, LapPort, SurfacePort
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.friction import FrictionLike, as_constant_friction
from warpffrf.model.laps.facing import Pairing, pair_faces
from warpffrf.model.laws import Law, Unilateral, as_law
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments

UNILATERAL = Unilateral()
ROUND_OFF = 1e-12  # of the extent of a face: smaller gaps count as zero


@dataclass(frozen=True, eq=False)
class LapCellsOf:
    """Cells of a lap at the initial pose, c of them: `cell` (c,) their numbers on the first face, `points` (c, 3) [m]
    and `frames` (c, 3, 3) in user axes of the first body, `area` (c,) [m2], `gap` (c,) [m] less the interference; of a
    second flexible face `weights` (c, its cells)."""

    cell: np.ndarray
    points: np.ndarray
    frames: np.ndarray
    area: np.ndarray
    gap: np.ndarray
    weights: sp.csr_matrix | None
    shares: tuple[float, float]


@named_arguments
class Lap(reprs.Item):
    """Contact with friction between two faces with small relative sliding.

    a: `body["lap"]` of two faces of one body (`reduce(laps={"lap": ("top", "bottom")})`), then b is left out; or a face
    of a flexible body (`reduce(laps={"foot": "foot"})`). b: a face of another flexible body, or a surface of a rigid
    body or the ground. friction: the coefficient, or `friction.Coulomb`. law: `laws.UNILATERAL`, or `laws.LinearLayer`
    for a layer with the deformation p/stiffness. tangential_stiffness [Pa/m]: that of such a layer along the face, None
    for its normal stiffness; without a layer the value is tangential only, and None means rigid. interference [m]:
    initial penetration of the second face into the first, as in a press fit, added to that of the geometry. name:
    default "<first>-<second>".

    Forces are those on the second face. The pairing of cells is fixed by the poses of the bodies when the run begins.
    Raises `InputError` for ports, laws and numbers that cannot be used.
    """

    scene_list = "laps"
    kind = "lap"

    def __init__(
        self,
        a: LapPort,
        b: LapPort | SurfacePort | None = None,
        *,
        friction: FrictionLike = 0.0,
        law: Law = UNILATERAL,
        interference: float = 0.0,
        tangential_stiffness: float | None = None,
        name: str | None = None,
    ) -> None:
        if not isinstance(a, LapPort):
            raise InputError(
                f"lap: the first port must be a lap of a flexible body, body['lap'] with 'lap' named in "
                f"reduce(laps={{...}}), got {getattr(a, 'label', None) or repr(a)}"
            )
        pair = a.surface.pair
        self.a = a
        self.b: Any = b  # a LapPort, a SurfacePort or None
        self.name = name or (f"{a.body.name}-{a.name}" if b is None else f"{a.body.name}-{getattr(b, 'body', b).name}")
        label = self.label
        if pair and b is not None:
            raise InputError(f"{label}: {a.label} has both of its faces in one body already; leave the second port out")
        if not pair and b is None:
            raise InputError(f"{label}: {a.label} is one face; name the face that it lies on as the second port")
        if b is not None:
            rigid = isinstance(b, SurfacePort) and b.rigid
            if not rigid and not isinstance(b, LapPort):
                raise InputError(
                    f"{label}: the second port must be a face of a flexible body named in reduce(laps={{...}}), or a "
                    f"surface of a rigid body or of the ground, got {getattr(b, 'label', None) or repr(b)}"
                )
            if b.body is a.body:
                raise InputError(
                    f"{label}: both faces are on body {a.body.name!r}; reduce it with laps={{name: (face, face)}} and "
                    "give that lap alone"
                )
            if isinstance(b, LapPort) and b.surface.pair:
                raise InputError(f"{label}: {b.label} has both of its faces in one body; name a single face")
        self.law = as_law(law, label)
        if self.law.bent is not None or self.law.chi:
            raise InputError(
                f"{label}: law {self.law.kind!r} does not yield in proportion to the pressure; take laws.UNILATERAL, "
                "or laws.LinearLayer with the stiffness at the pressures of the joint"
            )
        self.friction = as_constant_friction(friction, label)
        if self.friction.creep_limit:
            raise InputError(f"{label}: friction of kind {self.friction.kind!r} does not stick; take friction.Coulomb")
        self.interference = require_number(interference, f"{label}: interference [m]")
        self.tangential_stiffness = tangential_stiffness
        if tangential_stiffness is not None:
            self.tangential_stiffness = require_number(
                tangential_stiffness, f"{label}: tangential_stiffness [Pa/m]", positive=True
            )

    @property
    def label(self) -> str:
        """Readable name, for messages."""
        return f"lap {self.name!r}"

    @property
    def ports(self) -> tuple[Any, ...]:
        """One or two."""
        return (self.a,) if self.b is None else (self.a, self.b)

    @property
    def coefficient(self) -> float:
        """mu [-] of friction at rest."""
        return self.friction.static_coefficient

    @property
    def yields(self) -> tuple[float, float]:
        """Compliance of a layer, normal and tangential [m/Pa]."""
        normal = self.law.compliance
        return normal, normal if self.tangential_stiffness is None else 1.0 / self.tangential_stiffness

    def cells(self) -> LapCellsOf:
        """Its cells at the current initial pose. Raises `InputError` for faces that do not face each other."""
        surface = self.a.surface
        if self.b is None:
            every = np.arange(surface.cells)
            return LapCellsOf(
                every, surface.points, surface.frames, surface.area,
                self._from_touch(surface.gap), None,
                surface.covered,
            )  # fmt: skip
        if self.b.rigid:
            return self._on_rigid()
        found = self._pairing()
        cell = found.cell
        return LapCellsOf(
            cell, surface.points[cell], surface.frames[cell], surface.area[cell] * found.covered,
            self._from_touch(found.gap), found.weights, found.shares,
        )  # fmt: skip

    def _from_touch(self, distance: np.ndarray) -> np.ndarray:
        """Gaps (c,) [m] of faces at this distance, minus the interference; zero where they are round-off of
        positions."""
        gap = distance - self.interference
        extent = float(np.linalg.norm(np.ptp(self.a.surface.triangles.reshape(-1, 3), axis=0)))
        return np.where(np.abs(gap) < ROUND_OFF * extent, 0.0, gap)

    def _pairing(self) -> Pairing:
        first, second = self.a.surface, self.b.surface
        body, other = self.a.body, self.b.body
        world = first.frames[:, 0] @ rot.matrix(body.rotation).T
        return pair_faces(
            self.label, body.to_world(first.triangles), first.cell, world, other.to_world(second.triangles), second.cell
        )

    def _on_rigid(self) -> LapCellsOf:
        """Cells opposite a rigid surface: all of the first face, each with the distance of its centre."""
        surface, shape = self.a.surface, self.b.surface.shape
        world = self.a.body.to_world(surface.points)
        theta, z, distance = shape.chart(self.b.body.to_user(world))
        outwards = np.asarray(shape.normal(theta, z)) @ rot.matrix(self.b.body.rotation).T
        normals = surface.frames[:, 0] @ rot.matrix(self.a.body.rotation).T
        if np.any(np.einsum("ci,ci->c", outwards, normals) > -0.5):
            raise InputError(
                f"{self.label}: {self.a.label} does not look at {self.b.label}: their outward normals are not opposite "
                "everywhere; place the body so that the face lies on the surface"
            )
        return LapCellsOf(
            np.arange(surface.cells), surface.points, surface.frames, surface.area,
            self._from_touch(np.asarray(distance)), None, (1.0, 1.0),
        )  # fmt: skip

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        places = [[port.body.name, port.name] for port in self.ports]
        laws = {"law": self.law.describe(), "friction": self.friction.describe()}
        more = {"interference": self.interference, "tangential_stiffness": self.tangential_stiffness}
        return {"name": self.name, "ports": places, **laws, **more}


Array = np.ndarray
ONE_SIDED = 0.5  # of r
APART = 1e-3  # of the extent of a lap: gaps that elastic bodies hardly close
DEEP = 1e-2  # of it: interference beyond small strains
COVERED = 0.5  # of the smaller face


def refuse_pushed_apart(scene: Any) -> None:
    """Raises `InputError` where interference pushes away a part of the scene that is neither constrained nor loaded."""
    if not any(lap.interference > 0.0 for lap in scene.laps) or np.any(scene.gravity):
        return
    part = _parts(scene)
    for number in set(part.values()) - {part[GROUND_INDEX]}:
        members = [lap for lap in scene.laps if _sides(lap, part, number) == 1]
        pressing = [lap for lap in members if lap.interference > 0.0]
        if not pressing or any(part[port.body.index] == number for item in _loads(scene) for port in item.ports):
            continue
        sums = [_resultant(lap, first=part[lap.a.body.index] == number) for lap in members]
        total = np.linalg.norm(sum(n for n, _ in sums)) / sum(area for _, area in sums)
        if total > ONE_SIDED:
            lap = pressing[0]
            names = ", ".join(repr(body.name) for body in scene.bodies if part[body.index] == number)
            raise InputError(
                f"{lap.label}: its interference of {lap.interference:.3g} m pushes {names} away, a preload without a "
                "load path: no joint, spring or contact holds both sides together and no force presses them; add a "
                "bolt (JointSpringDamper(preload=)), a joint or a force, or leave the interference out"
            )


def lap_notes(lap: Lap, cells: LapCellsOf) -> list[str]:
    """Notes on implausible initial gaps of a lap."""
    extent = float(np.linalg.norm(np.ptp(lap.a.surface.points, axis=0))) + float(np.sqrt(cells.area.max()))
    notes = []
    if (gap := float(cells.gap.min())) > APART * extent:
        notes.append(
            f"{lap.label}: its faces are {gap:.3g} m apart where they are nearest, {gap / extent:.2g} of their extent, "
            "and carry nothing until they meet; move a body, with scene.place(), or give interference"
        )
    if (depth := -float(cells.gap.min())) > DEEP * extent:
        notes.append(
            f"{lap.label}: one face begins {depth:.3g} m inside the other, {depth / extent:.2g} of their extent, "
            "beyond small strains unless a layer yields; check the places of the bodies and the unit of interference, m"
        )
    if max(cells.shares) < COVERED:
        notes.append(
            f"{lap.label}: {cells.shares[0]:.2g} and {cells.shares[1]:.2g} of the areas of its faces overlap, the rest "
            "carries nothing; move a body, or name smaller facet sets"
        )
    return notes


def _loads(scene: Any) -> list[Any]:
    return [item for item in scene.forces if len(item.ports) == 1]


def _parts(scene: Any) -> dict[int, int]:
    """Part number of each body by index, and of the ground."""
    part = {index: index for index in (GROUND_INDEX, *(body.index for body in scene.bodies))}
    linking = (*scene.joints, *scene.forces, *scene.contacts, *scene.lumped_contacts, *scene.films)
    for item in linking:
        first, *others = (part[port.body.index] for port in item.ports)
        for other in others:
            part = {index: first if number == other else number for index, number in part.items()}
    return part


def _sides(lap: Lap, part: dict[int, int], number: int) -> int:
    """Number of faces of a lap on a part."""
    return 0 if lap.b is None else sum(part[port.body.index] == number for port in lap.ports)


def _resultant(lap: Lap, *, first: bool) -> tuple[Array, float]:
    """sum n A (3,) in the world, outwards of the lap's first face or of its second, and sum A [m2]."""
    cells = lap.cells()
    n = rot.matrix(lap.a.body.rotation) @ (cells.area @ cells.frames[:, 0])
    return n if first else -n, float(cells.area.sum())
