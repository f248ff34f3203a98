r"""Modes of a scene: frequencies, damping, shapes, a table and a plot.

Frequency errors. Errors of the frequencies of a machine due to the truncated bases of bodies.

Vibration modes of the finite-element model that the basis includes are exact. For the other modes, k, the response to
interface loads at the frequency f, g_k/(1 - (f/f_k)^2), is represented by its static part and the first inertia term,
g_k (1 + (f/f_k)^2), which attachment modes match; part of the next term, g_k (f/f_k)^4, is missing. An error e of a
flexibility with the share s of the strain energy of a mode changes the frequency by s e/2 (Rayleigh). With the
attachment modes a, of frequencies f_a and shares s_a, in place of the modes k

    error = PART/2 sum_a s_a (f/f_a)^4,

`PART` as measured (tests/output/results/test_frequency_errors.py: for beams with two to eight modes, free and with an
end mass, nine of ten errors above 0.1 % are estimated to a factor of three; errors of bodies without vibration modes
are up to ten times smaller). Local modes under pressures have no inertia, only g_k: e = r^2/(1 - r^2) at most, with r =
f over the frequency up to which the bodies include their vibrations. Their share is at most the remaining energy if a
contact is closed, including springs and joints. Mesh errors are not included.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.errors import InputError, require_count, require_number, unknown_name
from warpffrf.model.files.paths import check_ending, checked_output_path, written_whole
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.messages.progress import speaking
from warpffrf.model.reduced.inertia import skin_displacement, skin_variation
from warpffrf.model.scene import Scene
from warpffrf.online.vibrations.eigenmodes import BodyShape, SceneModes, find_modes
from warpffrf.output.budget.budget import FLOOR, SMALL, percent
from warpffrf.output.equivalent_damping import EquivalentDamping, equivalent_damping
from warpffrf.output.frequency_response import FrequencyResponse, frequency_response
from warpffrf.output.mode_files import gltf_file, universal_file
from warpffrf.output.plots.modes import draw_shape, shapes_figure, skins_of
from warpffrf.output.result import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

UNDAMPED = 1e-6  # ratio: residual damping of an undamped machine linearised about the end of a run is about 1e-7
NAMED_SHARE = 0.01  # of the kinetic energy: bodies with a smaller share are not named in the table
SIZE = (7.0, 4.2)  # inches


class Modes(reprs.Shown):
    """Modes of a scene about a state, by ascending frequency; returned by `eigenmodes`.

    A motion is the real part of `shape * exp(eigenvalue * t)`. SI units, world axes. `about` names the state, `notes`
    list neglected effects. Mode indices such as in `modes[i]` start at 0.
    """

    def __init__(self, found: SceneModes) -> None:
        self.found = found
        self.scene: Any = found.scene
        self.about, self.notes = found.about, found.notes

    def __len__(self) -> int:
        return len(self.eigenvalues)

    def _facts(self) -> dict[str, Any]:
        return {"about": self.about, "modes": len(self)} | {
            f"mode {number}": f"{frequency:.6g} Hz" for number, frequency in enumerate(self.frequencies)
        }

    def __repr__(self) -> str:
        lowest = f"{self.frequencies[0]:.6g} to {self.frequencies[-1]:.6g} Hz" if len(self) else "none"
        return f"Modes({len(self)} about the {self.about}: {lowest})"

    @property
    def eigenvalues(self) -> np.ndarray:
        """(n,) complex [1/s]; of a conjugate pair the one with positive imaginary part, of an overdamped motion
        both."""
        return self.found.eigenvalues

    @property
    def frequencies(self) -> np.ndarray:
        """(n,) Hz, |eigenvalue|/2 pi; 0 for a motion without stiffness."""
        return np.abs(self.eigenvalues) / (2.0 * np.pi)

    @property
    def damping_ratios(self) -> np.ndarray:
        """(n,) -Re(eigenvalue)/|eigenvalue|: 0 undamped, 1 no oscillation, negative unstable; 0 at 0 Hz."""
        size = np.abs(self.eigenvalues)
        return np.divide(-np.real(self.eigenvalues), size, out=np.zeros(len(size)), where=size > 0.0)

    @property
    def frequency_errors(self) -> np.ndarray:
        """(n,) relative errors of the frequencies due to the truncated bases of flexible bodies, NaN if unknown; mesh
        errors are not included. See `warpffrf.output.modes_result`."""
        return frequency_errors(self.found)

    def shape(self, i: int, body: str) -> BodyShape:
        """Mode i on a body: `translation` (3,) [m] of its user origin, `rotation` (3,) [rad], `modal` (m,), complex.

        Scaled so that the kinetic energy of the velocity `shape` 1/s is 1/2 J. Raises InputError for an unknown mode or
        body.
        """
        if body not in self.found.shapes:
            raise unknown_name("body", body, self.found.shapes)
        return self.found.shapes[body][self._index(i)]

    def displacement(self, i: int, body: str) -> np.ndarray:
        """Mode i at the skin points (n, 3) of a flexible body, complex, world axes; of a rigid body at its user origin
        (1, 3)."""
        shape = self.shape(i, body)
        scene_body = self.scene.body(body)
        if scene_body.reduced is None:
            return shape.translation[None].copy()
        A = rot.matrix(self.found.rotation[body])
        q = self.found.modal[body]
        moved = (scene_body.reduced.surface.points + skin_displacement(scene_body, q)) @ A.T
        elastic = skin_variation(scene_body, q, shape.modal) @ A.T
        return shape.translation + np.cross(shape.rotation, moved) + elastic

    def energy_shares(self, i: int) -> dict[str, float]:
        """Share of each body in the kinetic energy of mode i."""
        i = self._index(i)
        return {name: float(share[i]) for name, share in self.found.shares.items()}

    def equivalent_damping(
        self,
        i: int,
        amplitude: float | Sequence[float] | np.ndarray,
        *,
        at: Any = None,
        cycles: int = 3,
        steps: int = 48,
    ) -> EquivalentDamping:
        """Damping and stiffness that the friction of small-sliding contacts gives a vibration in mode i, at given
        amplitudes.

        amplitude: one or several, the displacement [m] of the port `at` in the mode, `body["interface"]` or
        `body.at((x, y, z))`; without `at` that of the mode's coordinate [m kg^(1/2)], whose modal mass is 1. The
        contacts undergo `cycles` (3 or more) quasi-static cycles of `steps` steps about the reference state of the
        modes, and the last one is evaluated; bodies, springs and other contacts are linear, and deform with the slip.
        More steps improve frequency and loss. Raises InputError for scenes without small-sliding contacts, states in
        motion, modes that are no standing vibration, ports that do not move, and amplitudes at which nothing constrains
        the mode. Method: `warpffrf.online.vibrations.rubbing`.
        """
        return equivalent_damping(self.found, self._index(i), amplitude, at=at, cycles=cycles, steps=steps)

    def frequency_response(self, force: Any, responses: Any, frequencies: Any) -> FrequencyResponse:
        """Response of the scene about the state to a harmonic force, with all coordinates, not the modes found alone.

        force: (port, direction), `(body["interface"], (0, 0, 1))` or `(body.at((x, y, z)), ...)`, direction (3,) in
        world axes. responses: the same, or a list of such pairs. frequencies (f,) [Hz]. A reciprocal of the force over
        a displacement is a dynamic stiffness. Raises InputError for scenes with oil films, states with rotating
        bodies, ports that do not move, and frequencies at which the response is infinite.
        """
        return frequency_response(self.found, force, responses, frequencies)

    def report(self) -> str:
        """Table of the modes, frequencies, damping, the bodies with the largest motion, and notes: plain text."""
        lines = [f"modes about the {self.about}, t = {self.found.time:.6g} s", ""]
        lines.append(f"{'mode':>4}  {'frequency Hz':>14}  {'damping %':>10}  moves")
        for i, (f, zeta) in enumerate(zip(self.frequencies, self.damping_ratios, strict=True)):
            shares = sorted(self.energy_shares(i).items(), key=lambda item: -item[1])
            named = ", ".join(f"{name} {100.0 * share:.0f} %" for name, share in shares if share >= NAMED_SHARE)
            lines.append(f"{i:>4}  {f:>14.6g}  {100.0 * zeta + 0.0:>10.4g}  {named}")
        if any(body.reduced is not None for body in self.scene.bodies):
            lines += ["", *_errors_told(self.frequency_errors)]
        if np.any(self.damping_ratios < -UNDAMPED):
            lines += ["", "Negative damping: the motion grows, the state is unstable."]
        if len(self.notes):
            lines += ["", *(f"note: {note}" for note in self.notes)]
        return "\n".join(lines)

    __str__ = report

    def plot(self, ax: Any = None) -> Any:
        """Draw the share of each body in each mode, modes labelled with frequency and damping, on the matplotlib axes
        `ax` (new ones if None); returns them."""
        if ax is None:
            ax = _new_axes()
        left = np.zeros(len(self))
        for name, share in self.found.shares.items():
            ax.barh(np.arange(len(self)), 100.0 * share, left=left, label=name, height=0.75)
            left += 100.0 * share
        ratios = np.where(np.abs(self.damping_ratios) > UNDAMPED, self.damping_ratios, 0.0)
        labels = [f"{f:.5g} Hz, {100.0 * z:.3g} %" for f, z in zip(self.frequencies, ratios, strict=True)]
        ax.set_yticks(np.arange(len(self)), labels)
        ax.invert_yaxis()
        ax.set(xlabel="share of the kinetic energy [%]", title=f"Modes about the {self.about}")
        ax.set_xlim(0.0, 100.0)
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncols=4, frameon=False)
        return ax

    def plot_shape(self, i: int, ax: Axes | None = None, *, scale: float = 0.06) -> Axes:
        """Draw mode i on the matplotlib axes `ax` (new ones if None) and return them: deformed skins in colour, red at
        the largest motion, over the undeformed ones in grey, at the instant of the largest displacement; rigid bodies
        as solids, as in pictures of a run. scale [-]: largest displacement drawn, as a fraction of the extent of the
        bodies.

        Raises InputError for an unknown mode and a scale that is not positive.
        """
        drawn_on: Any = _new_axes() if ax is None else ax
        draw_shape(drawn_on, skins_of(self, self._index(i)), self._title(i), drawn=_scale(scale))
        return drawn_on

    def plot_shapes(self, count: int = 8, *, scale: float = 0.06) -> Figure:
        """A matplotlib Figure of the first `count` modes, drawn as by `plot_shape` with its scale [-]. Raises
        InputError for a count below 1, no modes, and as `plot_shape`."""
        count = min(require_count(count, "plot_shapes: count", 1), len(self))
        if not count:
            raise InputError("plot_shapes: there are no modes; nothing in the scene can move")
        drawn = _scale(scale)
        shapes = [(self._title(i), skins_of(self, i)) for i in range(count)]
        return shapes_figure(shapes, f"Modes about the {self.about}", drawn=drawn)

    def to_uff(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Write a universal file: nodes and triangles of the skins (datasets 2411, 2412, SI units), and a dataset 55
        per mode, six digits; returns the path. Undamped modes are normal modes of modal mass 1, others complex ones.
        Raises InputError for a file that exists, unless warpffrf wrote it and `overwrite` is set, and where there is
        nothing to write."""
        return self._written(path, "to_uff", (".uff", ".unv"), overwrite)

    def to_gltf(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Write a .glb file, glTF with the modes as morph targets and an animation of each, which viewers in browsers
        rotate and play; returns the path. Raises InputError as `to_uff`, with `overwrite`."""
        return self._written(path, "to_gltf", (".glb",), overwrite)

    def _written(self, path: str | os.PathLike[str], what: str, endings: tuple[str, ...], overwrite: bool) -> Path:
        check_ending(path, what, endings)
        target = checked_output_path(path, what, overwrite=overwrite)
        skins = [skins_of(self, i) for i in range(len(self))]
        if not skins or not skins[0]:
            raise InputError(f"{what}: there are no modes, or no skins of bodies to show them")
        if what == "to_uff":
            content = universal_file(self, skins, UNDAMPED).encode()
        else:
            content = gltf_file(self, skins, UNDAMPED)
        with written_whole(target) as partial:
            partial.write_bytes(content)
        return target

    def _title(self, i: int) -> str:
        ratio = 100.0 * self.damping_ratios[i] + 0.0
        return f"{i}: {self.frequencies[i]:.5g} Hz" + (f", {ratio:.2g} %" if abs(ratio) > 100.0 * UNDAMPED else "")

    def _index(self, i: int) -> int:
        if not isinstance(i, int | np.integer) or not 0 <= i < len(self):
            raise InputError(f"mode {i!r} does not exist; there are {len(self)}, numbered from 0")
        return int(i)


def _errors_told(errors: np.ndarray) -> list[str]:
    """Text of the report on the errors of frequencies."""
    known = np.flatnonzero(np.isfinite(errors))
    lines = []
    if len(known):
        told = ", ".join(f"{number}: {percent(errors[number])}" for number in known if errors[number] >= FLOOR)
        lines.append(f"frequency errors due to the bases of bodies: {told + '; others ' if told else ''}{SMALL}")
    if missing := [str(number) for number in np.flatnonzero(np.isnan(errors))]:
        lines.append(
            f"not estimated: those of modes {', '.join(missing)} (bases that do not say which vibrations they hold, or "
            "hold none so high where a contact is closed)"
        )
    return [*lines, "not estimated: mesh errors of frequencies (require the bodies on other meshes)"]


def _new_axes() -> Any:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, layout="constrained")
    FigureCanvasAgg(figure)
    return figure.add_subplot()


def _scale(scale: float) -> float:
    return require_number(scale, "plot_shape: scale", positive=True)


@named_arguments
def eigenmodes(scene: Scene, count: int = 20, *, about: Result | str | None = None, progress: bool = True) -> Modes:
    """The `count` lowest modes of `scene`: complex modes of its small motions, with damping and joints.

    about: None for its equilibrium, "initial" for its initial positions and velocities, or the Result of a run or
    `equilibrium` of this scene, whose last state is used with its velocities: modes of a rotating machine then include
    gyroscopic and centrifugal terms, in axes that rotate with the bodies. progress: report the progress on stderr.
    Raises InputError for wrong input and if there is no equilibrium. Method: `warpffrf.online.vibrations.linearise`.
    """
    if not hasattr(scene, "bodies") or not hasattr(scene, "content_hash"):
        raise InputError(f"eigenmodes: a Scene is needed, got {scene!r}")
    state: Any = about
    if isinstance(about, Result):
        if about.view.content_hash != scene.content_hash():
            raise InputError(
                "eigenmodes: about is the result of another scene (their content differs); use the scene that it came "
                "from"
            )
        if not about.history.checkpoint:
            raise InputError("eigenmodes: about has no checkpoint, the state at its end; run it again")
        state = about.history
    with speaking(progress):
        return Modes(find_modes(scene, count, about=state, progress=progress))


Array = np.ndarray
PART = 1.0 / 5.0
ROUND_OFF = 1e-9  # share of the energy


def frequency_errors(found: SceneModes) -> Array:
    """(n,) relative errors of the frequencies; NaN if a basis does not state which vibrations it includes, and for
    vibrations of closed contacts above those; 0 at 0 Hz."""
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
