"""The checked arguments of `reduce`: everything that determines the numbers of a reduced body.

Doubts. Implausible input of a reduction: warned of before the computation begins, and repeated in the report.

Units and shape of the mesh are checked by `warpffrf.model.mesh.report`. This module checks the numbers of the contact
and of the basis: a half-width that is impossible on such a surface (given in mm), and a frequency below which there is
no mode (given in kHz).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_number, unknown_name
from warpffrf.model.material import THERMAL, Material, Orthotropic, SolidMaterial
from warpffrf.model.mesh import Mesh
from warpffrf.model.surfaces import Matched
from warpffrf.model.thermal import BodyTemperature
from warpffrf.offline.bases import Basis, basis_options
from warpffrf.offline.contact.node_loads import ContactFacets
from warpffrf.offline.inertia.invariants import require_cells
from warpffrf.offline.interfaces import INTERFACE_KINDS
from warpffrf.offline.options import ContactGrid, ReductionOptions, require_modes
from warpffrf.offline.products import Limits, resolve_shapes
from warpffrf.offline.small_sliding.cells import require_sets
from warpffrf.offline.stress.plan import stress_settings
from warpffrf.offline.thermal import require_thermal_input

CYCLIC_BASES = ("free_free", "craig_chang")  # their span is that of free vibration and attachment modes


@dataclass(frozen=True, eq=False)
class Settings:
    """Arguments of `reduce`; see there. `check` raises `InputError` for inadmissible values."""

    material: SolidMaterial | Mapping[str, SolidMaterial] | None
    interfaces: dict[str, str]
    contact: dict[str, Any]
    basis: Basis
    max_frequency: float | None
    modes: int | None
    stress: dict[str, Any]
    grid: ContactGrid
    options: ReductionOptions
    matched: dict[str, Matched] = field(default_factory=dict)
    thermal: BodyTemperature | None = None

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
        stress: Mapping[str, Any] | None,
        grid: Any,
        options: Any,
        thermal: Any = None,
    ) -> Settings:
        """The settings for the arguments of `reduce`, checked as far as possible without the mesh."""
        chosen = basis_options(basis)
        chosen.check_limits(max_frequency, modes)
        if max_frequency is not None:
            max_frequency = require_number(max_frequency, "reduce: max_frequency", positive=True)
        stress_settings(stress or {})  # raises unless it is {name: points}
        faces = _by_set(contact, "contact", '{"rim": surfaces.Cylinder()}, None for a fitted shape')
        return cls(
            material=material,
            interfaces=_by_set(interfaces, "interfaces", '{"bore": "rigid"}'),
            contact={name: shape for name, shape in faces.items() if not isinstance(shape, Matched)},
            basis=chosen,
            max_frequency=max_frequency,
            modes=None if modes is None else require_modes(modes, "reduce: modes"),
            stress=dict(stress or {}),
            grid=_require(grid, ContactGrid, "grid"),
            options=_require(options, ReductionOptions, "options"),
            matched={name: wanted.called(name) for name, wanted in faces.items() if isinstance(wanted, Matched)},
            thermal=thermal,
        )

    def check_against(self, mesh: Mesh) -> None:
        """Raises `InputError` for sets that the mesh does not have and for inadmissible combinations."""
        for name in self.basis.facet_sets:
            mesh.facets(name)
        for name, kind in self.interfaces.items():
            if name in mesh.node_sets and kind != "rigid":
                raise InputError(
                    f"interface {name!r}: a node set is a rigid interface, got {kind!r}; use a facet set for a mean"
                )
            if name not in mesh.node_sets:
                mesh.facets(name)
            if kind not in INTERFACE_KINDS:
                raise unknown_name(f"interface {name!r}: kind", kind, INTERFACE_KINDS)
        if self.options.stiffening and mesh.structure.parts:
            raise InputError(
                f"reduce: stiffening={self.options.stiffening!r}: the geometric stiffness of shells and beams is not "
                "computed; leave it out, or mesh the body with solids"
            )
        if self.options.stiffening:
            require_cells(mesh, self.material, self.options.stiffening)
        require_sets(mesh, self.matched, self.contact, self.interfaces)
        if self.thermal is not None:
            require_thermal_input(mesh, self.material, self.thermal, self.contact)
        for name, shape in self.contact.items():
            mesh.facets(name)
            require_solid(mesh, name)
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
        if self.options.periodic is False:
            return "periodic=False"
        if self.matched:
            return "surfaces.Matched: the compliance of its cells is computed on the general path"
        if self.options.stiffening:
            return f"stiffening={self.options.stiffening!r}: geometric stiffness is computed on the general path"
        if self.thermal is not None:
            return "thermal=: temperature and expansion are computed on the general path"
        if self.basis.kind not in CYCLIC_BASES or self.basis != type(self.basis)():
            return f"basis {self.basis.kind!r} with these options is computed on the general path"
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
            "stress": stress_settings(self.stress),
            "grid": self.grid.describe(),
            "options": {name: value for name, value in asdict(self.options).items() if name != "solver"},
            "matched": [[name, face.describe()] for name, face in self.matched.items()],
            **({} if self.thermal is None else {"thermal": [self.thermal.describe(), _thermal_numbers(self.material)]}),
        }


def _by_set(value: Any, what: str, example: str) -> dict[str, Any]:
    """`value` as a dict keyed by set names; raises `InputError` for anything else."""
    if value is None:
        return {}
    if not isinstance(value, Mapping) or not all(isinstance(name, str) for name in value):
        raise InputError(f"reduce: {what} must be {{facet set: ...}}, such as {example}; got {value!r}")
    return dict(value)


def _require(value: Any, kind: type, name: str) -> Any:
    """`value`, a `kind` as argument `name`; raises `InputError` otherwise."""
    if not isinstance(value, kind):
        raise InputError(f"reduce: {name} must be a {kind.__name__}(...), got {value!r}")
    return value


def _numbers(material: SolidMaterial | Mapping[str, SolidMaterial] | None) -> Any:
    """The properties of a material that affect numbers; its name does not."""
    if isinstance(material, Material):
        return [material.youngs_modulus, material.poisson_ratio, material.density, material.mixed]
    if isinstance(material, Orthotropic):
        return [*asdict(replace(material, name="")).values()]
    return None if material is None else {name: _numbers(one) for name, one in material.items()}


def _thermal_numbers(material: Any) -> Any:
    """The thermal properties of materials."""
    if isinstance(material, Mapping):
        return {name: _thermal_numbers(one) for name, one in material.items()}
    return [getattr(material, name) for name in THERMAL]


def require_solid(mesh: Mesh, name: str) -> None:
    """Raises `InputError` if facets of the contact surface `name` are no faces of solid cells."""
    inside = np.zeros(len(mesh.points), dtype=bool)
    for nodes in mesh.cells.values():
        inside[nodes] = True
    if mesh.structure.parts and not inside[mesh.facets(name).node_set].all():
        raise InputError(
            f"contact {name!r}: it has facets of shells; contact surfaces need solid cells below them, so mesh the "
            "part in contact with solids"
        )


HALF_WIDTH = 0.5  # of radius or extent: a patch of this size is not a small contact, and no grid resolves less
FACETS = 50.0  # longest facet edge over the half-width: coarser meshes are not suited to it


def input_doubts(mesh: Mesh, settings: Settings) -> list[str]:
    """Doubts about mesh, materials and requested results: texts that name the item and the likely mistake."""
    known = settings.material if isinstance(settings.material, Material | Orthotropic | Mapping) else None
    return [*mesh.report(known).warnings, *_half_width_doubts(mesh, settings)]


def _half_width_doubts(mesh: Mesh, settings: Settings) -> list[str]:
    half_width = settings.grid.expected_half_width
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
                f"{said} is not small compared with {what}, {size:.3g} m; lengths are in m, {half_width:g} mm is "
                f"{half_width * 1e-3:g}"
            )
        elif half_width * FACETS < edge:
            found.append(
                f"{said} is {edge / half_width:.0f} times smaller than the facets of the mesh, {edge:.3g} m; lengths "
                "are in m; if it is meant, refine the mesh (half_width=), or use contact-fixed cells "
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
