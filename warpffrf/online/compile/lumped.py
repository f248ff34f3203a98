"""Lumped contacts of a scene -> device tables of their laws and points."""

from __future__ import annotations

import numpy as np

from warpffrf.model.friction import cubic_pieces
from warpffrf.model.rigid_surface import RigidSurface
from warpffrf.online.compile.collector import Collector


def fill_lumped(collector: Collector) -> None:
    """Laws and points. Raises `InputError` for surfaces for which a law is not valid."""
    contacts = collector.scene.lumped_contacts
    laws = [contact.approach() for contact in contacts]
    tables = [_with_energy(law.table) for law in laws]
    counts = [max(len(law.z), 1) for law in laws]
    none = [np.zeros(0)]
    forms = [surface.form if isinstance(surface, RigidSurface) else None for _, _, surface in collector.surfaces]
    pieces = [np.zeros((0, 4)) if form is None else form.pieces for form in forms]
    slips = [cubic_pieces(c.friction, c.label) if c.friction.breaks else np.zeros((0, 5)) for c in contacts]
    collector.fill(
        collector.elements.lumped, count=len(contacts), places=sum(counts), first=collector.lumped_sides[::2],
        second=collector.lumped_sides[1::2],
        stiffness=[law.stiffness for law in laws], exponent=[law.exponent for law in laws],
        table_start=np.cumsum([0, *map(len, tables)])[:-1], table_count=[len(table) for table in tables],
        table=np.concatenate([np.zeros((0, 3)), *tables]), damping=[contact.law.chi for contact in contacts],
        friction=[contact.friction.static_coefficient for contact in contacts],
        slip_velocity=[contact.friction.creep_limit for contact in contacts], shear=[law.shear for law in laws],
        slip_start=np.cumsum([0, *map(len, slips)])[:-1], slip_count=[len(pieces) for pieces in slips],
        slip_piece=np.concatenate([np.zeros((0, 5)), *slips]),
        contact=np.repeat(np.arange(len(contacts)), counts),
        lamina=np.repeat([int(len(law.z) > 0) for law in laws], counts),
        z=np.concatenate([*none, *(law.z if len(law.z) else [0.0] for law in laws)]),
        drop=np.concatenate([*none, *(law.drop if len(law.z) else [0.0] for law in laws)]),
        share=np.concatenate([*none, *(np.full(n, 1.0 / n) for n in counts)]),
        form_start=np.cumsum([0, *map(len, pieces)])[:-1], form_count=[len(piece) for piece in pieces],
        form_begin=[0.0 if form is None else form.start for form in forms],
        form_piece=np.concatenate([np.zeros((0, 4)), *pieces]),
    )  # fmt: skip
    _fill_moments(collector, np.cumsum([0, *counts]))


def _fill_moments(collector: Collector, start: np.ndarray) -> None:
    """Tables of the points with rolling or pivoting resistance; start: first point of each contact."""
    places, found = [], []
    for i, contact in enumerate(collector.scene.lumped_contacts):
        if (moments := contact.moments()) is not None:
            places += range(start[i], start[i + 1])
            found += [moments] * int(start[i + 1] - start[i])
    number = np.full(start[-1], -1)
    number[places] = np.arange(len(places))
    collector.fill(collector.elements.lumped, moment=number)
    names = ("bound", "bound_power", "slope", "slope_power")
    numbers = {name: np.array([[getattr(m, name) for m in both] for both in found]).reshape(-1, 2) for name in names}
    collector.fill(collector.elements.moments, count=len(places), place=places, **numbers)


def _with_energy(table: np.ndarray) -> np.ndarray:
    """Approach, force (n, 2) and the energy up to there, of piecewise linear laws: (n, 3)."""
    if not len(table):
        return np.zeros((0, 3))
    pieces = 0.5 * (table[1:, 1] + table[:-1, 1]) * np.diff(table[:, 0])
    return np.column_stack([table, np.concatenate([[0.0], np.cumsum(pieces)])])
