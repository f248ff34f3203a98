r"""Friction on cells that move with the patch -> device tables (kernels of `rolling`): half-space displacements by
tractions on cells, and the tangential part of far fields.

Of both bodies, x along e_theta and z along t_z of the first surface, per unit traction of a cell on the first body, for
e = u_A - u_B (`warpffrf.model.half_space`),

    e_1 by tau_1: sum ((1 - nu) J + nu J_xx)/(2 pi G),      e_2 by tau_2: the same with J_zz,
    e_1 by tau_2: sum nu J_xz/(2 pi G),                     e by p: -kappa (J_x, J_z),
    kappa = (1 - 2 nu)/(4 pi G) of A less that of B,

and tractions open the gap by the transpose of the last. Everything is multiplied by the area of the receiving cell, and
averaged with the transposed influence, which makes it symmetric where rows are unequal. Tables extend RINGS strips, and
rows where these move, beyond the cells: cells that pass the patch carry their history along (`rolling.history`).

At a free end a force along the edge has its mirror image, which leaves that face without shear, and a force across it
an image of the same sign, as if that face were not loaded by it; their effect in the other direction belongs to two
different problems and is omitted. There is no quarter space for tractions.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from warpffrf.model.contact import Contact
from warpffrf.model.half_space import across, along_x, along_z, rectangle, toward_x, toward_z
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.online.compile.patches.plan import OnMeridian, PatchPlan, bodies_under
from warpffrf.online.compile.patches.tables import filled
from warpffrf.online.compile.strips import StripTables
from warpffrf_kernels.core.model import Model
from warpffrf_kernels.rolling.shear import COUPLED_KINDS, KINDS, RINGS

Array = np.ndarray
UNLIKE = 1e-9  # of the larger coupling of both half-spaces: smaller differences are round-off


def fill_rolling(collector: Any, m: Model) -> None:
    """Near fields of all pairs with friction on patches, and tangential far fields."""
    contacts = collector.scene.finite_sliding
    rolling = {i: plan for i, plan in collector.patches.items() if contacts[i].friction.acts}
    per_pair: dict[str, list[int]] = {"ring_rows": [], "coupled": [], "shear_start": []}
    tables, numbers, cells = [np.zeros(0)], 0, 0
    strips = StripTables.of(contacts, rolling)
    for i, contact in enumerate(contacts):
        per_pair["shear_start"].append(sum(map(len, tables)))
        plan = rolling.get(i)
        if plan is None:
            per_pair["ring_rows"].append(0)
            per_pair["coupled"].append(0)
            strips.skip()
            continue
        bodies = bodies_under(contact)
        rings = RINGS if plan.follows else 0
        coupled = is_coupled(bodies)
        table = shear_levels(plan, bodies, contact.a.surface.shape.side, coupled)
        tables.append(table.ravel())
        strips.add(table, plan.columns, rings, filled(len(plan.z)))
        per_pair["ring_rows"].append(rings)
        per_pair["coupled"].append(int(coupled))
        numbers = max(numbers, table[0].size)
        cells = max(cells, (plan.columns + 2 * RINGS) * (len(plan.z) + 2 * rings))
    far: dict[str, list[int]] = {"tangent_start": [], "sheared_start": [], "turned_start": []}
    tangent, sheared, turned = [np.zeros(0)], [np.zeros(0)], [np.zeros(0)]
    for _, _, surface in collector.surfaces:
        if not collector.patches or not isinstance(surface, ContactSurface) or surface.far is None:
            continue
        part = surface.far.tangential
        present = bool(rolling) and part is not None
        for name, found in zip(far, (tangent, sheared, turned), strict=True):
            far[name].append(sum(map(len, found)) if present else -1)
        if part is not None and present:
            tangent.append(np.ascontiguousarray(surface.mode_tangent_splines).ravel())
            sheared.append(np.ascontiguousarray(part.lags_tt).ravel())
            turned.append(np.ascontiguousarray(part.lags_nt).ravel())
    collector.notes.extend(_apart(contacts, rolling))
    collector.fill(
        collector.elements.rolling, count=len(rolling), shear_numbers=numbers, ring_cells=cells, **per_pair, **far,
        shear=np.concatenate(tables), tangent=np.concatenate(tangent), sheared=np.concatenate(sheared),
        turned=np.concatenate(turned), **strips.arrays(),
    )  # fmt: skip


def _apart(contacts: list[Contact], rolling: Mapping[int, PatchPlan]) -> list[str]:
    """Notes on bodies with several patches with friction, whose tractions would influence each other by local
    modes.
    """
    on_body: dict[str, list[str]] = {}
    for i in rolling:
        for port in contacts[i].ports:
            if not port.rigid and not port.surface.half_space:
                on_body.setdefault(port.body.name, []).append(repr(contacts[i].name))
    return [
        f"body {body!r}: its contacts {', '.join(names)} have friction on contact-fixed grids, and the "
        "influence of the tractions of one on the others by its local modes is neglected; global modes include a part "
        "of it (more modes=)"
        for body, names in on_body.items()
        if len(names) > 1
    ]


def coupling_of(body: OnMeridian) -> float:
    """(1 - 2 nu)/(4 pi G) [1/Pa] of a body."""
    far = body.far
    return (1.0 - 2.0 * far.poisson_ratio) * (1.0 + far.poisson_ratio) / (2.0 * np.pi * far.youngs_modulus)


def is_coupled(bodies: list[OnMeridian]) -> bool:
    """Whether the half-spaces of a pair differ, so that pressures displace them tangentially against each other."""
    parts = [coupling_of(body) * body.way for body in bodies]
    return abs(sum(parts)) > UNLIKE * max(abs(part) for part in parts)


def shear_levels(plan: PatchPlan, bodies: list[OnMeridian], side: float, coupled: bool) -> Array:
    """Tables (levels, kinds, columns + RINGS, loaded rows, receiving rows, padded) over W^power, as
    `PatchPlan.table`; `side` of the first surface.
    """
    levels = [0.0] if plan.follows else plan.first + plan.step * np.arange(len(plan.table))
    found = [
        shear_table(plan.columns, float(np.exp(x)), plan.along.s, plan.along.length, bodies, side, follows=plan.follows,
                    coupled=coupled) / np.exp(plan.power * x)
        for x in levels
    ]  # fmt: skip
    return np.stack(found)


def shear_table(
    columns: int, width: float, z: Array, length: Array, bodies: list[OnMeridian], side: float, *, follows: bool,
    coupled: bool,
) -> Array:  # fmt: skip
    """Weak displacements (kinds, columns + RINGS, loaded rows, receiving rows, padded) [m^3/Pa] of the module.

    width W [m]; z, length (rows,) [m] on the first surface; `follows`: rows are equal, and there are RINGS more on
    either side of the receiving ones.
    """
    strip = 2.0 * width / columns
    rings = RINGS if follows else 0
    more = np.arange(1, rings + 1)
    seen = np.concatenate([z[0] - more[::-1] * length[0], z, z[-1] + more * length[-1]])
    size = np.concatenate([np.full(rings, length[0]), length, np.full(rings, length[-1])])
    x = strip * np.arange(columns + RINGS)[:, None, None]
    loaded, its = z[None, :, None], length[None, :, None]
    at, own = seen[None, None, :], size[None, None, :]
    kinds = COUPLED_KINDS if coupled else KINDS
    line = filled(max(len(seen), rings + filled(len(z))))
    found = np.zeros((kinds, columns + RINGS, len(z), line))
    view = found[..., : len(seen)]

    def weak(integral: Any, offset: Array) -> Array:
        """Mean of the influences in both directions, times the areas of both."""
        one = integral(x, offset, strip, its) * own
        other = integral(x, offset, strip, own) * its
        return 0.5 * strip * (one + other)

    def add(offset: Array, scale: float, nu: float, straight: bool) -> None:
        j = weak(rectangle, offset)
        view[0] += scale * ((1.0 - nu) * j + nu * weak(along_x, offset))
        view[1] += scale * ((1.0 - nu) * j + nu * weak(along_z, offset))
        if straight:
            view[2] += side * scale * nu * weak(across, offset)

    for body in bodies:
        nu = body.far.poisson_ratio
        scale = (1.0 + nu) / (np.pi * body.far.youngs_modulus)  # 1/(2 pi G)
        kappa = body.way * coupling_of(body)
        add(at - loaded, scale, nu, True)
        if coupled:
            view[3] -= side * kappa * weak(toward_x, at - loaded)
            view[4] -= kappa * weak(toward_z, at - loaded)
        for end in () if follows else body.far.ends:
            place, inward = (end.z - body.offset) / body.sign, int(body.sign) * end.side
            a, b = (np.maximum(inward * (place - v), 0.0) for v in (at, loaded))
            add(a + b, scale, nu, False)
            if coupled:
                view[3] -= side * kappa * weak(toward_x, a + b)
    return found
