"""Runs of the monolithic reference as Results, which read, plot, save and report like those of `warpffrf.simulate`.

Such a Result lacks, as its notes state, the works of the energy ledger (NaN: the stored energies are available).
Pressures of a law at nodes are node forces spread over grid nodes (`references.monolithic.line_of_centres.record`);
the creep velocity there is that of the FE node next to the centre of the patch, stored as that of a grid node.

Assumption A1, local modes without inertia, is assessed by `local="hht"`: local modes with their own mass. Their
coupling with the inertia of the moving frame (`J1`, `J2`, `G` of local modes) is in neither treatment: a reduced body
does not contain these invariants.

This is the only file of the reference that imports the engine and the output: their records, not their algorithms.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from references.monolithic.core.integrator import DEFAULT_INTEGRATOR, coefficients_of
from references.monolithic.history import MonolithicHistory
from references.monolithic.run import run
from warpffrf.model.checks.contacts import refuse_overlap
from warpffrf.model.checks.redundancy import refuse_positions, refuse_singular_mass, refuse_velocities
from warpffrf.model.checks.scene import refuse_short_signals
from warpffrf.model.errors import InputError
from warpffrf.model.films.film import refuse_touching
from warpffrf.model.forces.notes import characteristic_notes
from warpffrf.model.step_count import step_count
from warpffrf.online.compile.forces import ForceTable
from warpffrf.online.history.films import eccentricity
from warpffrf.online.history.history import (
    ENERGY_LINES,
    BodyHistory,
    ContactHistory,
    FilmHistory,
    ForceHistory,
    FrictionHistory,
    History,
    JointHistory,
)
from warpffrf.online.history.record import coordinates, half_turn_notes, left_out_notes, with_pulls
from warpffrf.online.history.sensors import force_histories, sensor_histories
from warpffrf.online.local_modes import LocalModes, LocalPlan, as_local_modes
from warpffrf.output.result import Result

CONTACT_FIELDS = (
    "force", "torque", "force_second", "torque_second", "first_column", "center_column", "pressure",
    "first_column_second", "load_second", "approach",
)  # fmt: skip
NO_LEDGER = (
    "monolithic reference: works of forces, drives and dampers are not booked, so that there is no energy balance; the "
    "energies at hand are there"
)


def simulate(
    scene: Any,
    duration: float,
    *,
    step: float,
    start: Any = "initial",
    integrator: Any = DEFAULT_INTEGRATOR,
    local: str | LocalModes = "quasi_static",
    project_start: bool = False,
    **choices: Any,
) -> Result:
    """The Result of `scene` by the monolithic reference; local, project_start and the initial checks as for
    `warpffrf.simulate`, all other arguments as for `references.monolithic.run`. Raises `InputError`."""
    treatment = as_local_modes(local)
    if treatment.treatment not in ("quasi_static", "hht", "auto"):
        raise InputError(
            f"the monolithic reference: local modes are 'quasi_static', 'hht' or 'auto' there, got "
            f"{treatment.treatment!r}"
        )
    refuse_singular_mass(scene)
    if not isinstance(start, MonolithicHistory):
        refuse_short_signals(scene, 0.0, step_count(duration, step)[0] * step)
        if start == "initial":
            refuse_positions(scene)
            refuse_overlap(scene)
        refuse_touching(scene.films)
        if not project_start:
            refuse_velocities(scene)
    plan = LocalPlan.of(scene, treatment)
    modes = {(scene.bodies[i].name, name): m for i, own in plan.modes.items() for name, m in own.items()}
    found = run(
        scene, duration, step=step, start=start, integrator=integrator,
        local="quasi_static" if treatment.treatment == "quasi_static" else "hht", local_modes=modes,
        local_damping=treatment.ratio, **choices,
    )  # fmt: skip
    notes = list(plan.notes)
    if modes and coefficients_of(integrator) != treatment.coefficients:
        notes.append(
            f"monolithic reference: local modes follow {type(integrator).__name__} of the run, not HHT of their own "
            f"(alpha {treatment.alpha:g})"
        )
    return Result(to_history(found, notes))


def to_history(found: MonolithicHistory, notes: list[str]) -> History:
    """A monolithic run as a `History`, with `notes` before its own."""
    scene: Any = found.scene
    T, time = len(found.time), found.time
    bodies = {name: BodyHistory(**vars(motion)) for name, motion in found.bodies.items()}
    joints = {}
    for joint in scene.joints:
        driven = {d.coordinate: d.position() for d in scene.drives if d.joint is joint}
        named = coordinates(joint, driven, time, bodies)
        first, second = [*named.values(), np.full(T, np.nan), np.full(T, np.nan)][:2]
        force, torque = found.reactions[str(joint.name)]
        joints[joint.name] = JointHistory(first, force, torque, second, tuple(named))
    springs = _springs(scene)
    rows = found.spring_rows
    stretches = {name: rows[:, own, 0] for name, own in springs.rows.items()}
    forces = force_histories(scene, springs, time, rows[:, :, 0], rows[:, :, 1:], bodies)
    pulls = {name: ForceHistory(row[:, 1:4], row[:, 4:], row[:, :1]) for name, row in found.tensions.items()}
    forces = with_pulls(forces, pulls)
    contacts = {
        name: ContactHistory(
            **{field: getattr(c, field) for field in CONTACT_FIELDS},
            active_nodes=c.active,
            friction=None if c.friction is None else FrictionHistory(**c.friction),
        )
        for name, c in found.contacts.items()
    }
    missing = np.full(T, np.nan)
    films = {
        str(film.name): FilmHistory(
            **vars(own), eccentricity=eccentricity(film, bodies, T), asperity=np.zeros_like(own.pressure),
            asperity_force=np.zeros(T), largest_asperity_pressure=np.zeros(T),
        )
        for film in scene.films if (own := found.films[str(film.name)])
    }  # fmt: skip
    history = History(
        scene=scene, time=time, step_size=found.step_size, bodies=bodies, joints=joints, contacts=contacts, films=films,
        energy={line: found.energy.get(line, missing).copy() for line in ENERGY_LINES},
        iterations=found.iterations, factorisations=found.factorisations, status=found.status, message=found.message,
        counters={**found.counters, "rejected_steps": 0}, forces=forces,
        notes=[*notes, NO_LEDGER, *found.notes, *left_out_notes(scene, found.dropped, bodies, T),
               *half_turn_notes(springs.laws, bodies, T), *characteristic_notes(springs.laws, stretches, time)],
    )  # fmt: skip
    history.sensors = sensor_histories(history)
    return history


def _springs(scene: Any) -> ForceTable:
    """Laws of the springs of a scene, and their rows in sequence."""
    table, at = ForceTable(), 0
    for item in scene.forces:
        if hasattr(item, "law"):
            law = item.law()
            table.laws[item.name] = law
            table.rows[item.name] = list(range(at, at + len(law.coordinates)))
            at += len(law.coordinates)
    return table
