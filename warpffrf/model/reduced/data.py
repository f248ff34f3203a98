"""Data of a reduced body, without its methods: `ReducedBody` builds on this and on its file."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.reduced.contact_surface import ContactSurface, CrossCompliance
from warpffrf.model.reduced.inertia import InertiaTerms
from warpffrf.model.reduced.stress_field import StressField
from warpffrf.model.reduced.thermal import ReducedThermal
from warpffrf.model.small_sliding import MatchedSurface


@dataclass(frozen=True, eq=False)
class Interface:
    """An interface of kind "rigid", "average" or "free": `modes` (m, 6) is its translation [m] and rotation [rad] at
    `point` (3,) [m] per unit modal coordinate, user axes; for the last two kinds the mean motion of its nodes.

    Local modes do not move it. A free one keeps its `nodes` (k, 3) [m], positions in the user frame, and their
    displacement `node_modes` (m, k, 3) [m]; local modes move none of them either.
    """

    kind: str
    point: np.ndarray
    modes: np.ndarray
    nodes: np.ndarray | None = None
    node_modes: np.ndarray | None = None


@dataclass(frozen=True, eq=False)
class DisplaySurface:
    """Outer skin for visualisation: points (n, 3) [m, user frame], triangles (t, 3), modes (m, n, 3), and `matched` (N,
    n, 3) [m/N], the residual displacement per force on the body's matched faces, beyond the global modes, user axes;
    None without matched faces, or where it was omitted as too large; `second_order` (R, n, 3), the shapes of
    second-order motion (`warpffrf.model.reduced.inertia`), None for a body without."""

    points: np.ndarray
    triangles: np.ndarray
    modes: np.ndarray
    matched: np.ndarray | None = None
    second_order: np.ndarray | None = None


@dataclass(frozen=True, eq=False)
class ReducedBodyData:
    """Mass properties, global modes, interfaces, contact surfaces, skin, and provenance.

    Modes are M-orthonormal (modal mass 1 kg), K-orthogonal and M-orthogonal to rigid motion (Tisserand frame).
    """

    mass: float  # kg
    center_of_mass: np.ndarray  # (3,) m, user frame
    inertia: np.ndarray  # (3, 3) kg m2, about the centre of mass, user axes
    frequencies: np.ndarray  # (m,) Hz, ascending; measured ones (`measured_modes`) may be out of order
    interfaces: dict[str, Interface]
    contact_surfaces: dict[str, ContactSurface]
    surface: DisplaySurface
    stress: dict[str, StressField] = field(default_factory=dict)  # points of stress evaluation, by name
    report: dict[str, Any] = field(default_factory=dict)
    provenance: dict[str, Any] = field(default_factory=dict)
    inertia_terms: InertiaTerms | None = None  # of the first modes; None: without
    cross: tuple[CrossCompliance, ...] = ()  # one for each pair of contact surfaces
    matched: dict[str, MatchedSurface] = field(default_factory=dict)  # faces with cells, `model.small_sliding`
    matched_compliance: np.ndarray | None = (
        None  # (N, N) m/N of all forces of `matched`, in their order; None without matched faces
    )
    thermal: ReducedThermal | None = None  # temperature and thermal expansion; None: without

    @property
    def local_modes(self) -> int:
        """Normal local modes of all contact surfaces."""
        return sum(s.local_modes for s in self.contact_surfaces.values())

    def cross_compliance(self, target: str, source: str) -> CrossCompliance | None:
        """Cross compliance from contact surface `source` to contact surface `target`; None for a body without. Raises
        `InputError` for names that are not two contact surfaces."""
        if target == source or not {target, source} <= set(self.contact_surfaces):
            raise InputError(
                f"cross_compliance: {target!r} and {source!r} are not two contact surfaces of this body; it has "
                f"{', '.join(map(repr, self.contact_surfaces)) or 'none'}"
            )
        for one in self.cross:
            if (one.target, one.source) == (target, source):
                return one
            if (one.source, one.target) == (target, source):
                return one.transposed()
        return None
