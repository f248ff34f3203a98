"""Contacts that the monolithic reference does not have: friction, rigid partners, and shapes other than (crowned)
cylinders with the material inside."""

from __future__ import annotations

from typing import Any

from warpffrf.model.errors import InputError

SHAPES = ("cylinder", "crowned_cylinder")


def refuse_contacts(scene: Any) -> None:
    """Raises `InputError` naming the contact and the cure, method "separated"."""
    for contact in scene.contacts:
        label = f"contact {contact.name!r}"
        friction = getattr(contact, "friction", 0.0)
        if getattr(friction, "coefficient", friction) > 0.0:
            raise InputError(f"{label}: method 'monolithic' has no friction; use friction=0.0, or method 'separated'")
        for port in (contact.a, contact.b):
            if getattr(port, "rigid", False):
                raise InputError(
                    f"{label}: method 'monolithic' has contact between flexible bodies only, {port.label} is rigid; "
                    "use method 'separated'"
                )
            if port.surface.shape.kind not in SHAPES:
                raise InputError(
                    f"{label}: method 'monolithic' has contact of cylinders and crowned cylinders only, {port.label} "
                    f"is a {port.surface.shape.kind}; use method 'separated'"
                )
