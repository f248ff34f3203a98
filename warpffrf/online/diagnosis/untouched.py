"""Contacts that carry nothing in a whole run: surfaces that only touch, that cannot, or that stay apart.

What is below `UNLOADED` of the largest contact force is round-off of the balance of forces. Each note names the pair,
what was seen, and the cure; those that merely stay apart share one note, with the least distance of each.
"""

from __future__ import annotations

import numpy as np

from warpffrf.model.checks.unreachable_contacts import out_of_reach
from warpffrf.model.contact import Contact
from warpffrf.model.forces import JointSpringDamper
from warpffrf.model.placement.gap import facing_gap
from warpffrf.model.scene import Scene
from warpffrf.model.signals import Signal
from warpffrf.online.history.history import ContactHistory, History

CELLS = 'or grid="contact_fixed" with bodies that were reduced with contact_fixed=True'
UNLOADED, TINY = 1e-12, 1e-15  # of the largest contact force, N: round-off of contacts that carry nothing
SHALLOW = 1e-6  # of the radius: overlaps that round-off of positions makes


def loaded_contacts(scene: Scene, history: History) -> list[Contact]:
    """The pairs with saved rows that carry a load in any of them."""
    largest = max((_largest(found) for found in history.contacts.values()), default=0.0)
    return [c for c in _saved(scene, history) if _largest(history.contacts[c.name]) > max(UNLOADED * largest, TINY)]


def untouched_notes(scene: Scene, history: History) -> list[str]:
    """Notes on pairs, lumped ones too, without any load in the run: those that only touch or cannot, and overlaps that
    the grid does not see."""
    loaded = loaded_contacts(scene, history)
    notes, apart = [], []
    for contact in _saved(scene, history):
        if contact in loaded:
            continue
        surface = contact.a.surface
        if np.any(history.contacts[contact.name].pressure > 0.0):
            notes.append(
                f"contact {contact.name!r}: the surfaces touch without a load, nothing presses them together; a spring "
                "with a preload, a force or gravity would"
            )
            continue
        apart.append(contact)
        radius, approach = float(surface.shape.radius), float(history.contacts[contact.name].approach[0])
        if approach > SHALLOW * radius:
            notes.append(
                f"contact {contact.name!r}: an overlap of {approach:.3g} m without any pressure: the modes take it up, "
                f"or it is too shallow for columns {surface.grid.pitch * radius:.2g} m apart; use a finer mesh "
                f"(half_width=), {CELLS}"
            )
    notes += out_of_reach(scene, {c.name: facing_gap(c) for c in apart})
    gaps = {c.name: -float(np.max(history.contacts[c.name].approach)) for c in apart}
    gaps |= {
        name: -float(np.max(found.approach))
        for name, found in history.lumped_contacts.items()
        if len(found.approach) and not np.any(found.force != 0.0)
    }
    open_ones = [
        f"{name!r} ({gap:.2g} m apart at the least)" if np.isfinite(gap) else repr(name)
        for name, gap in gaps.items()
        if not gap < 0.0 and not any(note.startswith(f"contact {name!r}:") for note in notes)
    ]
    if open_ones:
        what = "contact" if len(open_ones) == 1 else "contacts"
        cure = f"check the gaps{pulled_apart(scene)}"
        notes.append(f"{what} without any touch in the run: {', '.join(open_ones)}; if that is not meant, {cure}")
    return notes


def _saved(scene: Scene, history: History) -> list[Contact]:
    found = history.contacts
    return [c for c in scene.contacts if c.name in found and len(found[c.name].approach)]


def _largest(found: ContactHistory) -> float:
    return float(np.linalg.norm(found.force, axis=1).max(initial=0.0))


def pulled_apart(scene: Scene) -> str:
    """A clause on preloads of springs, whose sign is the usual reason where one is in the scene."""
    loaded = [f for f in scene.forces if isinstance(f, JointSpringDamper) and f.preload != 0.0]
    if not loaded:
        return ""
    sizes = ["a signal" if isinstance(f.preload, Signal) else f"{f.preload:+g} N" for f in loaded]
    signs = ", ".join(f"{f.name!r} ({size})" for f, size in zip(loaded, sizes, strict=True))
    return f" and the sign of the preload of {signs}: a positive one pushes the second body along the axis of the joint"
