"""`simulate(method="monolithic")`: what the reference supports, and its history in the form of every other run.

A result of it reads, plots, saves and records like any other. It lacks, and its notes say so, the works of the energy
ledger (NaN: energies at hand are there), and error control of the step. Pressures of law "nodes" are node forces
spread over hats (`warpffrf.monolithic.line_of_centres.record`).

Assumption A1, local modes without inertia, is measured by `local="hht"`: local modes with their own mass. Their
coupling with the inertia of the moving frame (`J1`, `J2`, `G` of local modes) is in neither treatment: a reduced body
does not hold these invariants.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from warpffrf import monolithic
from warpffrf.model.checks.consistency import refuse_positions, refuse_singular_mass, refuse_velocities
from warpffrf.model.checks.overlap import refuse_overlap
from warpffrf.model.checks.signal_cover import refuse_short_signals
from warpffrf.model.errors import InputError
from warpffrf.model.films.film import refuse_touching
from warpffrf.model.forces.notes import characteristic_notes
from warpffrf.model.messages.checkpoints import Keeper, Rows, Source, Unfinished
from warpffrf.model.scene import Scene
from warpffrf.model.step_count import step_count
from warpffrf.monolithic import records
from warpffrf.monolithic.checkpoint import from_arrays, is_monolithic, time_of, to_arrays
from warpffrf.monolithic.run import build
from warpffrf.online.compile.forces import ForceTable
from warpffrf.online.diagnosis.deflections import deflection_lines, deflections
from warpffrf.online.diagnosis.free_falls import fall_notes
from warpffrf.online.diagnosis.untouched import untouched_notes
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
from warpffrf.online.history.joint_motion import coordinates, half_turn_notes, left_out_notes
from warpffrf.online.history.pretension import with_pulls
from warpffrf.online.history.sensors import force_histories, sensor_histories
from warpffrf.online.local_dynamics import LocalDynamics, LocalPlan, as_local_dynamics

METHOD = "monolithic"
CONTACT_FIELDS = (
    "force", "torque", "force_second", "torque_second", "first_column", "center_column", "pressure",
    "first_column_second", "load_second", "approach",
)  # fmt: skip
NO_LEDGER = (
    "method 'monolithic': works of forces, drives and dampers are not booked, so that there is no energy balance; the "
    "energies at hand are there"
)


def run_monolithic(
    scene: Any,
    duration: float,
    *,
    step: float,
    start: Any = "initial",
    integrator: Any = None,
    local: Any = "quasi_static",
    step_error: float | None = None,
    save_every: int = 1,
    device: str | None = None,
    progress: bool = True,
    project_start: bool = False,
    options: monolithic.Monolithic | None = None,
    keeper: Keeper | None = None,
) -> History:
    """Simulate `scene` by the monolithic reference; arguments as of `warpffrf.online.run`, `integrator` None is HHT
    with alpha -0.3. Raises InputError for what the reference does not do: adaptive steps, other devices, exponential
    local modes, and going on from a run of the separated solver."""
    options = options or monolithic.Monolithic()
    treatment = as_local_dynamics(local)
    if step_error is not None:
        raise InputError("method 'monolithic' takes fixed steps; leave step_error out")
    if device not in (None, "cpu"):
        raise InputError(f"method 'monolithic' runs on the CPU, got device {device!r}")
    if treatment.treatment not in ("quasi_static", "hht", "auto"):
        raise InputError(
            f"method 'monolithic': local modes are 'quasi_static', 'hht' or 'auto' there, got {treatment.treatment!r}"
        )
    integrator = monolithic.DEFAULT_INTEGRATOR if integrator is None else integrator
    refuse_singular_mass(scene)
    continued = isinstance(start, History | Unfinished)
    began = time_of(start.checkpoint) if isinstance(start, History) else 0.0
    if not isinstance(start, Unfinished):
        refuse_short_signals(scene, began, began + step_count(duration, step)[0] * step)
    if not continued:
        if start == "initial":
            refuse_positions(scene)
            refuse_overlap(scene)
        refuse_touching(scene.films)
        if not project_start:
            refuse_velocities(scene)
    if keeper is not None:
        keeper.begin(Source(METHOD, scene, {"local": treatment, "options": options}))
    plan, modes = _local_modes(scene, treatment)
    found = monolithic.run(
        scene, duration, step=step, start=_continued(start) if isinstance(start, History) else start,
        integrator=integrator, save_every=save_every, progress=progress, keeper=keeper,
        **_system_options(treatment, modes, options),
    )  # fmt: skip
    notes = [*plan.notes, NO_LEDGER]
    if modes and monolithic.coefficients_of(integrator) != treatment.coefficients:
        notes.append(
            f"method 'monolithic': local modes follow {type(integrator).__name__} of the run, not HHT of their own "
            f"(alpha {treatment.alpha:g})"
        )
    if options.law == "nodes" and scene.contacts:
        notes.append("method 'monolithic': pressures shown are node forces spread over the hats of the contact grid")
    notes += [
        f"contact {contact.name!r}: pressures on the material grid, the only one of method 'monolithic', though its "
        "bodies have what cells that travel with the patch need"
        for contact in scene.contacts
        if contact.grid == "auto" and all(port.rigid or port.surface.far is not None for port in contact.ports)
    ]
    return to_history(found, notes)


def history_of(scene: Scene, rows: Rows, *, local: LocalDynamics, options: monolithic.Monolithic) -> History:
    """The History of rows that a run of `scene` has given out; options as its `Source` has them."""
    system, _ = build(scene, **_system_options(local, _local_modes(scene, local)[1], options))
    return to_history(records.history_of(scene, system, rows, "completed", "", None), [])


def _local_modes(scene: Scene, local: LocalDynamics) -> tuple[LocalPlan, dict[tuple[str, str], Any]]:
    """The plan of the local modes with inertia, and the modes by (body, surface)."""
    plan = LocalPlan.of(scene, local)
    return plan, {(scene.bodies[i].name, name): m for i, own in plan.modes.items() for name, m in own.items()}


def _system_options(local: LocalDynamics, modes: dict[tuple[str, str], Any], chosen: monolithic.Monolithic) -> dict:
    """What the system of equations depends on, as arguments of `warpffrf.monolithic.run.build`."""
    return {
        "variant": chosen.variant, "law": chosen.law, "layer_stiffness": chosen.layer_stiffness,
        "stick_stiffness": chosen.stick_stiffness, "tolerance": chosen.tolerance,
        "local": "quasi_static" if local.treatment == "quasi_static" else "hht", "local_modes": modes,
        "local_damping": local.ratio,
    }  # fmt: skip


def _continued(start: History) -> monolithic.MonolithicHistory:
    """`start` as the solver takes it: only its final state counts. Raises `InputError` for another solver's."""
    final = from_arrays(start.checkpoint)
    none = np.zeros(0)
    return monolithic.MonolithicHistory(start.scene, none, none, {}, {}, {}, {}, none, none, final=final)


def refuse_other_method(checkpoint: Any, method: str, where: str) -> None:
    """Raises `InputError` unless `checkpoint` was left by `method`: the solvers keep different states."""
    left_by = "monolithic" if is_monolithic(checkpoint) else "separated"
    if checkpoint and left_by != method:
        raise InputError(
            f"{where}: it begins where a run of method {left_by!r} ended, and method {method!r} cannot go on from "
            "there; use one method for all, or start from 'initial' or 'equilibrium'"
        )


def _springs(scene: Scene) -> ForceTable:
    """Laws of the springs of a scene, and their rows one behind the other."""
    table, at = ForceTable(), 0
    for item in scene.forces:
        if hasattr(item, "law"):
            law = item.law()
            table.laws[item.name] = law
            table.rows[item.name] = list(range(at, at + len(law.coordinates)))
            at += len(law.coordinates)
    return table


def to_history(found: monolithic.MonolithicHistory, notes: list[str]) -> History:
    """A monolithic run as a `History`, with `notes` before its own."""
    scene: Any = found.scene
    T, time = len(found.time), found.time
    bodies = {name: BodyHistory(**vars(motion)) for name, motion in found.bodies.items()}
    joints = {}
    for joint in scene.joints:
        drives = {d.coordinate: d for d in scene.drives if d.joint is joint}
        named = coordinates(joint, drives, time, bodies)
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
            active_hats=c.active,
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
    counters = dict(found.counters)
    counters["rejected_steps"] = 0
    history = History(
        scene=scene, time=time, step_size=found.step_size, bodies=bodies, joints=joints, contacts=contacts, films=films,
        energy={line: found.energy.get(line, missing).copy() for line in ENERGY_LINES},
        iterations=found.iterations, factorisations=found.factorisations, status=found.status, message=found.message,
        counters=counters, forces=forces,
        notes=[*notes, *found.notes, *left_out_notes(scene, found.dropped, bodies, T),
               *half_turn_notes(springs.laws, bodies, T), *characteristic_notes(springs.laws, stretches, time),
               *deflection_lines(scene, deflections(scene, bodies))],
        checkpoint={} if found.final is None else to_arrays(found.final),
    )  # fmt: skip
    history.sensors = sensor_histories(history)
    history.notes += [*fall_notes(scene, history), *untouched_notes(scene, history)]
    return history


def same_windows(histories: list[History]) -> list[History]:
    """Consecutive runs with contact windows of one width, as one History has them; wider ones end in zeros."""
    found = []
    for history in histories:
        contacts = {}
        for name, contact in history.contacts.items():
            wide = {}
            for field in ("pressure", "load_second"):
                columns = max(getattr(h.contacts[name], field).shape[1] for h in histories)
                values = getattr(contact, field)
                wide[field] = np.pad(values, ((0, 0), (0, columns - values.shape[1]), (0, 0)))
            if contact.friction is not None:
                rub = contact.friction
                beside = wide["pressure"].shape[1] - rub.state.shape[1]
                ends = ((0, 0), (0, beside), (0, 0))
                fields = {"state": np.pad(rub.state, ends)}
                fields |= {x: np.pad(getattr(rub, x), ((0, 0), *ends)) for x in ("traction", "slip_velocity")}
                wide["friction"] = replace(rub, **fields)
            contacts[name] = replace(contact, **wide)
        found.append(replace(history, contacts=contacts))
    return found
