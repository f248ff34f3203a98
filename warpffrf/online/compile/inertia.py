"""Modes that carry inertia, and stiffening by loads -> tables (`warpffrf_kernels.bodies.inertia`)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from warpffrf.model.bodies import Body
from warpffrf.model.reduced.body import ReducedBody
from warpffrf.model.reduced.inertia import PRODUCTS
from warpffrf.online.compile.collector import Collector
from warpffrf_kernels.core.model import Model


def fill_inertia(collector: Collector, m: Model) -> None:
    """Retained modes, and the inertia tables of those that carry inertia."""
    plans = collector.inertia.bodies
    carrying = [plan.count for plan in plans]
    counts = retained_modes(collector)
    starts = np.cumsum([0, *counts])
    modal = np.cumsum([0, *collector.mode_counts])
    dense_of = np.full(modal[-1], -1)
    dense_body, dense_mode, first, tables = [], [], [np.zeros((0, 6))], [np.zeros(0)]
    for b, (plan, n) in enumerate(zip(plans, counts, strict=True)):
        dense_body += [b] * n
        dense_mode += list(range(modal[b], modal[b] + n))
        dense_of[modal[b] : modal[b] + n] = np.arange(starts[b], starts[b] + n)
        slopes = np.zeros((n, 6))
        if plan.terms is not None and plan.count:
            J1, J2, G = plan.terms.kept(plan.level, stiffened=plan.stiffening is not None)
            slopes[: plan.count] = np.stack([J1[:, i, j] for i, j in PRODUCTS], axis=1)
            channels = [J2[:, :, i, j] for i, j in PRODUCTS]
            channels += [G[:, :, c].T for c in range(3)]  # line j, column i
            tables.append(np.stack(channels).ravel())
        first.append(slopes)
    collector.fill(
        m.dense, count=int(starts[-1]), body=dense_body, mode=dense_mode, first=np.concatenate(first),
        table=np.concatenate(tables),
    )  # fmt: skip
    collector.fill(m.modes, dense_of=dense_of)
    collector.fill(
        m.bodies, dense_start=starts[:-1], dense_count=counts, inertia_count=carrying,
        inertia_start=np.cumsum([0] + [9 * n * n for n in carrying])[:-1],
    )  # fmt: skip
    _fill_membrane(collector, m)
    collector.notes.extend(collector.inertia.notes)


def _fill_membrane(collector: Collector, m: Model) -> None:
    """Forms of the membrane energy of bodies that are stiffened, body by body."""
    forms = []
    for plan in collector.inertia.bodies:
        found = None if plan.stiffening is None else plan.stiffening.membrane
        forms.append(np.zeros((0, plan.count, plan.count)) if found is None else np.asarray(found))
    ranks, counts = [len(L) for L in forms], [L.shape[1] for L in forms]
    lines = np.concatenate([[0], np.cumsum(np.repeat(counts, ranks))]).astype(int)
    entries = np.concatenate([[0], np.cumsum(np.repeat(np.square(counts), ranks))]).astype(int)
    collector.fill(
        m.membrane, count=sum(ranks), lines=int(lines[-1]), body=np.repeat(np.arange(len(forms)), ranks),
        table_start=entries[:-1], line_start=lines[:-1],
        table=np.concatenate([np.zeros(0), *(L.ravel() for L in forms)]),
    )  # fmt: skip
    collector.fill(m.bodies, square_start=np.cumsum([0, *ranks]))


def retained_modes(collector: Collector) -> list[int]:
    """Number of retained modes of each body: those that carry inertia; all global ones of a body that is loaded on
    several surfaces, as those of a sheet, by which its pairs influence each other about as much as themselves; and all
    global ones of a body with a film or a small-sliding contact, which have blocks of their own.
    """
    loads = Counter(body.index for body, _, _ in (collector.surfaces[s] for s in set(collector.sides)))
    scene = collector.scene
    blocks = {port.body.index for item in (*scene.films, *scene.small_sliding) for port in item.ports}
    return [
        body.mode_count if loads[body.index] > 1 or body.index in blocks else plan.count
        for body, plan in zip(collector.scene.bodies, collector.inertia.bodies, strict=True)
    ]


def mode_reach(reduced: ReducedBody) -> np.ndarray:
    """Largest displacement of each mode (m,) [m per unit coordinate], on the display surface and at interfaces."""
    fields = [reduced.surface.modes, *(interface.modes[:, None, :3] for interface in reduced.interfaces.values())]
    largest = [np.linalg.norm(np.asarray(modes), axis=-1).max(axis=1, initial=0.0) for modes in fields]
    return np.max(largest, axis=0)


def fill_stiffening(collector: Collector, m: Model) -> bool:
    """Tables of stiffening by interface loads; True where there are any."""
    start = np.full(max(len(collector.interfaces), 1), -1)
    bodies = np.full(max(len(collector.interfaces), 1), -1)
    tables, size = [], 0
    for (b, name), f in collector.interfaces.items():
        bodies[f] = b
        plan = collector.inertia.bodies[b]
        stiffening = plan.stiffening
        if stiffening is not None:
            K = np.asarray(stiffening.interfaces[name])
            start[f], size = size, size + K.size
            tables.append(K.ravel())
    collector.fill(
        m.interfaces, count=len(collector.interfaces), body=bodies, stiffening_start=start,
        stiffening=np.concatenate([np.zeros(0), *tables]),
    )  # fmt: skip
    return bool(tables)


def dense_columns(m: Model, collector: Collector, bodies: Sequence[Body]) -> list[int]:
    """Retained columns of the retained modes of `bodies`."""
    starts = np.cumsum([0, *retained_modes(collector)])
    indices = dict.fromkeys(body.index for body in bodies)
    return [6 * m.bodies.count + int(d) for i in indices for d in range(starts[i], starts[i + 1])]
