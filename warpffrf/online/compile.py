"""Scene -> constant device data (`warpffrf_kernels.model.Model`).

Body frames are moved to the centre of mass here and nowhere else; `CompiledScene` keeps what is needed to move results
back.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import warp as wp
from warpffrf_kernels import control as k
from warpffrf_kernels.contact_geometry import GUARD
from warpffrf_kernels.model import Model

from warpffrf.model.errors import InputError
from warpffrf.online.compile_forces import ForceTable, compile_forces, fill_forces
from warpffrf.online.compile_inertia import InertiaPlan, dense_columns, fill_inertia, fill_stiffening, mode_reach
from warpffrf.online.compile_joints import JointTable, compile_joints
from warpffrf.online.local_dynamics import FOLLOWS, LocalDynamics, LocalPlan
from warpffrf.online.settings import Settings

LARGEST_TABLE = 2**31 - 1  # kernels count in 32-bit integers
MIN_HALF_WINDOW = 6  # columns: margin and guard columns of a patch of a few columns
MAX_HALF_WINDOW = 60
STENCIL_SPARE = 2  # a hat's support of length x touches at most ceil(x) + 1 cells, ceil(x) + 2 columns
REACH_SPARE = 1.02  # arc length over its projection at the edge of the widest window


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
    model: Any  # warpffrf_kernels.model.Model
    models: wp.array  # the same as a device array of one entry: kernels read it by address, launches stay small
    device: str
    joints: JointTable  # rows of each joint, drives included, and those left out
    forces: ForceTable  # rows of each spring
    row_count: int
    modal_start: np.ndarray
    pair_surfaces: list[tuple[int, int]]
    interface_modes: np.ndarray  # (interfaces, modes, 6)
    stiffened: bool  # loads at interfaces stiffen a body
    local: LocalPlan
    inertia: InertiaPlan
    notes: list[str]


class _Compiler:
    def __init__(self, scene: Any, settings: Settings, device: str, local: LocalDynamics) -> None:
        self.scene, self.settings, self.device = scene, settings, device
        self.rows = Rows()
        self.markers: list[tuple[int, int, np.ndarray, np.ndarray]] = []
        self.signals: list[tuple[np.ndarray, np.ndarray]] = []
        self.interfaces: dict[tuple[int, str], int] = {}
        self.notes: list[str] = []
        self.joint_table = JointTable()
        self.force_table = ForceTable()
        self.surfaces: list[tuple[Any, Any]] = []  # (body, ContactSurface)
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

    def array(self, values: Any, dtype: Any = wp.float64, shape: tuple[int, ...] | None = None) -> wp.array:
        """Device array; an empty one gets a single unused entry, so that kernels can be given it."""
        kind = np.int32 if dtype is int or dtype is wp.int32 else np.float64
        data = np.ascontiguousarray(values, dtype=kind)
        if shape is not None:
            data = data.reshape(shape)
        if data.size > LARGEST_TABLE:
            raise InputError(
                f"scene: a table of {data.size} numbers is needed, at most {LARGEST_TABLE} can be indexed; reduce with "
                "a coarser traction_spacing"
            )
        if data.size == 0:
            data = np.zeros([max(n, 1) for n in data.shape], kind)
        return wp.array(data, dtype=wp.int32 if kind is np.int32 else dtype, device=self.device)

    # --- the whole

    def compile(self) -> CompiledScene:
        scene, settings = self.scene, self.settings
        m = Model()
        self.joint_table = compile_joints(self)
        self.notes.extend(self.joint_table.notes)
        self.force_table = compile_forces(self)
        bodies = scene.bodies
        for contact in scene.contacts:
            for port in contact.ports:
                self.surfaces.append((port.body, self.local.surface(port)))
        modal_start = np.cumsum([0, *self.mode_counts])
        m.body_count, m.modal_count, m.row_count = len(bodies), int(modal_start[-1]), len(self.rows)
        fill_inertia(self, m)
        m.row_offset = 6 * m.body_count + m.dense_count
        m.outer_count = m.row_offset + m.row_count
        m.pair_count = len(scene.contacts)
        m.gravity = wp.vec3d(*scene.gravity)
        m.mass = self.array([b.mass for b in bodies])
        m.inertia = self.array([b.inertia for b in bodies], wp.mat33d, (-1, 3, 3))
        m.modal_start = self.array(modal_start, int)
        self._modes(m)
        modes = self._interfaces(m)
        stiffened = fill_stiffening(self, m)
        fill_forces(self, self.force_table, m)
        self._markers_rows_signals(m)
        self._pairs(m)
        self._surfaces(m)
        m.residual_tolerance = settings.residual_tolerance
        m.max_iterations = settings.max_iterations
        m.max_inner = settings.max_inner
        m.max_guarded = settings.max_guarded
        m.max_level = settings.max_level
        m.energy_tolerance = settings.energy_tolerance
        pairs = [(2 * i, 2 * i + 1) for i in range(m.pair_count)]
        return CompiledScene(
            scene, m, wp.array([m], dtype=Model, device=self.device), self.device, self.joint_table, self.force_table,
            len(self.rows), modal_start, pairs, modes, stiffened, self.local, self.inertia,
            self.notes,
        )  # fmt: skip

    def _modes(self, m: Any) -> None:
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
        m.stiffness, m.damping = self.array(w**2), self.array(2.0 * np.concatenate(ratios) * w)
        m.mode_kind = self.array(np.concatenate(kinds), int)
        m.mode_reach = self.array(np.concatenate(reach))
        self.notes.extend(local.notes)

    def _interfaces(self, m: Any) -> np.ndarray:
        bodies = self.scene.bodies
        widest = max(self.mode_counts, default=0)
        points = np.zeros((max(len(self.interfaces), 1), 3))
        modes = np.zeros((max(len(self.interfaces), 1), max(widest, 1), 6))
        for (body, name), i in self.interfaces.items():
            interface = bodies[body].reduced.interfaces[name]
            points[i] = interface.point - bodies[body].center_of_mass
            modes[i, : bodies[body].mode_count] = interface.modes
        m.interface_point = self.array(points, wp.vec3d)
        m.interface_modes = self.array(modes)
        m.interface_reach = self.array(np.abs(modes).max(axis=1))
        return modes

    def _markers_rows_signals(self, m: Any) -> None:
        m.marker_body = self.array([x[0] for x in self.markers], int)
        m.marker_interface = self.array([x[1] for x in self.markers], int)
        m.marker_point = self.array([x[2] for x in self.markers], wp.vec3d, (-1, 3))
        m.marker_axes = self.array([x[3] for x in self.markers], wp.mat33d, (-1, 3, 3))
        rows = self.rows
        for name in rows.__dataclass_fields__:
            dtype = wp.float64 if name in ("stiffness", "damping", "reference", "preload") else int
            setattr(m, f"row_{name}", self.array(getattr(rows, name), dtype))
        start = np.cumsum([0] + [len(c) for _, c in self.signals])
        m.signal_start = self.array(start, int)
        m.signal_break = self.array(np.concatenate([np.zeros(0)] + [b[: len(c)] for b, c in self.signals]))
        m.signal_coefficient = self.array(
            np.concatenate([np.zeros((0, 8))] + [c for _, c in self.signals]), shape=(-1, 8)
        )

    def _surfaces(self, m: Any) -> None:
        lists: dict[str, list] = {name: [] for name in (
            "body", "origin", "frame", "radius", "crown", "theta", "pitch", "columns", "periodic",
            "turn", "rows", "block",
            "z_start", "lag_start", "mode_start",
        )}  # fmt: skip
        z, D, MDM, modes, moments = [], [], [], [], []
        for body, surface in self.surfaces:
            grid, shape = surface.grid, surface.shape
            e_a = np.asarray(shape.e_a)
            frame = np.stack([grid.e_0, np.cross(e_a, grid.e_0), e_a], axis=1)
            sectors, side = len(surface.lags), surface.lags.shape[1]
            block = side // grid.rows
            turn = sectors * block if sectors > 1 or grid.periodic else 0
            values = (
                body.index, shape.axis_point - body.center_of_mass, frame, shape.radius,
                1.0 / shape.curvature if shape.curvature else 0.0,
                grid.theta_start, grid.pitch, grid.columns, int(grid.periodic), turn, grid.rows, block,
                sum(map(len, z)), sum(map(len, D)), sum(map(len, modes)),
            )  # fmt: skip
            for name, value in zip(lists, values, strict=True):
                lists[name].append(value)
            z.append(np.asarray(grid.z))
            D.append(response_table(surface, surface.lags, self.reach).ravel())
            MDM.append(response_table(surface, weak_compliance(surface), self.reach).ravel())
            modes.append(np.ascontiguousarray(surface.mode_normal).ravel())
            moments.append(_moments(surface).ravel())
        for name, values in lists.items():
            if name == "origin":
                m.surface_origin = self.array(values, wp.vec3d, (-1, 3))
            elif name == "frame":
                m.surface_frame = self.array(values, wp.mat33d, (-1, 3, 3))
            else:
                dtype = wp.float64 if name in ("radius", "crown", "theta", "pitch") else int
                setattr(m, f"surface_{name}", self.array(values, dtype))
        empty = [np.zeros(0)]
        m.surface_z = self.array(np.concatenate(empty + z))
        m.compliance = self.array(np.concatenate(empty + D))
        m.self_compliance = self.array(np.concatenate(empty + MDM))
        m.mode_normal = self.array(np.concatenate(empty + modes))
        m.mode_moment = self.array(np.concatenate(empty + moments))

    def _pairs(self, m: Any) -> None:
        settings = self.settings
        for name, count in (("theta", settings.theta_points), ("z", settings.z_points)):
            x, weight = np.polynomial.legendre.leggauss(count)
            setattr(m, f"{name}_points", count)
            setattr(m, f"{name}_abscissa", self.array(0.5 * (x + 1.0)))
            setattr(m, f"{name}_weight", self.array(0.5 * weight))
        m.pair_first = self.array(np.arange(0, 2 * m.pair_count, 2), int)
        m.pair_second = self.array(np.arange(1, 2 * m.pair_count, 2), int)
        half = rows = second_half = second_rows = pair_modes = 1
        slots = 1
        stencil = (1, 1)
        coupled: list[list[int]] = []
        for i, contact in enumerate(self.scene.contacts):
            (body_a, a), (body_b, b) = self.surfaces[2 * i], self.surfaces[2 * i + 1]
            wanted = self._half_window(contact, a, b)
            half, rows = max(half, wanted), max(rows, a.grid.rows)
            second_rows = max(second_rows, b.grid.rows)
            ratio = a.grid.pitch * a.shape.radius / (b.grid.pitch * b.shape.radius)
            columns = int(np.ceil(2.0 * ratio * REACH_SPARE - 1e-9)) + STENCIL_SPARE
            stencil = (max(stencil[0], columns), max(stencil[1], _row_reach(a.grid.z, b.grid.z)))
            pair_modes = max(pair_modes, self.mode_counts[body_a.index] + self.mode_counts[body_b.index])
            hats = (2 * wanted + 1) * a.grid.rows
            slots += hats if contact.capacity is None else min(contact.capacity, hats)
            touching = [
                m.row_offset + r
                for r in range(len(self.rows))
                if any(self._is_flexible(x, (body_a.index, body_b.index)) for x in (self.rows.a[r], self.rows.b[r]))
            ]  # fmt: skip
            coupled.append(
                [6 * body_a.index + c for c in range(6)]
                + [6 * body_b.index + c for c in range(6)]
                + dense_columns(m, self, (body_a, body_b))
                + touching
            )
        for i in range(m.pair_count):  # all pairs share the widest window, so each needs what lies opposite that
            second_half = max(second_half, _reach_on_second(self.surfaces[2 * i][1], self.surfaces[2 * i + 1][1], half))
        m.half_window, m.window_columns, m.max_rows = half, 2 * half + 1, rows
        m.mode_capacity = m.window_columns * rows
        m.stencil_columns, m.stencil_rows = stencil
        m.second_half_window, m.second_columns = second_half, 2 * second_half + 1
        m.node_capacity = m.second_columns * second_rows
        self.reach = m.reach = m.window_columns + m.second_columns + m.stencil_columns
        m.pair_modes = pair_modes
        m.slot_capacity = slots
        m.coupled_capacity = max([len(c) for c in coupled], default=1)
        if m.coupled_capacity > k.MOST_COUPLED_COLUMNS:
            raise InputError(
                f"scene: the gap of a contact pair depends on {m.coupled_capacity} outer columns, at most "
                f"{k.MOST_COUPLED_COLUMNS}: fewer modes with inertia terms, see the inertia levels of its bodies"
            )
        if stencil[0] * stencil[1] > k.MOST_STENCIL:
            raise InputError(
                f"scene: a hat of a contact's first grid covers {stencil[0]} x {stencil[1]} nodes of the second, at "
                f"most {k.MOST_STENCIL}: swap the two surfaces, or give the second a coarser traction_spacing"
            )
        m.coupled_count = self.array([len(c) for c in coupled], int)
        m.coupled = self.array(
            [c + [0] * (m.coupled_capacity - len(c)) for c in coupled], int, (-1, m.coupled_capacity)
        )

    def _is_flexible(self, marker: int, bodies: tuple[int, int]) -> bool:
        """True where a marker rides on a flexible interface of one of the bodies."""
        return self.markers[marker][0] in bodies and self.markers[marker][1] >= 0

    def _half_window(self, contact: Any, a: Any, b: Any) -> int:
        spacing = a.grid.pitch * a.shape.radius
        effective = 1.0 / (1.0 / a.shape.radius + 1.0 / b.shape.radius)
        if contact.capacity is not None:
            return max(int(np.ceil(contact.capacity / a.grid.rows / 2.0)) + int(GUARD), 2 * int(GUARD) + 1)
        wanted = int(np.ceil(self.settings.window_strain * effective / spacing)) + int(GUARD) + 1
        if wanted > MAX_HALF_WINDOW:
            self.notes.append(
                f"contact {contact.name!r}: window capped at {2 * MAX_HALF_WINDOW + 1} columns of {2 * wanted + 1}; "
                "a coarser contact grid (traction_spacing) would do, or give capacity="
            )
        quarter = int(0.5 * np.pi / a.grid.pitch) - 2  # no surface is opposite beyond a quarter turn
        return int(min(np.clip(wanted, MIN_HALF_WINDOW, MAX_HALF_WINDOW), max(quarter, int(GUARD) + 1)))


def _reach_on_second(a: Any, b: Any, half_window: int) -> int:
    """Columns of the second grid on each side that face the window: opposite xi lies asin(R_A sin(xi)/R_B)."""
    xi = min((half_window + 1.5) * a.grid.pitch, 0.5 * np.pi)
    angle = np.arcsin(min(a.shape.radius * np.sin(xi) / b.shape.radius, 1.0))
    return int(np.ceil(angle / b.grid.pitch + 0.5)) + STENCIL_SPARE


def _row_reach(z_a: np.ndarray, z_b: np.ndarray) -> int:
    """Most rows of the second grid under a hat of the first, at any axial offset."""
    widest = max(z_a[min(i + 1, len(z_a) - 1)] - z_a[max(i - 1, 0)] for i in range(len(z_a)))
    return min(len(z_b), int(np.ceil(widest / np.min(np.diff(z_b)) - 1e-9)) + STENCIL_SPARE)


def _moments(surface: Any) -> np.ndarray:
    """M Phi (nodes, modes): weak normal displacement of the global modes on the hats of the grid."""
    grid = surface.grid
    phi = surface.mode_normal.reshape(grid.columns, grid.rows, -1)
    return np.einsum("kl,jlm->jkm", surface.gram_z, grid.along_theta(phi))


def weak_compliance(surface: Any) -> np.ndarray:
    """C = M D M, block-circulant like D: weak displacement of hat i under a unit pressure hat j [m^3/Pa].

    On a turn the two products are taken harmonic by harmonic; a dense operator is multiplied out.
    """
    grid, lags = surface.grid, surface.lags
    sectors, side = lags.shape[:2]
    c = side // grid.rows
    if sectors == 1:
        M = np.kron(grid.gram_theta(), surface.gram_z)
        return (M @ lags[0] @ M)[None]
    theta = np.zeros((sectors, c, c))
    j = np.arange(c)
    theta[0, j, j] = 2.0 / 3.0 * grid.pitch
    for shift in (1, -1):  # hat j overlaps hat j + shift, which may stand in the next sector
        other = j + shift
        theta[(-(other // c)) % sectors, j, other % c] += grid.pitch / 6.0
    M = np.einsum("nab,kl->nakbl", theta, surface.gram_z).reshape(sectors, side, side)
    M_hat, D_hat = np.fft.rfft(M, axis=0), np.fft.rfft(lags, axis=0)
    return np.fft.irfft(M_hat @ D_hat @ M_hat, n=sectors, axis=0)


def response_table(surface: Any, lags: np.ndarray, reach: int) -> np.ndarray:
    """Block-circulant `lags` as a table (column of the block, source row, target column + reach, target row).

    The response to a hat along the columns of a window is one contiguous run, whatever the block: kernels add such
    runs. Columns are counted from the source's block; a dense operator on an arc is padded with zeros, where the grid
    has no nodes.
    """
    grid = surface.grid
    sectors, side = lags.shape[:2]
    c = side // grid.rows
    column = np.arange(-reach, c + reach)
    blocks = lags.reshape(sectors, c, grid.rows, c, grid.rows)
    table = blocks[(column // c) % sectors, column % c].transpose(2, 3, 0, 1).copy()
    if sectors == 1 and not grid.periodic:
        table[:, :, (column < 0) | (column >= c)] = 0.0
    return table


def compile_scene(scene: Any, settings: Settings, device: str, local: LocalDynamics | None = None) -> CompiledScene:
    """Constant device data of `scene`; raises `InputError` for a scene that cannot be run."""
    if not scene.bodies:
        raise InputError("scene: there are no bodies; add one with scene.add_body or scene.add_rigid_body")
    return _Compiler(scene, settings, device, local or LocalDynamics()).compile()
