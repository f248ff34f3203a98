"""Fixed joint: d = 0, A = 1 with d = A_a^T (x_b - x_a), A = A_a^T A_b; no coordinate."""

from __future__ import annotations

from warpffrf.model.arguments import Vector
from warpffrf.model.bodies import PortLike
from warpffrf.model.joints.base import NO_SPIN, PARALLEL, POINT, Joint
from warpffrf.model.messages.named_arguments import named_arguments


@named_arguments
class Fixed(Joint):
    """Holds b to a: no relative motion. `axis` only names the marker's z axis.

    >>> hold = scene.add(wf.joints.Fixed(scene.ground, lower["bore"], axis=(0, 1, 0), name="hold"))
    """

    kind = "fixed"
    rows = (*POINT, *PARALLEL, *NO_SPIN)

    def __init__(
        self,
        a: PortLike,
        b: PortLike,
        *,
        axis: Vector = (0.0, 0.0, 1.0),
        point: Vector | None = None,
        name: str | None = None,
    ) -> None:
        super().__init__(a, b, axis=axis, point=point, name=name)
