"""The three ways to evaluate a contact pair, `Contact(evaluation=)`: one law, three sets of places where it holds.

    "semi"    pressure in hats, the gap over all Gauss points of the contact grid; the default
    "hyper"   the same with few points of positive weight, chosen by `reduce(..., sampling_error=)`
    "full"    the law at every FE node of the first surface, nodal forces on all modes, solved with all coordinates at
              once: `simulate(method="monolithic")`, the conventional way and the reference for the other two

An oil film has the same words: hats, profiles along, and pressures at the FE nodes.

The last is a method of solution as much as of evaluation, because what makes it slow is exactly what separate
integration removes: a force at every node on every local mode. It is therefore left to the solver that has all modes as
coordinates. What a method does not evaluate is refused here.
"""

from __future__ import annotations

from typing import Any

from warpffrf.model.errors import InputError

DEFAULT = "semi"


def evaluation_of(contact: Any) -> str:
    """How `contact` is evaluated."""
    return getattr(contact, "evaluation", DEFAULT)


def refuse_full(pair: Any) -> None:
    """Raises `InputError` for a contact, or an oil film, that method "separated" does not evaluate."""
    if evaluation_of(pair) == "full":
        label = getattr(pair, "label", f"contact {pair.name!r}")
        raise InputError(
            f"{label}: evaluation 'full' is solved with all coordinates at once; use method='monolithic', or "
            "evaluation 'semi' or 'hyper'"
        )


def all_full(scene: Any) -> bool:
    """Whether the contacts of `scene` are evaluated "full", all of them or none. Raises `InputError` for contacts that
    method "monolithic" does not evaluate."""
    full = [contact for contact in scene.contacts if evaluation_of(contact) == "full"]
    for contact in scene.contacts:
        if evaluation_of(contact) == "hyper":
            raise InputError(
                f"contact {contact.name!r}: evaluation 'hyper' belongs to method 'separated'; use that, or evaluation "
                "'semi' or 'full'"
            )
        if full and evaluation_of(contact) != "full":
            raise InputError(
                f"contact {contact.name!r}: method 'monolithic' evaluates all contacts in one way, and "
                f"{full[0].name!r} is 'full'; give all of them evaluation='full', or none"
            )
    return bool(full)
