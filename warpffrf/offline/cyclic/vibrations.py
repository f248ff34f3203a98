"""Vibration modes of a periodic body: which harmonics have any, and the modes of these.

Whether a harmonic has modes below a limit is one factorisation (Sylvester's law of inertia), modes are many solves: so
all harmonics are asked and few are worked on, and none is forgotten.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.offline.bases.modes import SAME_FREQUENCY, vibration_modes, whole_multiples
from warpffrf.offline.cyclic.harmonics import Harmonics
from warpffrf.offline.elastic import Array, ElasticModel
from warpffrf.offline.products import Limits
from warpffrf.offline.progress import Progress

LIMIT_GROWTH = 1.35  # factor by which the frequency limit grows until it holds the wanted number of modes
# Harmonics that are looked at alone until they hold the wanted number of modes; the limit they set is then asked of all
# others. The first ones hold most of the lowest modes of a round body.
FIRST_HARMONICS = 8


@dataclass
class _Found:
    """Modes of one harmonic: its model, omega (p,), V (n, p)."""

    model: ElasticModel
    omega: Array
    V: Array


def vibrations(
    harmonics: Harmonics, limits: Limits, progress: Progress
) -> tuple[dict[int, tuple[ElasticModel, Array]], dict]:
    """Vibration modes by harmonic, {k: (model, V (n_k, p))}, whole pairs only, and what was rounded."""
    if limits.none:
        return {}, {}
    last = harmonics.count // 2
    if limits.omega_max is not None:
        found = _modes_up_to(harmonics, range(last + 1), limits.omega_max, progress, {})
    else:
        found = _enough(harmonics, limits.count or 0, progress)
    facts: dict = {}
    if limits.count is not None:
        omega = np.sort(np.concatenate([np.repeat(f.omega, harmonics.multiplicity(k)) for k, f in found.items()]))
        kept = whole_multiples(omega, limits.count)
        if kept > limits.count:
            facts["notes"] = [f"modes={limits.count} would split a pair of equal frequencies: {kept} are kept"]
        cut = omega[kept - 1] * (1.0 + SAME_FREQUENCY) if kept else 0.0
        found = {k: _Found(f.model, f.omega[f.omega <= cut], f.V[:, f.omega <= cut]) for k, f in found.items()}
    return {k: (f.model, f.V) for k, f in found.items() if len(f.omega)}, facts


def _enough(harmonics: Harmonics, count: int, progress: Progress) -> dict[int, _Found]:
    """All modes up to a limit that holds `count` of them, or all that the mesh has."""
    last = harmonics.count // 2
    models = {k: harmonics.model(k) for k in range(min(3, last + 1))}
    lowest = [w[0] for m in models.values() if len(w := vibration_modes(m, count=1)[0])]
    limit, found = LIMIT_GROWTH * float(min(lowest)), {}
    for group in (range(min(FIRST_HARMONICS, last + 1)), range(last + 1)):
        total = sum(harmonics.multiplicity(k) * harmonics.size(k) for k in group)
        while True:
            found = _modes_up_to(harmonics, group, limit, progress, models)
            number = sum(harmonics.multiplicity(k) * len(f.omega) for k, f in found.items())
            if number >= min(count, total - 6):  # the six rigid motions are no modes
                break
            limit *= LIMIT_GROWTH
    return found


def _modes_up_to(
    harmonics: Harmonics, group: range, omega: float, progress: Progress, models: dict[int, ElasticModel]
) -> dict[int, _Found]:
    """Modes of the harmonics in `group`; `models` of harmonics that have modes are kept for the next limit."""
    found = {}
    for k in progress.track(group, "vibration modes"):
        if k < 2 or k in models or harmonics.has_modes(k, omega):
            if k not in models:
                models[k] = harmonics.model(k)
            model = models[k]
            w, V = vibration_modes(model, omega_max=omega)
            if len(w):
                found[k] = _Found(model, w, V)
    return found
