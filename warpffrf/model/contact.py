"""A contact between two surfaces: the surfaces it may join and the conditions on them.

The first surface carries the contact grid, so it is a surface of a flexible body. The second may be flexible too, or
the rigid surface of a rigid body or of the ground. Two rigid surfaces have no compliance and no pressure between them:
such a contact is refused; use a `LumpedContact`. The gap between the true shapes is computed in `gap`;
`checks.exclusive_unknowns` defines which contacts may share two surfaces. Contact with small sliding (joint interfaces)
is between faces of any shape, `surfaces.Matched`, whose cells keep their partners (`warpffrf.model.small_sliding`).
"""

from __future__ import annotations

from dataclasses import asdict
from typing import Any, Literal

import numpy as np

from warpffrf.model.bodies import SurfacePort
from warpffrf.model.errors import InputError, require_array, require_count, require_number, unknown_name
from warpffrf.model.friction import FrictionLaw, FrictionLike, as_constant_friction, as_pair_friction
from warpffrf.model.laws import Law, Unilateral, as_law
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.reduced.far_field import LONGEST, UNUSABLE
from warpffrf.model.small_sliding import SmallSliding
from warpffrf.model.small_sliding.sliding import as_sliding, check_law, check_ports
from warpffrf.model.surfaces.form_deviations import refuse_form

UNILATERAL = Unilateral()
QUADRATURES = ("full", "reduced")
GRIDS = ("auto", "body_fixed", "contact_fixed")
KINEMATICS = ("auto", "closest_point")
CELL_ERROR = 0.005  # of force and largest pressure: the size of the errors of half-space and mesh
CELL_ERRORS = (5e-4, 0.02)  # 2,400 cells; seven strips, below which the error follows no rule


@named_arguments
class Contact(reprs.Item):
    """Contact between two contact surfaces a and b, `body["rim"]` each; a must be of a flexible body.

    sliding: "finite", or "small" (or a `SmallSliding` with its options) for faces of any shape that slide on each other
    by less than the size of a cell, as in bolted and riveted joints, leaf springs and press fits. a is then a face
    reduced as `surfaces.Matched`, b one of another flexible body, or a surface of a rigid body or the ground; b is
    omitted where `Matched(second=...)` names the opposite face of the same body. The cells are paired at the initial
    pose. Of the other options only law, `laws.UNILATERAL` or `laws.LinearLayer`, and friction, `friction.Coulomb`,
    apply. Forces are reported on the second face.

    Otherwise forces are reported on the first body. law: contact law (`warpffrf.model.laws`), default unilateral
    contact. friction: the coefficient, or a friction law (`warpffrf.model.friction`); above 0 it requires flexible
    bodies reduced with tangential=True. quadrature: of the law, "full" at all points of the contact grid (semi-hyper-
    reduction, SHR), "reduced" at the few points chosen when the first body was reduced (hyper-reduction, HR). grid:
    "body_fixed", pressures on the contact grid of the first body, fixed to its material, which requires four nodes per
    contact half-width; "contact_fixed", on cells that move with the patch, for meshes of any size (bodies reduced on
    coarse meshes, or with contact_fixed=True); "auto", the latter where bodies and options allow it, as reported in the
    notes of a run.
    cell_error: admissible contribution of the patch cells to the relative error of force and largest pressure, 0.0005
    to 0.02; after a run a note reports the change with finer cells at some saved steps. kinematics: computation of the
    gap: "auto", parallel-axes kinematics for rollers whose axes are parallel at the start, which is fast; otherwise, or
    with "closest_point", at points of both surfaces, which also holds for axes that tilt later. cells: strips across,
    rows along, None: chosen for that error; instead of the number of rows their boundaries (n + 1,) [m] along the axis
    of the first surface, rising, for several places of a profile that touch at once. capacity: largest number of active
    nodes, None: chosen automatically. overlap [m]: admissible overlap of the surfaces at the start of a run, None for a
    small fraction of their radius.
    name: default "<first body>-<second body>". Raises `InputError` for incompatible surfaces, laws and
    options.

    Of `lower` and `upper`, bodies as in `Scene.add_body`:

    >>> contact = scene.add(wf.Contact(lower["rim"], upper["rim"]))
    >>> contact.name
    'lower-upper'
    >>> closed_by = scene.close_gap(contact)  # m, that the upper one was moved down
    """

    scene_list = "contacts"
    kind = "contact"

    def __init__(
        self,
        a: SurfacePort,
        b: SurfacePort | None = None,
        *,
        sliding: Literal["finite", "small"] | SmallSliding = "finite",
        law: Law = UNILATERAL,
        friction: FrictionLike = 0.0,
        quadrature: Literal["full", "reduced"] = "full",
        grid: Literal["auto", "body_fixed", "contact_fixed"] = "auto",
        kinematics: Literal["auto", "closest_point"] = "auto",
        cell_error: float = CELL_ERROR,
        cells: tuple[int, Any] | None = None,
        capacity: int | None = None,
        overlap: float | None = None,
        name: str | None = None,
    ) -> None:
        self._sliding = as_sliding(sliding)
        self.a = a
        self.b: Any = b  # None where both faces are on one body
        if self.sliding is not None:
            self.name = check_ports(a, b, name)
        else:
            for port, place in ((a, "first"), (b, "second")):
                _require_surface(port, place)
            self.name = f"{a.body.name}-{self.b.body.name}" if name is None else name
            self._require_bodies(a, self.b)
        self.law = law
        self.friction = friction
        self.quadrature = quadrature
        self.cell_error = cell_error
        self.cells = cells
        self.grid = grid
        self.kinematics = kinematics
        self.capacity = capacity
        self.overlap = overlap
        # where surfaces meet that are apart at the initial pose, a `placement.nearest.FacingPlace`; None: found there
        self.meeting: Any = None

    def _require_bodies(self, a: SurfacePort, b: SurfacePort) -> None:
        label = self.label
        if a.body is b.body:
            raise InputError(f"{label}: body {a.body.name!r} in contact with itself is not supported; name two bodies")
        if a.rigid and b.rigid:
            raise InputError(
                f"{label}: {a.label} and {b.label} are both rigid, and without any compliance there is no pressure "
                f"between them; use LumpedContact({a.label}, {b.label}, ...), a force against their approach, or make "
                "one of the two a flexible body, scene.add_body(reduce(...)), and name it first"
            )
        if a.rigid:
            raise InputError(
                f"{label}: the first surface carries the contact grid and must be flexible, {a.label} is rigid; name "
                f"the flexible body first, Contact({b.label}, {a.label})"
            )
        if b.rigid:
            refuse_form(b, label)
            if getattr(b.surface.shape, "steep", False):
                raise InputError(
                    f"{label}: {b.label} is a cone too flat for distributed contact; use surfaces.Plane, or "
                    "LumpedContact between rigid bodies"
                )

    # attributes that may change before a run are checked when set

    @property
    def sliding(self) -> SmallSliding | None:
        """The options of small sliding; None for finite sliding."""
        return self._sliding

    @sliding.setter
    def sliding(self, value: Any) -> None:
        sliding = as_sliding(value)
        if (sliding is None) != (self._sliding is None):
            raise InputError(f"{self.label}: finite and small sliding are of other surfaces; add another contact")
        self._sliding = sliding

    @property
    def law(self) -> Law:
        """The contact law."""
        return self._law

    @law.setter
    def law(self, value: Any) -> None:
        law = as_law(value, self.label)
        if self.sliding is not None:
            check_law(law, self.label)
        self._law = law
        self._check_patch()

    @property
    def friction(self) -> FrictionLaw:
        """The friction law; a number is the coefficient of `Coulomb`."""
        return self._friction

    @friction.setter
    def friction(self, value: Any) -> None:
        if self.sliding is not None:
            self._friction = as_constant_friction(value, self.label)
            if self._friction.creep_limit:
                raise InputError(
                    f"{self.label}: friction of kind {self._friction.kind!r} does not stick; take friction.Coulomb"
                )
            return
        friction = as_pair_friction(value, self.label)
        if friction.acts:
            self._require_tangential(self.label)
        self._friction = friction
        self._check_patch()

    @property
    def quadrature(self) -> str:
        """Quadrature of the law, one of QUADRATURES."""
        return self._quadrature

    @quadrature.setter
    def quadrature(self, value: Any) -> None:
        self._finite_only("quadrature", value, "full")
        if value not in QUADRATURES:
            raise unknown_name(f"{self.label}: quadrature", value, QUADRATURES)
        if value == "reduced" and self.a.surface.sampling is None:
            raise InputError(
                f"{self.label}: quadrature='reduced' needs points chosen offline, body {self.a.body.name!r} was "
                "reduced without them; reduce(..., grid=ContactGrid(sampling_error=0.01)), or use quadrature='full'"
            )
        self._quadrature = str(value)
        self._check_patch()

    @property
    def grid(self) -> str:
        """Grid of the pressures, one of GRIDS."""
        return self._grid

    @grid.setter
    def grid(self, value: Any) -> None:
        self._finite_only("grid", value, "auto")
        if value not in GRIDS:
            raise unknown_name(f"{self.label}: grid", value, GRIDS)
        self._grid = str(value)
        self._check_patch()

    @property
    def kinematics(self) -> str:
        """Kinematics of the gap, one of KINEMATICS."""
        return self._kinematics

    @kinematics.setter
    def kinematics(self, value: Any) -> None:
        self._finite_only("kinematics", value, "auto")
        if value not in KINEMATICS:
            raise unknown_name(f"{self.label}: kinematics", value, KINEMATICS)
        self._kinematics = str(value)

    @property
    def cell_error(self) -> float:
        """Admissible contribution of the patch cells to the relative error of force and largest pressure."""
        return self._cell_error

    @cell_error.setter
    def cell_error(self, value: Any) -> None:
        self._finite_only("cell_error", value, CELL_ERROR)
        error = require_number(value, f"{self.label}: cell_error", positive=True)
        if not CELL_ERRORS[0] <= error <= CELL_ERRORS[1]:
            raise InputError(
                f"{self.label}: cell_error must lie between {CELL_ERRORS[0]:g} and {CELL_ERRORS[1]:g}, got "
                f"{error:g}; cells=(strips across, rows along) allows other grids"
            )
        self._cell_error = error

    @property
    def cells(self) -> tuple[int, Any] | None:
        """Strips across, and rows along of a patch of cells or their boundaries [m]; None: chosen automatically."""
        return self._cells

    @cells.setter
    def cells(self, value: Any) -> None:
        self._finite_only("cells", value, None)
        if value is None:
            self._cells = None
            return
        try:
            across, along = value
        except (TypeError, ValueError):
            raise InputError(f"{self.label}: cells must be (strips across, rows along), got {value!r}") from None
        strips, label = require_count(across, f"{self.label}: strips across", 4), f"{self.label}: rows along"
        if np.ndim(along) == 0:
            self._cells = strips, require_count(along, label, 4)
            return
        edges = require_array(along, label, (None,))
        if len(edges) < 5 or not np.all(np.diff(edges) > 0.0):
            raise InputError(f"{label}: their boundaries must rise and be five or more")
        self._cells = strips, tuple(edges.tolist())

    @property
    def capacity(self) -> int | None:
        """Largest number of active nodes; None: chosen automatically."""
        return self._capacity

    @capacity.setter
    def capacity(self, value: Any) -> None:
        self._finite_only("capacity", value, None)
        self._capacity = None if value is None else require_count(value, f"{self.label}: capacity", 1)

    @property
    def overlap(self) -> float | None:
        """Admissible overlap [m] of the surfaces at the start of a run; None for a fraction of their radius."""
        return self._overlap

    @overlap.setter
    def overlap(self, value: Any) -> None:
        self._finite_only("overlap", value, None)
        name = f"{self.label}: overlap"
        self._overlap = None if value is None else require_number(value, name, non_negative=True)

    @property
    def label(self) -> str:
        """Readable name, for messages."""
        return f"contact {self.name!r}"

    @property
    def ports(self) -> tuple[SurfacePort, ...]:
        """Two, or one where both faces are on one body."""
        return (self.a,) if self.b is None else (self.a, self.b)

    def describe(self) -> dict[str, Any]:
        """Plain data for hashing."""
        surfaces = {side: [port.body.name, port.name] for side, port in zip("ab", self.ports, strict=False)}
        laws = {"law": self.law.describe(), "friction": self.friction.describe()}
        if self.sliding is not None:
            return {"name": self.name, **surfaces, **laws, "sliding": asdict(self.sliding)}
        options: dict[str, Any] = {"quadrature": self.quadrature, "capacity": self.capacity, "overlap": self.overlap}
        if self.grid != "auto":  # existing scenes keep their hash
            options |= {"grid": self.grid, "cells": None if self.cells is None else list(self.cells)}
        if self.kinematics != "auto":
            options["kinematics"] = self.kinematics
        if self.cell_error != CELL_ERROR:
            options["cell_error"] = self.cell_error
        return {"name": self.name, **surfaces, **laws, **options}

    def without_patch(self) -> str | None:
        """Why a contact-fixed grid is not possible, and the cure; None where it is."""
        for port in self.ports:
            if port.rigid:
                continue
            far = port.surface.far
            if far is None:
                return (
                    f"grid='contact_fixed' needs the far field of {port.label}, body {port.body.name!r} was reduced "
                    "without it; reduce(..., grid=ContactGrid(contact_fixed=True))"
                )
            if self.friction.acts and far.tangential is None:
                return (
                    f"friction on a patch needs the tangential far field of {port.label}, body {port.body.name!r} "
                    "was reduced without it; reduce(..., grid=ContactGrid(contact_fixed=True, tangential=True))"
                )
            if (long := _longer_than_wide(port.surface)) > LONGEST and not port.surface.half_space:
                return (
                    f"the contact grid of {port.label}, body {port.body.name!r}, is {long:.0f} times as long as wide, "
                    f"more than the {LONGEST:g} up to which contact-fixed cells are validated; use a mesh with "
                    "shorter facets along, or wider ones across"
                )
            tangential = far.tangential if self.friction.acts else None
            asymmetry = max(far.asymmetry, 0.0 if tangential is None else tangential.asymmetry)
            if asymmetry > UNUSABLE:
                return (
                    f"the half-space on the mesh of {port.label}, body {port.body.name!r}, is not symmetric "
                    f"({asymmetry:.0%}, {UNUSABLE:.0%} is allowed), so that its far field is wrong: its cells are too "
                    "long compared with their width, or too coarse; reduce it with squarer cells at the surface, "
                    "finer along the longer side, or quadratic ones"
                )
        if self.quadrature != "full":
            return (
                f"quadrature {self.quadrature!r} belongs to grid='body_fixed'; a patch of cells is evaluated at their "
                "middles, leave quadrature out"
            )
        return None

    def _finite_only(self, name: str, value: Any, default: Any) -> None:
        """Raises `InputError` for an option of finite sliding given to a contact with small sliding."""
        if self.sliding is not None and value is not default and value != default:
            raise InputError(
                f"{self.label}: {name} is an option of finite sliding only; leave it out. Cells with small sliding are "
                "those of surfaces.Matched(...) in reduce(contact=...)"
            )

    def _check_patch(self) -> None:
        """Raises `InputError` for options that a contact-fixed grid does not support."""
        if getattr(self, "_grid", "auto") == "contact_fixed" and (reason := self.without_patch()):
            raise InputError(f"{self.label}: {reason}")

    def _require_tangential(self, label: str) -> None:
        for port in self.ports:
            if not port.rigid and port.surface.tangential is None:
                raise InputError(
                    f"{label}: friction needs tangential modes, body {port.body.name!r} was reduced without them; "
                    "reduce(..., grid=ContactGrid(tangential=True))"
                )


def _require_surface(port: Any, place: str) -> None:
    if not isinstance(port, SurfacePort):
        raise InputError(
            f"contact: the {place} surface must be a contact surface, body['rim'] with 'rim' named in "
            "reduce(contact=...) or in add_rigid_body(surfaces=...), got "
            f"{getattr(port, 'label', None) or repr(getattr(port, 'name', port))}"
        )
    if port.matched:
        raise InputError(
            f"contact: the {place} surface, {port.label}, was reduced as surfaces.Matched, for small sliding; give "
            "sliding='small', or reduce the body with a shape in its place, such as surfaces.Cylinder()"
        )
    if not port.rigid and port.surface.unyielding:
        raise InputError(
            f"contact: the {place} surface, {port.label}, is of a rigid_film_body and has no compliance; it carries "
            "oil films only: give a rigid body the surface, or reduce a mesh"
        )
    kind = "nodes" if port.rigid else port.surface.grid.kind
    if kind != "nodes":
        raise InputError(
            f"contact: the {place} surface, {port.label}, was reduced with traction={kind!r}; normal contact "
            "is solved with tractions on nodes: reduce the body with traction='nodes'"
        )


def _longer_than_wide(surface: Any) -> float:
    """Ratio of the largest spacing of a contact grid along the meridian to that across."""
    z, planar = np.asarray(surface.grid.z), surface.shape.profile().planar
    across = surface.grid.pitch * (1.0 if planar else float(np.max(surface.shape.radius_at(z))))
    return float(np.diff(z).max(initial=0.0)) / across
