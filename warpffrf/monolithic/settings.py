"""What can be chosen about the monolithic reference: `simulate(method=Monolithic(law="hats"))`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from warpffrf.model.errors import InputError, require_number
from warpffrf.monolithic.core.linear import VARIANTS
from warpffrf.monolithic.line_of_centres.pair import LAWS

TOLERANCE = 1e-9  # of the residuals, as fractions


@dataclass(frozen=True)
class Monolithic:
    """The method "monolithic" of `simulate` with other choices than its own, which are the conventional ones.

    variant: how the linear systems are solved, "full" (dense LU in each iteration), "modified" (kept LU) or "low_rank"
    (local coordinates condensed), see `warpffrf.monolithic.core.linear`. law: "nodes", a stiff layer at every FE node
    of the first surface, or "hats", the weak unilateral law of the separated solver. layer_stiffness [Pa/m] of law
    "nodes"; None: 300 times that of the surface under it. stick_stiffness [Pa/m]: of nodes that stick, where contacts
    of evaluation "full" have Coulomb friction; None: of the layer (`warpffrf.monolithic.nodal.friction`). tolerance: of
    the residuals, as fractions. Raises `InputError`.
    """

    variant: str = "full"
    law: str = "nodes"
    layer_stiffness: float | None = None
    tolerance: float = TOLERANCE
    stick_stiffness: float | None = None

    def __post_init__(self) -> None:
        for name, known in (("variant", VARIANTS), ("law", LAWS)):
            value = getattr(self, name)
            if value not in known:
                choice = ", ".join(map(repr, known))
                raise InputError(f"method 'monolithic': {name} must be one of {choice}, got {value!r}")
        require_number(self.tolerance, "method 'monolithic': tolerance", positive=True)
        if self.stick_stiffness is not None:
            require_number(self.stick_stiffness, "method 'monolithic': stick_stiffness", positive=True)
        if self.layer_stiffness is not None:
            require_number(self.layer_stiffness, "method 'monolithic': layer_stiffness", positive=True)
            if self.law == "hats":
                raise InputError("method 'monolithic': layer_stiffness belongs to law='nodes'; law 'hats' has no layer")


def contact_layers(scene: Any, full: bool, law: str, layer_stiffness: float | None) -> tuple[str, list[float | None]]:
    """The law for the contacts of `scene`, and the layer of each [Pa/m], None for the default one.

    With evaluation "full" (`full`) these are nodes with the layer of each contact's own law, whatever `law` says, None
    of a law that has no one stiffness. Raises `InputError` where `layer_stiffness` contradicts that, for full contacts
    without any layer, and for layers elsewhere.
    """
    layers: list[float | None] = []
    for contact in scene.contacts:
        label = f"contact {contact.name!r}"
        if not full:
            if contact.law.curve is not None:
                raise InputError(
                    f"{label}: method 'monolithic' has no {contact.law.kind} but at nodes; use evaluation='full', or "
                    "laws.Unilateral()"
                )
            layers.append(layer_stiffness)
            continue
        if contact.law.curve is None:
            raise InputError(
                f"{label}: evaluation 'full' has no {contact.law.kind}; use laws.LinearLayer(stiffness) or another "
                "layer, as a law at nodes needs a stiffness, or method 'separated' with evaluation 'semi'"
            )
        if layer_stiffness is not None:
            raise InputError(
                f"{label}: evaluation 'full' takes the layer of the contact's own law; leave layer_stiffness out"
            )
        layers.append(1.0 / contact.law.compliance if contact.law.compliance else None)
    return ("nodes" if full else law), layers
