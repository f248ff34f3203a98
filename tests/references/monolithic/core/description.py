"""Scene -> plain arrays: bodies about their centres of mass, markers, rows, springs and loads.

The counterpart of `warpffrf.online.compile.scene`, written from the model alone.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from references.monolithic.core.inertia_forces import DeformationTerms, deformation_terms
from references.monolithic.core.rows import MarkerPlace
from warpffrf.model import rotation as rot
from warpffrf.model.checks.redundancy import ConstraintRow, find_redundancy
from warpffrf.model.errors import InputError
from warpffrf.model.forces import BodyLoad, PointLoad
from warpffrf.model.forces.laws import tension_of


@dataclass(frozen=True, eq=False)
class BodyData:
    """A body: mass [kg], inertia (3, 3) about the centre of mass, stiffness and damping (m,) of its global modes (mass
    1), the effect of deformation on its inertia, and the forms (R, k, k) of its membrane energy, None without."""

    name: str
    mass: float
    inertia: np.ndarray
    center: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    terms: DeformationTerms | None
    membrane: np.ndarray | None = None

    @property
    def gyration(self) -> float:
        """A radius of gyration [m], to compare torques with forces."""
        return float(np.sqrt(self.inertia[0, 0] / self.mass))


@dataclass(frozen=True, eq=False)
class ConstraintData:
    """A rigid row: kind and axes, its two markers, the prescribed signal (None: none) and its reference value; for a
    pretension, whose `joint` is empty, a row that is not always rigid."""

    joint: str
    kind: str
    i: int
    j: int
    markers: tuple[int, int]
    signal: Any
    reference: float

    @property
    def is_length(self) -> bool:
        return self.kind in ("translation", "distance")


@dataclass(frozen=True, eq=False)
class SpringData:
    """A spring law on n coordinates, see `warpffrf.model.forces.laws`; `coordinates` are (kind, i, j, vector),
    `elastic` and `viscous` the characteristics of some of them, by coordinate."""

    name: str
    coordinates: tuple[tuple[str, int, int, np.ndarray], ...]
    markers: tuple[int, int]
    stiffness: np.ndarray
    damping: np.ndarray
    reference: np.ndarray
    preload: np.ndarray
    elastic: dict[int, Any]
    viscous: dict[int, Any]


@dataclass(frozen=True, eq=False)
class TensionData:
    """A pretension: its number among the constraints, its force [N] as a signal, and its locking time [s]."""

    name: str
    row: int
    force: Any
    lock_at: float


@dataclass(frozen=True, eq=False)
class LoadData:
    """A concentrated force or torque at a marker, three signals, in world or body axes."""

    what: str
    marker: int
    in_body: bool
    components: tuple[Any, Any, Any]


@dataclass
class SceneData:
    """All data of a scene for a step, except its contacts."""

    gravity: np.ndarray
    bodies: list[BodyData]
    markers: list[MarkerPlace] = field(default_factory=list)
    constraints: list[ConstraintData] = field(default_factory=list)
    tensions: list[TensionData] = field(default_factory=list)
    springs: list[SpringData] = field(default_factory=list)
    loads: list[LoadData] = field(default_factory=list)
    body_loads: list[BodyLoad] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    dropped: list[ConstraintRow] = field(default_factory=list)


def describe_scene(scene: Any) -> SceneData:
    """Arrays of `scene`. Raises `InputError` for a scene without bodies and for drives that the joints contradict."""
    if not scene.bodies:
        raise InputError("scene: there are no bodies; add one with scene.add_body or scene.add_rigid_body")
    data = SceneData(np.asarray(scene.gravity, dtype=np.float64), [_body(b) for b in scene.bodies])
    found = find_redundancy(scene)
    joints: dict[str, tuple[int, int]] = {}
    for joint in scene.joints:
        pair = [
            _marker(data, port, marker.point, rot.matrix(marker.rotation))
            for port, marker in zip(joint.ports, joint.frames(), strict=True)
        ]
        joints[str(joint.name)] = (pair[0], pair[1])
    for item, kept in zip(found.rows, found.kept, strict=True):
        if not kept and item.drive is not None:
            raise InputError(
                f"drive {item.drive.name!r}: the {item.drive.coordinate} of joint {item.joint.name!r} is fixed already "
                "by the other joints and drives; remove one of them"
            )
        if not kept:
            data.dropped.append(item)
            data.notes.append(f"redundant constraint left out, its reaction counts as zero: {item.label}")
            continue
        signal, reference = None, item.initial
        if item.drive is not None:
            signal = item.drive.position()
            reference = 0.0 if item.drive.quantity == "position" else item.initial
        row, name = item.row, str(item.joint.name)
        data.constraints.append(ConstraintData(name, row.kind, row.i, row.j, joints[name], signal, reference))
    for item in scene.forces:
        if hasattr(item, "law"):
            data.springs.append(_spring(data, str(item.name), item.law(), joints))
        if (law := tension_of(item)) is not None:
            c, markers = law.coordinate, joints[str(law.joint.name)]
            data.tensions.append(TensionData(str(item.name), len(data.constraints), law.force, law.lock_at))
            data.constraints.append(ConstraintData("", c.kind, c.i, c.j, markers, None, 0.0))
        if hasattr(item, "law") or law is not None:
            continue
        if hasattr(item, "slip"):
            raise InputError(f"{item.label}: the monolithic reference has no friction in joints; use warpffrf.simulate")
        load = item.load()
        if isinstance(load, BodyLoad):
            data.body_loads.append(load)
        elif isinstance(load, PointLoad):
            marker = _marker(data, load.port, load.port.point, np.eye(3))
            data.loads.append(LoadData(load.what, marker, load.frame == "body", load.components))
        else:
            raise InputError(
                f"force {item.name!r}: the monolithic reference does not know a {item.kind}; use warpffrf.simulate"
            )
    return data


def inertia_level(body: Any) -> str:
    """The inertia terms of a flexible body: its level; for "auto" all with which it was reduced, since this solver is
    the reference for the levels. Raises `InputError` if the body was reduced without them."""
    terms = body.reduced.inertia_terms
    if body.stiffening and (terms is None or terms.stiffening is None):
        raise InputError(
            f"body {body.name!r}: it was reduced without geometric stiffening; use ReductionOptions(stiffening=True)"
        )
    if body.level == "auto":
        return "constant" if terms is None else "full"
    if body.level != "constant" and terms is None:
        raise InputError(
            f"body {body.name!r}: inertia {body.level!r} needs inertia terms, and the reduced body has none; reduce it "
            'again, or use inertia="constant"'
        )
    return body.level


def _body(body: Any) -> BodyData:
    reduced = body.reduced
    omega = np.zeros(0) if reduced is None else 2.0 * np.pi * np.asarray(reduced.frequencies)
    zeta = np.zeros(0) if reduced is None else np.asarray(body.damping)
    terms = membrane = None
    if reduced is not None:
        terms = deformation_terms(reduced.inertia_terms, inertia_level(body), body.stiffening)
        membrane = reduced.inertia_terms.stiffening.membrane if body.stiffening else None
    return BodyData(
        body.name, float(body.mass), np.asarray(body.inertia), np.asarray(body.center_of_mass), omega**2,
        2.0 * zeta * omega, terms, membrane,
    )  # fmt: skip


def _marker(data: SceneData, port: Any, point: Any, axes: np.ndarray) -> int:
    body = port.body
    if body.index < 0:
        data.markers.append(MarkerPlace(-1, np.asarray(point, dtype=np.float64), axes))
        return len(data.markers) - 1
    center = np.asarray(body.center_of_mass)
    modes = pivot = stiffening = None
    if port.interface_name is not None and body.mode_count:
        interface = body.reduced.interfaces[port.interface_name]
        modes, pivot = np.asarray(interface.modes, dtype=np.float64), interface.point - center
        if body.stiffening:
            stiffening = body.reduced.inertia_terms.stiffening.interfaces[port.interface_name]
    data.markers.append(MarkerPlace(body.index, np.asarray(point) - center, axes, modes, pivot, stiffening))
    return len(data.markers) - 1


def _spring(data: SceneData, name: str, law: Any, joints: dict[str, tuple[int, int]]) -> SpringData:
    if law.joint is not None:
        markers = joints[str(law.joint.name)]
    else:
        sides = zip(law.ports, law.points or (), law.axes or (), strict=True)
        a, b = (_marker(data, port, point, axes) for port, point, axes in sides)
        markers = (a, b)
    coordinates = tuple((c.kind, c.i, c.j, np.asarray(c.vector)) for c in law.coordinates)
    elastic, viscous = (
        {i: curve for i, curve in enumerate(curves) if curve is not None} for curves in (law.elastic, law.viscous)
    )
    return SpringData(
        name, coordinates, markers, np.asarray(law.stiffness), np.asarray(law.damping), np.asarray(law.reference),
        np.asarray(law.preload), elastic, viscous,
    )  # fmt: skip
