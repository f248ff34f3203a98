"""Curves of a whole machine for a recording: lumped contacts, oil films, laps, reactions, applied forces, joint
coordinates, sensors, energies."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.sensors import Position, Stress

Series = tuple[tuple[str, ...], str, np.ndarray]  # entity path below the root, label with the unit, values (T,)
STORES = ("kinetic", "strain", "potential", "contact")  # lines of the ledger that are energies at hand
FLOWS = ("force_work", "drive_work", "damping", "friction")
MOST_SENSORS = 6  # further ones are in the results; a plot of more curves is not read
EQUIVALENT = Stress.components[-1]  # of a stress only this one is drawn
FROM_START = ", change from the start"
MACHINE_PLOTS = {
    "lumped_force": "Forces of lumped contacts [N]",
    "film_force": "Forces of oil films [N]",
    "film_gap": "Smallest films [µm]",
    "film_pressure": "Largest pressures of films [MPa]",
    "lap_force": "Normal forces of laps [N]",
    "lap_slip": "Slipping areas of laps [mm²]",
    "lap_loss": "Losses of laps by friction [J]",
    "joint_force": "Reactions of the joints [N]",
    "applied_force": "Applied and spring forces [N]",
    "joint_friction": "Friction in joints, and its bounds [N]",
    "coordinate": "Coordinates of the joints [m or rad]",
    "energy": "Energies [J]",
}


def machine_series(result: Any) -> list[Series]:
    """What there is to plot of lumped contacts, films, laps, joints, forces, sensors and energies; entities
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
    for name in result.lap_names:
        lap = result.lap(name)
        found.append((("plots", "lap_force", name), f"{name} [N]", lap.normal_force))
        if lap.friction > 0.0:
            found.append((("plots", "lap_slip", name), f"{name} [mm²]", lap.slip_area * 1e6))
            found.append((("plots", "lap_loss", name), f"{name} [J]", lap.loss))
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
        moved = sensor.kind == Position.kind  # a path of millimetres is not seen beside a place of metres
        shown = sensor.values - sensor.values[:1] if moved else sensor.values
        for component, values in zip(sensor.components, shown.T, strict=True):
            if sensor.kind != Stress.kind or component == EQUIVALENT:
                label = f"{name} {component}{FROM_START * moved} [{sensor.unit}]"
                found.append((("plots", sensor.kind, name, component), label, values))
    for line in (*STORES, *FLOWS):
        values = np.asarray(history.energy.get(line, np.zeros(0)))
        moved = line == "potential"  # its zero is anywhere
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
