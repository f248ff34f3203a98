"""Options of `reduce`: the contact grid of its surfaces, and settings that are rarely needed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from warpffrf.model.errors import InputError, require_count, require_number
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.reduced.contact_grid import require_kind
from warpffrf.offline.inertia.membrane import MEMBRANE
from warpffrf.offline.solvers import require_solver

TANGENTIAL = "cells"  # for `tangential=True`: friction is solved in cells; nodes were measured to be less accurate


@named_arguments
@dataclass(frozen=True)
class ContactGrid:
    """The grid of tractions on the contact surfaces of a reduced body, for `reduce(grid=...)`.

    spacing [m]: distance of its nodes; None: the surface nodes of a structured mesh, otherwise the longest facet edge.
    expected_half_width [m], force_error: alternative to a spacing: the half-width of the smallest contact patch of
        interest and the admissible grid error of the contact force; the rule is given in `contact_spacing`.
    traction, tangential: shape functions of the normal tractions, "nodes" (bilinear functions of the nodes of the
        grid) or "cells" (constants on cells around the nodes), and of the two tangential directions: False (none),
        True ("cells"), "nodes" or "cells".
    contact_fixed: also compute the data for pressures on a contact-fixed grid, which travels with the patch and is much
        finer than the mesh (`warpffrf.model.reduced.far_field`). None: for contact surfaces whose mesh is too coarse
        for pressures on its own grid, where possible; True: for all, with an error that states why if impossible;
        False: for none. With `tangential=` on cells it also serves friction. The cost is the solution of some hundred
        to thousand dofs for every few dozen functions of the contact grid (of one sector). The cells near the surface
        must be of one material.
    sampling_error: also choose a small set of sampling points on each contact surface for
        `Contact(quadrature="reduced")`, so that the error of the integrals of training patches is at most this
        fraction of their size; None: no such points. 0.01 requires a third of the points of quadrature "full", see
        `warpffrf.offline.contact.cubature`. Requires traction="nodes".

    Raises `InputError` for numbers that are not positive, words that do not exist, and a spacing together with an
    expected half-width.

    >>> wf.ContactGrid(expected_half_width=0.3e-3, tangential=True).force_error
    0.01
    """

    spacing: float | None = None
    expected_half_width: float | None = None
    force_error: float = 0.01
    traction: Literal["nodes", "cells"] = "nodes"
    tangential: bool | Literal["nodes", "cells"] = False
    contact_fixed: bool | None = None
    sampling_error: float | None = None

    def __post_init__(self) -> None:
        require_kind(self.traction, "ContactGrid: traction")
        if not isinstance(self.tangential, bool | None):
            require_kind(self.tangential, "ContactGrid: tangential must be True, False or a kind of functions:")
        for name in ("spacing", "expected_half_width", "sampling_error"):
            if getattr(self, name) is not None:
                require_number(getattr(self, name), f"ContactGrid: {name}", positive=True)
        require_number(self.force_error, "ContactGrid: force_error", positive=True)
        if self.spacing is not None and self.expected_half_width is not None:
            raise InputError("ContactGrid: expected_half_width chooses the spacing of the grid; leave spacing out")
        if self.contact_fixed not in (None, True, False):
            raise InputError(
                "ContactGrid: contact_fixed must be True, False or None (where the mesh is coarse), "
                f"got {self.contact_fixed!r}"
            )
        if self.sampling_error is not None and self.sampling_error >= 1.0:
            raise InputError(
                f"ContactGrid: sampling_error is a fraction below 1, got {self.sampling_error:g}; for one per cent "
                "give 0.01"
            )
        if self.sampling_error is not None and self.traction == "cells":
            raise InputError(
                "ContactGrid: sampling points are chosen for tractions on nodes; use traction='nodes', or leave "
                "sampling_error out"
            )

    @property
    def tangential_kind(self) -> str | None:
        """Shape functions of the tangential tractions; None: none."""
        return TANGENTIAL if self.tangential is True else self.tangential or None

    def describe(self) -> dict[str, Any]:
        """Plain data for provenance and the cache key."""
        return {
            "spacing": self.spacing,
            "expected_half_width": self.expected_half_width,
            "force_error": self.force_error if self.expected_half_width is not None else None,
            "traction": self.traction,
            "tangential": self.tangential_kind,
            "contact_fixed": self.contact_fixed,
            "sampling_error": self.sampling_error,
        }


@named_arguments
@dataclass(frozen=True)
class ReductionOptions:
    """Settings of a reduction that are rarely needed, for `reduce(options=...)`.

    local_dynamics: True: also compute the mass of the local modes, required for dynamic local modes
        (`warpffrf.model.reduced.local_modes`); one additional solution per unit load on the general path.
    inertia_modes: number of global modes, lowest first, with inertia terms (`warpffrf.model.reduced.inertia`); None:
        all up to 60. `report["inertia"]` states the number.
    stiffening: True: also compute the geometric stiffness of these modes due to prestress from rotation and from
        interface loads; on the general path. "membrane": also the membrane energy of plates, frames and shells with
        deflections of their thickness or more, `warpffrf.model.reduced.inertia`; requires cells that do
        not lock in bending, and enough bending modes.
    membrane_modes: number of modes, lowest first, with membrane energy; None: up to 20. n modes require n (n + 1)/2
        static responses. Only with stiffening="membrane".
    centrifugal: True: also include the attachment modes of rotation, the static responses to the products of the
        components of the angular velocity. Expansion and bending under the body's own rotation are then exact for any
        number of modes. Intended for fast rotors, discs, rings and blades: the vibration modes of a round body hardly
        represent that shape. Adds six modes; if `inertia_modes` is omitted, inertia terms extend to as many modes as
        these need.
    periodic: None: rotational periodicity is used, and detected in meshes that do not declare it; False: never used.
    solver: name of an installed direct solver for large systems; None: the default, see `report["solver"]`.
    memory_limit [byte]: bound on factors, dense operators and blocks of right-hand sides of the general path together;
        None: 8 GiB.

    Raises `InputError` for values of the wrong kind, a solver that is not installed, and membrane modes without
    membrane energy.

    Of a blade that spins, for `reduce(options=...)`:

    >>> wf.ReductionOptions(stiffening=True, centrifugal=True).stiffening
    True
    """

    local_dynamics: bool = False
    inertia_modes: int | None = None
    stiffening: bool | Literal["membrane"] = False
    membrane_modes: int | None = None
    centrifugal: bool = False
    periodic: bool | None = None
    solver: str | None = None
    memory_limit: float | None = None

    def __post_init__(self) -> None:
        for name in ("local_dynamics", "centrifugal"):
            if not isinstance(value := getattr(self, name), bool):
                raise InputError(f"ReductionOptions: {name} must be True or False, got {value!r}")
        if not isinstance(self.stiffening, bool) and self.stiffening != MEMBRANE:
            raise InputError(
                f"ReductionOptions: stiffening must be True or False, or {MEMBRANE!r}, got {self.stiffening!r}"
            )
        for name in ("inertia_modes", "membrane_modes"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, require_modes(getattr(self, name), f"ReductionOptions: {name}"))
        if self.membrane_modes is not None and self.stiffening != MEMBRANE:
            raise InputError(
                f"ReductionOptions: membrane_modes is a number of modes of stiffening={MEMBRANE!r}; set that, too"
            )
        if self.membrane_modes == 0:
            raise InputError(
                "ReductionOptions: membrane_modes=0 is a membrane basis without bending modes; give a number, or leave "
                "it out"
            )
        if self.periodic not in (None, False):
            raise InputError(
                "ReductionOptions: periodic must be None (used where the mesh has it) or False (never used), "
                f"got {self.periodic!r}"
            )
        if self.solver is not None:
            require_solver(self.solver)
        if self.memory_limit is not None:
            require_number(self.memory_limit, "ReductionOptions: memory_limit", positive=True)


def require_modes(modes: Any, name: str) -> int:
    """`modes` as a number of modes of at least 0; raises `InputError` otherwise, naming `name`."""
    if isinstance(modes, bool):
        raise InputError(f"{name} is a number of modes, got {modes}; leave it out for none")
    return require_count(modes, name, 0)
