r"""Errors of contacts: the grid or the cells of the pressure, reduced sampling points, the mesh, and the iteration.

*Body-fixed grid*: grid error of the force at a given approach, and of the pressures in the L2 norm, for the patch size
at the largest load: half of the rule of `offline.contact.grid_rule`, which is for the worst position of the patch on
the grid. Fields err at their edges, peaks by the square of that. *Cells of a patch*: comparison with a finer or coarser
grid at sampled steps, for pressures as cell means in the L2 norm (`online.diagnosis.cell_check`). *Parallel-axes
kinematics*: the neglected moment if axes are inclined (`online.diagnosis.contact_notes.Leaning`), relative to that of
the contact, or to `EDGE` of the moment of its force at the end. *Friction on cells*: for a patch that advances c cells
per step, with c above `MOST_CELLS`, c/MOST_CELLS times `FRICTION_ERROR` of the largest friction force
(docs/studies/patch_rolling.md: 0.9 to 1.0 % at 2.5, 1.0 to 1.4 % at 4). *Points*: all points at sampled steps
(`online.diagnosis.sampling_check`). *Mesh*: mesh error of the far fields of both bodies
(`model.mesh_error.own_mesh_error`), exactly by a second mesh, `ReducedBody.mesh_error`. *Half-widths* on n strips
follow from moments, about 0.3 % 11/n too large for lines and 1 % (11/n)^2 for points (docs/studies/coarse_points.md).

Errors of forces are relative to the force of the contact, at least `quantities.LIGHT` of the largest force of the
machine. Pressures of a line depend on the root of the force F, so that their errors are then relative to the pressures
at that force.

Bodies. Errors of bodies: neglected inertia terms, and local modes without inertia.

*Inertia*: sizes of the terms on the computed motion (`online.diagnosis.inertia_indicator`). *Stiffening* by rotation is
of the size of the deformed inertia. *Local modes* follow the contact force without delay, although modes above the
highest global one, omega_c, have inertia: for a force F(t) the error is F''/omega_c^2 at most, so that the root mean
square of F'' over that of omega_c^2 F is the relative error of the local deformation, and so of the approach.

Spurious energy, from the energy ledger of the run.

With L = numerical + contact_grid, the energy errors of the steps and of contact grids, a run has gained max(L - running
min L), relative to the energy scale. Such a gain is an error of the step, of second order in it for smooth motion, even
if coordinates are still accurate. A loss is numerical damping of unresolved motion, which the report states separately;
with lumped contacts, where the contact law is the only compliance in an impact, a loss is also an error, and the larger
of the two counts.

The lines have different remedies: `numerical` depends on the step, `contact_grid` on the grid under a moving patch, at
any step. The line that changed more between the rows of the largest rise or fall is named, with the other if it
contributed more than `SHARE`.

Films. Errors of oil films: with quadrature "reduced" a few axial profiles compared with all nodes, in states of the
run; the grid of the nodes compared with finer ones, in the last state.

The smallest gap and the largest pressure are compared at the same force, the force at the same positions
(`online.diagnosis.film_check`); force, flow and torque of finer grids at the same gap (`online.diagnosis.film_grid`).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from warpffrf.model.reduced.mesh_error import own_mesh_error
from warpffrf.offline.contact.contact_grid import grid_error
from warpffrf.online.diagnosis.contact_notes import Leaning, check_sampling, few_columns
from warpffrf.online.diagnosis.film_notes import cure_of
from warpffrf.online.diagnosis.inertia_indicator import term_sizes
from warpffrf.online.engine import Engine
from warpffrf.online.history.history import BudgetLine, History
from warpffrf.output.budget.figures import WORK
from warpffrf.output.budget.quantities import LIGHT, shares
from warpffrf.output.contact.friction import FRICTION_ERROR, MOST_CELLS
from warpffrf.output.contact.hertz import flexible_sides
from warpffrf.output.round_off import idle_energy
from warpffrf_kernels.core.model import LINE_OF_CENTRES

PATCHES = {"line": "line", "point": "ellipse"}  # kinds of patches covered by the rule
LINES = ("line", "line_around")
FORCE, PRESSURE = "force", "pressure"
MEAN = 0.5  # of the rule, which is for the worst position of a patch on its grid
GAPS = "parallel-axes kinematics"
EDGE = 0.01  # of the force times half the width
ADVANCE = "friction of large steps"
MESH_CURE = "a finer mesh; body.mesh_error(the same body on another mesh) computes it exactly"
USUAL = 11  # strips of a patch; with so many, moments overestimate half-widths by
MOMENTS = {"line": (0.003, 1.0), "line_around": (0.003, 1.0), "point": (0.01, 2.0)}  # this, with a power of the strips
PEAK = 0.5  # of the change of the largest pressure with the cells: a peak is that of the parabola through them
ROLLING = {"creepage": 2.0, "friction power": 2.0, "wear index": 10.0, WORK: 0.5}  # times `FRICTION_ERROR`
HALF_WIDTHS = "moments of pressures at strip centres, by studies of cylinders and balls"
GRID, POINTS, MESH, TOLERANCE = "contact grid", "sampling points", "FE mesh", "iteration"
ALONG, ALONG_CURE = (
    "cells along the axis",
    "more cells of the mesh along the axis, at most as long as the wall is thick",
)


def grid_lines(result: Any, engine: Engine) -> list[BudgetLine]:
    """One line for each loaded contact."""
    history = result.history
    checks, share = history.cell_checks, shares(history)
    lines: list[BudgetLine] = []
    for number, contact in enumerate(history.scene.finite_sliding):
        found = result.contact(contact.name)
        if not np.any(found.touching):
            continue
        if number in engine.compiled.patches:
            check = checks.get(number)
            known = check is not None and bool(check.rows)
            other = _compared(check) if known else "the comparison with another grid found no state"
            sizes = (check.force, check.field) if check is not None and known else (np.nan, np.nan)
            cure = "a smaller cell_error, or more cells"
            own = [
                BudgetLine(GRID, f"{of} of contact {contact.name!r}", size, other, cure)
                for of, size in zip((FORCE, PRESSURE), sizes, strict=True)
            ]
            lines += _of_cells(found, history.time, cure)
            peak = PEAK * check.pressure if check is not None and known else np.nan
        else:
            own = [_of_nodes(found, of) for of in (FORCE, PRESSURE)]
            peak = own[1].size ** 2
            if few := few_columns(history.contacts[contact.name], found.patch_kind):
                own = [_at_least(line, size) for line, size in zip(own, few, strict=True)]
                peak = few[1]
                lines.append(replace(own[1], of=f"half-widths of contact {contact.name!r}", size=peak))
        own.append(replace(own[1], of=f"peak {own[1].of}", size=peak))
        parts = share[contact.name], np.sqrt(share[contact.name]), np.sqrt(share[contact.name])
        lines += [_beside(line, part) for line, part in zip(own, parts, strict=True)]
    return lines


def _at_least(line: BudgetLine, size: float) -> BudgetLine:
    """`line`, or the error of a patch of few columns where that is larger or the rule does not hold."""
    return line if line.size >= size else replace(line, size=size, basis="few columns of the grid across the patch")


def _of_cells(found: Any, time: np.ndarray, cure: str) -> list[BudgetLine]:
    """Errors of half-widths of a patch of cells by the moments of pressures at cell centres, and of rolling friction on
    cells; for micro-slip in a stationary patch no estimate exists."""
    strips, owner = found.pressure(0).pressure.shape[0], f"contact {found.name!r}"
    moments, power = MOMENTS.get(found.patch_kind, (0.0, 1.0))
    lines = [BudgetLine(GRID, f"half-widths of {owner}", moments * (USUAL / strips) ** power, HALF_WIDTHS, cure)]
    if found.has_friction and _rolls(found, time):
        advance = float(np.nanmax(found.friction.cells_per_step)) / MOST_CELLS["cells"]
        size = FRICTION_ERROR * max(advance, 1.0) * USUAL / strips
        basis = f"rolling on {strips} strips, by studies of cylinders and balls"
        for of, factor in ROLLING.items():
            name = of if of == WORK else f"{of} of {owner}"
            lines.append(BudgetLine(GRID, name, factor * size, basis, "more strips, a smaller step"))
    return lines


def _rolls(found: Any, time: np.ndarray) -> bool:
    """Whether the patch moves: it advances by more than its width."""
    way = np.trapezoid(np.nan_to_num(np.abs(found.friction.rolling_velocity)), time)
    return bool(way > 2.0 * np.max(found.half_widths[:, 0], initial=0.0))


def _compared(check: Any) -> str:
    return f"compared with a {'finer' if check.finer else 'coarser'} grid at sampled steps"


def _beside(line: BudgetLine, share: float) -> BudgetLine:
    """`line` of a contact that carries at least a `share` of the reference force of errors."""
    if share == 1.0:
        return line
    basis = f"{line.basis}; relative to {LIGHT:g} of the largest force of the machine, it carries less"
    return replace(line, size=share * line.size, basis=basis)


def _of_nodes(found: Any, quantity: str) -> BudgetLine:
    """Error of the body-fixed grid by the rule, at the largest load."""
    cure = "a finer grid (half_width= of the mesh, ContactGrid(spacing=)), or contact_fixed=True"
    of = f"{quantity} of contact {found.name!r}"
    if found.patch_kind not in PATCHES:
        return BudgetLine(GRID, of, np.nan, f"there is no rule for a patch that is {found.patch_kind!r}", cure)
    size = MEAN * nodes_error(found, found.spacing, quantity)
    if np.isnan(size):
        return BudgetLine(GRID, of, np.nan, "the patch is smaller than a column of the grid", cure)
    return BudgetLine(GRID, of, size, "the rule of the grid at the largest load, mean position", cure)


def nodes_error(found: Any, spacing: float, quantity: str) -> float:
    """Error of a grid with node `spacing` [m] around, for a patch as `found` at its largest load; NaN if the patch is
    smaller than a spacing, or of a kind without a rule."""
    kind = PATCHES.get(found.patch_kind)
    if kind is None:
        return np.nan
    row = int(np.argmax(found.force_magnitude))
    widths = found.half_widths[row] if kind == "ellipse" else found.half_width[row : row + 1]
    along = float(np.max(np.diff(found.view.first.grid.z)))
    sizes = [
        grid_error(float(s), float(width), quantity=quantity, patch=kind) if width > 0.0 else None
        for s, width in zip((spacing, along), widths, strict=False)
    ]
    return max((np.nan if size is None else size for size in sizes), key=lambda size: (np.isnan(size), size))


def gap_lines(result: Any, engine: Engine) -> list[BudgetLine]:
    """One line for each loaded contact with parallel-axes kinematics."""
    lines, families = [], engine.compiled.model.pairs.family.numpy()
    for number, contact in enumerate(result.history.scene.finite_sliding):
        if families[number] != LINE_OF_CENTRES or not np.any(result.contact(contact.name).touching):
            continue
        lean = Leaning.of(contact, result.history.contacts[contact.name], result.history)
        beside = max(lean.moment, EDGE * lean.force * 0.5 * float(np.ptp(contact.a.surface.grid.z)))
        size = lean.left / beside if beside > 0.0 else 0.0
        basis = f"axes are inclined by {lean.tilt:.2g} rad"
        lines.append(BudgetLine(GAPS, f"moment of contact {contact.name!r}", size, basis, 'kinematics="closest_point"'))
    return lines


def friction_lines(result: Any) -> list[BudgetLine]:
    """One line for each contact whose patch of cells advances too fast for friction."""
    lines = []
    for contact in result.history.scene.finite_sliding:
        found = result.contact(contact.name)
        if contact.friction.acts and found.loaded == "cells" and np.any(found.friction.too_fast):
            advance = float(np.nanmax(found.friction.cells_per_step))
            lines.append(
                BudgetLine(
                    ADVANCE,
                    f"largest friction force of contact {contact.name!r}",
                    FRICTION_ERROR * advance / MOST_CELLS["cells"],
                    f"the patch advances {advance:.2g} cells per step",
                    "a smaller step, or fewer strips in cells=",
                )  # fmt: skip
            )
    return lines


def point_lines(result: Any) -> list[BudgetLine]:
    """One line for each contact of quadrature "reduced"."""
    lines = []
    for contact in result.history.scene.finite_sliding:
        if contact.quadrature == "reduced" and np.any(result.contact(contact.name).touching):
            check = check_sampling(contact, result.history)
            cure = "a smaller sampling_error of the first body"
            lines.append(BudgetLine(POINTS, _force(contact.name), check.force, "all points at sampled steps", cure))
    return lines


def mesh_lines(result: Any) -> list[BudgetLine]:
    """For each loaded contact the effect of the meshes of its bodies on the force at a given approach, weighted by
    their share of the compliance: by `model.mesh_error.own_mesh_error`, on a body-fixed grid by `line_mesh_error` of
    the reduction."""
    lines = []
    for contact in result.history.scene.finite_sliding:
        found = result.contact(contact.name)
        if not np.any(found.touching):
            continue
        row = int(np.argmax(found.force_magnitude))
        widths = tuple(float(width) for width in found.half_widths[row])
        sides = [(body.reduced, surface) for body, surface in flexible_sides(found.view)]
        errors = [_of_mesh(found, reduced, surface, widths) for reduced, surface in sides]
        yields = [_softness(reduced, surface.name) for reduced, surface in sides]
        known = bool(errors) and None not in errors and None not in yields
        size = float(np.dot(errors, yields) / np.sum(yields)) if known else np.nan  # type: ignore[arg-type]
        basis = "rule of far fields and walls" if found.loaded == "cells" else "rule of the elements behind the surface"
        if any(surface.half_space for _, surface in sides):
            basis = "half-spaces, without a mesh"
            if not known:
                basis = "half-spaces have no depth, on which the approach of a line depends; reduce bodies from meshes"
        elif not known:
            basis = "there is no rule for the elements behind point contacts at nodes; use bodies on another mesh"
        if not sides:
            size, basis = 0.0, "rigid bodies"
        lines.append(BudgetLine(MESH, _force(contact.name), size, basis, MESH_CURE))
        along = max((_along(reduced, surface.name) for reduced, surface in sides), default=0.0)
        if along > 0.0 and found.patch_kind in LINES:
            of, basis = f"peak pressure of contact {contact.name!r}", "rules of cells along a layer with free ends"
            lines.append(BudgetLine(ALONG, of, along, basis, ALONG_CURE))
    return lines


def _along(reduced: Any, name: str) -> float:
    """Error of the largest pressure of a line due to few cells along the axis, in the middle or near the ends."""
    known = reduced.report.get("contact", {}).get(name, {})
    return max(known.get("axial_error", 0.0), known.get("far_field", {}).get("end_error", 0.0))


def _softness(reduced: Any, name: str) -> float | None:
    """(1 - nu^2)/E [1/Pa] of the material at a surface; None if unknown."""
    material = reduced.provenance.get("contact_materials", {}).get(name)
    return (1.0 - material["poisson_ratio"] ** 2) / material["youngs_modulus"] if material else None


def _of_mesh(found: Any, reduced: Any, surface: Any, widths: tuple[float, ...]) -> float | None:
    line = found.patch_kind in LINES
    if surface.half_space:
        return None if line else 0.0
    if found.loaded == "cells" and surface.far is not None:
        return own_mesh_error(reduced, surface.name, (widths[0], widths[1]), line=line)
    figures = reduced.report.get("contact", {}).get(surface.name, {})
    return figures.get("line_mesh_error") if line else None


def tolerance_lines(result: Any, engine: Engine) -> list[BudgetLine]:
    """Tolerance of the equilibrium iteration of a step."""
    of = "force of all contacts" if result.history.scene.finite_sliding else "all results"
    size = engine.settings.residual_tolerance
    return [BudgetLine(TOLERANCE, of, size, "the tolerance of the balance of forces")]


def _force(name: str) -> str:
    return f"force of contact {name!r}"


INERTIA, STIFFENING, LOCAL = "inertia terms", "geometric stiffening", "local modes without inertia"
STATIC = "quasi_static"
LEAST_ROWS = 5  # for second differences of a force
UNEVEN = 1e-6  # of the distance of saved steps


def inertia_lines(result: Any, engine: Engine) -> list[BudgetLine]:
    """One line for each flexible body, for its deformation."""
    scene, bodies = result.history.scene, result.history.bodies
    levels = {body.name: plan.level for body, plan in zip(scene.bodies, engine.compiled.inertia.bodies, strict=True)}
    sizes = term_sizes(scene, bodies, levels)
    lines = []
    for body in scene.bodies:
        own = [s for s in sizes if s.body == body.name]
        if not own:
            continue
        of = f"deformation of body {body.name!r}"
        left_out = [s for s in own if not s.kept]
        if left_out:
            names = ", ".join(s.term for s in left_out)
            size = float(min(np.linalg.norm([s.size for s in left_out]), 1.0))
            lines.append(BudgetLine(INERTIA, of, size, f"{names}, on the motion found", "inertia='full'"))
        softened = next((s.on_modes for s in own if s.term == "deformed inertia"), 0.0)
        if not body.stiffening:
            cure = "ReductionOptions(stiffening=True) in reduce, stiffening=True in add_body"
            lines.append(BudgetLine(STIFFENING, of, float(min(softened, 1.0)), "as the deformed inertia", cure))
    return lines


def local_lines(result: Any, engine: Engine) -> list[BudgetLine]:
    """One line for each loaded contact, for its approach."""
    if engine.compiled.local.options.treatment != STATIC:
        return []
    lines = []
    for contact in result.history.scene.finite_sliding:
        found = result.contact(contact.name)
        if not np.any(found.touching):
            continue
        of = f"approach of contact {contact.name!r}"
        cure = "modes of the bodies to a higher max_frequency, or local_modes='hht'"
        highest = [highest_frequency(port.body) for port in (contact.a, contact.b) if not port.rigid]
        size, basis = _missed(result.time, found.force, min(highest))
        lines.append(BudgetLine(LOCAL, of, size, basis, cure))
    return lines


def highest_frequency(body: Any) -> float:
    """Frequency [Hz] up to which the global modes of a body include its vibrations; 0 without any."""
    known = body.reduced.report.get("quality", {}).get("frequencies", {}).get("covered")
    frequencies = body.reduced.frequencies
    return float(known or frequencies.max(initial=0.0))


def _missed(time: np.ndarray, force: np.ndarray, highest: float) -> tuple[float, str]:
    if highest == 0.0:
        return np.nan, "a body has no vibration modes to estimate the effect of their inertia"
    step = np.diff(time)
    if len(time) < LEAST_ROWS or np.ptp(step) > UNEVEN * step.max():
        return np.nan, "requires a force saved at even times"
    bend = np.diff(force, 2, axis=0) / step[0] ** 2
    size = np.sqrt(np.mean(np.sum(bend**2, axis=1)) / np.mean(np.sum(force**2, axis=1)))
    return float(size / (2.0 * np.pi * highest) ** 2), _pace(highest)


def _pace(highest: float) -> str:
    lowest = f"{1e-3 * highest:.4g} kHz" if highest >= 1e3 else f"{highest:.4g} Hz"
    return f"rate of change of the force, compared with the lowest neglected frequency, {lowest}"


SOURCE, OF = "energy ledger", "energy in the system"
SHARE = 0.2  # of the gain or loss: a line with less is not named
FINER_GRID = "a finer contact grid (expected_half_width= or spacing= of ContactGrid), or more cells of a patch (cells=)"


def energy_lines(result: Any) -> list[BudgetLine]:
    """One line, if there is energy beyond round-off and the ledger was computed."""
    hand = result.energy_scale
    ledger = {name: np.asarray(result.energy[name]) for name in ("numerical", "contact_grid")}
    L = ledger["numerical"] + ledger["contact_grid"]
    if hand <= idle_energy(result) or not np.all(np.isfinite(L)):
        return []
    rises = L - np.minimum.accumulate(L)
    falls = np.maximum.accumulate(L) - L
    lost = bool(result.history.scene.lumped_contacts and falls.max() > rises.max())
    sign, basis = (-1.0, "lost") if lost else (1.0, "gained")
    end = int(np.argmax(falls if lost else rises))
    begin = int(np.argmin(sign * L[: end + 1]))
    made = {name: sign * (values[end] - values[begin]) for name, values in ledger.items()}
    size = float(sum(made.values()))
    own = [name for name in sorted(made, key=lambda name: -made[name]) if made[name] >= SHARE * size]
    or_else = ", or energy_tolerance=" if result.history.counters.get("rejected_steps") else ""
    cures = {"numerical": f"a smaller step{or_else}", "contact_grid": FINER_GRID}
    named = f"{basis} by line{'s' * (len(own) > 1)} {' and '.join(own)}"
    return [BudgetLine(SOURCE, OF, size / hand, named, "; ".join(cures[name] for name in own))]


PROFILES, FILM_GRID = "film profiles", "film grid"


def film_lines(history: History) -> list[BudgetLine]:
    """Three lines for each film."""
    lines = []
    for film in history.scene.films:
        grid = history.film_grids.get(str(film.name))
        if grid is not None:
            told = f"twice {film.grid.columns} columns and {film.grid.rows} rows at the gap of the last state"
            cure = f"reduce with a finer mesh {grid.finer}"
            for of, size in (("force", grid.load), ("end flow", grid.flow), ("torque", grid.torque)):
                lines.append(BudgetLine(FILM_GRID, f"{of} of film {film.name!r}", float(size), told, cure))
        check = history.film_checks.get(str(film.name))
        if check is None:
            continue
        basis = f"all nodes in {len(check.time)} states of the run"
        if not len(check.time):
            basis = "the film at all nodes was found in no state of the run"
        for of, size, where in (
            ("force", check.force, "at the same positions"),
            ("smallest gap", check.gap, "under the same force"),
            ("largest pressure", check.pressure, "under the same force"),
        ):
            told = basis
            if np.isfinite(size):
                told += f", {where}; the error of {film.grid.rows} rows of nodes is {check.own:.1%}"
            lines.append(BudgetLine(PROFILES, f"{of} of film {film.name!r}", float(size), told, cure_of(film)))
    return lines
