r"""What the bases of bodies leave out of the frequencies of a machine.

Vibration modes of the finite elements that a basis holds are exact. Of those beyond, k, loads on interfaces have the
static response and the first term of their inertia, g_k (1 + (f/f_k)^2) of g_k/(1 - (f/f_k)^2) at the frequency f,
which attachment modes match; missing is a part of what follows, g_k (f/f_k)^4. A flexibility that has the share s of
the strain energy of a mode and errs by e changes its frequency by s e/2 (Rayleigh), so that with the attachment modes
a, of frequencies f_a and shares s_a, in place of the modes k

    error = PART/2 sum_a s_a (f/f_a)^4,

`PART` as measured (tests/output/test_frequency_errors.py: of beams with two to eight modes, free and with a mass at
the end, of the errors above 0.1 % nine of ten are known to a factor of three; those of bodies without vibration modes
are up to ten times less). Local modes under pressures have no inertia, and g_k alone: e = r^2/(1 - r^2) at most, r = f
over the frequency up to which bodies hold their vibrations. Their share is at most what bodies leave of the energy
where a contact is closed, springs and joints with it. What meshes make of frequencies is not in it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from warpffrf.online.vibrations.eigenmodes import SceneModes

Array = np.ndarray
PART = 1.0 / 5.0
ROUND_OFF = 1e-9  # share of the energy


def frequency_errors(found: SceneModes) -> Array:
    """(n,) fractions of the frequencies; NaN where a basis does not say which vibrations it holds, and of vibrations of
    closed contacts above those; 0 at 0 Hz."""
    rate = np.abs(found.eigenvalues)
    moves, error, lowest = rate > 0.0, np.zeros(len(rate)), np.inf
    left = moves.astype(float)
    for body in found.scene.bodies:
        if body.reduced is None or not len(body.reduced.frequencies):
            continue
        facts = body.reduced.report.get("quality", {}).get("frequencies", {})
        own = 2.0 * np.pi * body.reduced.frequencies
        q = np.array([shape.modal for shape in found.shapes[body.name]]).reshape(len(rate), -1)
        share = np.divide(np.abs(own * q) ** 2, rate[:, None] ** 2, out=np.zeros(q.shape), where=moves[:, None])
        held = facts.get("vibration_modes")
        if held is None:
            error[np.any(share > ROUND_OFF, axis=1)] = np.nan
        else:
            error += 0.5 * PART * np.sum((share * (rate[:, None] / own) ** 4)[:, held:], axis=1)
        left -= share.sum(axis=1)
        lowest = min(lowest, 2.0 * np.pi * (facts.get("covered") or 0.0))
    if found.linear.closed and np.isfinite(lowest):
        square = np.divide(rate, lowest, out=np.full(len(rate), np.inf), where=lowest > 0.0) ** 2
        inert = np.divide(square, 1.0 - square, out=np.full(len(rate), np.nan), where=square < 1.0)
        error += np.where(left > ROUND_OFF, 0.5 * left * inert, 0.0)
    return error
