"""Contact pairs and their surfaces -> device tables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse.csgraph import connected_components

from warpffrf.model.bodies import Body, Ground
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.model.rigid_surface import RigidSurface
from warpffrf.online.compile.capacity import slots_of
from warpffrf.online.compile.collector import Collector, Pair
from warpffrf.online.compile.inertia import dense_columns
from warpffrf.online.compile.points import fill_points
from warpffrf.online.compile.sampling_rules import on_stations, rule_of
from warpffrf.online.compile.surfaces import NO_NODES
from warpffrf.online.compile.windows import (
    MAX_HALF_WINDOW,
    REACH_SPARE,
    ROUND_OFF,
    STENCIL_SPARE,
    Extent,
    between_axes,
    half_window,
    second_reach,
)
from warpffrf_kernels.core import control as k
from warpffrf_kernels.core.model import AT_POINTS, LINE_OF_CENTRES, PATCH, Model
from warpffrf_kernels.kinematics.line_of_centres import GUARD

LEAST_CROWN = 1.0  # radii: below, the drop of the crown along the width is not small
SOFT, SOFT_STRAIN = 2e8, 0.3  # Pa, of elastomers: half of their default window over the effective radius
MATRIX_CELLS = 400  # of a patch: above, iterations cost less than factors, even where these are kept (bench/README.md)
SKEW = 0.02  # rad between the axes: the line of centres drops terms of the order of its square, 4e-4


def fill_pairs(collector: Collector, m: Model) -> None:
    """Quadrature, windows and stencils of the contacts, and the retained columns that their gaps depend on."""
    _fill_quadrature(collector, m)
    pairs = collector.pairs()
    turned = [between_axes(pair.contact) for pair in pairs]
    families = [
        PATCH if i in collector.patches else family_of(collector, pair, angle)
        for i, (pair, angle) in enumerate(zip(pairs, turned, strict=True))
    ]
    plans = [collector.patches.get(i) for i in range(len(pairs))]
    halves = [
        _half_window(collector, pair, angle) if plan is None else plan.columns // 2
        for pair, angle, plan in zip(pairs, turned, plans, strict=True)
    ]
    half = max(halves, default=1)
    rows = second_half = second_rows = pair_modes = slots = limit = 1
    stencil = (1, 1)
    coupled: list[list[int]] = []
    for pair, family, angle, own, plan in zip(pairs, families, turned, halves, plans, strict=True):
        contact, body_a, a, body_b, b = pair
        if plan is not None:
            rows = max(rows, len(plan.z))
            second_rows = max(second_rows, NO_NODES)
            pair_modes = max(pair_modes, sum(collector.mode_counts[body.index] for body in _moving(body_a, body_b)))
            cells = plan.columns * len(plan.z)
            limit += cells
            slots += slots_of(contact, cells)
            coupled.append(_coupled_columns(collector, m, body_a, body_b))
            continue
        rows = max(rows, a.grid.rows)
        second_rows = max(second_rows, b.grid.rows if isinstance(b, ContactSurface) else NO_NODES)
        # all contacts share the widest window, so each needs the columns opposite it
        if family == LINE_OF_CENTRES and isinstance(b, ContactSurface):
            _require_common_width(collector, contact, a, b)
            side, *grid_node = _reach_on_second(a, b, half)
        else:
            side, *grid_node = second_reach(b, Extent.of(a), Extent.of(b), angle, half)
        second_half = max(second_half, side)
        stencil = (max(stencil[0], grid_node[0]), max(stencil[1], grid_node[1]))
        pair_modes = max(pair_modes, sum(collector.mode_counts[body.index] for body in _moving(body_a, body_b)))
        grid_nodes = (2 * min(own, MAX_HALF_WINDOW) + 1) * a.grid.rows
        most = grid_nodes if contact.capacity is None else min(contact.capacity, (2 * own + 1) * a.grid.rows)
        limit += most
        slots += slots_of(contact, most)
        coupled.append(_coupled_columns(collector, m, body_a, body_b))
    second_half = max(second_half, stencil[0])  # the window of a rigid surface also contains a stencil
    collector.fill(
        m.window, half=half, columns=2 * half + 1, rows=rows, grid_nodes=(2 * half + 1) * rows,
        second_half=second_half, second_columns=2 * second_half + 1, nodes=(2 * second_half + 1) * second_rows,
        stencil_columns=stencil[0], stencil_rows=stencil[1],
    )  # fmt: skip
    m.capacity.slots, m.capacity.slot_limit = slots, limit
    most_coupled = max([len(c) for c in coupled], default=1)
    if most_coupled > k.MOST_COUPLED_COLUMNS:
        raise InputError(
            f"scene: the gap of a contact pair depends on {most_coupled} retained columns, at most "
            f"{k.MOST_COUPLED_COLUMNS}: fewer modes with inertia terms, see the inertia levels of its bodies"
        )
    if stencil[0] * stencil[1] > k.MOST_STENCIL:
        raise InputError(
            f"scene: a node of a contact's first grid overlaps {stencil[0]} x {stencil[1]} nodes of the second, at "
            f"most {k.MOST_STENCIL}: swap the two surfaces, or give the second a coarser grid, ContactGrid(spacing=)"
        )
    matrix = [int(plan is None or plan.columns * len(plan.z) <= MATRIX_CELLS) for plan in plans]
    collector.fill(
        m.pairs, first=collector.sides[::2], second=collector.sides[1::2], family=families, group=_groups(pairs),
        matrix=matrix, dense=int(any(matrix)), matrix_free=int(not all(matrix)),
        most_modes=pair_modes, coupled_capacity=most_coupled, coupled_count=[len(c) for c in coupled],
        coupled=[c + [0] * (most_coupled - len(c)) for c in coupled],
    )  # fmt: skip
    rules = [
        None if family == PATCH else rule_of(pair.contact, collector.settings.theta_points, collector.settings.z_points)
        for pair, family in zip(pairs, families, strict=True)
    ]
    fill_points(collector, m, [pair.a for pair in pairs], rules)


def _groups(pairs: Sequence[Pair]) -> np.ndarray:
    """Number of the group of each pair: pairs on one body are in one; the ground connects none."""
    bodies = [{body.index for body in _moving(pair.body_a, pair.body_b)} for pair in pairs]
    shared = [[bool(one & other) for other in bodies] for one in bodies]
    return connected_components(np.array(shared).reshape(len(pairs), len(pairs)), directed=False)[1]


def family_of(collector: Collector, pair: Pair, turned: float) -> int:
    """LINE_OF_CENTRES for two flexible cylinders or crowned cylinders, the material inside, with axes nearly parallel:
    fast, and exact there; AT_POINTS for all others, and where the contact asks for it."""
    asked = collector.settings.force_points or pair.contact.kinematics == "closest_point"
    if asked or isinstance(pair.b, RigidSurface) or turned > SKEW:
        return AT_POINTS
    if not on_stations(pair.contact, collector.settings.z_points):
        return AT_POINTS
    for profile in (pair.a.shape.profile(), pair.b.shape.profile()):
        plain = not profile.planar and profile.side > 0.0 and profile.tangent == 0.0 and not len(profile.coefficients)
        if not plain or not (profile.crown == 0.0 or profile.crown > LEAST_CROWN * profile.radius):
            return AT_POINTS
    return LINE_OF_CENTRES


def _require_common_width(collector: Collector, contact: Contact, a: ContactSurface, b: ContactSurface) -> None:
    """Raises `InputError` where the two surfaces face each other over a width in which the first has no sampling point
    along its axis: the contact would never act."""
    ends = b.shape.axis_point + np.outer([b.grid.z[0], b.grid.z[-1]], b.shape.e_a)
    places = (contact.a.body.to_user(contact.b.body.to_world(ends)) - a.shape.axis_point) @ a.shape.e_a
    z = np.asarray(a.grid.z)
    low, high = max(places.min(), z[0]), min(places.max(), z[-1])
    x, _ = np.polynomial.legendre.leggauss(collector.settings.z_points)
    stations = z[:-1, None] + 0.5 * (x + 1.0) * np.diff(z)[:, None]
    if high > low and not np.any((stations >= low) & (stations <= high)):
        raise InputError(
            f"contact {contact.name!r}: {contact.a.label} and {contact.b.label} face each other over only "
            f"{high - low:.3g} m, less than the rows of the first one's contact grid resolve; give it finer rows there"
        )


def _fill_quadrature(collector: Collector, m: Model) -> None:
    count = collector.settings.z_points
    x, weight = np.polynomial.legendre.leggauss(count)
    collector.fill(m.quadrature, z_points=count, z_abscissa=0.5 * (x + 1.0), z_weight=0.5 * weight)


def _moving(*bodies: Body | Ground) -> list[Body]:
    """Those that are not the ground."""
    return [body for body in bodies if isinstance(body, Body)]


def _coupled_columns(collector: Collector, m: Model, body_a: Body | Ground, body_b: Body | Ground) -> list[int]:
    """Retained columns that the gap of a contact depends on: of its bodies, their modes with inertia terms, and rows
    that end on one of their flexible interfaces. For the ground, those of A are used, with a gradient of zero."""
    moving = _moving(body_a, body_b)
    own = [body.index for body in moving]
    rigid = [6 * index + c for index in (own if len(own) == 2 else 2 * own) for c in range(6)]
    markers = [body in own and interface >= 0 for body, interface, *_ in collector.markers]
    ends = zip(collector.rows.a, collector.rows.b, strict=True)
    touching = [m.retained.row_offset + r for r, (a, b) in enumerate(ends) if markers[a] or markers[b]]
    return rigid + dense_columns(m, collector, moving) + touching


def _half_window(collector: Collector, pair: Pair, turned: float) -> int:
    contact, _, a, _, b = pair
    if contact.capacity is not None:
        return max(int(np.ceil(contact.capacity / a.grid.rows / 2.0)) + int(GUARD), 2 * int(GUARD) + 1)
    strain = max(collector.settings.window_strain, SOFT_STRAIN if _soft(contact) else 0.0)
    flat = Extent.of(a, flattest=True), Extent.of(b, flattest=True)
    half, wanted = half_window(a, *flat, turned, strain)
    if half < wanted and half == MAX_HALF_WINDOW:
        collector.notes.append(
            f"contact {contact.name!r}: window capped at {2 * MAX_HALF_WINDOW + 1} columns of {2 * wanted + 1}; "
            "a coarser contact grid (ContactGrid(spacing=)) would do, or give capacity="
        )
    return half


def _soft(contact: Contact) -> bool:
    """Whether a body of the pair is of a material that is compressed far beyond the range of metals."""
    found = [
        port.body.reduced.provenance.get("contact_materials", {}).get(port.name)
        for port in contact.ports
        if not port.rigid
    ]
    return any(material and material["youngs_modulus"] < SOFT for material in found)


def _reach_on_second(a: ContactSurface, b: ContactSurface, half_window: int) -> tuple[int, int, int]:
    """Columns of the second grid on each side that face the window, and columns and rows under a node, of two bodies of
    revolution: opposite xi lies asin(R_A sin(xi)/R_B)."""
    xi = min((half_window + 1.5) * a.grid.pitch, 0.5 * np.pi)
    angle = np.arcsin(min(a.shape.radius * np.sin(xi) / b.shape.radius, 1.0))
    ratio = a.grid.pitch * a.shape.radius / (b.grid.pitch * b.shape.radius)
    columns = int(np.ceil(2.0 * ratio * REACH_SPARE - ROUND_OFF)) + STENCIL_SPARE
    return int(np.ceil(angle / b.grid.pitch + 0.5)) + STENCIL_SPARE, columns, _row_reach(a.grid.z, b.grid.z)


def _row_reach(z_a: np.ndarray, z_b: np.ndarray) -> int:
    """Largest number of rows of the second grid under a node of the first, at any axial offset."""
    widest = max(z_a[min(i + 1, len(z_a) - 1)] - z_a[max(i - 1, 0)] for i in range(len(z_a)))
    return min(len(z_b), int(np.ceil(widest / np.min(np.diff(z_b)) - ROUND_OFF)) + STENCIL_SPARE)
