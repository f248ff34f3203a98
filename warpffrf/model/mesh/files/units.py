"""Units of the files that say none: lengths, and the consistent system of stress and density that goes with them.

With newton and second, a length unit fixes the rest:

    m:  N, kg, s   stress Pa = N/m2,    density kg/m3
    mm: N, t, s    stress MPa = N/mm2,  density t/mm3 = 1e12 kg/m3

For other units of length there is no usual system, and the materials of a file are not taken over.
"""

from __future__ import annotations

LENGTH_UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": 0.0254, "ft": 0.3048}  # in m
SYSTEMS = {"m": (1.0, 1.0, "Pa and kg/m3"), "mm": (1e6, 1e12, "MPa and t/mm3")}  # stress in Pa, density in kg/m3


def system_of(length_unit: str, notes: list[str]) -> tuple[float, float, str] | None:
    """Units of stress [Pa] and density [kg/m3] and their names; None without a usual system, said in `notes`."""
    if length_unit in SYSTEMS:
        return SYSTEMS[length_unit]
    notes.append(
        f"materials are not taken over: with lengths in {length_unit} the units of stress and density are not "
        f"known (they are with {' and '.join(SYSTEMS)}); give the materials yourself"
    )
    return None
