"""Local coordinates of the contact surfaces of a scene.

A surface has one system of them for all its pairs, so that each pair includes the loads of the others. The surfaces of
one body that are in contact share one system, so that each includes the loads on the others. A note states where that
is impossible: if a body's file does not contain the compliance between its surfaces, and with local="hht",
as the mass of local modes is known for each surface alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from references.monolithic.core.equations import LocalData
from references.monolithic.core.local_coordinates import (
    Loaded,
    LocalCoordinates,
    dynamic_coordinates,
    static_coordinates,
)
from warpffrf.model.errors import InputError
from warpffrf.model.reduced.local_modes import leanings

Place = tuple[int, str]  # number of the body, name of the surface


@dataclass(frozen=True, eq=False)
class LocalSystems:
    """Coordinates of each surface in contact and the number of its system, `system_of`; of each pair the numbers of its
    two surfaces, None for a rigid one; of each film the number of its first surface; `notes` for the history."""

    coordinates: list[LocalCoordinates]
    system_of: list[int]
    surfaces: list[tuple[int, int | None]]
    films: list[int]
    notes: list[str]

    @property
    def counts(self) -> list[int]:
        """Coordinates of each system."""
        return [c.count for c in self._first()]

    def data(self) -> LocalData:
        """All systems as one, one behind the other."""
        parts = ("mass", "damping", "stiffness")
        return LocalData(*(np.concatenate([np.zeros(0), *(getattr(c, x) for c in self._first())]) for x in parts))

    def _first(self) -> list[LocalCoordinates]:
        """The coordinates of the first surface of each system: mass, damping and stiffness are the system's."""
        return [self.coordinates[self.system_of.index(s)] for s in range(len(set(self.system_of)))]


def local_systems(scene: Any, local: str, given: dict[tuple[str, str], Any], zeta: float) -> LocalSystems:
    """The systems of `scene` for the treatment `local`; with "hht" the modes `given` by (body, surface) and their
    damping ratio `zeta`. Raises `InputError` for dynamics with friction, and as the coordinates do."""
    ports: dict[Place, Any] = {}
    rough: set[Place] = set()
    sides: list[Place | None] = []
    for contact in scene.finite_sliding:
        for port in (contact.a, contact.b):
            place = None if port.rigid else (port.body.index, port.name)
            sides.append(place)
            if place is not None:
                ports.setdefault(place, port)
                rough |= {place} if contact.friction.acts else set()
    oiled = [(film.a.body.index, film.a.name) for film in scene.films]
    for place, film in zip(oiled, scene.films, strict=True):
        ports.setdefault(place, film.a)
    lean = leanings(scene.finite_sliding)
    groups, notes = _groups(ports, local)
    coordinates: dict[Place, LocalCoordinates] = {}
    for group in groups:
        first = ports[group[0]]
        names = ", ".join(name for _, name in group)
        label = f"surface {first.label}" if len(group) == 1 else f"body {first.body.name!r}, surfaces {names}"
        if local == "quasi_static":
            loaded = [Loaded(place[1], place in rough, lean.get(place, 0.0)) for place in group]
            found = static_coordinates(first.body.reduced, loaded, label)
        elif rough & set(group):
            raise InputError(
                f"{label}: friction is there for quasi-static local modes only; use local='quasi_static', or "
                "friction=0.0"
            )
        else:
            modes = given.get((first.body.name, first.name))
            found = [dynamic_coordinates(first.surface, modes, zeta, label)]
        coordinates |= dict(zip(group, found, strict=True))
    number = {place: i for i, place in enumerate(ports)}
    of_place = {place: i for i, group in enumerate(groups) for place in group}
    of = [None if place is None else number[place] for place in sides]
    return LocalSystems(
        [coordinates[place] for place in ports],
        [of_place[place] for place in ports],
        [(a, b) for a, b in zip(of[::2], of[1::2], strict=True) if a is not None],
        [number[place] for place in oiled],
        notes,
    )


def _groups(ports: dict[Place, Any], local: str) -> tuple[list[list[Place]], list[str]]:
    """Surfaces that share one system, in the order of their first pair, and notes on those that cannot."""
    by_body: dict[int, list[Place]] = {}
    for place in ports:
        by_body.setdefault(place[0], []).append(place)
    groups: list[list[Place]] = []
    notes = []
    for group in by_body.values():
        body, names = ports[group[0]].body, [name for _, name in group]
        known = all(body.reduced.cross_compliance(a, b) is not None for a, b in combinations(names, 2))
        if len(group) == 1 or (known and local == "quasi_static"):
            groups.append(group)
            continue
        groups += [[place] for place in group]
        why = f"local={local!r} has the mass of local modes of each surface alone"
        if not known:
            why = "the reduced body holds no compliance between them; reduce it again"
        notes.append(
            f"monolithic reference: contact surfaces {', '.join(names)} of body {body.name!r} feel each other through "
            f"its {body.mode_count} global modes only: {why}"
        )
    return groups, notes
