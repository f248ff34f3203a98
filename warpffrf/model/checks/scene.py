"""Summary of a scene before a run: masses, degrees of freedom, redundant constraints, initial gaps.

Grübler's count assumes independent constraints: freedoms = 6 bodies + modes - constraints. The actual count uses the
rank of the constraint Jacobian C_q, freedoms = unknowns - rank(C_q); the difference is the number of redundant
constraints (`redundancy`). A flexible interface moves with its modes, so a constraint that is redundant between rigid
bodies need not be between flexible ones.

Signal cover. The signals of a scene: coverage of the simulated time, and shortest time of change.

A `Table` holds its end values outside its times, which suits single evaluations but not a run: a measured load that
ends early would continue as a constant one without a note. `Table(hold=True)` requests this. A `Sine` covers its
duration.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.bodies import GROUND_INDEX, Body
from warpffrf.model.checks.contacts import Wedge, excessive_overlap, find_wedge, out_of_reach, refuse_claims_of
from warpffrf.model.checks.redundancy import find_redundancy, velocity_defects
from warpffrf.model.errors import InputError
from warpffrf.model.forces import JointSpringDamper, Pretension
from warpffrf.model.forces.laws import vanishes
from warpffrf.model.lumped_contact import allowed_overlap
from warpffrf.model.placement.gap import facing_gap
from warpffrf.model.signals import Signal

if TYPE_CHECKING:
    from warpffrf.model.scene import Scene


@dataclass(frozen=True)
class SceneCheck:
    """Findings of `Scene.check()`; `str()` returns a table. Masses kg, gaps m, infinite where surfaces do not face each
    other."""

    masses: dict[str, float]
    modes: dict[str, int]
    local_modes: dict[str, int]
    constraints: dict[str, int]
    grubler: int
    degrees_of_freedom: int
    redundant: dict[str, int]
    gaps: dict[str, float]
    unsupported: tuple[str, ...]
    loose_preloads: dict[str, str] = field(default_factory=dict)  # forces whose tension has no load path, and the cure
    redundant_rows: tuple[str, ...] = ()  # 'joint': what its redundant row would hold, axes of the joint
    refused_drives: tuple[str, ...] = ()  # drives of coordinates that joints fix already: such a scene cannot be run
    velocity_defects: tuple[str, ...] = ()  # joints and drives that the initial velocities contradict, and by how much
    overlaps: tuple[str, ...] = ()  # pairs that overlap by more than is allowed at the start, and by how much
    wedge: Wedge | None = None  # pairs whose overlap no small motion opens, the deepest
    out_of_reach: tuple[str, ...] = ()  # pairs that will hardly close, and why
    films: dict[str, tuple[float | None, float]] = field(default_factory=dict)  # clearance, smallest initial gap [m]
    film_notes: tuple[str, ...] = ()  # notes on the discretisation of films
    singular_pose: bool = False  # the constraints lose rank at the initial pose only: a dead centre, a flat loop

    def __str__(self) -> str:
        lines = [f"{'body':<20}{'mass [kg]':>14}{'global modes':>14}{'local modes':>14}"]
        for name, mass in self.masses.items():
            lines.append(f"{name:<20}{mass:>14.6g}{self.modes[name]:>14d}{self.local_modes[name]:>14d}")
        lines += ["", f"{'joint or drive':<20}{'constraints':>14}{'redundant':>14}"]
        for name, count in self.constraints.items():
            lines.append(f"{name:<20}{count:>14d}{self.redundant.get(name, 0):>14d}")
        if self.gaps:
            lines += ["", f"{'contact':<20}{'initial gap [m]':>18}"]
        lines += [f"{name:<20}{gap:>18.6g}" for name, gap in self.gaps.items()]
        if self.films:
            lines += ["", f"{'film':<20}{'clearance [m]':>18}{'initial gap [m]':>18}"]
        for name, (clearance, gap) in self.films.items():
            lines.append(f"{name:<20}{'-' if clearance is None else format(clearance, '.6g'):>18}{gap:>18.6g}")
        lines += self.film_notes
        lines += ["", f"degrees of freedom  {self.degrees_of_freedom} (count without redundancy {self.grubler})"]
        if self.redundant:
            found = ", ".join(f"{name} ({count})" for name, count in self.redundant.items())
            lines.append(
                f"redundant constraints: {found}; they are omitted, with zero reactions (z: axis of the joint)"
            )
            lines += [f"  {label}" for label in self.redundant_rows]
        if self.refused_drives:
            lines.append(
                f"driven though fixed already: {', '.join(self.refused_drives)}; remove them, or simulate refuses"
            )
        if self.singular_pose:
            lines.append("the initial pose is singular (a dead centre or a flat loop): place the bodies off it")
        if self.overlaps:
            lines.append(f"overlap too much at the start: {', '.join(self.overlaps)}; simulate refuses that")
        if self.wedge is not None:
            lines.append(str(self.wedge))
        lines += self.out_of_reach
        if self.velocity_defects:
            lines.append(f"initial velocities violate joints: {', '.join(self.velocity_defects)}")
        lines += self.loose_preloads.values()
        if self.unsupported:
            lines.append(
                f"not connected to the ground by joints, springs, contacts or films: {', '.join(self.unsupported)}"
            )
        return "\n".join(lines)


def check_scene(scene: Scene) -> SceneCheck:
    """See `Scene.check`."""
    if not scene.bodies:
        raise InputError("scene: there are no bodies; add one with scene.add_body or scene.add_rigid_body")
    refuse_claims_of(scene)
    found = find_redundancy(scene)
    constraints: dict[str, int] = {}
    for row in found.rows:
        constraints[row.owner] = constraints.get(row.owner, 0) + 1
    found_gaps = {contact.name: facing_gap(contact) for contact in scene.finite_sliding}
    lumped_gaps = {contact.name: contact.gap() for contact in scene.lumped_contacts}
    unknowns = sum(6 + body.mode_count for body in scene.bodies)
    return SceneCheck(
        masses={b.name: b.mass for b in scene.bodies},
        modes={b.name: b.mode_count for b in scene.bodies},
        local_modes={b.name: _local_modes(b) for b in scene.bodies},
        constraints=constraints,
        grubler=unknowns - sum(constraints.values()),
        degrees_of_freedom=unknowns - found.rank,
        redundant=found.counts(),
        gaps={**{name: gap[0] if gap else inf for name, gap in found_gaps.items()}, **lumped_gaps},
        unsupported=_unsupported(scene),
        loose_preloads=loose_preloads(scene),
        redundant_rows=tuple(row.label for row in found.dropped),
        refused_drives=tuple(str(row.drive.name) for row in found.dropped if row.drive is not None),
        velocity_defects=tuple(str(defect) for defect in velocity_defects(scene)),
        overlaps=(*_overlaps(scene, found_gaps), *_lumped_overlaps(scene, lumped_gaps)),
        wedge=find_wedge(scene, found_gaps),
        out_of_reach=tuple(out_of_reach(scene, found_gaps)),
        films={film.name: (film.clearance(), float(film.initial_gap().min())) for film in scene.films},
        film_notes=tuple(note for film in scene.films for note in film.notes),
        singular_pose=found.rank_here < found.rank,
    )


def _overlaps(scene: Scene, gaps: dict[str, tuple[float, float, float] | None]) -> list[str]:
    """The pairs whose initial overlap a run refuses."""
    told = []
    for contact in scene.finite_sliding:
        gap = gaps[contact.name]
        allowed = None if gap is None else excessive_overlap(contact, *gap)
        if gap is not None and allowed is not None:
            told.append(f"{contact.name} ({-gap[0]:.3g} m, {allowed:.3g} m are allowed)")
    return told


def _lumped_overlaps(scene: Scene, gaps: dict[str, float]) -> list[str]:
    told = []
    for contact in scene.lumped_contacts:
        gap = gaps[contact.name]
        if gap < 0.0 and -gap > (allowed := allowed_overlap(contact)):
            told.append(f"{contact.name} ({-gap:.3g} m, {allowed:.3g} m are allowed)")
    return told


def connecting(scene: Scene) -> list[Any]:
    """All items with two ports, on two bodies or the ground."""
    return [*scene.joints, *scene.forces, *scene.contacts, *scene.lumped_contacts, *scene.films]


def _local_modes(body: Body) -> int:
    if body.reduced is None:
        return 0
    return sum(s.grid.columns * len(s.grid.z) for s in body.reduced.contact_surfaces.values())


def _unsupported(scene: Scene) -> tuple[str, ...]:
    """Names of bodies that no chain of joints, springs, contacts and films connects with the ground."""
    floating = {b for group in floating_groups(scene) for b in group}
    return tuple(body.name for body in scene.bodies if body.index in floating)


def floating_groups(scene: Scene) -> list[list[int]]:
    """Bodies that chains of joints, springs, contacts and films connect with each other, but not with the ground,
    by index."""
    items, groups = connecting(scene), []
    reached = reached_from(GROUND_INDEX, items)
    for body in scene.bodies:
        if body.index not in reached:
            groups.append(sorted(reached_from(body.index, items)))
            reached |= set(groups[-1])
    return groups


def reached_from(index: int, items: list[Any]) -> set[int]:
    """Bodies, and the ground, that chains of `items` connect with the body `index`."""
    links = [item.ports for item in items if len(item.ports) == 2]
    reached = {index}
    while True:
        new = {p.body.index for link in links for p in link if any(q.body.index in reached for q in link)} - reached
        if not new:
            return reached
        reached |= new


def _resists(item: Any, force: Pretension | JointSpringDamper) -> bool:
    """Whether `item` may resist what `force` pulls along: of the same joint only a spring on the same coordinate."""
    if item is force.joint:
        return False
    if getattr(item, "joint", None) is not force.joint:
        return True
    same = isinstance(item, JointSpringDamper) and item.coordinate == force.coordinate
    return same and not vanishes(item.stiffness)


def loose_preloads(scene: Scene) -> dict[str, str]:
    """Pretensions, and joint springs with a preload, between two bodies without any other connection: their
    tension has no load path. By name, with the cure.

    A spring with a preload may also be a suspension, loaded by the weight; so this is reported, not refused.
    """
    told = {}
    for force in scene.forces:
        if not isinstance(force, (Pretension, JointSpringDamper)):
            continue
        if isinstance(force, JointSpringDamper) and force.preload == 0.0:
            continue
        a, b = force.ports
        others = [item for item in connecting(scene) if item is not force and _resists(item, force)]
        if b.body.index not in reached_from(a.body.index, others):
            told[str(force.name)] = (
                f"{force.kind} {force.name!r}: its tension has no load path, only joint {force.joint.name!r} connects "
                f"{a.body.name!r} and {b.body.name!r}; add the contact or joint between them that it presses "
                "together, or take two interfaces of one body"
            )
    return told


ROUNDING = 1e-9  # of the duration: ends that differ by less count as equal


def refuse_short_signals(scene: Scene, begin: float, end: float) -> None:
    """Raises `InputError` naming the drive or force whose signal does not cover `begin` to `end` [s]."""
    slack = ROUNDING * (end - begin)
    for item in (*scene.drives, *scene.forces):
        for signal in signals_in(vars(item)):
            first, last = signal.covers
            if first > begin + slack or last < end - slack:
                raise InputError(
                    f"{item.kind} {item.name!r}: its signal covers {max(first, 0.0):g} to {last:g} s, but {begin:g} to "
                    f"{end:g} s are simulated; extend it, shorten the run, or give a Table hold=True if its end values "
                    "hold"
                )


def quickest_rise(scene: Scene, begin: float, end: float) -> float:
    """The shortest time [s] in which a signal of a drive or force would cross its whole range, at its largest slope
    within `begin` to `end` [s]; infinite where nothing changes."""
    shortest = np.inf
    for item in (*scene.drives, *scene.forces):
        for signal in signals_in(vars(item)):
            values, slopes = signal.samples(begin, end)
            if (steepest := float(np.abs(slopes).max(initial=0.0))) > 0.0:
                shortest = min(shortest, float(np.ptp(values)) / steepest)
    return shortest


def signals_in(value: Any) -> Iterator[Signal]:
    """All signals in the attributes of a drive or force, `vars(item)`."""
    if isinstance(value, Signal):
        yield value
    elif isinstance(value, dict):
        for entry in value.values():
            yield from signals_in(entry)
    elif isinstance(value, (list, tuple)):
        for entry in value:
            yield from signals_in(entry)
