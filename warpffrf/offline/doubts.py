"""Input of a reduction that is hardly meant: said before the work begins, and once more in its report.

Units and shape of the mesh are judged by `warpffrf.model.mesh.report`. Here are the numbers of the contact and of the
basis: a half-width that no contact on such a surface has, because it is in mm, and a frequency below which no mode
lies, because it is in kHz.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.offline.contact.traction_fields import ContactFacets
from warpffrf.offline.paths import resolve_shapes
from warpffrf.offline.settings import Settings

HALF_WIDTH = 0.5  # of radius or extent: a patch of this size is no small contact, and no grid resolves less
FACETS = 50.0  # longest facet edge over the half-width: coarser meshes are not meant for it


def input_doubts(mesh: Mesh, settings: Settings) -> list[str]:
    """Doubts about mesh, materials, and what was asked for: texts that name the thing and the likely slip."""
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
    """A doubt where `max_frequency` was asked for and no vibration mode lies below it; `omega` (m,) [rad/s] of the
    basis."""
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
