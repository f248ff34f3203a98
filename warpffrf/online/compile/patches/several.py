r"""Several patches of cells on one body -> device tables: displacements of cells of one by pressures of others (room
`patch`).

Patches on different surfaces of a body influence each other by its compliance among splines. On one surface the mesh is
inaccurate where they are a few facets apart - by a tenth and more of the mutual influence -, so that there, too, the
far field is added to the half-space of its `FarField`, cut off and with its ends: of the displacement u per force at
the distance d along the circle,

    u(d; z, z') = cutoff(d/R) (half-space + mirror images + quarter space)/E,

tabulated over ln d and both z. Patches are narrow compared with their distance: for both, d is that of the middles.
Where rows of a pair are not along the second surface - crossed axes, a ball whose axis is upright -, on spheres and on
extruded curves, the whole compliance is used there, too.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.model.reduced.far_field import NOTHING, cutoff
from warpffrf.online.compile.patches.sides import PatchSide, meridian
from warpffrf_kernels.patch.between import LEVEL
from warpffrf_kernels.patch.between import ROWS as HEIGHTS

Array = np.ndarray
TURNED = 0.02  # rad between the axes of a pair: beyond, its rows are not rows of the second surface
NEAREST = 0.01  # of the radius, or of the size of a plane: the smallest distance of two patches


def fill_beside(collector: Any) -> dict[str, Any]:
    """Fields of the device: for every side of a patch the other patches on its body, and tables of their displacements
    there.
    """
    starts, others, which = [0], [], []
    tables: dict[tuple[int, int, bool], int] = {}
    fields: dict[str, Any] = {name: [] for name in ("table_start", "table_sectors", "table_target", "table_source")}
    numbers, heights = [np.zeros(0)], [np.zeros(0)]
    between: list[int] = []
    spans: dict[int, int] = {}
    tabled: dict[str, Any] = {f"between_{name}": [] for name in ("start", "levels", "first", "low", "high")}
    sides = collector.sides
    for side, number in enumerate(sides):
        target = collector.surfaces[number]
        for other, source_number in enumerate(sides):
            source = collector.surfaces[source_number]
            if (
                other // 2 == side // 2
                or source.body is not target.body
                or not _travels(target)
                or not _travels(source)
            ):
                continue
            along = _along_surface(target, source) and all(
                _keeps_rows(collector.scene.finite_sliding[i // 2], i % 2) for i in (side, other)
            )
            if not along and target.surface.real.half_space:
                continue  # rigid in between
            key = (target.surface.number, source.surface.number, along)
            if key not in tables:
                lags, c, c_source = _operator_between(target, source, along)
                tables[key] = len(tables)
                values = (sum(map(len, numbers)), len(lags), c, c_source)
                for name, value in zip(fields, values, strict=True):
                    fields[name].append(value)
                numbers.append(lags.ravel())
            others.append(other)
            which.append(tables[key])
            if not along:
                between.append(-1)
                continue
            number = target.surface.number
            if number not in spans:
                spans[number] = len(spans)
                span = BetweenTable.of(target.surface.real)
                for name, value in (
                    ("start", sum(map(len, heights))),
                    ("levels", len(span.values)),
                    ("first", span.first),
                    ("low", span.low),
                    ("high", span.high),
                ):
                    tabled["between_" + name].append(value)
                heights.append(span.values.ravel())
            between.append(spans[number])
        starts.append(len(others))
    return {
        "beside_start": starts, "beside_side": others, "beside_table": which, "beside_between": between, **fields,
        "beside": np.concatenate(numbers), **tabled, "between": np.concatenate(heights),
        **_meridians(collector),
    }  # fmt: skip


def _meridians(collector: Any) -> dict[str, list[float]]:
    """Direction and origin of z on each side of the pairs."""
    found: dict[str, list[float]] = {"row_sign": [], "row_offset": []}
    for contact in collector.scene.finite_sliding:
        for port in contact.ports:
            sign, offset = (1.0, 0.0) if port.surface.grid is None else meridian(contact, port)
            found["row_sign"].append(sign)
            found["row_offset"].append(offset)
    return found


def _along_surface(target: Any, source: Any) -> bool:
    """Whether two patches influence each other by the half-space too: on one surface, along whose circles it is
    known.
    """
    own = target.surface.number == source.surface.number
    return own and target.surface.shape.kind not in ("sphere", "extruded")


def _keeps_rows(contact: Any, side: int) -> bool:
    """Whether rows on the first meridian are rows of the surface of `side`, too: its own, or one along it."""
    e_a = [port.body.to_world(port.surface.shape.e_a) - port.body.to_world(np.zeros(3)) for port in contact.ports]
    return side == 0 or abs(float(e_a[0] @ e_a[1])) > np.cos(TURNED)


@dataclass(frozen=True, eq=False)
class BetweenTable:
    """u (levels, z, z) [m/N] of the module at ln d = `first` + LEVEL k, places z evenly from `low` to `high` [m]."""

    values: Array
    first: float
    low: float
    high: float

    @classmethod
    def of(cls, surface: Any) -> BetweenTable:
        """Of a contact surface with a far field."""
        far, shape, grid = surface.far, surface.shape, surface.grid
        z = np.linspace(grid.z[0], grid.z[-1], HEIGHTS)
        flat = shape.profile().planar
        size = float(np.ptp(grid.theta)) if flat else float(shape.radius_at(np.mean(z)))
        farthest = 1.5 * size if flat else NOTHING * size
        first = float(np.log(NEAREST * size))
        d = np.exp(first + LEVEL * np.arange(int(np.ceil((np.log(farthest) - first) / LEVEL)) + 3))[:, None, None]
        c = (1.0 - far.poisson_ratio**2) / np.pi
        u = c / np.hypot(d, z[:, None] - z)
        for end in far.ends:
            a = np.maximum(end.side * (end.z - z), 0.0)
            u = u + c / np.hypot(d, a[:, None] + a) + far.quarter.displacement(d, a[:, None], a)
        if not flat:
            u = u * cutoff(np.cos(np.minimum(d / size, np.pi)))
        return cls(u / far.youngs_modulus, first, float(z[0]), float(z[-1]))


def _travels(side: Any) -> bool:
    """Whether a side is that of a patch on a body with a far field."""
    return isinstance(side.surface, PatchSide) and isinstance(side.surface.real, ContactSurface)


def _operator_between(target: Any, source: Any, along: bool) -> tuple[Array, int, int]:
    """Displacement on splines of `target` by loads on those of `source`, on one body, block-circulant, and the columns
    per sector of both: the far field where the half-space is known between them (`along`), else the whole compliance.
    """
    first, second = target.surface.real, source.surface.real
    if target.surface.number == source.surface.number:
        c = first.grid.columns_per_sector
        return first.far.lags if along else first.splines.compliance(first.lags), c, c
    cross = target.body.reduced.cross_compliance(target.name, source.name)
    if cross is None:
        raise InputError(
            f"body {target.body.name!r}: its surfaces {target.name!r} and {source.name!r} are not coupled by "
            "its local modes; reduce it again"
        )
    lags = second.splines.sources(first.splines.targets(cross.lags))
    return lags, lags.shape[1] // first.grid.rows, lags.shape[2] // second.grid.rows
