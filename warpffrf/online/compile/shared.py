"""Surfaces that serve several pairs -> device tables of what the pairs do to each other there (`shared_surface`)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from warpffrf_kernels.core.model import Model, Window

from warpffrf.model.contact_surface import ContactSurface
from warpffrf.online.compile.collector import Collector
from warpffrf.online.compile.compliance_tables import hat_gram, response_table

SPARE = 2  # columns that a window may have moved since the sources were counted


def neighbours(collector: Collector) -> list[list[int]]:
    """Of every surface number (two for each pair) those that are the same flexible surface in other pairs."""
    own = list(zip(collector.places, collector.surfaces, strict=True))
    return [
        [t for t, (other, _) in enumerate(own) if t != s and other == place and isinstance(surface, ContactSurface)]
        for s, (place, (_, surface)) in enumerate(own)
    ]


def serves_several(m: Model) -> bool:
    """Whether any surface of the model serves more than one pair."""
    return bool(m.shared.start.numpy()[-1])


def surface_reaches(collector: Collector, window: Window) -> list[int]:
    """Grid columns on each side of a block that the compliance tables of every surface hold: what a pair sees of its
    own, and half a turn where other pairs load the same surface."""
    near = window.columns + window.second_columns + window.stencil_columns
    half = max(window.half, window.second_half) + SPARE
    reaches = []
    for (_, surface), others in zip(collector.surfaces, neighbours(collector), strict=True):
        turn = 0
        if others and isinstance(surface, ContactSurface):
            sectors = len(surface.lags)
            full = sectors > 1 or surface.grid.periodic
            turn = sectors * surface.lags.shape[1] // surface.grid.rows if full else 0
        reaches.append(max(near, turn // 2 + half) if turn else near)
    return reaches


def fill_shared(collector: Collector, m: Model, reaches: Sequence[int]) -> None:
    """Neighbours of the surfaces and the tables between them; `reaches`: of `surface_reaches`."""
    found = neighbours(collector)
    collector.notes.extend(_apart(collector))
    start = np.cumsum([0, *map(len, found)])
    tables: list[np.ndarray] = []
    begins: dict[tuple, int] = {}
    at = []
    for s, others in enumerate(found):
        surface = collector.surfaces[s][1]
        if not isinstance(surface, ContactSurface):
            continue  # a rigid one has no neighbours
        for t in others:
            key = (collector.places[s], s % 2, t % 2)
            if key not in begins:
                begins[key] = sum(map(len, tables))
                tables.append(_between(surface, s % 2, t % 2, reaches[s]))
            at.append(begins[key])
    collector.fill(
        m.shared, start=start, neighbour=[t for others in found for t in others], table=at,
        compliance=np.concatenate([np.zeros(0), *tables]),
    )  # fmt: skip


def _apart(collector: Collector) -> list[str]:
    """A note for each body that is loaded on two surfaces: local modes of one do not move the other."""
    notes = []
    for body in collector.scene.bodies:
        names = sorted({p[1] for p, (_, s) in zip(collector.places, collector.surfaces, strict=True)
                        if p[0] == body.index and isinstance(s, ContactSurface)})  # fmt: skip
        if len(names) > 1:
            notes.append(
                f"body {body.name!r}: its contact surfaces {', '.join(names)} feel each other through its "
                f"{body.mode_count} global modes only"
            )
    return notes


def _between(surface: ContactSurface, reading: int, loading: int, reach: int) -> np.ndarray:
    """Flat table of the displacement that a pair reads under what another loads, each 0 weakly by hats (of a first
    surface), 1 at nodes (of a second): M D M, M D, D M or D."""
    D, M = surface.lags, hat_gram(surface)
    turned = len(D) > 1
    if turned:  # circulant: product by product over the harmonics
        D, M = np.fft.rfft(D, axis=0), np.fft.rfft(M, axis=0)
    if reading == 0:
        D = M @ D
    if loading == 0:
        D = D @ M
    if turned:
        D = np.fft.irfft(D, n=len(surface.lags), axis=0)
    return response_table(surface, D, reach).ravel()
