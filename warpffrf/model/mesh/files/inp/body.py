"""One body of a deck, and what the names and numbers of sets mean for it.

A body is an instance with its part, a part without an instance, or a deck without parts. Two levels of names reach it:

- its *own* scopes (what stands inside the instance, then the part), where a number is one of its nodes or elements;
- the *assembly*, where numbers belong to the instance of `INSTANCE=`, and `instance.name` or `instance.number` reaches
  into an instance.

Sets may name other sets, defined before or after. What a set says about other instances is passed over.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from warpffrf.model.mesh.files.inp.deck import Place
from warpffrf.model.mesh.files.inp.model import FAMILIES, Instance, Scope, SetDefinition, SurfaceDefinition, fold
from warpffrf.model.mesh.files.inp.numbers import number_or_none

NESTING = 100  # sets inside sets; deeper is taken for garbage
OWN, ASSEMBLY = "own", "assembly"


@dataclass(eq=False)
class Body:
    """The scopes that define a body, and the sorted numbers of all its nodes and elements.

    `missing` counts members of sets that name a node or an element which the body does not have.
    """

    name: str
    own: tuple[Scope, ...]
    place: Place
    assembly: Scope | None = None
    instance: Instance | None = None
    instances: Mapping[str, Instance] = field(default_factory=dict)
    missing: Counter[str] = field(default_factory=Counter)

    def __post_init__(self) -> None:
        nodes = [table.labels for scope in self.own for table in scope.nodes]
        elements = [block.labels for scope in self.own for block in scope.elements]
        self.labels = {"nset": _sorted(nodes), "elset": _sorted(elements)}
        self._memo: dict[tuple[str, str, str], np.ndarray] = {}

    def scopes(self, level: str) -> tuple[Scope, ...]:
        """The scopes that a level looks into, in this order."""
        if level == OWN:
            return self.own
        return () if self.assembly is None else (self.assembly,)

    def levels(self) -> tuple[str, ...]:
        """The levels of names that reach the body."""
        return (OWN,) if self.assembly is None else (OWN, ASSEMBLY)

    def definition(self, level: str, family: str, name: str) -> SetDefinition | None:
        """The set of that name at a level, None where there is none."""
        return next((s.sets[family][fold(name)] for s in self.scopes(level) if fold(name) in s.sets[family]), None)

    def members(self, level: str, family: str, name: str, place: Place, chain: tuple[str, ...] = ()) -> np.ndarray:
        """Sorted numbers of this body's nodes ("nset") or elements ("elset") in a set; `place` is who asks.

        Raises `InputError` for an unknown set and for sets that contain themselves.
        """
        key = (level, family, fold(name))
        if key in self._memo:
            return self._memo[key]
        definition = self.definition(level, family, name)
        if definition is None:
            dotted = self._dotted(name) if level == ASSEMBLY else None
            if dotted is not None:
                return self._of_instance(*dotted, family, place, chain)
            known = sorted({d.name for scope in self.scopes(level) for d in scope.sets[family].values()})
            shown = ", ".join(repr(k) for k in known) or "none"
            raise place.fault(f"there is no {FAMILIES[family]} {name!r}; known: {shown}")
        link = f"{level}|{family}|{fold(name)}"
        if link in chain:
            raise definition.place.fault(f"{FAMILIES[family]} {name!r} contains itself")
        if len(chain) >= NESTING:
            raise definition.place.fault(f"sets are nested more than {NESTING} deep")
        parts = [self._one(level, family, definition, number, (*chain, link)) for number in definition.members]
        self._memo[key] = _sorted(parts)
        return self._memo[key]

    def surface_target(self, level: str, family: str, target: str, place: Place) -> np.ndarray:
        """Numbers of this body's nodes or elements that a line of a surface names: a number or a set."""
        number = number_or_none(target)
        if number is None:
            return self.members(level, family, target, place)
        if level == ASSEMBLY:
            return _none()
        found = self._known(family, np.array([number]))
        if not len(found):
            raise place.fault(f"there is no {'element' if family == 'elset' else 'node'} {number}")
        return found

    def surfaces(self, level: str) -> list[SurfaceDefinition]:
        """The surfaces of a level, those of element faces first."""
        found = [surface for scope in self.scopes(level) for surface in scope.surfaces.values()]
        return sorted(found, key=lambda surface: surface.nodal)

    def _one(self, level: str, family: str, owner: SetDefinition, m, chain: tuple[str, ...]) -> np.ndarray:
        """What one definition adds to the set of `owner`."""
        inner = level
        if level == ASSEMBLY and m.instance is not None:
            if fold(m.instance) not in self.instances:
                known = ", ".join(repr(i.name) for i in self.instances.values()) or "none"
                raise m.place.fault(f"there is no instance {m.instance!r}; known: {known}")
            if self.instance is None or fold(m.instance) != fold(self.instance.name):
                return _none()
            inner = OWN
        found = [self.members(inner, family, name, place, chain) for name, place in m.names]
        if m.elset is not None:
            found.append(self._nodes_of(self.members(inner, "elset", m.elset, m.place, chain)))
        if inner == OWN:  # at the level of the assembly a bare number is a reference point's
            listed = self._known(family, m.labels)
            ranges = [self._in_range(family, *r) for r in m.ranges]
            wanted = len(np.unique(m.labels)) + sum((r[1] - r[0]) // r[2] + 1 for r in m.ranges)
            self.missing[owner.name] += wanted - len(listed) - sum(len(r) for r in ranges)
            found += [listed, *ranges]
        return _sorted(found)

    def _dotted(self, name: str) -> tuple[Instance, str] | None:
        """Instance and rest of `instance.rest`."""
        for i, character in enumerate(name):
            if character == "." and fold(name[:i]) in self.instances:
                return self.instances[fold(name[:i])], name[i + 1 :]
        return None

    def _of_instance(self, instance: Instance, rest: str, family: str, place: Place, chain: tuple) -> np.ndarray:
        if self.instance is None or instance is not self.instance:
            return _none()
        number = number_or_none(rest)
        if number is not None:
            return self._known(family, np.array([number]))
        return self.members(OWN, family, rest, place, chain)

    def _known(self, family: str, numbers: np.ndarray) -> np.ndarray:
        return present(numbers, self.labels[family])

    def _in_range(self, family: str, first: int, last: int, step: int) -> np.ndarray:
        labels = self.labels[family]
        inside = labels[np.searchsorted(labels, first) : np.searchsorted(labels, last, side="right")]
        return inside[(inside - first) % step == 0]

    def _nodes_of(self, elements: np.ndarray) -> np.ndarray:
        tables = [block.table for scope in self.own for block in scope.elements if block.table is not None]
        return _sorted([t.rows[np.isin(t.labels, elements)].ravel() for t in tables])


def present(numbers: np.ndarray, among: np.ndarray) -> np.ndarray:
    """Sorted, unique `numbers` that are in the sorted array `among`; quick for few numbers among many."""
    numbers = np.unique(numbers)
    if not len(among):
        return numbers[:0]
    return numbers[among[np.minimum(np.searchsorted(among, numbers), len(among) - 1)] == numbers]


def _none() -> np.ndarray:
    return np.zeros(0, dtype=np.int64)


def _sorted(parts: list[np.ndarray]) -> np.ndarray:
    return np.unique(np.concatenate([_none(), *parts]))
