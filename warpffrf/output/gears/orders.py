r"""Orders of the transmission error: a Fourier series of the mesh, fitted to whole mesh cycles.

Over the last M whole pitches of a run, at angles phi_t of gear 1 from the start of these pitches,

    TE(phi) = m + sum_k a_k cos(k z_1 phi) + b_k sin(k z_1 phi) + r,      A_k = sqrt(a_k^2 + b_k^2),

by least squares, so that saved steps need not be equally spaced in angle. r holds what does not repeat from pitch to
pitch, and orders above the fitted ones. Its variance estimates the standard error of A_k,

    sigma^2 = sum r^2/(N - p),      s_k = sigma sqrt((C_aa + C_bb)/2),      C = (X^T X)^-1,

of N rows and p coefficients. Fitted are the orders below half the number of rows of a pitch (Nyquist).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from warpffrf.model.errors import require_count

Array = np.ndarray
SLACK = 1e-6  # of a pitch: a run over so much less than whole pitches covers them


@dataclass(frozen=True)
class MeshOrders:
    """Transmission error over whole mesh cycles, `begin` [s] to the end of the run.

    mean, peak_to_peak [m], the latter of the saved steps; order (count,) [-], multiples of the frequency of the teeth;
    amplitude (count,) [m], phase (count,) [rad] of A cos(k z_1 phi - phase), phi = 0 at `begin`; error (count,) [m]:
    standard errors of the amplitudes, NaN without a row more than coefficients; residual [m]: root mean square of what
    the fit leaves; cycles: whole pitches. Orders that the saved steps do not resolve are NaN; all is, with a `reason`,
    for a run over less than a pitch.
    """

    mean: float
    peak_to_peak: float
    order: Array
    amplitude: Array
    phase: Array
    error: Array
    residual: float
    cycles: int
    begin: float
    reason: str = ""


def mesh_orders(time: Array, angle: Array, error: Array, teeth: int, count: int) -> MeshOrders:
    """Orders 1 to `count` of the transmission `error` (T,) [m] over the rotation `angle` (T,) [rad] of the gear with so
    many `teeth`. Raises `InputError` for a count below 1."""
    number = require_count(count, "orders: count", 1)
    order, nan = np.arange(1, number + 1), np.full(number, np.nan)
    turned = np.unwrap(np.asarray(angle, float)) * teeth / (2.0 * np.pi)  # pitches
    back = np.abs(turned[-1] - turned) if len(turned) else np.zeros(0)  # from the end of the run
    cycles = int(np.floor(back.max(initial=0.0) + SLACK))
    if not cycles:
        why = f"the run covers {back.max(initial=0.0):.3g} pitches, less than one"
        return MeshOrders(np.nan, np.nan, order, nan, nan, nan, np.nan, 0, np.nan, why)
    first = int(np.flatnonzero(back >= cycles - SLACK)[-1])  # its row is that of the end, whole pitches earlier
    place, values = turned[first + 1 :] - turned[first], np.asarray(error, float)[first + 1 :]
    fitted = min(number, (-(-len(place) // cycles) - 1) // 2)
    phase = 2.0 * np.pi * np.outer(place, order[:fitted])
    columns = np.column_stack([np.ones(len(place)), np.cos(phase), np.sin(phase)])
    found, _, rank, _ = np.linalg.lstsq(columns, values, rcond=None)
    rest, spare = values - columns @ found, len(values) - columns.shape[1]
    a, b = found[1 : fitted + 1], found[fitted + 1 :]
    amplitude, angles, errors = nan.copy(), nan.copy(), nan.copy()
    if rank == columns.shape[1]:
        amplitude[:fitted], angles[:fitted] = np.hypot(a, b), np.arctan2(b, a)
        if spare > 0:
            own = np.diag(np.linalg.inv(columns.T @ columns))[1:]
            sigma = np.sqrt(float(rest @ rest) / spare)
            errors[:fitted] = sigma * np.sqrt(0.5 * (own[:fitted] + own[fitted:]))
    return MeshOrders(
        float(found[0]), float(np.ptp(values)), order, amplitude, angles, errors,
        float(np.sqrt(np.mean(rest**2))), cycles, float(time[first]),
    )  # fmt: skip
