"""What the times of a study were taken on: machine, versions, the unit U, and what else the machine did.

A study that was interrupted has a sitting for each part. Other work is known by the load average when a sitting began:
processes that run or wait for a core, over the minute before.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

from warpffrf.study.machine import machine

BUSY = 1.5  # processes: this one, which may have reduced bodies before, and the odd job


def load_before() -> float | None:
    """Processes that run or wait now, over the last minute; None where the system does not tell."""
    return float(os.getloadavg()[0]) if hasattr(os, "getloadavg") else None


def sitting(load: float | None) -> dict[str, Any]:
    """Facts of a sitting that began at this `load`, as plain data."""
    return {**machine(), "load_before": load}


def unit_of(sittings: Sequence[Mapping[str, Any]]) -> float | None:
    """U [s] of a study, the least of its sittings, as of times; None where machines were unlike, or there was none."""
    machines = {(s["machine"]["processor"], s["machine"]["cores"]) for s in sittings}
    return min(float(s["unit_seconds"]) for s in sittings) if len(machines) == 1 else None


def stated(facts: Mapping[str, Any]) -> str:
    """A sitting in one sentence."""
    on, load = facts["machine"], facts.get("load_before")
    versions = ", ".join(f"{name} {version}" for name, version in facts["versions"].items())
    if load is None:
        beside = "what else ran is not known"
    elif load < BUSY:
        beside = f"on a quiet machine (load average {load:.2g} before)"
    else:
        beside = f"beside other work (load average {load:.2g} before), so that times are preliminary"
    return (
        f"Times taken on {on['processor']}, {on['cores']} cores, {on['platform']}, Python {on['python']}, {versions}; "
        f"{beside}. U = {facts['unit_seconds'] * 1e6:.4g} us (Cholesky factor-and-solve of size 128, one thread)."
    )
