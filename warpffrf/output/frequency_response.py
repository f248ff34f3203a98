r"""Frequency response between ports about a state, without truncation of modes: a table, a plot and a universal file.

With M y'' + D y' + K y + C^T lambda = P_e^T F and C y = 0 of `warpffrf.online.vibrations.linearise`, with all
y that satisfy the rigid rows in a basis N, y = N z, and with F = f e^(i omega t) along a unit vector,

    H_r(omega) = P_r N (-omega^2 m + i omega d + k)^-1 (P_e N)^T,      m, d, k = N^T (M, D, K) N.

P are the displacements of the ports along their directions per y: of interfaces at the deformation of the state. Small
motions hold the patches of closed contacts, which in an equilibrium follow the load: the compliance of a line contact
between rollers differs by 0.5 % with the cells that are chosen by default, by 0.02 % with 31 strips.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.bodies import Port, as_port
from warpffrf.model.errors import InputError, require_array, unknown_name
from warpffrf.model.files.paths import check_ending, checked_output_path, written_whole
from warpffrf.model.reduced.inertia import interface_motion, interface_slope
from warpffrf.online.vibrations.eigenmodes import SceneModes, free_basis
from warpffrf.output.files.universal import Direction, function_58

Array = np.ndarray
LABEL = "frequency_response"
RATES = {"displacement": (0, "m/N"), "velocity": (1, "m/(s N)"), "acceleration": (2, "m/(s2 N)")}
CHUNK = 1 << 24  # numbers of the systems that are solved at once
SIZE = (7.0, 5.2)  # inches


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """Displacements per unit force [m/N] at `frequencies`, returned by `Modes.frequency_response`.

    `receptance` (responses, f) complex: amplitude and phase of e^(i omega t); `responses` and `force` name the ports
    with their directions, world axes. `about` names the state, `notes` list neglected effects.
    """

    frequencies: Array  # (f,) Hz
    receptance: Array
    force: str
    responses: tuple[str, ...]
    about: str
    places: tuple[Direction, ...]  # of the force, then of the responses
    notes: list[str] = field(default_factory=list)

    def of(self, quantity: str = "displacement") -> Array:
        """(responses, f) complex, per unit force: "displacement" [m/N], "velocity" [m/(s N)], "acceleration"
        [m/(s2 N)]. Raises InputError for others."""
        if quantity not in RATES:
            raise unknown_name(f"{LABEL}: quantity", quantity, RATES)
        return self.receptance * (2.0j * np.pi * self.frequencies) ** RATES[quantity][0]

    def report(self, quantity: str = "displacement") -> str:
        """Table of magnitude and phase over the frequencies, and notes: plain text."""
        found, unit = self.of(quantity), RATES[quantity][1]
        lines = [f"{quantity} [{unit}] per force at {self.force}, about the {self.about}", ""]
        lines += [f"response {i}: {name}" for i, name in enumerate(self.responses)]
        head = "".join(f"  {f'|{i}|':>12} {'phase deg':>10}" for i in range(len(found)))
        lines += ["", f"{'frequency Hz':>14}{head}"]
        for f, column in zip(self.frequencies, found.T, strict=True):
            lines.append(f"{f:>14.6g}" + "".join(f"  {abs(h):>12.5g} {np.degrees(np.angle(h)):>10.2f}" for h in column))
        return "\n".join([*lines, *(f"note: {note}" for note in self.notes)])

    __str__ = report

    def __repr__(self) -> str:
        span = f"{self.frequencies[0]:g} to {self.frequencies[-1]:g} Hz"
        return f"FrequencyResponse({len(self.responses)} per force at {self.force}, {span})"

    def plot(self, axes: Any = None, *, quantity: str = "displacement") -> Any:
        """Draw magnitude and phase over the frequency on two matplotlib axes (new ones if None); returns them."""
        found, unit = self.of(quantity), RATES[quantity][1]
        if axes is None:
            from matplotlib.backends.backend_agg import FigureCanvasAgg
            from matplotlib.figure import Figure

            figure = Figure(figsize=SIZE, layout="constrained")
            FigureCanvasAgg(figure)
            axes = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
        for name, h in zip(self.responses, found, strict=True):
            axes[0].semilogy(self.frequencies, np.abs(h), label=name)
            axes[1].plot(self.frequencies, np.degrees(np.angle(h)))
        axes[0].set(ylabel=f"{quantity} [{unit}]", title=f"Response to a force at {self.force}")
        axes[1].set(xlabel="frequency [Hz]", ylabel="phase [deg]", ylim=(-190.0, 190.0), yticks=(-180, -90, 0, 90, 180))
        for ax in axes:
            ax.grid(visible=True, alpha=0.3)
        axes[0].legend(frameon=False)
        return axes

    def to_csv(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Write frequencies and real and imaginary parts of the receptances [m/N]; returns the path. Raises InputError
        for a file that is not to be replaced."""
        check_ending(path, "to_csv", (".csv",))
        target = checked_output_path(path, "to_csv", overwrite=overwrite)
        names = [f'"{part} {name} [m/N]"' for name in self.responses for part in ("real", "imag")]
        table = np.stack([part for h in self.receptance for part in (h.real, h.imag)])
        rows = [",".join(map(repr, row)) for row in np.vstack([self.frequencies, table]).T.tolist()]
        with written_whole(target) as partial:
            partial.write_text("\n".join(["# written by warpffrf", ",".join(["frequency [Hz]", *names]), *rows, ""]))
        return target

    def to_uff(self, path: str | os.PathLike[str], *, quantity: str = "displacement", overwrite: bool = False) -> Path:
        """Write each response as a dataset 58 of a universal file, complex in double precision; returns the path.

        Nodes are numbered as the ports occur, the force's first. Directions that are none of the axes have the code 0,
        and the identification lines have them all. The format has six digits for the frequencies. Raises InputError for
        a file that is not to be replaced.
        """
        check_ending(path, "to_uff", (".uff", ".unv"))
        target = checked_output_path(path, "to_uff", overwrite=overwrite)
        found = self.of(quantity)
        rate = RATES[quantity][0]
        parts = [
            function_58(self.frequencies, h, rate, place, self.places[0], (name, self.force, self.about))
            for h, place, name in zip(found, self.places[1:], self.responses, strict=True)
        ]
        with written_whole(target) as partial:
            partial.write_text("".join(parts))
        return target


def frequency_response(found: SceneModes, force: Any, responses: Any, frequencies: Any) -> FrequencyResponse:
    """See `Modes.frequency_response`."""
    linear = found.linear
    if linear.films:
        raise InputError(f"{LABEL}: scenes with oil films are not supported; use eigenmodes for their modes")
    if linear.co_rotating and linear.turning:
        names = ", ".join(map(repr, linear.turning))
        raise InputError(
            f"{LABEL}: bodies rotate ({names}), and a force along a fixed direction is none in their axes; use a state "
            "at rest"
        )
    f = require_array(frequencies, f"{LABEL}: frequencies", (None,))
    if not len(f) or np.any(f < 0.0):
        raise InputError(f"{LABEL}: frequencies [Hz] must be one or several, none negative")
    if not isinstance(responses, Sequence) or not responses:
        raise InputError(f"{LABEL}: responses are (port, direction), or a list of them")
    many = list(responses) if isinstance(responses[0], tuple | list) else [responses]
    ports = [_directed(pair) for pair in [force, *many]]
    rows = np.stack([_displacement(found, port, e) for port, e in ports])
    N = free_basis(linear.M, linear.K, linear.C)
    if not N.shape[1]:
        raise InputError(f"{LABEL}: nothing in the scene can move")
    m, d, k = (N.T @ X @ N for X in (linear.M, linear.D, linear.K))
    seen = rows @ N
    H = np.zeros((len(rows) - 1, len(f)), complex)
    for part in np.array_split(np.arange(len(f)), len(f) * N.shape[1] ** 2 // CHUNK + 1):
        w = 2.0 * np.pi * f[part, None, None]
        try:
            z = np.linalg.solve(-(w**2) * m + 1j * w * d + k, np.broadcast_to(seen[0][:, None], (len(part), len(m), 1)))
        except np.linalg.LinAlgError:
            raise InputError(
                f"{LABEL}: the response is infinite at one of the frequencies (0 Hz of what is not held, or the "
                "frequency of an undamped mode); leave it out, or add damping"
            ) from None
        H[:, part] = seen[1:] @ z[:, :, 0].T
    labels = [f"{port.label} along {_named(e)}" for port, e in ports]
    node: dict[str, int] = {}
    places = tuple(Direction(node.setdefault(port.label, len(node) + 1), port.label, _code(e)) for port, e in ports)
    return FrequencyResponse(f, H, labels[0], tuple(labels[1:]), found.about, places, list(found.notes))


def _directed(pair: Any) -> tuple[Port, Array]:
    """A port and a unit vector."""
    if not isinstance(pair, Sequence) or len(pair) != 2:
        raise InputError(f"{LABEL}: a force or response is (port, direction), body['interface'] and (x, y, z)")
    e = require_array(pair[1], f"{LABEL}: direction", (3,))
    length = float(np.linalg.norm(e))
    if not length > 0.0:
        raise InputError(f"{LABEL}: a direction must not be zero")
    return as_port(pair[0], f"{LABEL}: port"), e / length


def _displacement(found: SceneModes, port: Port, e: Array) -> Array:
    """Displacement of a port along e (world) per y: (n,)."""
    if port.point is None or port.body.name not in found.shapes:
        raise InputError(
            f"{LABEL}: a port must be a place on a body that moves, body['interface'] or body.at((x, y, z)), got "
            f"{port.label}"
        )
    body, T = port.body, found.linear.T
    A, q = rot.matrix(found.rotation[body.name]), found.modal[body.name]
    place = port.point - body.center_of_mass
    row = np.zeros(len(T))
    start = 6 * len(found.shapes) + sum(len(found.modal[b.name]) for b in found.scene.bodies if b.index < body.index)
    if port.interface_name is not None and len(q):
        place = place + interface_motion(body, port.interface_name, q)[:3]
        row[start : start + len(q)] = interface_slope(body, port.interface_name, q)[:, :3] @ (A.T @ e)
    row[6 * body.index : 6 * body.index + 3] = e
    row[6 * body.index + 3 : 6 * body.index + 6] = np.cross(place, A.T @ e)  # e . A (psi x place)
    return row @ T


def _code(e: Array) -> int:
    """1, 2, 3 and their negatives along an axis of the world, 0 otherwise."""
    at = int(np.argmax(np.abs(e)))
    return (at + 1) * int(np.sign(e[at])) if abs(e[at]) > 1.0 - 1e-12 else 0


def _named(e: Array) -> str:
    code = _code(e)
    return f"{'-' if code < 0 else ''}{'xyz'[abs(code) - 1]}" if code else f"({', '.join(f'{x:.4g}' for x in e)})"
