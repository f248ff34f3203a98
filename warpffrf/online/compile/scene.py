"""Scene -> constant device data (`warpffrf_kernels.core.model.Model`).

Body frames are moved to the centre of mass here and nowhere else; `CompiledScene` keeps what is needed to move results
back.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import warp as wp
from warpffrf_kernels.core.model import Model

from warpffrf.model.errors import InputError
from warpffrf.model.slopes import leanings, leant
from warpffrf.online.arrays.constants import Constants
from warpffrf.online.compile.forces import ForceTable, compile_forces, fill_forces
from warpffrf.online.compile.friction import fill_friction
from warpffrf.online.compile.inertia import InertiaPlan, fill_inertia, fill_stiffening, mode_reach
from warpffrf.online.compile.joints import JointTable, compile_joints
from warpffrf.online.compile.layers import LAYER_ITERATIONS, fill_layers
from warpffrf.online.compile.pairs import fill_pairs
from warpffrf.online.compile.shared import fill_shared
from warpffrf.online.compile.surfaces import fill_surfaces
from warpffrf.online.local_dynamics import FOLLOWS, LocalDynamics, LocalPlan
from warpffrf.online.settings import Settings


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

    def add(
        self, kind, a, b, i=0, j=0, signal=-1, stiffness=0.0, damping=0.0, reference=0.0, preload=0.0, rigid=1
    ) -> int:
        values = (int(kind), a, b, i, j, signal, stiffness, damping, reference, preload, rigid)
        for name, value in zip(self.__dataclass_fields__, values, strict=True):
            getattr(self, name).append(value)
        return len(self.kind) - 1

    def __len__(self) -> int:
        return len(self.kind)


@dataclass
class CompiledScene:
    """Device constants of a scene and the host-side map from rows and surfaces back to names."""

    scene: Any
    model: Model
    models: wp.array  # the same as a device array of one entry: kernels read it by address, launches stay small
    device: str
    joints: JointTable  # rows of each joint, drives included, and those left out
    forces: ForceTable  # rows of each spring
    row_count: int
    modal_start: np.ndarray
    interface_modes: np.ndarray  # (interfaces, 6, modes)
    stiffened: bool  # loads at interfaces stiffen a body
    local: LocalPlan
    inertia: InertiaPlan
    cell_margin: int  # cells with friction that may be loaded beside those of the slots
    notes: list[str]

    def enlarge(self, slots: int) -> None:
        """Room for `slots` hats in play, and cells where there is friction; scratch arrays are to be made anew."""
        m = self.model
        m.capacity.slots = slots
        m.capacity.cells = slots + self.cell_margin if m.capacity.cells else 0
        self.models = wp.array([m], dtype=Model, device=self.device)


class _Compiler:
    def __init__(self, scene: Any, settings: Settings, device: str, local: LocalDynamics) -> None:
        self.scene, self.settings, self.device = scene, settings, device
        self.constants = Constants(device)
        self.fill = self.constants.fill
        self.rows = Rows()
        self.markers: list[tuple[int, int, np.ndarray, np.ndarray]] = []
        self.signals: list[tuple[np.ndarray, np.ndarray]] = []
        self.interfaces: dict[tuple[int, str], int] = {}
        self.notes: list[str] = []
        self.cell_margin = 0
        self.joint_table = JointTable()
        self.force_table = ForceTable()
        self.surfaces: list[tuple[Any, Any]] = []  # (body, ContactSurface), two for each pair
        self.places: list[tuple[int, str]] = []  # (index of the body, name) of these: equal where pairs share one
        self.inertia = InertiaPlan.of(scene)
        self.local = LocalPlan.of(scene, local)
        self.mode_counts = [b.mode_count + self.local.count(b.index) for b in scene.bodies]

    # --- pieces

    def interface(self, port: Any) -> int:
        if port.interface_name is None or not port.body.mode_count:
            return -1
        return self.interfaces.setdefault((port.body.index, str(port.interface_name)), len(self.interfaces))

    def marker(self, port: Any, point: Any, axes: np.ndarray) -> int:
        body = port.body
        offset = body.center_of_mass if body.index >= 0 else np.zeros(3)
        self.markers.append((body.index, self.interface(port), np.asarray(point) - offset, axes))
        return len(self.markers) - 1

    def signal(self, signal: Any) -> int:
        self.signals.append(signal.polynomial())
        return len(self.signals) - 1

    # --- the whole

    def compile(self) -> CompiledScene:
        scene, settings = self.scene, self.settings
        m = Model()
        self.joint_table = compile_joints(self)
        self.notes.extend(self.joint_table.notes)
        self.force_table = compile_forces(self)
        bodies = scene.bodies
        lean = leanings(scene.contacts)
        for contact in scene.contacts:
            for port in contact.ports:
                place = (port.body.index, port.name)
                surface = self.local.surface(port)
                if surface is port.surface:  # dynamic modes keep the compliance that they were made of
                    surface = leant(surface, lean.get(place, 0.0))
                self.surfaces.append((port.body, surface))
                self.places.append(place)
        modal_start = np.cumsum([0, *self.mode_counts])
        self.fill(
            m.bodies, count=len(bodies), mass=[b.mass for b in bodies], inertia=[b.inertia for b in bodies],
            modal_start=modal_start, global_count=[b.mode_count for b in bodies],
        )  # fmt: skip
        m.modes.count, m.rows.count = int(modal_start[-1]), len(self.rows)
        fill_inertia(self, m)
        m.outer.row_offset = 6 * m.bodies.count + m.dense.count
        m.outer.count = m.outer.row_offset + m.rows.count
        m.pairs.count = len(scene.contacts)
        self.fill(m, gravity=wp.vec3d(*scene.gravity), length=self._length())
        self._modes(m)
        modes = self._interfaces(m)
        stiffened = fill_stiffening(self, m)
        fill_forces(self, self.force_table, m)
        self._markers_rows_signals(m)
        fill_pairs(self, m)
        fill_surfaces(self, m)
        fill_shared(self, m)
        fill_friction(self, m)
        fill_layers(self, m)
        self.fill(
            m.limits, residual_tolerance=settings.residual_tolerance, energy_tolerance=settings.energy_tolerance,
            max_iterations=settings.max_iterations * (LAYER_ITERATIONS if m.layers.count else 1),
            max_inner=settings.max_inner, max_guarded=settings.max_guarded, max_level=settings.max_level,
            most_made=settings.most_made,
        )  # fmt: skip
        return CompiledScene(
            scene, m, wp.array([m], dtype=Model, device=self.device), self.device, self.joint_table, self.force_table,
            len(self.rows), modal_start, modes, stiffened, self.local, self.inertia, self.cell_margin,
            self.notes,
        )  # fmt: skip

    def _length(self) -> float:
        """The length of the scene [m]: the farthest place of a body, its radius of gyration, and the longest arm of a
        joint or spring."""
        sizes = [float(np.sqrt(np.trace(b.inertia) / (3.0 * b.mass))) for b in self.scene.bodies if b.mass > 0.0]
        places = [b.to_world(b.center_of_mass) for b in self.scene.bodies] + [marker[2] for marker in self.markers]
        return max([*sizes, *(float(np.linalg.norm(place)) for place in places)]) or 1.0

    def _modes(self, m: Model) -> None:
        """Stiffness and damping of all modes: of each body the global ones, then its dynamic local ones."""
        local, empty = self.local, [np.zeros(0)]
        omega, ratios, kinds, reach = list(empty), list(empty), list(empty), list(empty)
        for body in self.scene.bodies:
            n = local.count(body.index)
            if body.reduced is not None:
                omega.append(2.0 * np.pi * body.reduced.frequencies)
                reach.append(mode_reach(body.reduced))
            omega.append(local.omega(body.index))
            ratios += [body.damping, np.full(n, local.options.ratio)]
            kinds += [np.full(body.mode_count, FOLLOWS), np.full(n, local.options.kind)]
            reach.append(np.zeros(n))  # the accuracy asked for is that of the motion, not of the stiff modes
        w = np.concatenate(omega)
        own = np.concatenate(kinds) != FOLLOWS
        self.fill(
            m.modes, stiffness=w**2, damping=2.0 * np.concatenate(ratios) * w, kind=np.concatenate(kinds),
            reach=np.concatenate(reach), dynamic_count=int(np.count_nonzero(own)),
            top_frequency=float(np.max(w, initial=0.0)), outer_frequency=float(np.max(w[~own], initial=0.0)),
        )  # fmt: skip
        self.notes.extend(local.notes)

    def _interfaces(self, m: Model) -> np.ndarray:
        bodies = self.scene.bodies
        count = max(len(self.interfaces), 1)
        points = np.zeros((count, 3))
        modes = np.zeros((count, 6, max((b.mode_count for b in bodies), default=0) or 1))
        for (body, name), i in self.interfaces.items():
            interface = bodies[body].reduced.interfaces[name]
            points[i] = interface.point - bodies[body].center_of_mass
            modes[i, :, : bodies[body].mode_count] = interface.modes.T
        self.fill(
            m.interfaces, point=points, width=modes.shape[2], modes=modes.ravel(), reach=np.abs(modes).max(axis=2)
        )
        return modes

    def _markers_rows_signals(self, m: Model) -> None:
        body, interface, point, axes = zip(*self.markers, strict=True) if self.markers else ([], [], [], [])
        self.fill(m.markers, body=body, interface=interface, point=point, axes=axes)
        self.fill(m.rows, **vars(self.rows))
        self.fill(
            m.signals, start=np.cumsum([0] + [len(c) for _, c in self.signals]),
            breaks=np.concatenate([np.zeros(0)] + [b[: len(c)] for b, c in self.signals]),
            coefficient=np.concatenate([np.zeros((0, 8))] + [c for _, c in self.signals]),
        )  # fmt: skip


def compile_scene(scene: Any, settings: Settings, device: str, local: LocalDynamics | None = None) -> CompiledScene:
    """Constant device data of `scene`; raises `InputError` for a scene that cannot be run."""
    if not scene.bodies:
        raise InputError("scene: there are no bodies; add one with scene.add_body or scene.add_rigid_body")
    return _Compiler(scene, settings, device, local or LocalDynamics()).compile()
