"""The checked arguments of `reduce`: everything that determines the numbers of a reduced body.

Doubts. Implausible input of a reduction: warned of before the computation begins, and repeated in the report.

Units and shape of the mesh are checked by `warpffrf.model.mesh.report`. This module checks the numbers of the contact
and of the basis: a half-width that is impossible on such a surface (given in mm), and a frequency below which there is
no mode (given in kHz).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_count, require_number
from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.model.reduced.contact_grid import KINDS, require_kind
from warpffrf.model.surfaces import Matched
from warpffrf.offline.bases import Basis, basis_options
from warpffrf.offline.contact.hat_loads import ContactFacets
from warpffrf.offline.inertia.invariants import require_cells
from warpffrf.offline.inertia.membrane import MEMBRANE
from warpffrf.offline.interfaces import INTERFACE_KINDS
from warpffrf.offline.products import Limits, resolve_shapes
from warpffrf.offline.small_sliding.cells import require_sets
from warpffrf.offline.solvers import require_solver
from warpffrf.offline.stress.plan import stress_settings

TANGENTIAL = "cells"  # for `tangential=True`: friction is solved in cells; hats were measured to be less accurate
CYCLIC_BASES = ("free_free", "craig_chang")  # their span is that of free vibration and attachment modes


@dataclass(frozen=True, eq=False)
class Settings:
    """Arguments of `reduce`; see there. `check` raises `InputError` for inadmissible values."""

    material: Material | Mapping[str, Material] | None
    interfaces: dict[str, str]
    contact: dict[str, Any]
    basis: Basis
    max_frequency: float | None
    modes: int | None
    traction_spacing: float | None
    expected_half_width: float | None
    contact_error: float
    traction: str
    tangential: str | None
    stress: dict[str, Any]
    local_dynamics: bool
    inertia_modes: int | None
    stiffening: bool | str
    centrifugal: bool
    periodic: bool | None
    solver: str | None
    memory_limit: int | None
    sampling_error: float | None = None
    contact_fixed: bool | None = None
    matched: dict[str, Matched] = field(default_factory=dict)
    membrane_modes: int | None = None

    @classmethod
    def of(
        cls,
        *,
        material: Any,
        interfaces: Mapping[str, str] | None,
        contact: Mapping[str, Any] | None,
        basis: Any,
        max_frequency: float | None,
        modes: int | None,
        traction_spacing: float | None,
        expected_half_width: float | None,
        contact_error: float,
        traction: str,
        tangential: bool | str,
        stress: Mapping[str, Any] | None,
        local_dynamics: bool,
        inertia_modes: int | None,
        stiffening: bool | str,
        centrifugal: bool,
        periodic: bool | None,
        solver: str | None,
        memory_limit: float | None,
        sampling_error: float | None = None,
        contact_fixed: bool | None = None,
        membrane_modes: int | None = None,
    ) -> Settings:
        """The settings for the arguments of `reduce`, checked as far as possible without the mesh."""
        options = basis_options(basis)
        options.check_limits(max_frequency, modes)
        if max_frequency is not None:
            max_frequency = require_number(max_frequency, "reduce: max_frequency", positive=True)
        if traction_spacing is not None:
            require_number(traction_spacing, "reduce: traction_spacing", positive=True)
        if expected_half_width is not None:
            require_number(expected_half_width, "reduce: expected_half_width", positive=True)
            if traction_spacing is not None:
                raise InputError(
                    "reduce: expected_half_width chooses the spacing of the contact grid; leave traction_spacing out"
                )
        require_number(contact_error, "reduce: contact_error", positive=True)
        if sampling_error is not None:
            _refuse_sampling(require_number(sampling_error, "reduce: sampling_error", positive=True), traction)
        if memory_limit is not None:
            memory_limit = int(require_number(memory_limit, "reduce: memory_limit", positive=True))
        if periodic not in (None, False):
            raise InputError(
                f"reduce: periodic must be None (used where the mesh has it) or False (never used), got {periodic!r}"
            )
        if not isinstance(local_dynamics, bool):
            raise InputError(f"reduce: local_dynamics must be True or False, got {local_dynamics!r}")
        if not isinstance(stiffening, bool) and stiffening != MEMBRANE:
            raise InputError(f"reduce: stiffening must be True or False, or {MEMBRANE!r}, got {stiffening!r}")
        if membrane_modes is not None:
            membrane_modes = _membrane_modes(membrane_modes, stiffening)
        if not isinstance(centrifugal, bool):
            raise InputError(f"reduce: centrifugal must be True or False, got {centrifugal!r}")
        if contact_fixed not in (None, True, False):
            raise InputError(
                f"reduce: contact_fixed must be True, False or None (where the mesh is coarse), got {contact_fixed!r}"
            )
        stress_settings(stress or {})  # raises unless it is {name: points}
        if not isinstance(tangential, (bool, type(None))) and str(tangential) not in KINDS:
            raise InputError(
                f"reduce: tangential must be True, False or one of {', '.join(map(repr, KINDS))}, got {tangential!r}"
            )
        if tangential is True:
            tangential = TANGENTIAL
        faces = _by_set(contact, "contact", '{"rim": surfaces.Cylinder()}, None for a fitted shape')
        return cls(
            material=material,
            interfaces=_by_set(interfaces, "interfaces", '{"bore": "rigid"}'),
            contact={name: shape for name, shape in faces.items() if not isinstance(shape, Matched)},
            basis=options,
            max_frequency=max_frequency,
            modes=None if modes is None else _count(modes, "modes"),
            traction_spacing=traction_spacing,
            expected_half_width=expected_half_width,
            contact_error=contact_error,
            traction=require_kind(traction),
            tangential=require_kind(tangential) if tangential else None,
            stress=dict(stress or {}),
            local_dynamics=local_dynamics,
            inertia_modes=None if inertia_modes is None else _count(inertia_modes, "inertia_modes"),
            stiffening=stiffening,
            centrifugal=centrifugal,
            periodic=periodic,
            solver=None if solver is None else require_solver(solver),
            memory_limit=memory_limit,
            sampling_error=sampling_error,
            contact_fixed=contact_fixed,
            matched={name: wanted.called(name) for name, wanted in faces.items() if isinstance(wanted, Matched)},
            membrane_modes=membrane_modes,
        )

    def check_against(self, mesh: Mesh) -> None:
        """Raises `InputError` for sets that the mesh does not have and for inadmissible combinations."""
        for name in self.basis.facet_sets:
            mesh.facets(name)
        for name, kind in self.interfaces.items():
            mesh.facets(name)
            if kind not in INTERFACE_KINDS:
                raise InputError(
                    f"interface {name!r}: kind {kind!r} does not exist; known: {', '.join(INTERFACE_KINDS)}"
                )
        if self.stiffening:
            require_cells(mesh, self.material, self.stiffening)
        require_sets(mesh, self.matched, self.contact, self.interfaces)
        for name, shape in self.contact.items():
            mesh.facets(name)
            if self.interfaces.get(name) == "rigid":
                raise InputError(
                    f"set {name!r} cannot be a rigid interface and a contact surface at once; use two sets"
                )
            if shape is not None and (isinstance(shape, type) or not hasattr(shape, "fitted")):
                raise InputError(f"contact {name!r}: {shape!r} is no surface shape; use surfaces.Cylinder() or None")

    @property
    def limits(self) -> Limits:
        """The requested modes."""
        omega = None if self.max_frequency is None else 2.0 * np.pi * self.max_frequency
        return Limits(self.modes, omega)

    @property
    def general_reason(self) -> str | None:
        """The reason why these settings require the general path for any mesh, or None."""
        if self.periodic is False:
            return "periodic=False"
        if self.matched:
            return "surfaces.Matched: the compliance of its cells is computed on the general path"
        if self.stiffening:
            return f"stiffening={self.stiffening!r}: geometric stiffness is computed on the general path"
        if self.basis.kind not in CYCLIC_BASES or self.basis != type(self.basis)():
            return f"basis {self.basis.kind!r} with these options is made on the general path"
        other = [name for name, kind in self.interfaces.items() if kind != "rigid"]
        if other:
            return f"interface {other[0]!r} is not rigid"
        return None

    def describe(self, mesh: Mesh) -> dict[str, Any]:
        """Plain data for provenance and the cache key, excluding how it is computed (solver, threads)."""
        return {
            "mesh": mesh.content_hash(),
            "material": _numbers(self.material),
            "interfaces": self.interfaces,
            "contact": {name: None if s is None else s.describe() for name, s in self.contact.items()},
            "basis": self.basis.describe(),
            "max_frequency": self.max_frequency,
            "modes": self.modes,
            "traction_spacing": self.traction_spacing,
            "expected_half_width": self.expected_half_width,
            "contact_error": self.contact_error if self.expected_half_width is not None else None,
            "traction": self.traction,
            "tangential": self.tangential,
            "stress": stress_settings(self.stress),
            "local_dynamics": self.local_dynamics,
            "inertia_modes": self.inertia_modes,
            "stiffening": self.stiffening,
            "membrane_modes": self.membrane_modes,
            "centrifugal": self.centrifugal,
            "periodic": self.periodic,
            "memory_limit": self.memory_limit,
            "sampling_error": self.sampling_error,
            "contact_fixed": self.contact_fixed,
            "matched": [[name, face.describe()] for name, face in self.matched.items()],
        }


def _by_set(value: Any, what: str, example: str) -> dict[str, Any]:
    """`value` as a dict keyed by set names; raises `InputError` for anything else."""
    if value is None:
        return {}
    if not isinstance(value, Mapping) or not all(isinstance(name, str) for name in value):
        raise InputError(f"reduce: {what} must be {{facet set: ...}}, such as {example}; got {value!r}")
    return dict(value)


def _refuse_sampling(error: float, traction: str) -> None:
    """Raises `InputError` for an error of 1 or more, and for tractions without sampling points."""
    if error >= 1.0:
        raise InputError(f"reduce: sampling_error is a fraction below 1, got {error:g}; for one per cent give 0.01")
    if traction == "cells":
        raise InputError(
            "reduce: sampling points are chosen for hats; use traction='hats', or leave sampling_error out"
        )


def _membrane_modes(modes: Any, stiffening: bool | str) -> int:
    """The number of modes with membrane energy; raises `InputError` for zero, and without membrane stiffening."""
    if stiffening != MEMBRANE:
        raise InputError(f"reduce: membrane_modes is a number of modes of stiffening={MEMBRANE!r}; ask for that, too")
    count = _count(modes, "membrane_modes")
    if not count:
        raise InputError(
            "reduce: membrane_modes=0 is a membrane basis without bending modes; give a number, or leave it out"
        )
    return count


def _count(modes: Any, name: str) -> int:
    if isinstance(modes, bool):
        raise InputError(f"reduce: {name} is a number of modes, got {modes}; leave it out for none")
    return require_count(modes, f"reduce: {name}", 0)


def _numbers(material: Material | Mapping[str, Material] | None) -> Any:
    """The properties of a material that affect numbers; its name does not."""
    if isinstance(material, Material):
        return [material.youngs_modulus, material.poisson_ratio, material.density, material.mixed]
    return None if material is None else {name: _numbers(one) for name, one in material.items()}


HALF_WIDTH = 0.5  # of radius or extent: a patch of this size is not a small contact, and no grid resolves less
FACETS = 50.0  # longest facet edge over the half-width: coarser meshes are not suited to it


def input_doubts(mesh: Mesh, settings: Settings) -> list[str]:
    """Doubts about mesh, materials and requested results: texts that name the item and the likely mistake."""
    known = settings.material if isinstance(settings.material, Material | Mapping) else None
    return [*mesh.report(known).warnings, *_half_width_doubts(mesh, settings)]


def _half_width_doubts(mesh: Mesh, settings: Settings) -> list[str]:
    half_width = settings.expected_half_width
    if half_width is None:
        return []
    found = []
    for name, shape in resolve_shapes(mesh, settings.contact).items():
        facets = mesh.facets(name)
        flat = shape.profile().planar
        size = 0.5 * float(np.ptp(mesh.points[facets.node_set], axis=0).max()) if flat else float(shape.radius)
        edge = ContactFacets.of(mesh.points, facets, shape).chart.edge
        said = f"contact {name!r}: expected_half_width={half_width:g} m"
        if half_width > HALF_WIDTH * size:
            what = "half the size of the surface" if flat else "the radius"
            found.append(
                f"{said} beside {what}, {size:.3g} m, is no small contact; lengths are in m, {half_width:g} mm is "
                f"{half_width * 1e-3:g}"
            )
        elif half_width * FACETS < edge:
            found.append(
                f"{said} is {edge / half_width:.0f} times smaller than the facets of the mesh, {edge:.3g} m; lengths "
                "are in m; if it is meant, refine the mesh (half_width=), or let pressures stand on cells that travel "
                "(contact_fixed=True)"
            )
    return found


def too_low(omega: Any, settings: Settings) -> list[str]:
    """A doubt if `max_frequency` was given and no vibration mode lies below it; `omega` (m,) [rad/s] of the basis."""
    asked = settings.max_frequency
    if asked is None or settings.modes == 0:
        return []
    frequencies = np.asarray(omega) / (2.0 * np.pi)
    if len(frequencies) and frequencies[0] <= asked:
        return []
    lowest = f", the lowest frequency of the basis is {frequencies[0]:.4g} Hz" if len(frequencies) else ""
    return [
        f"max_frequency={asked:g} Hz: no vibration mode of the body lies below it{lowest}; it is in Hz, {asked:g} kHz "
        f"is {asked * 1e3:g}; for attachment modes alone leave it out"
    ]
