"""Which body of a deck is read: the only one, or the one that `part=` names."""

from __future__ import annotations

from collections.abc import Iterable

from warpffrf.model.errors import InputError
from warpffrf.model.mesh.files.inp.body import Body
from warpffrf.model.mesh.files.inp.model import Deck, Instance, Scope, fold


def choose(deck: Deck, part: str | None) -> Body:
    """The body that `part` names: an instance, else the one instance of a part, else a part without instances.

    Without `part` the deck must hold one body. Raises `InputError` that lists the names.
    """
    if not deck.instances and not deck.parts:
        if not deck.top.has_cells:
            raise _no_cells(deck)
        return Body("", (deck.top,), deck.top.place)
    if any(block.kind is not None for block in deck.top.elements):
        place = next(block.place for block in deck.top.elements if block.kind is not None)
        raise place.fault("solid elements outside the parts are not supported; put them into a *Part with an *Instance")
    bodies = _bodies(deck)
    names = ", ".join(repr(body.name) for body in bodies.values())
    if part is None:
        if not bodies:
            raise _no_cells(deck)
        if len(bodies) > 1:
            raise InputError(f"mesh file {deck.file}: there are {len(bodies)} bodies, say part= one of {names}")
        return next(iter(bodies.values()))
    if fold(part) in bodies:
        return bodies[fold(part)]
    of_part = [i for i in deck.instances.values() if fold(i.part) == fold(part)]
    if len(of_part) == 1 and fold(of_part[0].name) in bodies:
        return bodies[fold(of_part[0].name)]
    if len(of_part) > 1:
        placed = ", ".join(repr(i.name) for i in of_part)
        raise InputError(f"mesh file {deck.file}: part {part!r} is placed more than once, say part= one of {placed}")
    empty = deck.instances.get(fold(part))
    if empty is not None:
        scopes = (empty.scope, deck.parts[fold(empty.part)])
        raise empty.place.fault(
            f"instance {part!r} holds no solid elements (element types: {_types(scopes)}); say part= one of "
            f"{names or 'none'}"
        )
    raise InputError(f"mesh file {deck.file}: there is no body {part!r}; known: {names or 'none'}")


def _bodies(deck: Deck) -> dict[str, Body]:
    """Instances with volume elements by folded name; parts that nobody placed when there is no instance at all."""
    bodies: dict[str, Body] = {}
    for key, instance in deck.instances.items():
        scopes = (instance.scope, deck.parts[fold(instance.part)])
        if any(scope.has_cells for scope in scopes):
            bodies[key] = _placed(deck, instance)
    if not deck.instances:
        bodies = {key: Body(p.name, (p,), p.place) for key, p in deck.parts.items() if p.has_cells}
    return bodies


def _placed(deck: Deck, instance: Instance) -> Body:
    scopes = (instance.scope, deck.parts[fold(instance.part)])
    return Body(instance.name, scopes, instance.place, deck.top, instance, deck.instances)


def _no_cells(deck: Deck) -> InputError:
    found = _types((deck.top, *deck.parts.values()))
    return InputError(f"mesh file {deck.file}: there are no solid elements (element types: {found}); export a 3-D mesh")


def _types(scopes: Iterable[Scope]) -> str:
    return ", ".join(sorted({block.type for scope in scopes for block in scope.elements})) or "none"
