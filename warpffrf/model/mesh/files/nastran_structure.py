r"""Structural elements of Nastran bulk data: shells, bars, beams, masses, springs and rigid elements.

| card | read as | not read |
|---|---|---|
| CTRIA3, CQUAD4, CTRIA6, CQUAD8 (R too) with PSHELL | shells, ZOFFS as their offset | PCOMP, thickness at nodes |
| CBAR, CBEAM with PBAR, PBARL (ROD, TUBE, BAR), PBEAM | beams, offsets at both ends alike | pin flags, taper |
| CONM2 | point mass | systems other than basic |
| CELAS1, CELAS2, CBUSH between two nodes | springs | springs to the ground |
| RBE2 with all six components | rigid link | other components, RBE1, RBE3 |

I_1 of a section is int y^2 dA, in plane 1 of the orientation vector, so I_z here. Nonstructural mass is added to the
density.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.material import Material
from warpffrf.model.mesh.structure import Beam, BeamSection, PointMass, RigidLink, Shell, Spring, Structure

if TYPE_CHECKING:
    from warpffrf.model.mesh.files.nastran import Card

Array = np.ndarray
ELEMENTS = ("CBAR", "CBEAM", "CONM2", "CELAS1", "CELAS2", "CBUSH", "RBE2")
PROPERTIES = ("PSHELL", "PBAR", "PBARL", "PBEAM", "PELAS", "PBUSH")
_OFFSETS = {"CTRIA3": 7, "CTRIAR": 7, "CQUAD4": 8, "CQUADR": 8, "CTRIA6": 10, "CQUAD8": 16}
_THICKNESSES = {"CTRIA3": (10, 12), "CQUAD4": (10, 13), "CTRIA6": (11, 13), "CQUAD8": (11, 14)}


class StructureReader:
    """`cards`: elements of `ELEMENTS`; `properties` {number: card} of `PROPERTIES`; `shells` {kind: rows of property,
    nodes and card}; `number` {grid: position}; `points` [file's unit]; `material` makes one of a MAT1's number;
    `length` [m], `force` [N] and `mass` [kg] of the file's units."""

    def __init__(
        self,
        cards: list[Card],
        properties: Mapping[tuple[str, int], Card],
        shells: Mapping[str, list[tuple[int, list[int], Card]]],
        number: Mapping[int, int],
        points: Array,
        material: Callable[[int], Material | None],
        units: tuple[float, float, float],
    ) -> None:
        self.cards, self.properties, self.shells = cards, properties, shells
        self.number, self.points, self.material = number, points, material
        self.length, self.force, self.mass = units
        self.left_out: Counter[str] = Counter()
        self.notes: list[str] = []
        self.taken: set[int] = set()  # properties of shells that have been read

    def structure(self) -> Structure:
        """All parts, with positions in `points` as nodes and SI units; `left_out` counts the cards that were not read,
        by reason."""
        parts: list[Any] = [*self._shells(), *self._beams()]
        for card in self.cards:
            if card.name == "CONM2":
                parts += self._mass(card)
            elif card.name in ("CELAS1", "CELAS2", "CBUSH"):
                parts += self._spring(card)
            elif card.name == "RBE2":
                parts += self._rigid(card)
        return Structure(tuple(parts))

    def _at(self, card: Card, field: int) -> int:
        grid = card.integer(field)
        if grid not in self.number:
            raise card.fault(f"grid point {grid} does not exist")
        return self.number[grid]

    def _property(self, card: Card, *names: str) -> Card | None:
        number = card.integer(2, card.integer(1))
        return next((self.properties[n, number] for n in names if (n, number) in self.properties), None)

    def _shells(self) -> list[Shell]:
        groups: dict[tuple[str, int, float], list[list[int]]] = {}
        for kind, rows in self.shells.items():
            for p, nodes, card in rows:
                if ("PSHELL", p) not in self.properties or self.material(
                    self.properties["PSHELL", p].integer(2, 0)
                ) is None:
                    self.left_out[f"{card.name} without PSHELL and MAT1"] += 1
                    continue
                first, last = _THICKNESSES.get(card.name, (1, 0))
                if any(card.text(i) not in ("", "0") for i in range(first, last + 1)):
                    raise card.fault("thickness at nodes is not read; give it in PSHELL")
                offset = card.real(_OFFSETS[card.name], 0.0)
                groups.setdefault((kind, p, offset), []).append([self.number[a] for a in nodes])
        found = []
        for (_, p, offset), nodes in groups.items():
            card = self.properties["PSHELL", p]
            material = self.material(card.integer(2))
            if material is None:
                continue
            thickness = card.real(3) * self.length
            if not card.text(4):
                self.notes.append(f"PSHELL {p} is a membrane (no MID2); it is read as a shell, which also bends")
            extra = card.real(8, 0.0) * self.mass / self.length**2
            if extra:
                material = replace(material, density=material.density + extra / thickness)
            try:
                name = f"property_{p}"
                found.append(Shell(np.array(nodes), thickness, material, offset=offset * self.length, name=name))
            except InputError as error:
                raise card.fault(str(error)) from None
            self.taken.add(p)
        return found

    def _beams(self) -> list[Beam]:
        groups: dict[int, list[tuple[list[int], Array, Array]]] = {}
        for card in self.cards:
            if card.name not in ("CBAR", "CBEAM"):
                continue
            owner = self._property(card, "PBAR", "PBARL", "PBEAM")
            if owner is None or self.material(owner.integer(2, 0)) is None:
                self.left_out[f"{card.name} without PBAR, PBARL or PBEAM and MAT1"] += 1
                continue
            if any(card.text(i) not in ("", "0") for i in (9, 10)):
                raise card.fault("pin flags are not read; model the hinge as a joint between two bodies")
            nodes = [self._at(card, 3), self._at(card, 4)]
            if card.text(5).lstrip("+-").isdigit() and not card.text(6):
                direction = self.points[self._at(card, 5)] - self.points[nodes[0]]
            else:
                direction = np.array([card.real(i, 0.0) for i in (5, 6, 7)])
            ends = np.array([card.real(i, 0.0) for i in range(11, 17)]).reshape(2, 3)
            if not np.allclose(ends[0], ends[1]):
                raise card.fault("offsets of both ends must be alike; move the grid points")
            groups.setdefault(card.integer(2, card.integer(1)), []).append((nodes, direction, ends[0] * self.length))
        found = []
        for p, rows in groups.items():
            owner = next(self.properties[n, p] for n in ("PBAR", "PBARL", "PBEAM") if (n, p) in self.properties)
            material = self.material(owner.integer(2))
            if material is None:
                continue
            try:
                section, extra = self._section(owner)
                if extra:
                    density = material.density + extra * self.mass / self.length / section.area
                    material = replace(material, density=density)
                nodes, directions, offsets = (np.array(part) for part in zip(*rows, strict=True))
                found.append(Beam(nodes, section, material, directions, offset=offsets, name=f"property_{p}"))
            except InputError as error:
                raise owner.fault(str(error)) from None
        return found

    def _section(self, card: Card) -> tuple[BeamSection, float]:
        """Section in SI and nonstructural mass per length in the file's units."""
        L = self.length
        if card.name == "PBARL":
            kind, sizes = card.text(4).upper(), [card.real(9, 0.0) * L, card.real(10, 0.0) * L]
            if kind == "ROD":
                return BeamSection.circle(sizes[0]), card.real(10, 0.0)
            if kind == "TUBE":
                return BeamSection.circle(*sizes), card.real(11, 0.0)
            if kind == "BAR":  # the first dimension along z
                return BeamSection.rectangle(sizes[1], sizes[0]), card.real(11, 0.0)
            raise card.fault(f"sections of type {kind} are not read; give the constants in PBAR")
        beam = card.name == "PBEAM"
        torsion, product = (7, 6) if beam else (6, 19)
        if card.real(product, 0.0) != 0.0:
            raise card.fault("I12 is not zero; turn the orientation to the principal axes of the section")
        if beam and any(card.text(i) for i in range(17, len(card.fields) + 1)):
            self.notes.append(f"PBEAM {card.integer(1)}: the section of end A is used for the whole beam")
        shear = (1.0, 1.0) if beam else (card.real(17, 0.0), card.real(18, 0.0))
        A, I_1, I_2 = card.real(3) * L**2, card.real(4) * L**4, card.real(5) * L**4
        section = BeamSection(A, I_2, I_1, card.real(torsion) * L**4, shear_y=shear[0], shear_z=shear[1])
        return section, card.real(8 if beam else 7, 0.0)

    def _mass(self, card: Card) -> list[PointMass]:
        node, system = self._at(card, 2), card.integer(3, 0)
        if system not in (0, -1):
            raise card.fault(f"coordinate system {system} is not read; give the mass in the basic system")
        offset = np.array([card.real(i, 0.0) for i in (5, 6, 7)])
        if system == -1:
            offset = offset - self.points[node]
        xx, xy, yy, xz, yz, zz = (card.real(i, 0.0) * self.mass * self.length**2 for i in range(9, 15))
        inertia = np.array([[xx, -xy, -xz], [-xy, yy, -yz], [-xz, -yz, zz]])
        mass = card.real(4, 0.0) * self.mass
        if not mass > 0.0:
            self.left_out["CONM2 without mass"] += 1
            return []
        try:
            return [PointMass(node, mass, inertia=inertia, offset=offset * self.length)]
        except InputError as error:
            raise card.fault(str(error)) from None

    def _spring(self, card: Card) -> list[Spring]:
        axes, k = np.eye(3), np.zeros(6)
        if card.name == "CBUSH":
            ends = (3, 4)
            owner = self.properties.get(("PBUSH", card.integer(2, card.integer(1))))
            if owner is None or owner.text(2).upper() != "K":
                self.left_out["CBUSH without PBUSH and K"] += 1
                return []
            k = np.array([owner.real(i, 0.0) for i in range(3, 9)])
        else:
            ends = (3, 5)
            component = card.integer(4, 0)
            if card.name == "CELAS1":
                owner = self.properties.get(("PELAS", card.integer(2, card.integer(1))))
                if owner is None:
                    raise card.fault(f"PELAS {card.integer(2, 0)} does not exist")
                stiffness = owner.real(2)
            else:
                stiffness = card.real(2)
            if component not in range(1, 7) or card.integer(6, component) != component:
                self.left_out[f"{card.name} of scalar points or unlike components"] += 1
                return []
            k[component - 1] = stiffness
        if any(card.integer(i, 0) == 0 for i in ends) or not np.any(k):
            self.left_out[f"{card.name} to the ground or without stiffness"] += 1
            return []
        first, second = (self._at(card, i) for i in ends)
        if card.name == "CBUSH" and card.text(8) != "0" and card.text(5):
            apart = self.points[second] - self.points[first]
            direction = np.array([card.real(i, 0.0) for i in (5, 6, 7)])
            e_z = np.cross(apart, direction)
            if not np.linalg.norm(e_z) > 0.0:
                raise card.fault("its orientation does not define axes; give CID 0 for the basic ones")
            e_x, e_z = apart / np.linalg.norm(apart), e_z / np.linalg.norm(e_z)
            axes = np.stack([e_x, np.cross(e_z, e_x), e_z], axis=1)
        elif card.name == "CBUSH" and card.integer(8, 0) != 0:
            raise card.fault(f"coordinate system {card.integer(8)} is not read; give CID 0")
        k = k * np.repeat([self.force / self.length, self.force * self.length], 3)
        try:
            return [Spring((first, second), k, axes=axes)]
        except InputError as error:
            raise card.fault(str(error)) from None

    def _rigid(self, card: Card) -> list[RigidLink]:
        if sorted(card.text(3)) != list("123456"):
            self.left_out[f"RBE2 of components {card.text(3)}"] += 1
            return []
        followers = [i for i in range(4, len(card.fields) + 1) if card.text(i).isdigit()]
        nodes = [self._at(card, 2), *(self._at(card, i) for i in followers)]
        if len(set(nodes)) < 2:
            raise card.fault("it has no dependent grid points; give them from the fourth field on")
        return [RigidLink(np.array(nodes), name=f"RBE2_{card.integer(1)}")]
