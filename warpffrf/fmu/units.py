"""Units as FMI defines them: powers of the SI base units.

A unit is a product, separated by spaces, with at most one solidus, before what divides, and whole powers after a
symbol: "N m", "rad/s2", "N s/m".
"""

from __future__ import annotations

import re

DERIVED = {  # powers of kg, m, s
    "N": {"kg": 1, "m": 1, "s": -2},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "Hz": {"s": -1},
    "1": {},
}
BASE = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


def base_powers(unit: str) -> dict[str, int] | None:
    """Powers of the base units of a `unit`, without zeros; None if it is none that is known, such as "rev/min".

    >>> from warpffrf.fmu.units import base_powers
    >>> base_powers("N s/m")
    {'kg': 1, 's': -1}
    """
    over, *under = unit.split("/")
    if len(under) > 1:
        return None
    found = dict.fromkeys(BASE, 0)
    for sign, product in ((1, over), (-1, "".join(under))):
        for symbol in product.split():
            match = re.fullmatch(r"([A-Za-z]+|1)(\d?)", symbol)
            if match is None or match[1] not in (*DERIVED, *BASE):
                return None
            for base, power in DERIVED.get(match[1], {match[1]: 1}).items():
                found[base] += sign * power * int(match[2] or 1)
    return {base: power for base, power in found.items() if power}
