r"""Forces spread over the nodes of a free interface.

An interface of kind "free" keeps its nodes X_k and the displacement of the global modes there, `node_modes`. Forces F_k
at the nodes, times a signal, turn with the body:

    force = sum F_k,      torque = sum X_k cross F_k,      f_m = sum_k node_modes_mk . F_k.

Local modes move none of these nodes, so this is all the body feels. Rigid and averaging interfaces keep only their
resultant motion; a `PointForce` and a `PointTorque` are all that can be applied to them.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.arguments import Matrix, Vector
from warpffrf.model.bodies import Body, Port, PortLike, as_port
from warpffrf.model.errors import InputError, require_array
from warpffrf.model.forces.force import Force
from warpffrf.model.forces.laws import BodyLoad
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.signals import SignalLike, as_signal


@named_arguments
class NodalLoad(Force):
    """Forces on the nodes of a free interface of a flexible body, in body axes.

    port: `body['name of the interface']`. forces: (k, 3) [N], one a node in the order of the interface's `nodes`, or
    (3,), a total that is shared equally. signal: a number or signal [-] that multiplies them. Raises
    `InputError` for another kind of interface.
    """

    kind = "nodal_load"

    def __init__(
        self,
        port: PortLike,
        forces: Vector | Matrix,
        *,
        signal: SignalLike = 1.0,
        name: str | None = None,
    ) -> None:
        label = f"nodal load {name!r}" if name else "nodal load"
        self.name = name
        self.port = as_port(port, f"{label}: port")
        interface = self._interface()
        if interface is None or interface.nodes is None:
            raise InputError(
                f"{label}: {self.port.label} keeps no nodes; reduce the body with interfaces={{name: 'free'}}, or "
                "apply the resultant with PointForce and PointTorque"
            )
        count = len(interface.nodes)
        if np.ndim(np.asarray(forces)) == 1:
            forces = np.tile(require_array(forces, f"{label}: forces", (3,)) / count, (count, 1))
        self.forces = require_array(forces, f"{label}: forces", (count, 3))
        self.signal = as_signal(signal, f"{label}: signal")

    def _interface(self) -> Any:
        body, name = self.port.body, self.port.interface_name
        if not isinstance(body, Body) or body.reduced is None or name is None:
            return None
        return body.reduced.interfaces[name]

    @property
    def ports(self) -> tuple[Port, ...]:
        return (self.port,)

    def load(self) -> BodyLoad:
        """Resultants and modal forces of the forces, body axes, about the user origin."""
        interface = self._interface()
        torque = np.cross(interface.nodes, self.forces).sum(axis=0)
        modal = np.einsum("mki,ki->m", interface.node_modes, self.forces)
        return BodyLoad(self.port.body, self.forces.sum(axis=0), torque, modal, self.signal)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        fields = {"kind": self.kind, "name": self.name, "port": self.port.describe()}
        return {**fields, "forces": self.forces.tolist(), "signal": self.signal.describe()}
