"""From stress plans to the stress fields of a reduced body: observers for either path, and fields of what they saw."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from warpffrf.model.reduced.contact_surface import ContactSurface
from warpffrf.model.reduced.stress_field import GridSpan, StressField
from warpffrf.offline.cyclic.observers import CyclicObserver, ObservedModes
from warpffrf.offline.general.observers import Observer
from warpffrf.offline.stress.membrane import membrane_stress
from warpffrf.offline.stress.plan import StressPlan


class StressRecovery:
    """The plans of one reduction and their observers; `axes` (3, 3) of sector 0 for the cyclic path, None for the
    general one."""

    def __init__(self, plans: Sequence[StressPlan], axes: np.ndarray | None = None) -> None:
        self.plans = plans
        self._sectors = [None if axes is None else plan.sector_operator(axes) for plan in plans]

    def observers(self) -> list[Any]:
        """`CyclicObserver` or `Observer` of each plan, for the path's `observers`."""
        return [
            Observer(_label(plan), plan.operator()) if at is None else CyclicObserver(_label(plan), at.blocks)
            for plan, at in zip(self.plans, self._sectors, strict=True)
        ]

    def fields(self, product: Any, contact: Mapping[str, ContactSurface]) -> dict[str, StressField]:
        """Fields by name from the path's `product` and the finished `contact` surfaces, in the order of
        `product.surfaces`."""
        found = {}
        for plan, sectors in zip(self.plans, self._sectors, strict=True):
            label = _label(plan)
            seen = product.observed_modes[label]
            if isinstance(seen, ObservedModes):
                if sectors is None:
                    raise ValueError("a cyclic product needs the axes of sector 0")
                seen = seen.real(sectors.sampled)
            normal, tangential = {}, {}
            for name, s in zip(contact, product.surfaces, strict=True):
                span = GridSpan(s.first_column, s.whole_columns, sectors is not None or s.grid.periodic)
                normal[name] = (s.observed[label], span)
                if label in s.observed_tangential:
                    tangential[name] = (s.observed_tangential[label], span)
            field = plan.field(seen, contact, normal, tangential, sectors)
            if product.laps is not None:
                field = replace(field, laps=product.laps.by_force(label, 6))
            if product.membrane is not None:
                field = replace(field, membrane=membrane_stress(plan, product.membrane))
            found[plan.name] = field
        return found


def _label(plan: StressPlan) -> str:
    return f"stress/{plan.name}"
