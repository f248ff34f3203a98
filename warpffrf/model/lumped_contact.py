"""A lumped contact: one force between two rigid surfaces, a function of their approach at the nearest points.

`Contact` computes a pressure and requires a compliant body. Between rigid bodies only the neighbourhood of the contact
point deforms, according to a law: Hertz's, a roller by laminae, or any other (`warpffrf.model.laws.lumped`). Friction
acts at the same point (`warpffrf_kernels.lumped.forces`).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.bodies import SurfacePort
from warpffrf.model.errors import InputError, require_number
from warpffrf.model.friction import FrictionLike, as_lumped_friction
from warpffrf.model.laws.lumped import Approach, LumpedLaw, as_lumped_law
from warpffrf.model.laws.lumped.base import Meeting
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.moments import NO_RESISTANCE, Resistance, RollingResistance, as_rolling_resistance, spin_resistance
from warpffrf.model.placement.nearest import Nearest, curvatures_on, lamina_gap, nearest

OVERLAP_FRACTION = 1e-2  # of the smallest radius of curvature, as `warpffrf.model.checks.contacts` has it
STRAIGHT = 1e-6  # of the larger relative curvature: with a smaller one there is no single contact point


@named_arguments
class LumpedContact(reprs.Item):
    """Contact between the surfaces of two rigid bodies, or a rigid body and the ground, by a law of force over
    approach.

    a, b: `body["tread"]`, named in `add_rigid_body(surfaces=...)` or by `body.surface(shape, name=)`. law: one of
    `laws.LUMPED_LAWS`; by laminae the first surface is the roller. friction: the coefficient, or a friction law
    (`warpffrf.model.friction`), at the point of application of the force. rolling_resistance: None, or a law of the
    moment against rolling (`warpffrf.model.moments`), laws.RollingResistanceArm(lever, rolling_speed). spin: whether
    friction resists pivoting about the normal as well, of regularised friction on Hertz's ellipse. Forces are reported
    on the first body. overlap [m]: admissible overlap of the surfaces at the start of a run, None for a hundredth of
    their radius. name: default "<first body>-<second body>". Raises `InputError`.
    """

    scene_list = "lumped_contacts"
    kind = "lumped_contact"

    def __init__(
        self,
        a: SurfacePort,
        b: SurfacePort,
        *,
        law: LumpedLaw,
        friction: FrictionLike = 0.0,
        rolling_resistance: RollingResistance | None = None,
        spin: bool = False,
        overlap: float | None = None,
        name: str | None = None,
    ) -> None:
        for port, place in ((a, "first"), (b, "second")):
            if not isinstance(port, SurfacePort):
                raise InputError(
                    f"lumped contact: the {place} surface must be a surface of a rigid body or of the ground, "
                    "body['tread'] with 'tread' named in add_rigid_body(surfaces=...), got "
                    f"{getattr(port, 'label', None) or repr(getattr(port, 'name', port))}"
                )
        self.a, self.b = a, b
        self.name = f"{a.body.name}-{b.body.name}" if name is None else name
        label = self.label
        if a.body is b.body:
            raise InputError(f"{label}: body {a.body.name!r} in contact with itself is not supported; name two bodies")
        for port in self.ports:
            if not port.rigid:
                raise InputError(
                    f"{label}: {port.label} is a surface of a flexible body, whose deformation is not a function of a "
                    "single approach; use Contact(...) with the flexible body first, or a rigid body in its place"
                )
        self.law: LumpedLaw = as_lumped_law(law, label)
        self.friction = as_lumped_friction(friction, label)
        self.rolling_resistance = as_rolling_resistance(rolling_resistance, label)
        if not isinstance(spin, bool):
            raise InputError(f"{label}: spin must be True or False, got {spin!r}")
        self.spin = spin
        self.overlap = None if overlap is None else require_number(overlap, f"{label}: overlap", non_negative=True)
        self._require_shapes()
        self._moments(Meeting(label, (1.0, 1.0), 1.0))  # refuses options that are invalid at any pose

    @property
    def label(self) -> str:
        """Readable name, for messages."""
        return f"lumped contact {self.name!r}"

    @property
    def ports(self) -> tuple[SurfacePort, SurfacePort]:
        return self.a, self.b

    def nearest(self) -> Nearest:
        """The nearest points of the surfaces at the current initial pose; for a law by laminae one point of the
        line."""
        return nearest(self.a, self.b)

    def approach(self) -> Approach:
        """The law's parameters at the current initial pose. Raises `InputError` for surfaces to which it does not
        apply."""
        self._require_one_place()
        radius = 0.0 if self.law.by_laminae is False else float(self.a.surface.shape.radius)
        curvatures = (0.0, 0.0) if self.law.by_laminae else self._curvatures()
        return self.law.approach(Meeting(self.label, curvatures, radius))

    def moments(self) -> tuple[Resistance, Resistance] | None:
        """Rolling and pivoting resistance of each contact point at the current initial pose; None without any."""
        if self.rolling_resistance is None and not self.spin:
            return None
        line = self.law.by_laminae
        curvatures = self.nearest().curvatures if line else self._curvatures()
        return self._moments(Meeting(self.label, curvatures, float(self.a.surface.shape.radius) if line else 0.0))

    def gap(self) -> float:
        """Smallest gap [m] at the current initial pose, negative where the surfaces overlap."""
        if not self.law.by_laminae:
            return self.nearest().gap
        law = self.approach()
        return lamina_gap(self.a, self.b, law.z, law.drop)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        surfaces = {"a": [self.a.body.name, self.a.name], "b": [self.b.body.name, self.b.name]}
        laws: dict[str, Any] = {"law": self.law.describe(), "friction": self.friction.describe()}
        if self.rolling_resistance is not None:
            laws["rolling_resistance"] = self.rolling_resistance.describe()
        if self.spin:
            laws["spin"] = True
        return {"name": self.name, **surfaces, **laws, "overlap": self.overlap}

    def _moments(self, meeting: Meeting) -> tuple[Resistance, Resistance]:
        """Raises `InputError` for options that require a patch that the force law does not define, or other
        friction."""
        patch = self.law.patch(meeting)
        rolling = pivoting = NO_RESISTANCE
        if self.rolling_resistance is not None:
            rolling = self.rolling_resistance.resistance(patch, self.label)
        if self.spin:
            pivoting = spin_resistance(self.friction, patch, self.label)
        return rolling, pivoting

    def _curvatures(self) -> tuple[float, float]:
        small, large = self.nearest().curvatures
        if large <= 0.0 or small < -STRAIGHT * large:
            raise InputError(
                f"{self.label}: {self.a.label} is too conformal to {self.b.label} where they are nearest: they would "
                "touch at two points or all around; make the inner radius of curvature the smaller one"
            )
        if small < STRAIGHT * large:
            raise InputError(
                f"{self.label}: {self.a.label} and {self.b.label} touch along a line, where a point law has no single "
                "point; use laws.PalmgrenLine or laws.IsoLamina with the roller first, or give one of them a crown"
            )
        return small, large

    def _require_one_place(self) -> None:
        """Raises `InputError` for waves of a form deviation whose hollows the other surface would bridge."""
        for one, other in (self.ports, self.ports[::-1]):
            form = one.surface.form
            if form is None:
                continue
            hollow = form.most_hollow / float(one.surface.shape.radius) ** 2
            if hollow >= (ideal := curvatures_on(one, other)[0]):
                raise InputError(
                    f"{self.label}: the waves of {one.label} have hollows of {hollow:.4g} 1/m, which {other.label} "
                    f"bridges: it curves by {ideal:.4g} 1/m more than the ideal surface follows, and touches on both "
                    "sides; use lower or longer waves"
                )

    def _require_shapes(self) -> None:
        for port in self.ports:
            if port.surface.shape.profile().free:
                raise InputError(
                    f"{self.label}: {port.label} is of kind {port.surface.shape.kind}, which a lumped contact does not "
                    "support; use Contact(...) with a flexible body"
                )
        planar = [port.surface.shape.profile().planar for port in self.ports]
        if all(planar):
            raise InputError(
                f"{self.label}: {self.a.label} and {self.b.label} are both planes, which have no single contact "
                "point; put balls or rollers between them, or use a joint"
            )
        if not self.law.by_laminae:
            return
        if self.a.surface.form is not None:
            raise InputError(
                f"{self.label}: {self.a.label} is cut into round laminae, and its form deviation would be lost; give "
                "the form to the other surface"
            )
        name = type(self.law).__name__
        if planar[0] or self.a.surface.shape.side < 0.0:
            swap = not planar[1] and self.b.surface.shape.side > 0.0
            swapped = f"LumpedContact({self.b.label}, {self.a.label}, ...)"
            raise InputError(
                f"{self.label}: laws.{name} cuts the first surface into laminae, which must be the outside of a "
                f"roller, {self.a.label} is not; {swapped if swap else 'take a cylinder as the first surface'}"
            )


def allowed_overlap(contact: LumpedContact) -> float:
    """Depth [m] by which the surfaces may overlap at the start of a run."""
    if contact.overlap is not None:
        return contact.overlap
    at = contact.nearest().place
    largest = 0.0
    for port in contact.ports:
        shape = port.surface.shape
        largest = max(largest, float(np.max(np.abs(shape.curvatures(*shape.chart(port.body.to_user(at))[:2])))))
    return OVERLAP_FRACTION / largest


def refuse_lumped_overlap(contacts: list[LumpedContact]) -> None:
    """Raises `InputError` for surfaces that overlap at the initial pose by more than is allowed."""
    for contact in contacts:
        gap = contact.gap()
        if gap < 0.0 and -gap > (allowed := allowed_overlap(contact)):
            raise InputError(
                f"{contact.label}: the surfaces {contact.a.label} and {contact.b.label} overlap at the start by "
                f"{-gap:.3g} m, more than the {allowed:.3g} m that are allowed; move a body, or allow it with "
                f"LumpedContact(..., overlap={-1.05 * gap:.2g})"
            )
