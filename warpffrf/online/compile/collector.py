"""Data of a scene collected during compilation; `compile_...` and `fill_...` of this folder read and add to it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from warpffrf.model.bodies import Body, Ground, Port
from warpffrf.model.contact import Contact
from warpffrf.model.forces import Characteristic
from warpffrf.model.forces.characteristics import Pieces
from warpffrf.model.pieces import FromInput, Signal
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.model.rigid_surface import RigidSurface
from warpffrf.model.scene import Scene
from warpffrf.online.compile.capacity import CellRoom
from warpffrf.online.compile.constants import Constants, Shared
from warpffrf.online.compile.inertia_plan import InertiaPlan
from warpffrf.online.compile.inputs import device_pieces
from warpffrf.online.compile.patches.plan import PatchPlan
from warpffrf.online.compile.patches.sides import PatchSide
from warpffrf.online.compile.patches.tables import patch_plans
from warpffrf.online.local_modes import LocalModes, LocalPlan
from warpffrf.online.settings import Settings
from warpffrf_kernels.core.model import Elements, External, Films, Matched

Surface = ContactSurface | RigidSurface
Compiled = ContactSurface | RigidSurface | PatchSide


class OnBody(NamedTuple):
    """A surface of a body that pairs load, as it is compiled."""

    body: Body | Ground
    name: str
    surface: Compiled


class Pair(NamedTuple):
    """A contact pair and its surfaces as they are compiled, the first flexible; on a contact-fixed grid those with the
    meshes.
    """

    contact: Contact
    body_a: Body | Ground
    a: ContactSurface
    body_b: Body | Ground
    b: Surface


@dataclass
class Rows:
    """Scalar rows being collected: constraints, drives, springs."""

    kind: list[int] = field(default_factory=list)
    a: list[int] = field(default_factory=list)
    b: list[int] = field(default_factory=list)
    i: list[int] = field(default_factory=list)
    j: list[int] = field(default_factory=list)
    signal: list[int] = field(default_factory=list)
    stiffness: list[float] = field(default_factory=list)
    damping: list[float] = field(default_factory=list)
    reference: list[float] = field(default_factory=list)
    preload: list[float] = field(default_factory=list)
    rigid: list[int] = field(default_factory=list)
    elastic: list[int] = field(default_factory=list)
    viscous: list[int] = field(default_factory=list)

    def add(
        self, kind: int, a: int, b: int, i: int = 0, j: int = 0, signal: int = -1, stiffness: float = 0.0,
        damping: float = 0.0, reference: float = 0.0, preload: float = 0.0, rigid: int = 1, elastic: int = -1,
        viscous: int = -1,
    ) -> int:  # fmt: skip
        """Enter a row between markers a and b; returns its number."""
        values = (int(kind), a, b, i, j, signal, stiffness, damping, reference, preload, rigid, elastic, viscous)
        for name, value in zip(self.__dataclass_fields__, values, strict=True):
            getattr(self, name).append(value)
        return len(self.kind) - 1

    def __len__(self) -> int:
        return len(self.kind)


class Collector:
    """Data collected from a scene for the device: rows, markers, signals, interfaces, surfaces, notes; and the plans
    that decide what of bodies and modes is kept. `fill` puts arrays into a topic of the model.
    """

    def __init__(
        self,
        scene: Scene,
        settings: Settings,
        device: str,
        local_modes: LocalModes,
        patches: Mapping[int, PatchPlan] | None = None,
        shared: Shared | None = None,
        turned: Sequence[float] | np.ndarray = (),
        off_end: bool = False,
    ) -> None:
        self.scene, self.settings, self.device = scene, settings, device
        self.constants = Constants(device, shared)
        self.fill = self.constants.fill
        self.rows = Rows()
        self.markers: list[tuple[int, int, np.ndarray, np.ndarray]] = []
        self.signals: list[tuple[np.ndarray, np.ndarray]] = []
        self.following: list[tuple[int, FromInput]] = []  # numbers of the signals that follow an input
        self.characteristics: list[Pieces] = []
        self.interfaces: dict[tuple[int, str], int] = {}
        self.elements = Elements()
        self.external = External()
        self.films = Films()
        self.matched = Matched()
        self.notes: list[str] = []
        self.cell_room = CellRoom()
        self.surfaces: list[OnBody] = []
        self.sides: list[int] = []  # which of them each side of each pair is on
        self.lumped_sides: list[int] = []  # the same of lumped contacts
        self.film_sides: list[int] = []  # the same of films
        self.inertia = InertiaPlan.of(scene, turned)
        self.local = LocalPlan.of(scene, local_modes)
        dynamic = {body.index for body in scene.bodies if self.local.count(body.index)}
        if patches is None:
            self.patches, chosen = patch_plans(scene.finite_sliding, dynamic, off_end=off_end)
            self.notes += chosen
        else:
            self.patches = dict(patches)
        self.mode_counts = [b.mode_count + self.local.count(b.index) for b in scene.bodies]

    def pairs(self) -> list[Pair]:
        """All pairs, in the order of the contacts."""
        found = []
        for i, contact in enumerate(self.scene.finite_sliding):
            (body_a, _, a), (body_b, _, b) = (self.surfaces[s] for s in self.sides[2 * i : 2 * i + 2])
            a, b = (s.real if isinstance(s, PatchSide) else s for s in (a, b))
            if not isinstance(a, ContactSurface):
                raise TypeError(f"contact {contact.name!r}: its first surface is rigid")
            found.append(Pair(contact, body_a, a, body_b, b))
        return found

    def interface(self, port: Port) -> int:
        """Number of the flexible interface of a port, -1 for one that no mode moves."""
        if port.interface_name is None or not port.body.mode_count:
            return -1
        return self.interfaces.setdefault((port.body.index, str(port.interface_name)), len(self.interfaces))

    def marker(self, port: Port, point: np.ndarray, axes: np.ndarray) -> int:
        """Enter a joint frame, `point` (3,) [m] and `axes` (3, 3) in the user frame; returns its number."""
        body = port.body
        offset = body.center_of_mass if body.index >= 0 else np.zeros(3)
        self.markers.append((body.index, self.interface(port), np.asarray(point) - offset, axes))
        return len(self.markers) - 1

    def characteristic(self, curve: Characteristic | None) -> int:
        """Enter a characteristic; returns its number, -1 of None."""
        if curve is None:
            return -1
        self.characteristics.append(curve.pieces)
        return len(self.characteristics) - 1

    def signal(self, signal: Signal) -> int:
        """Enter a signal; returns its number."""
        if isinstance(signal, FromInput):
            self.following.append((len(self.signals), signal))
            self.signals.append(device_pieces(signal))
        else:
            self.signals.append(signal.polynomial())
        return len(self.signals) - 1
