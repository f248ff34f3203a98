"""The end of a run: status and message of its failure bits, and the History of its saved rows with all notes."""

from __future__ import annotations

from warpffrf.model.bearings.bearing import without_cage
from warpffrf.model.checks.contacts import find_wedge
from warpffrf.model.messages.status import Status
from warpffrf.online.diagnosis.cell_check import cell_check_notes, check_cells
from warpffrf.online.diagnosis.contact_notes import contact_notes, energy_notes, sampling_notes
from warpffrf.online.diagnosis.energy_watch import round_off_energy
from warpffrf.online.diagnosis.failure_report import failure_owner
from warpffrf.online.diagnosis.film_grid import film_grid_errors, film_grid_notes
from warpffrf.online.diagnosis.film_notes import (
    FilmWatch,
    alternation_notes,
    check_films,
    film_check_notes,
    film_notes,
    squeezed_out,
)
from warpffrf.online.diagnosis.inertia_indicator import (
    deflection_lines,
    deflections,
    indicator_lines,
    term_sizes,
    unheld_lines,
)
from warpffrf.online.diagnosis.motion_notes import fall_notes, hidden_inertia, is_static, load_notes, steep_notes
from warpffrf.online.diagnosis.no_equilibrium import NEARER, NO_LOAD_PATH, STATIC_CURE, not_found
from warpffrf.online.engine import Engine
from warpffrf.online.history.history import History
from warpffrf.online.history.record import history_from_rows
from warpffrf.online.start.motions import slide_time
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.model import LINE_OF_CENTRES

COARSEN = "coarsen the contact grid, ContactGrid(spacing=)"
UPHILL = "every step from here increases the energy; begin from another pose, or with a smaller load"
UNSOLVED = int(
    k.NOT_CONVERGED | k.CAPACITY | k.CYCLING | k.TRACTIONS | k.STENCIL
)  # failure bits of deeply wedged contact
RUNS_AWAY = int(
    k.NOT_CONVERGED | k.SINGULAR | k.NOT_FINITE | k.ENERGY | k.NOT_AT_REST | k.UNDERFLOW
)  # failure bits of an unconstrained body
MESSAGES = {
    k.NOT_CONVERGED: (Status.NOT_CONVERGED, "the Newton iteration did not converge; reduce step"),
    k.CYCLING: (Status.CYCLING, "the active set of contact cycles; reduce step, or {coarsen}"),
    k.TRACTIONS: (
        Status.CYCLING,
        "stick and slip of the cells of a contact do not settle, neither by Newton's method with its guard nor by the "
        "interior-point method; reduce step, or {coarsen}",
    ),
    k.CAPACITY: (Status.CAPACITY, "window overflow, raise capacity of the contact to >= {capacity}"),
    k.ROOM: (
        Status.MEMORY,
        "the memory does not suffice for {capacity} active nodes or cells; {coarsen}, "
        "give the contacts a capacity, or run fewer worlds",
    ),
    k.NOT_FINITE: (
        Status.NOT_FINITE,
        "a NaN or infinite number occurred; check for extreme loads, masses or stiffnesses",
    ),
    k.SINGULAR: (
        Status.SINGULAR,
        "the joint equations are singular: redundant constraints, or a mechanism with no load path",
    ),
    k.INDEFINITE: (Status.INDEFINITE, "the contact compliance is not positive definite; {coarsen}"),
    k.STENCIL: (
        Status.STENCIL,
        "a node of the first contact surface overlaps more of the second grid than its stencil allows (the bodies are "
        "rotated or tilted too far for the window); lower the capacity of the contact, or swap its surfaces",
    ),
    k.PASSED: (
        Status.PASSED,
        "a patch with friction advances by more than its own length in a step, so that none of its material was in it "
        "before; reduce step, to a tenth of that length over the rolling speed",
    ),
    k.LEAPT: (
        Status.LEAPT,
        "two surfaces change sides in a step without contact, so that they may pass through each other; reduce step",
    ),
    k.TOO_HOT: (Status.TOO_HOT, "an oil film runs away"),
    k.GAIN: (Status.ENERGY, "energy was created; reduce step"),
    k.NOT_AT_REST: (Status.NO_EQUILIBRIUM, "the bodies do not come to rest"),
    k.ENERGY: (Status.ENERGY, "the energy ledger does not close at an impact; reduce step"),
    k.STEP_ERROR: (
        Status.STEP_ERROR,
        "the local error of a step exceeds step_error; reduce step, or increase step_error",
    ),
}


def finish(
    engine: Engine, begin: float, built: float, notes: list[str], prefix: str, rejected_before: int = 0,
    films: FilmWatch | None = None,
) -> History:  # fmt: skip
    """The History of the saved rows; `rejected_before`: attempts rejected by the earlier run that is continued;
    `films`: intermediate states of the oil films."""
    left = engine.checkpoint()  # before the evaluations for the notes
    bits = int(engine.word("status")[0])
    wanted = engine.no_room.get(0)
    if wanted is None:
        bits &= ~int(k.ROOM)  # remains set when the user interrupts
    status, message = describe(bits, wanted or int(engine.word("spare")[0]), coarser(engine))
    at_rest = prefix.startswith("equilibrium")
    if at_rest and bits:
        uphill = bits & int(k.ENERGY) and not bits & int(k.CAPACITY)  # too small a window also causes it
        message = UPHILL if uphill else message.replace("; reduce step", NEARER if engine.unconverged else STATIC_CURE)
    hidden = hidden_inertia(engine) if bits & int(k.SINGULAR) else ""
    owner = failure_owner(engine, bits) if bits and not hidden else ""
    message = hidden or (f"{message} ({owner})" if owner else message)
    if (at_rest or bits & UNSOLVED) and bits and (wedge := find_wedge(engine.scene)) is not None:
        said = message.split("; ")[0] if prefix else message
        message = str(wedge) if wedge.all_round else f"{said}; {wedge}"
    nowhere = at_rest and not bits and not engine.chunks[0]
    still = [film for film in engine.scene.films if at_rest and slide_time(film) is None]
    if (bits or nowhere) and (squeezed := squeezed_out(engine, still)):
        status, message = (Status.NO_EQUILIBRIUM, squeezed) if at_rest else (status, f"{message}; {squeezed}")
    elif at_rest and engine.not_at_rest and not bits & ~RUNS_AWAY:
        status, message = (
            Status.NO_EQUILIBRIUM,
            f"{engine.not_at_rest}: {without_cage(engine.scene.bearings) or NO_LOAD_PATH}",
        )
    elif nowhere:
        status, message = not_found(engine)
    history = history_from_rows(engine.compiled, engine.saved())
    history.status, history.message = status, (prefix + message if message else "")
    steps = int(engine.word("steps")[0])
    history.counters = {
        "steps": steps,
        "rejected_steps": int(engine.word("rejected")[0]),
        "max_iterations": int(engine.word("worst")[0]),
        "mean_iterations": float(engine.word("iterations")[0]) / max(steps, 1),
        "build_seconds": built - begin,
        "seconds_in_graph": engine.seconds_in_graph,
        "coarse_steps": int(engine.word("coarse")[0]),
        "repeated_steps": int(engine.word("repeated")[0]),
        "impulsive_steps": int(engine.word("impulses")[0]),
        "idle_steps": int(engine.word("idle_steps")[0]),
        "retained_columns": engine.compiled.model.retained.count + engine.compiled.model.modes.count,
    }
    if engine.compiled.slips.laws or engine.compiled.tensions.laws:
        history.counters["restarted_steps"] = int(engine.word("restarted_steps")[0])
    if engine.graph.pattern is not None:
        factors = engine.scratch.fallback, engine.scratch.cell_fallback  # of pressures and tractions
        history.counters["dense_fallbacks"] = sum(int(factor.numpy()[0, 1]) for factor in factors)
    if engine.word("edge")[0]:
        arcs = [c.name for c in engine.scene.finite_sliding if not c.a.surface.grid.periodic]
        notes.append(
            f"a contact patch reached the end of a contact surface that covers an arc only ({', '.join(arcs)}): the "
            "pressure is cut there: where the body goes on, give it a larger contact surface; where it ends too, the "
            "pressure at its edge is as sharp as the grid"
        )
    notes.extend(steep_notes(engine.scene, engine.scratch.steep.numpy()[0]))
    notes.extend(film_notes(engine.scene, history))
    if history.status == Status.COMPLETED and engine.worlds == 1:
        history.film_grids = film_grid_errors(engine)
        notes.extend(film_grid_notes(engine, history.film_grids))
    if films is not None:
        history.film_checks = check_films(engine, films)
        notes.extend(film_check_notes(engine, history.film_checks))
    halved = int(engine.word("rejected")[0]) - rejected_before
    if halved and not at_rest:
        reasons = [text for bit, (text, _) in MESSAGES.items() if int(engine.word("reason")[0]) & int(bit)]
        notes.append(f"{halved} steps were halved ({', '.join(reasons)})")
        notes.extend(alternation_notes(engine.scene, engine.integrator))
    repeated = int(engine.word("repeated")[0])
    if repeated and engine.compiled.model.modes.dynamic_count:
        notes.append(
            f"{repeated} steps were repeated with a contact force without history: impacts on local modes with "
            "inertia, in which the faces lose their own kinetic energy"
        )
    levels = {
        body.name: plan.level for body, plan in zip(engine.scene.bodies, engine.compiled.inertia.bodies, strict=True)
    }
    stiffened = {body.name for body in engine.scene.bodies if body.stiffening}
    inertia = indicator_lines(term_sizes(engine.scene, history.bodies, levels), levels, stiffened)
    inertia += unheld_lines(engine.scene, history.bodies)
    inertia += deflection_lines(engine.scene, deflections(engine.scene, history.bodies), at_rest=at_rest)
    falls = [] if at_rest or is_static(engine) else fall_notes(engine.scene, history)
    families = engine.compiled.model.pairs.family.numpy()
    on_axes = [c.name for c, f in zip(engine.scene.finite_sliding, families, strict=False) if f == LINE_OF_CENTRES]
    contact = [*contact_notes(engine.scene, history, on_axes), *sampling_notes(engine.scene, history)]
    history.cell_checks = check_cells(engine, history)
    contact += cell_check_notes(engine, history.cell_checks)
    contact = [note for note in contact if note not in notes]
    if is_static(engine):
        energy = load_notes(engine, history.energy)
    else:
        energy = energy_notes(history.energy, round_off_energy(engine))
    history.notes = [*notes, *falls, *inertia, *contact, *energy, *history.notes]
    history.checkpoint = left
    return history


def coarser(engine: Engine) -> str:
    """The cure that reduces the contact unknowns: nodes of body-fixed grids, cells of contact-fixed grids."""
    cells = f"take fewer cells (cells= of {'the contact' if len(engine.compiled.patches) == 1 else 'contacts'})"
    on_cells = len(engine.compiled.patches)
    return " or ".join([cells] * (on_cells > 0) + [COARSEN] * (on_cells < len(engine.scene.finite_sliding)))


def describe(bits: int, capacity: int, coarsen: str = COARSEN) -> tuple[Status, str]:
    """Status and message of the failure bits of a world; `coarsen`: the cure of `coarser`."""
    if bits == 0:
        return Status.COMPLETED, ""
    for bit, (status, message) in MESSAGES.items():
        if bits & int(bit):
            text = message.format(capacity=capacity, coarsen=coarsen)
            return status, text + (" (the step was halved as often as allowed)" if bits & int(k.UNDERFLOW) else "")
    return Status.STEP_UNDERFLOW, "the step became too small"
