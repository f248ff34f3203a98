r"""Amplitude spectrum of a history by frequency, or by orders of a body's rotation.

With N values x_n at equal distances d in time, or in revolutions, and the Hann window w_n = sin^2(pi n/N),

    A_k = 2 |sum_n w_n (x_n - m) e^(-2 pi i k n/N)| / sum_n w_n,      m = sum_n w_n x_n / sum_n w_n,

at k/(N d) for k = 0 .. N/2, without the factor 2 in the last line of an even N: a sine of amplitude A at one of these
frequencies has A_k = A there and A/2 in both neighbours; between two of them the nearer one shows at least 8/(3 pi) =
0.85 of A. Two lines are resolved if they are 4 points apart. Linear interpolation, if necessary, reduces the amplitude
of a signal with m rows per period by (2 pi/m)^2/12. Peaks are those of a sine between lines: with the larger neighbour
A_j of a local maximum A_k, j = k +- 1, and c = A_j/A_k,

    k + d (j - k),      A_k (1 - d^2) pi d/sin(pi d),      d = (2 c - 1)/(1 + c).

The envelope of a history in a band of frequencies is the magnitude of its analytic signal, twice the part at these
frequencies of its Fourier series, which is periodic over the run; the Hann window takes off its ends. Impacts that
excite a resonance within the band appear at the frequency of their repetition.

Orders count per revolution: values are sampled at equal angles of the body, over the whole number of revolutions that
ends with the run, so that excitations locked to the rotation stay at one order even if the speed changes. The angle is
the integral of the angular velocity about the axis, by the trapezoidal rule over the saved rows.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from warpffrf.model.errors import InputError, require_array, require_count, require_direction

ROUND_OFF = 1e-14  # of the largest value: smaller amplitudes are zero
LEAST = 1e-6  # likewise: smaller ones may be round-off, or tolerance of iterations
EVEN = 1e-6  # of the distance between rows: smaller deviations are evenly spaced
FEWEST_ROWS = 8
FEWEST_TURNS = 2
FLOOR = 1e-6  # of the largest amplitude: lower limit of a plot's axis
TURN = 2.0 * np.pi
LINE = "#1b6ca8"


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Amplitudes of the history `label`, `largest` in magnitude, in `units`: `place` (n,) [Hz], for orders [1/rev],
    and `amplitude` (n,) of a sine there. `of` names the abscissa; `notes` list the preprocessing of the values."""

    label: str
    units: str
    of: str  # "frequency [Hz]" or "order of the rotation of 'shaft' [1/rev]"
    place: np.ndarray
    amplitude: np.ndarray
    notes: list[str] = field(default_factory=list)
    largest: float = 0.0

    @property
    def resolution(self) -> float:
        """Spacing of the spectrum [Hz or 1/rev]."""
        return float(self.place[1] - self.place[0])

    def peaks(self, count: int = 5) -> list[tuple[float, float]]:
        """(place, amplitude) of the largest local maxima, largest first, at most `count`, interpolated between lines as
        of a sine (see the module); zeros are excluded."""
        a = self.amplitude
        count = require_count(count, "peaks: count", 1)
        inner = np.flatnonzero((a[1:-1] > a[:-2]) & (a[1:-1] >= a[2:])) + 1
        inner = inner[a[inner] > 0.0]
        best = inner[np.argsort(-a[inner], kind="stable")][:count]
        right = a[best + 1] > a[best - 1]
        ratio = np.where(right, a[best + 1], a[best - 1]) / a[best]
        d = np.maximum((2.0 * ratio - 1.0) / (1.0 + ratio), 0.0)
        place = self.place[best] + np.where(right, d, -d) * self.resolution
        return list(zip(place.tolist(), (a[best] * (1.0 - d**2) / np.sinc(d)).tolist(), strict=True))

    def report(self, count: int = 5) -> str:
        """The `count` largest peaks as a table."""
        lines = [f"{self.label}: amplitudes by {self.of}, resolution {self.resolution:.4g}"]
        lines += [f"note: {note}" for note in self.notes]
        peaks = self.peaks(count)
        lines += [f"{place:14.6g}  {size:12.5g} {self.units}" for place, size in peaks] or ["no peak: it is constant"]
        return "\n".join(lines) + doubt(float(self.amplitude.max()), self.largest) * bool(peaks)

    def draw(self, ax: Any, *, logarithmic: bool = True) -> None:
        """Draw on the matplotlib axes `ax`, amplitudes on a logarithmic scale down to 1e-6 of the largest, or on a
        linear one."""
        first = 1 if logarithmic else 0  # zero frequency is empty because the mean is removed
        ax.plot(self.place[first:], self.amplitude[first:], lw=1.0, color=LINE)
        most = float(self.amplitude.max())
        if logarithmic and most > 0.0:
            ax.set_yscale("log")
            ax.set_ylim(FLOOR * most, max(2.0 * most, LEAST * self.largest))
        elif most < LEAST * self.largest:
            ax.set_ylim(0.0, LEAST * self.largest)
        ax.set_xlim(0.0, self.place[-1])
        ax.set(xlabel=self.of, ylabel=f"amplitude [{self.units}]")
        ax.set_title(self.label + doubt(most, self.largest), fontsize=10)
        ax.grid(alpha=0.3)


def frequency_spectrum(time: np.ndarray, values: np.ndarray, label: str, units: str, envelope: Any = None) -> Spectrum:
    """The `Spectrum` by frequency of `values` (T,) at `time` (T,) [s], or of their envelope in the band `envelope`,
    (low, high) [Hz]; rows at uneven times are interpolated linearly to even ones, with a note. Raises InputError for
    fewer than 8 rows, values that are not finite, and a band that the rows do not resolve."""
    values, step, notes = even_rows(time, values, label)
    if envelope is not None:
        values = envelope_of(values, step, envelope, label)
        label = f"{label}, envelope of {envelope[0]:g} to {envelope[1]:g} Hz"
    place, amplitude = amplitudes(values, step)
    return Spectrum(label, units, "frequency [Hz]", place, amplitude, notes, float(np.max(np.abs(values))))


def even_rows(time: np.ndarray, values: np.ndarray, label: str) -> tuple[np.ndarray, float, list[str]]:
    """`values` (T,) at even times, their spacing [s], and notes: interpolated linearly if rows are uneven. Raises
    InputError as `frequency_spectrum`."""
    _check(time, values, label)
    even = np.linspace(time[0], time[-1], len(time))
    step = float(even[1] - even[0])
    if np.max(np.abs(time - even)) <= EVEN * step:
        return values, step, []
    note = f"rows at uneven times, interpolated linearly to every {step:.4g} s"
    return np.interp(even, time, values), step, [note]


def envelope_of(values: np.ndarray, step: float, band: Any, label: str) -> np.ndarray:
    """(T,), in the unit of `values` (T,) at the distance `step` [s]: their envelope in a band, (low, high) [Hz]. Raises
    InputError naming `label` for a band of fewer than 8 lines, or beyond half the rate of the rows."""
    low, high = require_array(band, f"{label}: envelope [Hz]", (2,))
    line, most = 1.0 / (step * len(values)), 0.5 / step
    if not 0.0 <= low or not high <= most or not high - low >= FEWEST_ROWS * line:
        raise InputError(
            f"{label}: envelope must be a band (low, high) between 0 and {most:.4g} Hz, half the rate of saved rows, "
            f"and {FEWEST_ROWS * line:.4g} Hz wide or more, got ({low:g}, {high:g}); save more rows, or simulate longer"
        )
    frequency = np.fft.fftfreq(len(values), step)
    within = (frequency >= low) & (frequency <= high)
    return np.abs(np.fft.ifft(np.where(within, 2.0 * np.fft.fft(values), 0.0)))


def turning_rate(time: np.ndarray, spin: np.ndarray, axis: Any = None) -> np.ndarray:
    """(T,) rad/s about `axis` (3,), or about the mean of the angular velocity `spin` (T, 3), positive in the overall
    sense of rotation."""
    mean = np.trapezoid(spin, time, axis=0) if axis is None else require_direction(axis, "orders: axis")
    size = np.linalg.norm(mean)
    rate = spin @ (mean / size) if size > 0.0 else np.zeros(len(time))
    return -rate if np.sum(rate) < 0.0 else rate


def order_spectrum(
    time: np.ndarray, values: np.ndarray, spin: np.ndarray, label: str, units: str, body: str, axis: Any = None
) -> Spectrum:
    """The `Spectrum` by orders of the rotation of `body`, whose angular velocity is `spin` (T, 3) [rad/s, world]; axis:
    direction (3,) in the world, None: that of the mean angular velocity. Raises InputError for a body that rotates by
    fewer than 2 revolutions or reverses about the axis, for too few rows per revolution, and as `frequency_spectrum`.
    """
    _check(time, values, label)
    turns, even, whole = whole_turns(time, spin, body, axis)
    place, amplitude = amplitudes(np.interp(even, turns, values), (even[1] - even[0]))
    notes = [f"the last {whole} turns of {turns[-1]:.4g}, interpolated linearly to {len(even)} equal angles"]
    of = f"order of the rotation of '{body}' [1/rev]"
    return Spectrum(label, units, of, place, amplitude, notes, float(np.max(np.abs(values))))


def whole_turns(time: np.ndarray, spin: np.ndarray, body: str, axis: Any) -> tuple[np.ndarray, np.ndarray, int]:
    """Turns (T,) of `body` at the rows, equal angles (N,) [turns] over the whole turns that end with the run, without
    their last one, and the number of these turns. Raises InputError as `order_spectrum`."""
    rate = turning_rate(time, spin, axis)
    turns = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(time))]) / TURN
    whole = int(np.floor(turns[-1] * (1.0 + EVEN)))
    if whole < FEWEST_TURNS:
        raise InputError(
            f"orders: body '{body}' turns {max(turns[-1], 0.0):.3g} times about the axis, and orders need "
            f"{FEWEST_TURNS}; simulate longer, or look at frequencies with spectrum"
        )
    if np.any(np.diff(turns) < 0.0):
        raise InputError(f"orders: body '{body}' reverses during the run; look at frequencies with spectrum instead")
    begin = max(turns[-1] - whole, 0.0)
    count = int(np.count_nonzero(turns > begin))
    if count < 2 * whole:
        raise InputError(
            f"orders: {count} rows in {whole} turns of body '{body}' resolve no order; save more rows, save_every=1"
        )
    return turns, begin + (turns[-1] - begin) * np.arange(count) / count, whole


def amplitudes(values: np.ndarray, distance: float) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n,) [1/distance] and amplitudes (n,), as in the module docstring, of values (N,) at equal
    distances."""
    count = len(values)
    window = np.sin(np.pi * np.arange(count) / count) ** 2
    weight = window.sum()
    found = 2.0 * np.abs(np.fft.rfft(window * (values - window @ values / weight))) / weight
    found[0] = 0.0
    found[found < ROUND_OFF * np.max(np.abs(values))] = 0.0
    if count % 2 == 0:
        found[-1] *= 0.5
    return np.fft.rfftfreq(count, distance), found


def doubt(most: float, size: float) -> str:
    """Note if the largest amplitude, `most`, of values up to `size` may be round-off."""
    return f"\nall below {LEAST:g} of the largest value, may be round-off" if most < LEAST * size else ""


def _check(time: np.ndarray, values: np.ndarray, label: str) -> None:
    if len(time) < FEWEST_ROWS:
        raise InputError(f"{label}: {len(time)} saved rows, a spectrum needs {FEWEST_ROWS}; simulate longer")
    if np.shape(values) != np.shape(time):
        raise InputError(f"{label}: a value for each of the {len(time)} saved rows, got shape {np.shape(values)}")
    if not np.all(np.isfinite(values)):
        raise InputError(f"{label}: some rows have no value, as where a contact is open; choose another history")
