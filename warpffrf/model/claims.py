"""Which interactions may stand on the same two surfaces together: those that claim no unknown twice.

Interactions add their loads to the surfaces and read their displacements, so that several may stand on the same two: a
coating beside asperities, each with its own pressure p_i(depth). Where a gap is closed without any law between, its
pressure is what keeps it closed; two such pressures have a sum, but no shares. So have two tractions that both hold a
cell where it is.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from warpffrf.model.bodies import SurfacePort
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError


def refuse_double_claims(contact: Any, others: Iterable[Any]) -> None:
    """Raises `InputError` where `contact`, distributed or lumped, claims what one of the others on its surfaces
    does."""
    for other in others:
        if other is contact or not on_same_surfaces(contact, other):
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
    """The same for all contacts of a scene: laws may have been changed since they were added."""
    contacts = (*scene.contacts, *scene.lumped_contacts)
    for number, contact in enumerate(contacts):
        refuse_double_claims(contact, contacts[:number])


def on_same_surfaces(a: Any, b: Any) -> bool:
    """Whether two contacts stand on the same two surfaces, in whichever order they are named."""
    return all(any(_same_surface(port, used) for used in b.ports) for port in a.ports)


def _same_surface(a: SurfacePort, b: SurfacePort) -> bool:
    return a.body is b.body and a.name == b.name
