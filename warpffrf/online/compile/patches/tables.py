"""Pairs on contact-fixed grids -> device tables (kernels of `patch`): selection of the pairs, their cells
(`patch_plan`), and the far fields of their surfaces.
"""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import numpy as np

from warpffrf.model.bodies import Body, Ground
from warpffrf.model.checks.contacts import on_same_surfaces
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.online.compile.patches.plan import PatchPlan, relative_curvatures, smallest_radii
from warpffrf.online.compile.patches.several import fill_beside
from warpffrf.online.compile.strips import pressure_tables, product_numbers, waves
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.patch.spline_tables import LINE

Array = np.ndarray
# of the larger curvature: below it patches are wide compared with the radius, and require body-fixed grids
HUGGING = 0.2
FAR_COLUMNS = 4  # splines in addition to those over 2 W
TAPS = 3  # minimum of splines across in a window, also where a surface has only two


def patch_plans(
    contacts: list[Contact], dynamic: Collection[int], *, off_end: bool = False
) -> tuple[dict[int, PatchPlan], list[str]]:
    """Plans of contacts on contact-fixed grids by number, and notes on the choice of grid="auto". Raises `InputError`
    where one of their bodies is also loaded by a contact on a body-fixed grid, and where another contact uses the same
    two surfaces. dynamic: indices of bodies whose local modes have inertia; off_end: as `PatchPlan.of`.
    """
    plans: dict[int, PatchPlan] = {}
    alike: dict[int, PatchPlan] = {}  # pairs of teeth of two gears are, by identity of where they meet
    notes = []
    for i, contact in enumerate(contacts):
        asked = contact.grid == "contact_fixed"
        if contact.grid == "body_fixed":
            continue
        if asked and (reason := _on_its_surfaces(contact, contacts)):
            raise InputError(f'contact {contact.name!r}: {reason}; use grid="body_fixed"')
        if not asked and (reason := _why_not(contact, contacts, dynamic)):
            if coarse := _spacing_beside_far_fields(contact):
                notes.append(
                    f"contact {contact.name!r}: pressures on the body-fixed grid, whose columns are {coarse:.2g} m "
                    f"apart, though its bodies have the data of a contact-fixed grid: {reason}"
                )
            continue
        try:
            plans[i] = alike.get(id(contact.meeting)) or PatchPlan.of(contact, off_end=off_end)
            if contact.meeting is not None:
                alike[id(contact.meeting)] = plans[i]
        except InputError as error:
            if asked or any(port.surface.half_space for port in contact.ports if not port.rigid):
                raise
            notes.append(f"{error}: pressures on the body-fixed grid, not on the contact-fixed one")
    while beside := next(_beside_a_grid(contacts, plans), None):  # removing one may remove others
        i, port, other = beside
        if contacts[i].grid == "contact_fixed":
            raise InputError(
                f"contact {contacts[i].name!r}: body {port.body.name!r} is also loaded by {other.name!r}, whose nodes "
                "and the cells of a patch are not coupled by its local modes; give both the same grid="
            )
        del plans[i]
        notes.append(
            f"contact {contacts[i].name!r}: pressures on the body-fixed grid, as those of {other.name!r} on body "
            f"{port.body.name!r} are"
        )
    _refuse_half_spaces(contacts, plans, dynamic)
    notes += [
        f"contact {contacts[i].name!r}: pressures on the contact-fixed grid, for which its bodies were "
        'reduced (contact_fixed); grid="body_fixed" uses the other one'
        for i in plans
        if contacts[i].grid == "auto" and not any(p.surface.half_space for p in contacts[i].ports if not p.rigid)
    ]
    return plans, notes


def _refuse_half_spaces(contacts: list[Contact], plans: Collection[int], dynamic: Collection[int]) -> None:
    """Raises `InputError` for a half-space without a patch of cells, where it would be rigid, and for a surface over a
    plane, which cells alone evaluate."""
    for i, contact in enumerate(contacts):
        for port in contact.ports:
            if i not in plans and not port.rigid and port.surface.half_space:
                reason = _why_not(contact, contacts, dynamic) or f'it has grid="{contact.grid}"'
                raise InputError(
                    f"contact {contact.name!r}: {port.label} is a half-space, which is elastic only under the cells of "
                    f'grid="contact_fixed", not used here: {reason}; reduce its body from a mesh'
                )
            if i not in plans and port.surface.shape.profile().height is not None:
                reason = _why_not(contact, contacts, dynamic) or f'it has grid="{contact.grid}"'
                raise InputError(
                    f"contact {contact.name!r}: {port.label} is of kind {port.surface.shape.kind}, whose contact is on "
                    f'the cells of grid="contact_fixed" only, not used here: {reason}'
                )


def _on_its_surfaces(contact: Contact, contacts: list[Contact]) -> str | None:
    """Message that another contact uses the surfaces of this one, whose pressures are on separate cells."""
    for other in contacts:
        if other is not contact and on_same_surfaces(contact, other):
            return f"{other.name!r} uses the same surfaces, and cells of two patches at one point share no pressure"
    return None


def _why_not(contact: Contact, contacts: list[Contact], dynamic: Collection[int]) -> str | None:
    """Why grid="auto" chooses no contact-fixed grid: unsupported features, or a conformal contact; None where it
    does.
    """
    if reason := contact.without_patch() or _on_its_surfaces(contact, contacts):
        return reason
    if any(port.body.index in dynamic for port in contact.ports):
        return "their local modes have inertia"
    across, _ = relative_curvatures(contact)
    sharpest = 1.0 / smallest_radii(contact)[0]
    return None if across > HUGGING * sharpest else "the surfaces are nearly as curved as each other"


def _spacing_beside_far_fields(contact: Contact) -> float:
    """Distance [m] of the columns of a contact whose flexible bodies all have far fields; 0 of others."""
    if any(port.surface.far is None for port in contact.ports if not port.rigid):
        return 0.0
    surface = contact.a.surface
    planar = surface.shape.profile().planar
    return surface.grid.pitch * (1.0 if planar else float(np.max(surface.shape.radius_at(np.asarray(surface.grid.z)))))


def _beside_a_grid(contacts: list[Contact], taken: Collection[int]) -> Any:
    """Of those `taken` for contact-fixed grids, by number, the ones on a body that another contact loads on a
    body-fixed grid: number, port, and the other.
    """
    for i in sorted(taken):
        for port in (port for port in contacts[i].ports if not port.rigid):
            for j, other in enumerate(contacts):
                if j not in taken and any(q.body is port.body for q in other.ports):
                    yield i, port, other


def filled(count: int) -> int:
    """`count` padded to whole lines of LINE."""
    return -(-count // LINE) * LINE


def fill_patches(collector: Any, m: Model) -> None:
    """Cells, near tables and far fields of all pairs on contact-fixed grids."""
    plans, contacts = collector.patches, collector.scene.finite_sliding
    per_pair: dict[str, list] = {
        name: [] for name in ("columns", "first", "second", "curvature", "follows", "aspect", "middle", "least_width",
                              "most_width", "begins", "span", "layer", "row_start", "wave_start", "spectrum_start",
                              "inverse_start", "near_levels",
                              "near_first", "near_step", "near_power", "end_start")
    }  # fmt: skip
    z, length, end_z, strength = [np.zeros(0)], [np.zeros(0)], [], []
    blocks: dict[str, list[Array]] = {name: [np.zeros(0)] for name in ("wave", "spectrum", "inverse")}
    of_table: dict[bytes, dict[str, int]] = {}  # equal pairs share theirs
    spectrum_numbers = strip_numbers = 0
    for i, contact in enumerate(contacts):
        plan = plans.get(i)
        sides = [collector.surfaces[s].surface for s in collector.sides[2 * i : 2 * i + 2]]
        values = dict.fromkeys(per_pair, 0)
        values |= {"row_start": sum(map(len, z)), "end_start": len(end_z)}
        if plan is not None:
            first, second = (side.number for side in sides)
            values |= {
                "columns": plan.columns, "first": first, "second": second, "curvature": plan.curvature,
                "follows": int(plan.follows), "aspect": plan.aspect or 1.0,
                "middle": float(np.mean(plan.z)), "least_width": plan.least, "most_width": plan.most,
                "begins": plan.begins, "span": plan.span, "layer": contact.law.compliance,
                "near_levels": len(plan.table), "near_first": plan.first,
                "near_step": plan.step, "near_power": plan.power,
            }  # fmt: skip
            z.append(plan.z)
            length.append(plan.length)
            line, key = filled(len(plan.z)), plan.table.tobytes()
            if key not in of_table:
                of_table[key] = {f"{name}_start": sum(map(len, found)) for name, found in blocks.items()}
                spectrum, inverse = pressure_tables(plan.table, line)
                for name, table in (("wave", waves(plan.columns)), ("spectrum", spectrum), ("inverse", inverse)):
                    blocks[name].append(table.ravel())
                spectrum_numbers = max(spectrum_numbers, spectrum[0].size)
                strip_numbers = max(strip_numbers, product_numbers(plan.columns, line, 1))
            values |= of_table[key]
            end_z += [at for at, _ in plan.ends]
            strength += [value for _, value in plan.ends]
        for name, value in values.items():
            per_pair[name].append(value)
    per_pair["end_start"].append(len(end_z))
    far: dict[str, list] = {
        name: [] for name in ("far_start", "far_sectors", "far_columns", "column_knots", "row_knots", "mode_start")
    }
    operators, knots, modes = [np.zeros(0)], [np.zeros(0)], [np.zeros(0)]
    far_of, nodes, fewest_rows = [], LINE, LINE
    for body, _, surface in collector.surfaces:
        if not plans or not isinstance(surface, ContactSurface) or surface.far is None:
            far_of.append(-1)
            continue
        far_of.append(len(far["far_start"]))
        splines, grid = surface.splines, surface.grid
        column_knots = np.zeros(0)
        if not splines.turn:
            column_knots = (splines.theta_knots - grid.theta_start) / grid.pitch
        values = {
            "far_start": sum(map(len, operators)), "far_sectors": len(surface.far.lags),
            "far_columns": grid.columns_per_sector, "column_knots": sum(map(len, knots)),
            "row_knots": sum(map(len, knots)) + len(column_knots), "mode_start": sum(map(len, modes)),
        }  # fmt: skip
        for name, value in values.items():
            far[name].append(value)
        operators.append(surface.far.lags.ravel())
        knots += [column_knots, splines.z_knots]
        modes.append(_spline_modes(body, collector, surface).ravel())
        widest = max((plan.most for plan in plans.values()), default=0.0)
        radius = float(np.min(surface.shape.radius_at(np.asarray(grid.z))))
        columns = min(int(np.ceil(2.0 * widest / (grid.pitch * radius))) + FAR_COLUMNS, splines.turn or grid.columns)
        nodes = max(nodes, filled(max(columns, TAPS) * grid.rows))
        fewest_rows = min(fewest_rows, grid.rows)
    places = max((plan.columns * filled(len(plan.z)) for plan in plans.values()), default=0)
    beside = fill_beside(collector)
    if beside["beside_side"]:
        m.pairs.beside = 1
    collector.fill(
        collector.elements.patches, **beside, count=len(plans), touching=len(beside["beside_side"]), far_nodes=nodes,
        far_columns_most=nodes // fewest_rows, lasting=int(_rows_stand(collector, m)), places=places, **per_pair, **far,
        far_of=far_of, row_z=np.concatenate(z), row_length=np.concatenate(length), end_z=end_z, end_strength=strength,
        spectrum_numbers=spectrum_numbers, strip_numbers=strip_numbers,
        **{name: np.concatenate(found) for name, found in blocks.items()}, far=np.concatenate(operators),
        knot=np.concatenate(knots), mode=np.concatenate(modes),
    )  # fmt: skip


def _rows_stand(collector: Any, m: Model) -> bool:
    """Whether rows of the local compliance may be kept from step to step: all pairs on contact-fixed grids with a
    matrix, which depend only on their own pressures, with constant coefficients.
    """
    alone = not (m.capacity.cells or collector.elements.layers.count or m.modes.dynamic_count or m.pairs.beside)
    return alone and 0 < len(collector.patches) == len(collector.scene.finite_sliding) and not m.pairs.matrix_free


def _spline_modes(body: Body | Ground, collector: Any, surface: ContactSurface) -> Array:
    """Normal displacement (columns rows, modes) of the body's modes, as splines."""
    if collector.local.count(body.index):
        raise InputError(
            f"body {body.name!r}: its local modes have inertia, and a patch of cells needs them quasi-static; use "
            'local_modes="quasi_static", or grid="body_fixed"'
        )
    return np.ascontiguousarray(surface.splines.of_nodes(surface.mode_normal))
