"""Scene -> constant device data (`warpffrf_kernels.core.model.Model`).

Body frames are moved to the centre of mass here and nowhere else; `CompiledScene` keeps what is needed to move results
back.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import warp as wp

from warpffrf.model.checks.contacts import refuse_claims_of
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.local_modes import leanings, leant
from warpffrf.model.scene import Scene
from warpffrf.online.compile.capacity import CellRoom
from warpffrf.online.compile.collector import Collector, OnBody
from warpffrf.online.compile.constants import Shared
from warpffrf.online.compile.films.tables import fill_films
from warpffrf.online.compile.forces import ForceTable, compile_forces, fill_forces
from warpffrf.online.compile.friction import fill_friction
from warpffrf.online.compile.inertia import fill_inertia, fill_stiffening, mode_reach
from warpffrf.online.compile.inertia_plan import InertiaPlan
from warpffrf.online.compile.inputs import DeviceInputs
from warpffrf.online.compile.joint_friction import SlipTable, compile_joint_friction, fill_joint_friction
from warpffrf.online.compile.joints import JointTable, compile_joints
from warpffrf.online.compile.layers import LAYER_ITERATIONS, fill_layers
from warpffrf.online.compile.lumped import fill_lumped
from warpffrf.online.compile.matched import fill_matched
from warpffrf.online.compile.pairs import fill_pairs
from warpffrf.online.compile.parameters import Parameters
from warpffrf.online.compile.patches.plan import PatchPlan
from warpffrf.online.compile.patches.sides import PatchSide
from warpffrf.online.compile.patches.tables import fill_patches
from warpffrf.online.compile.pretension import TensionTable, compile_pretensions, fill_pretensions
from warpffrf.online.compile.responses import fill_responses
from warpffrf.online.compile.rolling import fill_rolling
from warpffrf.online.compile.surfaces import fill_surfaces
from warpffrf.online.local_modes import FOLLOWS, LocalModes, LocalPlan
from warpffrf.online.settings import Settings
from warpffrf_kernels.core.model import Elements, External, Films, Matched, Model


@dataclass
class CompiledScene:
    """Device constants of a scene and the host-side map from rows and surfaces back to names."""

    scene: Scene
    model: Model
    elements: Elements  # what `model.elements` has on the device
    external: External  # what `model.external` has
    films: Films  # what `model.elements[0].films` has
    matched: Matched  # what `model.elements[0].matched` has
    device: str
    joints: JointTable  # rows of each joint, drives included, and those left out
    forces: ForceTable  # rows of each spring
    slips: SlipTable  # friction in joints
    tensions: TensionTable  # pretensions
    row_count: int
    modal_start: np.ndarray
    interface_modes: np.ndarray  # (interfaces, 6, modes)
    stiffened: bool  # loads at interfaces stiffen a body
    local: LocalPlan
    inertia: InertiaPlan
    cell_room: CellRoom
    patches: dict[int, PatchPlan]  # by number of the contact
    notes: list[str]
    inputs: DeviceInputs

    @cached_property
    def parameters(self) -> Parameters:
        """The constants that may change between steps."""
        return Parameters(self)


def enlarge(worlds: Sequence[CompiledScene], slots: int) -> None:
    """Set the capacity to `slots` active nodes per world, and cells if there is friction; scratch arrays and the models
    on the device must be reallocated."""
    cells = max(compiled.cell_room.cells(slots) for compiled in worlds)
    for compiled in worlds:
        compiled.model.capacity.slots, compiled.model.capacity.cells = slots, cells


def models_of(worlds: Sequence[CompiledScene]) -> wp.array:
    """The models of all worlds as a device array: kernels read that of their world by address, launches stay small."""
    return wp.array([compiled.model for compiled in worlds], dtype=Model, device=worlds[0].device)


def _compiled(collector: Collector) -> CompiledScene:
    scene, settings = collector.scene, collector.settings
    m = Model()
    joints = compile_joints(collector)
    collector.notes.extend(joints.notes)
    slips = compile_joint_friction(collector, joints)
    tensions = compile_pretensions(collector, joints)
    springs = compile_forces(collector, joints)
    bodies = scene.bodies
    _gather_surfaces(collector)
    modal_start = np.cumsum([0, *collector.mode_counts])
    collector.fill(
        m.bodies, count=len(bodies), mass=[b.mass for b in bodies], inertia=[b.inertia for b in bodies],
        modal_start=modal_start, global_count=[b.mode_count for b in bodies],
    )  # fmt: skip
    m.modes.count, m.rows.count = int(modal_start[-1]), len(collector.rows)
    fill_inertia(collector, m)
    m.retained.row_offset = 6 * m.bodies.count + m.dense.count
    m.retained.count = m.retained.row_offset + m.rows.count
    m.pairs.count = len(scene.finite_sliding)
    collector.fill(m, gravity=wp.vec3d(*scene.gravity), length=_length(collector))
    _modes(collector, m)
    modes = _interfaces(collector, m)
    stiffened = fill_stiffening(collector, m)
    fill_forces(collector, springs, m)
    fill_joint_friction(collector, slips)
    fill_pretensions(collector, tensions)
    _markers_rows_signals(collector, m)
    fill_pairs(collector, m)
    z_start = fill_surfaces(collector, m)
    fill_friction(collector, m, z_start)
    fill_responses(collector, m)
    fill_layers(collector)
    fill_lumped(collector)
    fill_films(collector)
    fill_matched(collector)
    fill_patches(collector, m)
    fill_rolling(collector, m)
    slow = (
        collector.elements.layers.count
        or collector.elements.lumped.count
        or collector.films.count
        or collector.matched.count
    )
    cut = any(film.cavitation == "half_sommerfeld" for film in collector.scene.films)
    collector.fill(
        m.limits, residual_tolerance=settings.residual_tolerance, energy_tolerance=settings.energy_tolerance,
        max_iterations=settings.max_iterations * (LAYER_ITERATIONS if slow else 1),
        max_inner=settings.max_inner, max_guarded=settings.max_guarded, max_level=settings.max_level,
        gain_limit=0.0 if cut else settings.gain_limit,
    )  # fmt: skip
    collector.elements.films = wp.array([collector.films], dtype=Films, device=collector.device)
    collector.elements.matched = wp.array([collector.matched], dtype=Matched, device=collector.device)
    m.elements = wp.array([collector.elements], dtype=Elements, device=collector.device)
    m.external = wp.array([collector.external], dtype=External, device=collector.device)
    return CompiledScene(
        scene, m, collector.elements, collector.external, collector.films, collector.matched, collector.device, joints,
        springs, slips, tensions, len(collector.rows), modal_start, modes, stiffened, collector.local,
        collector.inertia, collector.cell_room, collector.patches, collector.notes,
        DeviceInputs(m.signals, collector.following),
    )  # fmt: skip


def _gather_surfaces(collector: Collector) -> None:
    """The surfaces of contacts, lumped contacts and films, each once, and the surface index of each of their sides."""
    scene = collector.scene
    lean = leanings(scene.finite_sliding)
    known: dict[tuple[int, str], int] = {}
    patched = {}  # sides of patches of cells
    for i, plan in collector.patches.items():
        patched |= {2 * i: len(plan.z), 2 * i + 1: 0}
    on: list[tuple[list[Any], list[int]]] = [
        (scene.finite_sliding, collector.sides), (scene.lumped_contacts, collector.lumped_sides),
        (scene.films, collector.film_sides),
    ]  # fmt: skip
    for items, sides in on:
        for number, port in enumerate(port for item in items for port in item.ports):
            place = (port.body.index, port.name)
            if place not in known:
                known[place] = len(collector.surfaces)
                surface = collector.local.surface(port)
                if surface is port.surface:  # dynamic modes keep the compliance from which they were computed
                    surface = leant(surface, lean.get(place, 0.0))
                collector.surfaces.append(OnBody(port.body, port.name, surface))
            if sides is collector.sides and number in patched:
                real: Any = collector.surfaces[known[place]].surface
                collector.surfaces.append(OnBody(port.body, port.name, PatchSide(real, known[place], patched[number])))
                sides.append(len(collector.surfaces) - 1)
            else:
                sides.append(known[place])


def _length(collector: Collector) -> float:
    """The length of the scene [m]: the farthest point of a body, its radius of gyration, and the longest arm of a
    joint or spring."""
    sizes = [float(np.sqrt(np.trace(b.inertia) / (3.0 * b.mass))) for b in collector.scene.bodies if b.mass > 0.0]
    places = [b.to_world(b.center_of_mass) for b in collector.scene.bodies] + [
        marker[2] for marker in collector.markers
    ]
    return max([*sizes, *(float(np.linalg.norm(place)) for place in places)]) or 1.0


def _modes(collector: Collector, m: Model) -> None:
    """Stiffness and damping of all modes: of each body the global ones, then its dynamic local ones."""
    local, empty = collector.local, [np.zeros(0)]
    omega, ratios, kinds, reach = list(empty), list(empty), list(empty), list(empty)
    for body in collector.scene.bodies:
        n = local.count(body.index)
        if body.reduced is not None:
            omega.append(2.0 * np.pi * body.reduced.frequencies)
            reach.append(mode_reach(body.reduced))
        omega.append(local.omega(body.index))
        ratios += [body.damping, np.full(n, local.options.ratio)]
        kinds += [np.full(body.mode_count, FOLLOWS), np.full(n, local.options.kind)]
        reach.append(np.zeros(n))  # the required accuracy is that of the motion, not of the stiff modes
    w = np.concatenate(omega)
    own = np.concatenate(kinds) != FOLLOWS
    collector.fill(
        m.modes, stiffness=w**2, damping=2.0 * np.concatenate(ratios) * w, kind=np.concatenate(kinds),
        reach=np.concatenate(reach), dynamic_count=int(np.count_nonzero(own)),
        top_frequency=float(np.max(w, initial=0.0)), retained_frequency=float(np.max(w[~own], initial=0.0)),
    )  # fmt: skip
    collector.notes.extend(local.notes)


def _interfaces(collector: Collector, m: Model) -> np.ndarray:
    bodies = collector.scene.bodies
    count = max(len(collector.interfaces), 1)
    points = np.zeros((count, 3))
    modes = np.zeros((count, 6, max((b.mode_count for b in bodies), default=0) or 1))
    for (body, name), i in collector.interfaces.items():
        interface = bodies[body].flexible.interfaces[name]
        points[i] = interface.point - bodies[body].center_of_mass
        modes[i, :, : bodies[body].mode_count] = interface.modes.T
    collector.fill(
        m.interfaces, point=points, width=modes.shape[2], modes=modes.ravel(), reach=np.abs(modes).max(axis=2)
    )
    return modes


def _markers_rows_signals(collector: Collector, m: Model) -> None:
    body, interface, point, axes = zip(*collector.markers, strict=True) if collector.markers else ([], [], [], [])
    collector.fill(m.markers, body=body, interface=interface, point=point, axes=axes)
    collector.fill(m.rows, **vars(collector.rows))
    shared = collector.constants.shared
    if collector.following:
        collector.constants.shared = None  # pieces that follow an input change
    collector.fill(
        m.signals, start=np.cumsum([0] + [len(c) for _, c in collector.signals]),
        breaks=np.concatenate([np.zeros(0)] + [b[: len(c)] for b, c in collector.signals]),
        coefficient=np.concatenate([np.zeros((0, 8))] + [c for _, c in collector.signals]),
    )  # fmt: skip
    collector.constants.shared = shared


def compile_scene(
    scene: Scene,
    settings: Settings,
    device: str,
    local_modes: LocalModes | None = None,
    patches: Mapping[int, PatchPlan] | None = None,
    shared: Shared | None = None,
    turned: Sequence[float] | np.ndarray = (),
    off_end: bool = False,
) -> CompiledScene:
    """Constant device data of `scene`; `patches`: the cells of its patches instead of those that the contacts specify;
    `shared`: arrays of scenes that differ in numbers only; equal ones are stored on the device once;
    `turned`: the largest angular speed of each body [rad/s] so far; `off_end`: patches of crowns run off an end.
    Raises `InputError` for a scene that cannot be run.
    """
    if not scene.bodies:
        raise InputError("scene: there are no bodies; add one with scene.add_body or scene.add_rigid_body")
    refuse_claims_of(scene)
    return _compiled(Collector(scene, settings, device, local_modes or LocalModes(), patches, shared, turned, off_end))
