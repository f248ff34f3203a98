"""Selection of the contact formulation of the monolithic reference, and what it does not support.

With `at_nodes` the contact law is evaluated at the FE nodes of the first surface: for pairs of cylinders (outside) and
crowned cylinders of flexible bodies with a linear layer with parallel-axes kinematics (`line_of_centres`), as for the
gaps of the separated solver, for all others by the true shapes (`nodal`). Without it, grid nodes or FE nodes of a
unilateral pair use parallel-axes kinematics only. Oil films are admitted alone, on one rigid surface.
"""

from __future__ import annotations

from typing import Any

from warpffrf.model.errors import InputError

SHAPES = ("cylinder", "crowned_cylinder")


def needs_nodes(scene: Any) -> bool:
    """Whether contacts at nodes have a feature that parallel-axes kinematics lack: friction, gaps at points, a rigid
    partner, another shape, or a nonlinear layer. Then all of them use the true shapes."""
    return any(_beyond(contact) is not None for contact in scene.finite_sliding)


def refuse_contacts(scene: Any, at_nodes: bool) -> None:
    """Raises `InputError` naming the contact and the cure: `at_nodes`, or warpffrf.simulate."""
    for lumped in scene.lumped_contacts:
        raise InputError(
            f"{lumped.label}: the monolithic reference has no lumped contacts; use warpffrf.simulate, or make a body "
            "flexible and use Contact(...)"
        )
    for lap in scene.small_sliding:
        raise InputError(
            f"{lap.label}: the monolithic reference has no small sliding; use warpffrf.simulate, which solves them "
            "exactly too, or Contact(...) between contact surfaces"
        )
    for contact in scene.finite_sliding:
        label = f"contact {contact.name!r}"
        if contact.quadrature == "reduced":
            raise InputError(f"{label}: the monolithic reference has no quadrature 'reduced'; use quadrature 'full'")
        if contact.grid == "contact_fixed":
            raise InputError(
                f"{label}: the monolithic reference has no cells that travel with the patch; use grid='body_fixed', or "
                "warpffrf.simulate"
            )
        beyond = _beyond(contact)
        if not at_nodes and beyond is not None and contact.law.bent is None:
            raise InputError(
                f"{label}: the monolithic reference has {beyond} with the law at nodes only; use at_nodes=True and a "
                "law with a stiffness, laws.LinearLayer(stiffness), or warpffrf.simulate"
            )
        if at_nodes and contact.friction.acts:
            for port in (contact.a, contact.b):
                if not port.rigid and port.surface.tangential is None:
                    raise InputError(
                        f"{label}: friction needs tangential modes, body {port.body.name!r} was reduced without them; "
                        "reduce(..., grid=ContactGrid(tangential=True))"
                    )


def refuse_films(scene: Any, local: str, variant: str) -> None:
    """Raises `InputError` naming the film, and the cure, for features that films of this solver do not support."""
    for film in scene.films:
        beyond = None
        if film.quadrature == "reduced":
            beyond, cure = "has no quadrature 'reduced' of films", "take quadrature='full'"
        elif not film.b.rigid:
            beyond, cure = f"has a rigid second surface of a film only, {film.b.label} is flexible", "make it rigid"
        elif film.mixed.asperities is not None:
            beyond, cure = "has no asperities in addition to a film", "leave asperities out"
        elif film.mixed.deviation > 0.0:
            beyond, cure = "has smooth walls of films only", "leave roughness out"
        elif film.oil.density is not None:
            beyond, cure = "has oils of constant density only", "leave density out"
        elif scene.finite_sliding:
            beyond, cure = "has films without contacts in addition to them", "take the contacts out"
        elif local != "quasi_static":
            beyond, cure = "has films on quasi-static local modes only", "take local='quasi_static'"
        elif variant != "full":
            beyond, cure = f"factors films anew, not as variant {variant!r}", "take variant='full'"
        if beyond is not None:
            raise InputError(f"{film.label}: the monolithic reference {beyond}; {cure}, or warpffrf.simulate")


def _beyond(contact: Any) -> str | None:
    """The feature of `contact` that parallel-axes kinematics lack, in words."""
    if contact.friction.acts:
        return "friction"
    if contact.kinematics == "closest_point":
        return 'kinematics="closest_point"'
    if contact.b.rigid:
        return f"a rigid partner, {contact.b.label},"
    for port in (contact.a, contact.b):
        if port.surface.shape.kind not in SHAPES:
            return f"a {port.surface.shape.kind}, {port.label},"
    return None if contact.law.bent is None else f"a {contact.law.kind}"
