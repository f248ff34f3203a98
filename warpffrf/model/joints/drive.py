"""Prescribed motion of a joint coordinate."""

from __future__ import annotations

from typing import Any, Literal

from warpffrf.model.bodies import Port
from warpffrf.model.errors import InputError
from warpffrf.model.joints.base import Joint, Row
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.signals import Signal, SignalLike, as_signal

QUANTITIES = ("velocity", "position")


@named_arguments
class Drive(reprs.Item):
    """Prescribes a coordinate of a joint, or its rate.

    signal: a number or a signal; [rad/s] or [m/s] for quantity="velocity", [rad] or [m] for quantity="position", which
    counts from the initial pose (a distance: the length itself). coordinate: its name ("rotation", "translation", ...),
    needed where the joint has several; None takes the only one. A prescribed velocity is integrated exactly, so the
    position does not drift. Raises `InputError` for a coordinate that the joint does not have.

    With `machine` and `axle` as in `joints.Revolute`, accelerated to 100 rad/s, constant afterwards:

    >>> speed = wf.signals.SmoothStep(0, 100, duration=0.01)
    >>> motor = machine.add(wf.joints.Drive(axle, speed, quantity="velocity", name="motor"))
    """

    scene_list = "drives"
    kind = "drive"

    def __init__(
        self,
        joint: Joint,
        signal: SignalLike,
        *,
        quantity: Literal["velocity", "position"] = "velocity",
        coordinate: str | None = None,
        name: str | None = None,
    ) -> None:
        label = f"drive {name!r}" if name else "drive"
        if not isinstance(joint, Joint):
            raise InputError(f"{label}: a joint is needed, got {joint!r}")
        if quantity not in QUANTITIES:
            raise InputError(f"{label}: quantity must be one of {', '.join(QUANTITIES)}, got {quantity!r}")
        try:
            self.coordinate = joint.coordinate(coordinate)
        except InputError as error:
            raise InputError(f"{label}: {error}") from None
        self.name = name
        self.joint = joint
        self.quantity = quantity
        self.signal = as_signal(signal, f"{label}: signal")

    @property
    def ports(self) -> tuple[Port, Port]:
        return self.joint.ports

    @property
    def row(self) -> Row:
        """The joint's function that is prescribed."""
        return self.joint.coordinates[self.coordinate]

    def position(self) -> Signal:
        """The prescribed coordinate [rad or m] as a signal: the signal, or its integral from t = 0 (which is counted
        from the initial value of the coordinate)."""
        return self.signal if self.quantity == "position" else self.signal.integral()

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        fields = {"name": self.name, "joint": self.joint.name, "coordinate": self.coordinate}
        return {**fields, "quantity": self.quantity, **self.signal.describe()}
