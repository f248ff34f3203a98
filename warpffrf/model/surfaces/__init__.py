"""True shapes of contact surfaces, one file per kind, given or fitted to nodes.

    outside   Cylinder  CrownedCylinder  ProfiledCylinder  Groove  Sphere  Cone  Plane
    inside    Bore      Ring (grooved)                             Cup     ConicalBore
    either    Extruded (along an axis, its section a `Curve`)  MeshSurface (over a plane, through the nodes of a mesh)

Their common base is in `base` (frame, fit), `revolution` (chart) and `profile` (the meridian's numbers). `SHAPES` lists
them by kind. A user-defined surface is a subclass of `RevolutionShape` with a `profile`, or of one of these. `Matched`
is a face of any shape for small-sliding contact, `railway` has the profiles of a wheel and a rail.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.surfaces.base import DEFAULT_FIT_FRACTION, Shape
from warpffrf.model.surfaces.cams import cam
from warpffrf.model.surfaces.curve import Curve
from warpffrf.model.surfaces.extruded import Extruded
from warpffrf.model.surfaces.matched import Matched
from warpffrf.model.surfaces.mesh_surface import MeshSurface
from warpffrf.model.surfaces.plane import Plane
from warpffrf.model.surfaces.profile import SurfaceProfile
from warpffrf.model.surfaces.profiled_cylinder import ProfiledCylinder, RevolutionShape
from warpffrf.model.surfaces.railway import rail_uic60, wheel_s1002
from warpffrf.model.surfaces.round import Bore, Cone, ConicalBore, CrownedCylinder, Cup, Cylinder, Groove, Ring, Sphere

__all__ = [
    "DEFAULT_FIT_FRACTION",
    "SHAPES",
    "Bore",
    "Cone",
    "ConicalBore",
    "CrownedCylinder",
    "Cup",
    "Curve",
    "Cylinder",
    "Extruded",
    "Groove",
    "Matched",
    "MeshSurface",
    "Plane",
    "ProfiledCylinder",
    "RevolutionShape",
    "Ring",
    "Shape",
    "Sphere",
    "SurfaceProfile",
    "cam",
    "from_description",
    "rail_uic60",
    "wheel_s1002",
]


def __dir__() -> list[str]:
    return __all__


_KINDS = (
    Cylinder, CrownedCylinder, ProfiledCylinder, Groove, Sphere, Cone, Plane, Bore, Ring, Cup, ConicalBore, Extruded,
    MeshSurface,
)  # fmt: skip
SHAPES: dict[str, type[Any]] = {shape.kind: shape for shape in _KINDS}


def from_description(description: dict[str, Any]) -> Any:
    """The shape from a `description` by `describe()`, of any class that is defined. Raises `InputError` for a kind
    that does not exist."""
    kind = description["kind"]
    shapes = {shape.kind: shape for shape in _subclasses(Shape)}
    if kind not in shapes:
        raise InputError(f"{unknown_name('surface', kind, SHAPES)}; a class of your own must be defined before")
    return shapes[kind](**{key: value for key, value in description.items() if key != "kind"})


def _subclasses(base: type) -> Iterator[Any]:
    for own in base.__subclasses__():
        yield own
        yield from _subclasses(own)
