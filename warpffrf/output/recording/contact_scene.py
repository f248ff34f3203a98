"""One contact in a recording: the relief on the patch and the unwrapped map, by every field of the run.

Below `/world/contacts/<pair>`, a frame that follows the patch, `relief` shows the pressure as height and colour, and
with friction `relief_traction`, `relief_slip`, `relief_state`, `relief_wear` show the same height in other colours.
Below `/patch_map/<pair>` are the labelled axes, logged once, and a picture for each field; the map of the traction has
arrows.

Contact series. Curves of one contact for a recording.

Machine series. Curves of a whole machine for a recording: lumped contacts, oil films, small-sliding contacts,
reactions, applied forces, joint coordinates, sensors, energies.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.sensors import Position, Stress
from warpffrf.output.plots.colors import ColorClasses, ColorScale, field_scale, largest, map_axes_picture
from warpffrf.output.recording import frames as fr
from warpffrf.output.recording.extent import EYE, round_length
from warpffrf.output.recording.glyphs import LEAST_SHOWN, MOST_LABELS, force_text
from warpffrf.output.recording.patch_map import cell_map, map_window, pixels, pressure_map

MAP_SHAPE = (220, 480)  # pixels (height, width) of the patch map
COARSER = 2  # pixels of a map per pixel of the pictures of friction, whose values are constant on cells
ARROW_LENGTH = 0.6  # of the largest body, for the largest force of the run
ARROW_CELLS = 1.5  # length of the arrow of the largest traction, in columns of cells
ARROW_COLOR = (20, 20, 20)
BAR_COLOR = (205, 90, 205)  # in no scale of pressure or displacement
NARROW, LONG, CUT = 4.0, 24.0, 0.3  # what a close-up shows, in reaches of the map; place of the bar on a longer patch
BESIDE, BAR_RADIUS = 0.03, 0.004  # of what a close-up shows: place and radius of its scale bar
FIRST_COLOR, SECOND_COLOR = (60, 130, 230), (220, 115, 30)  # readable on black and on white
FRICTION_FIELDS = ("traction", "state", "slip", "wear")
TITLES = {
    "pressure": "Pressure",
    "traction": "Traction",
    "state": "Stick and slip",
    "slip": "Slip speed",
    "wear": "Wear index",
}


def relief_name(field: str) -> str:
    """Entity of the relief coloured by `field`."""
    return "relief" if field == "pressure" else f"relief_{field}"


class ContactColors:
    """Colours of the contact fields, one range for all contacts of a run; `fields` are those that at least one contact
    has."""

    def __init__(self, contacts: list[Any], films: list[Any], small_sliding: list[Any], rows: np.ndarray) -> None:
        """films, small_sliding: their pressures, and the tractions of small-sliding contacts, have the colours of those
        of contacts."""
        rubbing = [c.friction for c in contacts if c.has_friction]
        pressing = "contact" if contacts else "film" if films else "small-sliding contact"
        self.fields = (["pressure"] if contacts else []) + (list(FRICTION_FIELDS) if rubbing else [])

        def top(arrays: list[np.ndarray]) -> float:
            return largest([a[rows] for a in arrays])

        tops = {
            "pressure": top([c.peak_pressure for c in contacts] + [o.pressure for o in (*films, *small_sliding)]),
            "traction": top([o.traction_magnitude for o in (*rubbing, *small_sliding)]),
            "slip": top([f.slip_speed for f in rubbing]),
            "wear": top([f.wear_index for f in rubbing]),
            "state": 0.0,
        }
        self._scales = {field: field_scale(field, most, pressing) for field, most in tops.items()}
        self.top_pressure = top([c.peak_pressure for c in contacts])
        self.top_traction = top([f.traction_magnitude for f in rubbing])

    def scale(self, field: str) -> ColorScale | ColorClasses:
        """The colours of one field."""
        return self._scales[field]


def field_window(contact: Any, field: str, i: int) -> np.ndarray:
    """(columns, rows) of one field of the contact at saved step `i`, SI units."""
    if field == "pressure":
        return contact.mean_pressure[i]
    friction = contact.friction
    return {
        "traction": friction.traction_magnitude,
        "slip": friction.slip_speed,
        "wear": friction.wear_index,
        "state": friction.state,
    }[field][i]


class ContactScene:
    """Logs one contact into a recording."""

    def __init__(self, recorder: Any, contact: Any) -> None:
        self.recorder, self.contact = recorder, contact
        self.fields = ("pressure", *(FRICTION_FIELDS if contact.has_friction else ()))
        self.window = map_window(contact, recorder.rows[recorder.good])
        self.height = fr.RELIEF_HEIGHT * 2.0 * self.window.reach
        wide, reach = self.window.high - self.window.low, self.window.reach
        self.across = min(max(wide, NARROW * reach), LONG * reach)  # m, of a close-up
        self.bar = round_length(reach)  # m, along the arc
        along = np.asarray(recorder.bodies[contact.view.first_body.name].points) @ contact.view.first.shape.e_a
        self.length = float(np.ptp(along))  # m, of the first body along the axis of its surface

    def world(self, *parts: str) -> str:
        """Entity below the patch's frame."""
        return self.recorder.path("world", "contacts", self.contact.name, *parts)

    def map(self, *parts: str) -> str:
        """Entity below the patch's map."""
        return self.recorder.path("patch_map", self.contact.name, *parts)

    def static(self) -> None:
        """Log the topology of the reliefs, and the map's axes as a static picture that frames the fields' pictures."""
        rr, log = self.recorder.rr, self.recorder.log_static
        shape = fr.relief_values(self.contact, self.contact.history.pressure[0]).shape
        triangles = fr.grid_triangles(*shape).astype(np.uint32)
        for field in self.fields:
            log(self.world(relief_name(field)), rr.Mesh3D.from_fields(triangle_indices=triangles))
        window = self.window
        reach, low, high = 1e3 * window.reach, 1e3 * window.low, 1e3 * window.high
        names = "along the arc from the line of centres [mm]", "along the axis [mm]"
        picture, self.corner = map_axes_picture((-reach, reach), (low, high), names, MAP_SHAPE)
        left, top = self.corner
        log(self.map("axes"), rr.Image(picture, draw_order=0.0, opacity=fr.BLENDED))
        for field in self.fields:
            scale = 1.0 if field == "pressure" else float(COARSER)
            log(self.map(field), rr.Transform3D(translation=[left, top, 0.0], scale=scale))
        log(self.world(EYE), rr.Transform3D(scale=self.across))
        middle = 0.5 * (float(self.contact.view.first.grid.z[0]) + float(self.contact.view.first.grid.z[-1]))
        end, half = window.low - middle - BESIDE * self.across, 0.5 * self.bar
        at = (end, 0.0) if window.high - window.low <= self.across else (-CUT * self.across, self.height)
        log(self.world("scale"), rr.LineStrips3D(
            [[(x, *at) for x in (-half, half)]], colors=[BAR_COLOR], radii=BAR_RADIUS * self.across
        ))  # fmt: skip

    def frame(self, i: int) -> None:
        """Log relief, maps and arrows of saved row i."""
        recorder, contact = self.recorder, self.contact
        rr, log, colors = recorder.rr, recorder.stream.log, recorder.contact_colors
        frame = fr.patch_frame(recorder.result, contact, i)
        log(self.world(), rr.Transform3D(translation=frame.origin, mat3x3=frame.axes))
        vertices = fr.relief(contact, i, colors.top_pressure, self.height).astype(np.float32)
        for field in self.fields:
            values, scale = field_window(contact, field, i), colors.scale(field)
            colored = scale.packed(fr.relief_values(contact, values).reshape(-1))
            mesh = rr.Mesh3D.from_fields(vertex_positions=vertices.copy(), vertex_colors=colored)
            log(self.world(relief_name(field)), mesh)
            if field == "pressure":
                picture = pressure_map(contact, i, values, self.window, MAP_SHAPE)
            else:
                coarse = MAP_SHAPE[0] // COARSER, MAP_SHAPE[1] // COARSER
                picture = cell_map(contact, i, values, self.window, coarse)
            log(self.map(field), rr.Image(scale.rgb(picture), draw_order=1.0))
        if contact.has_friction:
            log(self.map("traction_arrows"), self._tractions(i))
        self._forces(frame, i)

    def _tractions(self, i: int) -> Any:
        """Arrows of the tractions on the first body in pixels of the map; the largest is one cell long."""
        rr, contact = self.recorder.rr, self.contact
        picture, (left, top) = pixels(contact, i, self.window, MAP_SHAPE), self.corner
        tau, most = contact.friction.traction[i], self.recorder.contact_colors.top_traction
        inside = np.all((picture >= 0.0) & (picture <= np.array(MAP_SHAPE)[::-1]), axis=-1)
        shown = inside & np.any(tau != 0.0, axis=0)
        width = float(np.abs(np.diff(contact.cell_lines(i)[0])).max())
        cell = width / self.window.reach * 0.5 * MAP_SHAPE[1]
        scale = ARROW_CELLS * cell / most if most > 0.0 else 0.0
        # the picture's y axis points downwards
        vectors = scale * np.stack([tau[0][shown], -tau[1][shown]], axis=-1)
        origins = picture[shown] + np.array([left, top])
        return rr.Arrows2D(
            vectors=vectors, origins=origins - 0.5 * vectors, colors=[ARROW_COLOR], radii=1.0, draw_order=2.0
        )

    def _forces(self, frame: fr.PatchFrame, i: int) -> None:
        """Both forces, drawn outside the first body's end so that no body hides them; none without load, and no number
        if there are too many contacts."""
        recorder, contact = self.recorder, self.contact
        origin = frame.origin - frame.axes[:, 1] * 0.75 * self.length
        scale = ARROW_LENGTH * recorder.size / recorder.top_force if recorder.top_force > 0.0 else 0.0
        vectors = np.stack([contact.force[i], contact.force_second[i]]) * scale
        newton = [float(np.linalg.norm(contact.force[i])), float(np.linalg.norm(contact.force_second[i]))]
        path = recorder.path("world", "forces", contact.name)
        if max(newton) <= LEAST_SHOWN * recorder.top_force:
            recorder.stream.log(path, recorder.rr.Arrows3D(vectors=np.zeros((0, 3))))
            return
        labelled = len(recorder.contacts) <= MOST_LABELS
        arrows = recorder.rr.Arrows3D(
            origins=np.stack([origin, origin]),
            vectors=vectors,
            colors=[FIRST_COLOR, SECOND_COLOR],
            radii=0.012 * recorder.size,
            labels=[force_text(max(newton))] if labelled else None,  # in the middle of both
            show_labels=labelled,
        )
        recorder.stream.log(path, arrows)


CONTACT_PLOTS = {
    "force": "Contact forces [N]",
    "peak_pressure": "Largest pressure [MPa]",
    "half_width": "Half-widths of the patch [µm]",
}
FRICTION_PLOTS = {
    "traction_coefficient": "Tangential over normal load [-]",
    "creepage": "Longitudinal and lateral creepage [-]",
    "spin_creepage": "Spin creepage [rad/m]",
    "creep_force": "Creep forces Fx, Fy on the first body [N]",
    "spin_moment": "Spin moment Mz on the first body [N m]",
    "t_gamma": "T-gamma, energy per metre rolled [N]",
    "friction_power": "Friction power [W]",
    "contact_area": "Contact, stick and slip area [mm²]",
    "wear": "Largest wear index, pressure times slip [W/mm²]",
    "cells_per_step": "Columns that the patch advances per step [-]",
}


def contact_series(contact: Any) -> list[Series]:
    """Entities `plots/<kind>/<pair>` and `solver/active_nodes/<pair>`; NaN where a quantity is undefined."""
    name = contact.name
    found: list[Series] = [
        (("plots", "force", name), f"{name} [N]", contact.force_magnitude),
        (("plots", "peak_pressure", name), f"{name} [MPa]", contact.peak_pressure * 1e-6),
        (("plots", "half_width", name), f"{name} along the arc [µm]", contact.half_width * 1e6),
        (("solver", "active_nodes", name), f"{name} active {contact.loaded}", contact.active_nodes),
    ]
    if contact.patch_kind == "point":
        along = contact.half_widths[:, 1] * 1e6
        found.append((("plots", "half_width", name, "axial"), f"{name} along the axis [µm]", along))
    return found + (_friction_series(name, contact) if contact.has_friction else [])


def _friction_series(name: str, contact: Any) -> list[Series]:
    friction = contact.friction
    curves = (
        ("traction_coefficient", "", f"{name}", friction.traction_coefficient),
        ("creepage", "around", f"{name} longitudinal, along e_theta", friction.creepage[:, 0]),
        ("creepage", "axial", f"{name} lateral, along the axis", friction.creepage[:, 1]),
        ("spin_creepage", "", f"{name} [rad/m]", friction.spin_creepage),
        ("creep_force", "around", f"{name} Fx, along e_theta [N]", friction.tangential_force[:, 0]),
        ("creep_force", "axial", f"{name} Fy, along the axis [N]", friction.tangential_force[:, 1]),
        ("spin_moment", "", f"{name} [N m]", friction.spin_moment),
        ("t_gamma", "", f"{name} [N]", friction.t_gamma),
        ("friction_power", "", f"{name} [W]", friction.power),
        ("contact_area", "patch", f"{name} touches [mm²]", contact.patch_area * 1e6),
        ("contact_area", "stick", f"{name} sticks [mm²]", friction.stick_area * 1e6),
        ("contact_area", "slip", f"{name} slips [mm²]", friction.slip_area * 1e6),
        ("wear", "", f"{name} [W/mm²]", friction.wear_peak * 1e-6),
        ("cells_per_step", "", f"{name}", friction.cells_per_step),
    )
    return [
        (("plots", kind, name, *([part] if part else [])), label, np.asarray(values, dtype=float))
        for kind, part, label, values in curves
    ]


Series = tuple[tuple[str, ...], str, np.ndarray]  # entity path below the root, label with the unit, values (T,)
STORES = ("kinetic", "strain", "potential", "contact")  # ledger lines that are stored energies
FLOWS = ("force_work", "drive_work", "damping", "friction")
MOST_SENSORS = 6  # curves per plot; further sensors are only in the results
EQUIVALENT = Stress.components[-1]  # the only component of a stress that is drawn
FROM_START = ", change from the start"
MACHINE_PLOTS = {
    "lumped_force": "Forces of lumped contacts [N]",
    "film_gap": "Smallest films [µm]",
    "film_pressure": "Largest pressures of films [MPa]",
    "film_force": "Forces of oil films [N]",
    "small_sliding_force": "Normal forces of small-sliding contacts [N]",
    "small_sliding_slip": "Slipping areas of small-sliding contacts [mm²]",
    "small_sliding_loss": "Losses of small-sliding contacts by friction [J]",
    "joint_force": "Reactions of the joints [N]",
    "applied_force": "Applied and spring forces [N]",
    "joint_friction": "Friction in joints, and its bounds [N]",
    "coordinate": "Coordinates of the joints [m or rad]",
    "energy": "Energies [J]",
}


def machine_series(result: Any) -> list[Series]:
    """Curves of lumped contacts, films, small-sliding contacts, joints, forces, sensors and energies; entities
    `plots/<kind>/<name>`."""
    history = result.history
    found: list[Series] = []
    for kind, owners in (
        ("lumped_force", history.lumped_contacts),
        ("film_force", history.films),
        ("joint_force", history.joints),
        ("applied_force", history.forces),
    ):
        for name, owner in owners.items():
            size = np.linalg.norm(owner.force, axis=1)
            if np.any(size > 0.0):
                found.append((("plots", kind, name), f"{name} [N]", size))
    for name, film in history.films.items():
        found.append((("plots", "film_gap", name), f"{name} [µm]", film.smallest_gap * 1e6))
        found.append((("plots", "film_pressure", name), f"{name} [MPa]", film.largest_pressure * 1e-6))
    for name in result.small_sliding_names:
        contact = result.contact(name)
        found.append((("plots", "small_sliding_force", name), f"{name} [N]", contact.normal_force))
        if contact.friction > 0.0:
            found.append((("plots", "small_sliding_slip", name), f"{name} [mm²]", contact.slip_area * 1e6))
            found.append((("plots", "small_sliding_loss", name), f"{name} [J]", contact.loss))
    for name, force in history.forces.items():
        if force.friction is not None:
            size = np.linalg.norm(force.friction.traction, axis=1)
            found.append((("plots", "joint_friction", name), f"{name} [N]", size))
            found.append((("plots", "joint_friction", f"{name} bound"), f"{name} bound [N]", force.friction.bound))
    for name, joint in history.joints.items():
        for coordinate in joint.names:
            unit = "m" if coordinate in ("translation", "distance") else "rad"
            label = f"{name} {coordinate} [{unit}]"
            found.append((("plots", "coordinate", name, coordinate), label, joint.named(coordinate)))
    for name in result.sensor_names[:MOST_SENSORS]:
        sensor = result.sensor(name)
        moved = sensor.kind == Position.kind  # displacements of millimetres are not visible at positions of metres
        shown = sensor.values - sensor.values[:1] if moved else sensor.values
        for component, values in zip(sensor.components, shown.T, strict=True):
            if sensor.kind != Stress.kind or component == EQUIVALENT:
                label = f"{name} {component}{FROM_START * moved} [{sensor.unit}]"
                found.append((("plots", sensor.kind, name, component), label, values))
    for line in (*STORES, *FLOWS):
        values = np.asarray(history.energy.get(line, np.zeros(0)))
        moved = line == "potential"  # its reference level is arbitrary
        values = values - values[:1] if moved else values
        if np.any(values != 0.0):
            found.append((("plots", "energy", line), f"{line.replace('_', ' ')}{FROM_START * moved} [J]", values))
    return found


def plot_kinds(result: Any) -> dict[str, str]:
    """Kinds of plots that have curves, {kind: title}."""
    there = dict.fromkeys(path[1] for path, _, _ in machine_series(result))
    of_sensors = [kind for kind in there if kind not in MACHINE_PLOTS]
    titles = MACHINE_PLOTS | {kind: f"Sensors: {kind.replace('_', ' ')}" for kind in of_sensors}
    return {kind: titles[kind] for kind in titles if kind in there}
