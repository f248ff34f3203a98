"""Options of the monolithic reference."""

from __future__ import annotations

from typing import Any

from references.monolithic.core.linear import VARIANTS
from references.monolithic.line_of_centres.pair import LAWS
from warpffrf.model.errors import InputError, require_number

TOLERANCE = 1e-9  # of the residuals, as fractions


def check_choices(
    variant: str, law: str, layer_stiffness: float | None, stick_stiffness: float | None, tolerance: float
) -> None:
    """Raises `InputError` for options (see `references.monolithic.run.run`) that do not exist."""
    for name, value, known in (("variant", variant, VARIANTS), ("law", law, LAWS)):
        if value not in known:
            choice = ", ".join(map(repr, known))
            raise InputError(f"the monolithic reference: {name} must be one of {choice}, got {value!r}")
    require_number(tolerance, "the monolithic reference: tolerance", positive=True)
    if stick_stiffness is not None:
        require_number(stick_stiffness, "the monolithic reference: stick_stiffness", positive=True)
    if layer_stiffness is not None:
        require_number(layer_stiffness, "the monolithic reference: layer_stiffness", positive=True)
        if law == "hats":
            raise InputError(
                "the monolithic reference: layer_stiffness belongs to law='nodes'; law 'nodes' has no layer"
            )


def contact_layers(
    scene: Any, at_nodes: bool, law: str, layer_stiffness: float | None
) -> tuple[str, list[float | None]]:
    """The law for the contacts of `scene`, and the layer of each [Pa/m], None for the default one.

    With `at_nodes` these are nodes with the layer of each contact's own law, whatever `law` is, None for a law without
    a constant stiffness. Raises `InputError` if `layer_stiffness` contradicts that, for contacts without any layer
    there, and for layers elsewhere.
    """
    layers: list[float | None] = []
    for contact in scene.finite_sliding:
        label = f"contact {contact.name!r}"
        if not at_nodes:
            if contact.law.curve is not None:
                raise InputError(
                    f"{label}: the monolithic reference has no {contact.law.kind} but at nodes; use at_nodes=True, or "
                    "laws.Unilateral()"
                )
            layers.append(layer_stiffness)
            continue
        if contact.law.curve is None:
            raise InputError(
                f"{label}: at_nodes has no {contact.law.kind}; use laws.LinearLayer(stiffness) or another layer, as a "
                "law at nodes needs a stiffness, or at_nodes=False"
            )
        if layer_stiffness is not None:
            raise InputError(f"{label}: at_nodes takes the layer of the contact's own law; leave layer_stiffness out")
        layers.append(1.0 / contact.law.compliance if contact.law.compliance else None)
    return ("nodes" if at_nodes else law), layers
