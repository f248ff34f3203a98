"""Which interactions may stand on the same two surfaces together: those that claim no unknown twice.

Interactions add their loads to the surfaces and read their displacements, so that several may stand on the same two: a
coating beside asperities, each with its own pressure p_i(depth). Where a gap is closed without any law between, its
pressure is what keeps it closed; two such pressures have a sum, but no shares. So have two tractions that both hold a
cell where it is. A film claims the whole gap: asperities beside it are a law of its own, and another film has no place
on its grid.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from warpffrf.model.bodies import LapPort, SurfacePort
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.films import Film
from warpffrf.model.laps import Lap


def refuse_double_claims(contact: Any, others: Iterable[Any]) -> None:
    """Raises `InputError` where `contact`, distributed or lumped, or a film, claims what one of the others on its
    surfaces does."""
    for other in others:
        if other is contact:
            continue
        _refuse_beside_film(contact, other)
        if isinstance(contact, Film) or not on_same_surfaces(contact, other):
            continue
        where = (
            f"contact {contact.name!r}: {contact.a.label} and {contact.b.label} are in contact already, as "
            f"{other.name!r}"
        )
        if not (isinstance(contact, Contact) and isinstance(other, Contact)):
            raise InputError(f"{where}; one pair holds all their patches, in whichever order they are named")
        if contact.law.curve is None and other.law.curve is None:
            raise InputError(
                f"{where}; one pair holds all their patches, in whichever order they are named. A second one needs a "
                "law with a compliance (wf.laws): the pressures of two that hold a gap closed have no shares"
            )
        if contact.friction.acts and other.friction.acts:
            raise InputError(
                f"{where}, and both have friction: where they stick their tractions have no shares; leave the friction "
                "to one of them"
            )


def refuse_claims_of(scene: Any) -> None:
    """The same for all contacts and films of a scene: laws may have been changed since they were added."""
    contacts = (*scene.contacts, *scene.lumped_contacts, *scene.films)
    for number, contact in enumerate(contacts):
        refuse_double_claims(contact, contacts[:number])
    for number, lap in enumerate(scene.laps):
        refuse_double_laps(lap, scene.laps[:number])


def _refuse_beside_film(one: Any, other: Any) -> None:
    """Raises `InputError` where one of the two is a film whose surfaces, or whose grid, the other has too."""
    if isinstance(one, Film) and isinstance(other, Film):
        if _same_surface(one.a, other.a):
            raise InputError(
                f"{one.label}: on the grid of {one.a.label} there is {other.label} already; one film has all of it, "
                "take a surface of its own for a second one"
            )
    elif isinstance(one, Film) or isinstance(other, Film):
        film, contact = (one, other) if isinstance(one, Film) else (other, one)
        if on_same_surfaces(film, contact):
            raise InputError(
                f"contact {contact.name!r} and {film.label} stand on the same two surfaces, {film.a.label} and "
                f"{film.b.label}; give the film a law for asperities instead of a contact beside it: Film(..., "
                f"asperities=...)"
            )


def refuse_double_laps(lap: Lap, others: Iterable[Lap]) -> None:
    """Raises `InputError` where another lap stands on the same faces."""
    for other in others:
        if other is not lap and len(other.ports) == len(lap.ports) and on_same_surfaces(lap, other):
            raise InputError(
                f"{lap.label}: {' and '.join(port.label for port in lap.ports)} are joined already, as "
                f"{other.label}; one lap has all of their cells"
            )


def on_same_surfaces(a: Any, b: Any) -> bool:
    """Whether two contacts stand on the same two surfaces, in whichever order they are named."""
    return all(any(_same_surface(port, used) for used in b.ports) for port in a.ports)


def _same_surface(a: SurfacePort | LapPort, b: SurfacePort | LapPort) -> bool:
    return a.body is b.body and a.name == b.name
