"""The result of a run: histories by name, derived quantities, report, files and plots."""

from __future__ import annotations

import os
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.arguments import Vector
from warpffrf.model.errors import InputError, nearest, require_number
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.messages.progress import speaking
from warpffrf.model.messages.status import Status
from warpffrf.online.history.history import (
    BodyHistory,
    BudgetLine,
    ForceHistory,
    History,
    JointHistory,
    LumpedHistory,
    SensorHistory,
)
from warpffrf.online.history.sensors import sensor_history, sensor_values
from warpffrf.online.stages import last_rows
from warpffrf.output.bearings.bearing_result import BearingResult
from warpffrf.output.bodies.skin import Skin
from warpffrf.output.contact.cell_result import CellContactResult
from warpffrf.output.contact.pair_result import PairResult
from warpffrf.output.contact.result import ContactResult, FilmResult
from warpffrf.output.gears.gear_result import GearResult
from warpffrf.output.geometry.scene_view import SceneView, scene_view
from warpffrf.output.loops import SAME, Hysteresis, channel
from warpffrf.output.small_sliding import SmallSlidingResult
from warpffrf.output.written_file import Written

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from warpffrf.model.scene import Scene
    from warpffrf.model.sensors import Sensor
    from warpffrf.online.vibrations.film_coefficients import FilmCoefficients
    from warpffrf.output.bearings.stiffness import BearingStiffness
    from warpffrf.output.bodies.stress import StressResult
    from warpffrf.output.bodies.stress_below import StressBelow
    from warpffrf.output.report.fold import Pairs
    from warpffrf.output.spectrum import Spectrum
    from warpffrf.output.surface_velocity import SurfaceVelocity
    from warpffrf.output.waterfall import Waterfall


@named_arguments
class Result(reprs.Shown):
    """Result of a run. Arrays have one row per saved step; SI units; positions in the world frame, quaternions (x, y,
    z, w).

    `status` is "completed" or the reason why the run ended early. In the latter case the arrays hold all data up to
    that time and `message` states the remedy.
    """

    def __init__(self, history: History) -> None:
        self.history = history
        self.written: list[Written] = []  # files written by `simulate`, with their write times
        self.unwritten: list[str] = []  # files that `simulate` could not write, with the reason
        self.view: SceneView = scene_view(history.scene)

    @property
    def time(self) -> np.ndarray:
        """Saved times (T,) [s]."""
        return self.history.time

    @property
    def status(self) -> Status:
        """completed, interrupted, or what stopped the run (not_converged, cycling, capacity, not_finite, ...)."""
        return Status(self.history.status)

    @property
    def message(self) -> str:
        """What happened and the remedy; empty if the run completed."""
        return self.history.message

    @property
    def energy(self) -> dict[str, np.ndarray]:
        """The energy ledger, line -> (T,) [J]; see `warpffrf.online.history.history.ENERGY_LINES`."""
        return self.history.energy

    @property
    def scene(self) -> Scene:
        """The scene of the run, to continue with; after `simulate(accuracy=)` with the chosen settings. Raises
        InputError for a result that was read from a file."""
        if not hasattr(self.history.scene, "content_hash") or not hasattr(self.history.scene, "contacts"):
            raise InputError("the result was read from a file, which holds no scene; build the scene anew")
        return self.history.scene

    @property
    def contact_names(self) -> list[str]:
        """Names of the contacts, those with finite sliding first."""
        return [*self.finite_sliding_names, *self.small_sliding_names]

    @property
    def finite_sliding_names(self) -> list[str]:
        """Names of the contacts with finite sliding."""
        return list(self.history.contacts)

    @property
    def small_sliding_names(self) -> list[str]:
        """Names of the contacts with small sliding."""
        return list(self.history.small_sliding)

    def body(self, name: str) -> BodyHistory:
        """Motion of the body called `name`; raises InputError if there is none.

        >>> result.body("upper").position.shape  # (T, 3) m
        (11, 3)
        """
        return _named(self.history.bodies, "body", name)

    def joint(self, name: str) -> JointHistory:
        """Reaction and coordinate of the joint called `name`; raises InputError if there is none."""
        return _named(self.history.joints, "joint", name)

    def force(self, name: str) -> ForceHistory:
        """Force, torque and deformation of the force element called `name`; raises InputError if there is none.

        >>> result.force("press").deformation.shape  # (T, 1) m, of the guide
        (11, 1)
        """
        return _named(self.history.forces, "force", name)

    @property
    def lumped_contact_names(self) -> list[str]:
        """Names of the lumped contacts."""
        return list(self.history.lumped_contacts)

    def lumped_contact(self, name: str) -> LumpedHistory:
        """Force, position, approach and slip of the lumped contact called `name`; raises InputError if there is
        none."""
        return _named(self.history.lumped_contacts, "lumped contact", name)

    @property
    def film_names(self) -> list[str]:
        """Names of the oil films."""
        return list(self.history.films)

    def film(self, name: str) -> FilmResult:
        """The oil film called `name`; raises InputError if there is none."""
        return _named(self._films, "film", name)

    @cached_property
    def _films(self) -> dict[str, FilmResult]:
        return {name: FilmResult(film, self.view.films[name], self) for name, film in self.history.films.items()}

    @cached_property
    def _small_sliding(self) -> dict[str, SmallSlidingResult]:
        return {
            name: SmallSlidingResult(contact, self.view.small_sliding[name], self.time, self.history.bodies)
            for name, contact in self.history.small_sliding.items()
        }

    @property
    def bearing_names(self) -> list[str]:
        """Names of the rolling bearings."""
        return list(self.view.bearings)

    def bearing(self, name: str) -> BearingResult:
        """The bearing called `name`: loads, contact angles and patches of its elements, motion of its rings, lives;
        raises InputError if there is none."""
        return BearingResult(self.history, _named(self.view.bearings, "bearing", name))

    @property
    def gear_names(self) -> list[str]:
        """Names of the gear pairs."""
        return list(self.view.gears)

    def gear(self, name: str) -> GearResult:
        """The gear pair called `name`: transmission error, loads of pairs of teeth, stiffness; raises InputError if
        there is none."""
        return GearResult(self, _named(self.view.gears, "gear pair", name))

    def bearing_stiffness(self, name: str, row: int = -1) -> BearingStiffness:
        """Stiffness (6, 6) [N/m, N/rad, N m/rad] of the bearing called `name` about the saved step `row`, by central
        differences of twelve equilibria under the centrifugal forces and other loads of the step
        (`warpffrf.output.bearings.stiffness`). `.left_out` names what is not included. NaN, with `.reason`, for a
        bearing without load. Raises InputError for loose flexible rings and for a result from a file."""
        from warpffrf.output.bearings.stiffness import bearing_stiffness

        return bearing_stiffness(self.scene, name, self.history, row)

    def bearing_coefficients(self, name: str, frequency: float | None = None) -> FilmCoefficients:
        """Stiffness and damping of the journal bearing called `name` about the last saved step, all of its films
        together, for motions of `frequency` [Hz], None for that of the rotation of the shaft. Tilting pads follow the
        motion about their pivots with their inertia, so that these are the reduced coefficients at that frequency. See
        `FilmResult.coefficients`. Raises InputError for an unknown name, and a result from a file."""
        from warpffrf.online.vibrations.film_coefficients import bearing_coefficients

        if frequency is not None:
            frequency = require_number(frequency, "bearing_coefficients: frequency [Hz]", non_negative=True)
        return bearing_coefficients(self.scene, name, self.history, frequency)

    def since(self, begin: float) -> Result:
        """The saved steps from the time `begin` [s] on, as a Result: its figures, report and plots are those of this
        part, such as the last cycle of a periodic load. Quantities that accumulate (work, loss, slip) still count from
        the start of the run, and so do its counters and notes. An error budget is that of the whole run, if it was
        computed before. Raises InputError if no step was saved from then on.

        >>> part = result.since(result.time[-1] - 1e-3)
        >>> [f"{t:.4f}" for t in part.time[[0, -1]]]
        ['0.0010', '0.0020']
        """
        begin = require_number(begin, "since: begin")
        slack = SAME * float(np.ptp(self.time)) if len(self.time) else 0.0
        first = int(np.searchsorted(self.time, begin - slack))
        if first == len(self.time):
            end = f"the last one is at {self.time[-1]:g} s" if first else "the run saved none"
            raise InputError(f"since: no saved step from {begin:g} s on; {end}")
        return Result(last_rows(self.history, first))

    def hysteresis(self, force: Any, against: Any) -> Hysteresis:
        """Force against displacement over the run: loops with their losses and equivalent damping (`.loop(begin, end)`,
        `.cycles(period)`), stiffness against load (`.stiffness()`), and plots (`.draw(ax)`).

        force, against: an array (T,) [N, m], or an item and its component, `("push", "x")`, of a force, sensor, joint,
        small-sliding contact, contact, film or body; the name alone if it has one component, such as a joint coordinate
        or a sensor; see `warpffrf.output.loops`. Raises InputError for unknown names.
        """
        F = channel(self, force, "N", "force")
        x = channel(self, against, "m", "displacement")
        return Hysteresis(self.time, F.values, x.values, F.label, x.label, F.unit, x.unit)

    def spectrum(self, history: str | np.ndarray, *, envelope: tuple[float, float] | None = None) -> Spectrum:
        """Amplitude spectrum of a history: `.place` [Hz], `.amplitude`, `.peaks()`, `.report()`, `.draw(ax)`.

        history: the name of a column of `to_dataframe`, such as "contact_force_z[roller on plate]", or an array (T,).
        envelope: (low, high) [Hz], for the spectrum of its envelope in this band, which shows repeated impacts. Raises
        InputError for an unknown name, fewer than 8 rows, rows without a value, and a band that rows do not resolve.
        """
        from warpffrf.output.spectrum import frequency_spectrum

        return frequency_spectrum(self.time, *self._history(history), envelope)

    def orders(self, history: str | np.ndarray, body: str, axis: Any = None) -> Spectrum:
        """Order spectrum of a `history`, `.place` [1/rev], over the rotation of the body called `body` about `axis`
        (3,) in the world frame (None: its mean angular velocity); also for variable speed.

        Raises InputError as `spectrum`, and for a body that rotates by fewer than 2 revolutions or reverses.
        """
        from warpffrf.output.spectrum import order_spectrum

        values, label, units = self._history(history)
        return order_spectrum(self.time, values, self.body(body).angular_velocity, label, units, body, axis)

    def surface_velocity(self, body: str, rotor: str, orders: Sequence[float], axis: Any = None) -> SurfaceVelocity:
        """Complex velocity of the skin of a body that does not turn (a housing) at `orders` (k,) of the rotation
        of the body called `rotor` about `axis`, as of `orders`: `.velocity` (k, n, 3), `.normal` (k, n) [m/s],
        `.radiated_power()` (k,) [W], `.to_uff(path)`. Method and neglected parts: `warpffrf.output.surface_velocity`.

        Raises InputError as `orders`, for a rigid `body` or one that turns, and for orders that are no multiples of one
        over the whole turns of the run, or that its rows do not resolve.
        """
        from warpffrf.output.surface_velocity import surface_velocity

        return surface_velocity(self, body, rotor, orders, axis)

    def waterfall(
        self, history: str | np.ndarray, speed: str | None = None, *, window: float | None = None, axis: Any = None
    ) -> Waterfall:
        """Spectra, as of `spectrum`, of consecutive windows of a history over time: `.time` (w,) [s], `.frequency` (n,)
        [Hz], `.amplitude` (w, n), `.report()`, `.draw(ax)`; or over the rotational speed of the body called `speed`
        about `axis` as of `orders`: `.speed` (w,) [rev/s], drawn with lines of constant order.

        window: length of a window [s], an eighth of the run if None; its inverse is the frequency resolution. Raises
        InputError as `spectrum`, for fewer than 3 windows or 16 rows per window, and for a speed that does not vary.
        """
        from warpffrf.output.waterfall import over_speed, waterfall

        values, label, units = self._history(history)
        found = waterfall(self.time, values, label, units, window)
        if speed is None:
            return found
        return over_speed(found, self.time, self.body(speed).angular_velocity, speed, axis)

    def _history(self, history: str | np.ndarray) -> tuple[np.ndarray, str, str]:
        """Values (T,), name and unit."""
        from warpffrf.output.files.table import column

        if not isinstance(history, str):
            return np.asarray(history, dtype=float), "values", "as given"
        values, units = column(self, history)
        return values, history, units

    @property
    def sensor_names(self) -> list[str]:
        """Names of the sensors."""
        return [*self.history.sensors, *self._late_sensors]

    def sensor(self, name: str) -> SensorHistory:
        """The sensor called `name`: `.values` (T, components), `.components`, `.unit`; raises InputError if there is
        none. Stresses are evaluated at the first request.

        >>> result.sensor("place").unit
        'm'
        """
        late = self._late_sensors
        if name in late:
            return sensor_history(late[name], sensor_values(late[name], self))
        return _named({**self.history.sensors, **late}, "sensor", name)

    @property
    def _late_sensors(self) -> dict[str, Sensor]:
        """Sensors of a live scene that are evaluated on request; a file holds the values of all sensors."""
        sensors = getattr(self.history.scene, "sensors", [])
        return {s.name: s for s in sensors if s.name not in self.history.sensors}

    def contact(self, name: str) -> Any:
        """The contact called `name`, a `PairResult`, with small sliding a `SmallSlidingResult`; raises InputError if
        there is none.

        >>> pair = result.contact("lower-upper")
        >>> bool(pair.force[-1, 2] < 0.0 and pair.half_width[-1] > pair.half_width[0])  # on the lower roller; m
        True
        """
        return _named({**self._finite_sliding, **self._small_sliding}, "contact", name)

    @cached_property
    def _finite_sliding(self) -> dict[str, PairResult]:
        return {
            name: (ContactResult if history.cells is None else CellContactResult)(
                history, self.view.pairs[name], self.history.bodies, self.time
            )
            for name, history in self.history.contacts.items()
        }

    def skins(self) -> dict[str, Skin]:
        """Deformed skin of each flexible body by name."""
        return {
            name: Skin(self.history, self.view, body)
            for name, body in self.view.bodies.items()
            if body.reduced is not None
        }

    def stress(
        self,
        body: str,
        points: str,
        *,
        rows: Sequence[int] | np.ndarray | None = None,
        only: Sequence[int] | None = None,
    ) -> StressResult:
        """Stress [Pa] of the body at the `points` named in its reduction (`reduce(..., stress={name: points})`):
        `.tensor` (T, p, 6), `.von_mises`, `.principal`, `.max_shear`.

        rows: index numbers (r,) of saved steps, negative ones from the end; only: index numbers (p,) of points; None:
        all, which takes 48 bytes per point and step, so select rows if there are many points. Raises InputError for a
        body without stress points of that name (the message lists the available names), and for rows and points that do
        not exist.
        """
        from warpffrf.output.bodies.stress import stress_result

        return stress_result(self, body, points, rows, only)

    def stress_below(
        self, contact: str | None = None, row: int | None = None, depth: np.ndarray | None = None
    ) -> list[StressBelow]:
        """Stress [Pa] in the half-space below the centre of the patch of a contact (None: the first one), due to the
        pressure at the saved step `row` (None: the last row in contact), without tractions: `.depth` (n,) [m],
        `.tensor` (n, 6), `.von_mises`, `.max_shear`; one result for each Poisson's ratio of its bodies.

        depth: (n,) [m] below the surface, None: down to 3 half-widths. Stress points of the bodies are not required;
        method: `warpffrf.output.bodies.stress_below`. Raises InputError for an unknown contact or row, a row without
        contact, and bodies without material data.
        """
        from warpffrf.output.bodies.stress_below import stress_below

        names = self.finite_sliding_names
        if contact is None and not names:
            raise InputError(
                "stress_below: the scene has no contact with finite sliding; see result.stress for points of a body"
            )
        pair: PairResult = _named(self._finite_sliding, "contact with finite sliding", contact or names[0])
        touching = np.flatnonzero(pair.touching)
        if row is None:
            row = int(touching[-1]) if len(touching) else len(self.time) - 1
        if not 0 <= row < len(self.time):
            raise InputError(f"stress_below: row is {row}; the run has the saved rows 0 to {len(self.time) - 1}")
        return stress_below(pair, row, depth)

    @cached_property
    def energy_scale(self) -> float:
        """The largest energy of the run [J]: stored, or transferred by forces, drives, gravity, dampers and friction.
        Lines that were not computed (NaN) are ignored."""
        energy = {line: np.nan_to_num(values, nan=0.0) for line, values in self.energy.items()}
        zero = np.zeros(len(self.time))
        stored = sum((np.abs(energy.get(k, zero)) for k in ("kinetic", "strain", "contact")), zero)
        potential = energy.get("potential", zero)
        moved = np.abs(potential - potential[:1])
        moved = moved + sum(
            (np.abs(energy.get(k, zero)) for k in ("force_work", "drive_work", "damping", "friction")), zero
        )
        return float(np.max(np.maximum(stored, moved), initial=0.0))

    @property
    def energy_residual(self) -> np.ndarray:
        """(T,) [-] residual of the energy balance (ledger line "numerical") over the largest energy of the run;
        positive: energy was gained; NaN if it was not computed."""
        numerical = np.asarray(self.energy.get("numerical", np.zeros(len(self.time))))
        return numerical / self.energy_scale if self.energy_scale > 0.0 else np.zeros_like(numerical)

    def error_budget(self, *, progress: bool = False) -> list[BudgetLine]:
        """Effect of each source of error on the results: time step, contact grid, sampling points, mesh, inertia terms,
        local modes, iteration (`warpffrf.output.budget`), also for equilibria, and for each quantity that a report
        prints. Lines of the source "not estimated" state why no estimate exists. It is computed at the first request by
        repeating the run, or parts of it, with twice the step, and short parts with a quarter of the step: up to the
        time of a short run, a fifth of that of a long one. Results that are saved afterwards include it. progress:
        report the progress on stderr.

        If no estimate is possible (results from a file without one, check integrators), it is one line "not estimated"
        of size NaN, whose `basis` is the reason.
        """
        from warpffrf.output.budget import budget

        if not self.history.budget:
            if reason := budget.why_not(self):
                return [BudgetLine(budget.UNKNOWN, "all results", np.nan, f"not made: {reason}")]
            with speaking(progress):
                self.history.budget = budget.error_budget(self, progress=progress)
        return self.history.budget

    def report(self, *, progress: bool = True, pairs: Pairs = "folded") -> str:
        """Status, counters, contact quantities at the last saved step, energy balance, error budget, and all neglected
        or limited effects. progress: report the progress on stderr if the error budget is computed here and takes long.
        pairs: four or more contacts, joints, forces or notes that differ only in numbers, also within names, are
        "folded" into one entry with the minimum and maximum of each quantity and the names that have them; "all" lists
        each one. Raises InputError for another word.

        >>> print(result.report(progress=False))  # doctest: +ELLIPSIS
        status            completed
        time              0 to 0.002 s, 11 rows saved
        ...
        """
        from warpffrf.output.report.report import report_of

        return report_of(self, progress, pairs).text()

    def page(self, path: str | os.PathLike[str], *, overwrite: bool = False, progress: bool = True) -> Path:
        """Write one self-contained HTML page of the run to `path` (.html): what was modelled, the figures of the
        report with the error of each, plots and maps, error budget, energy, neglected effects, settings and versions.
        progress: as of `report`. Raises InputError for another ending, a path that cannot be written, and an existing
        file, unless `overwrite` is set and warpffrf wrote it.

        >>> page = result.page("run.html", progress=False)
        """
        from warpffrf.output.page.run_page import write_run_page

        return write_run_page(self, path, overwrite=overwrite, progress=progress)

    def _facts(self) -> dict[str, Any]:
        end = f"{self.time[-1]:.6g} s" if len(self.time) else "no step saved"
        return {**self.history.shown(), "end": end}

    def _picture(self) -> str:
        from warpffrf.output.plots.notebook import picture_html

        return picture_html(self)

    def __repr__(self) -> str:
        end = f"{self.time[-1]:.6g} s" if len(self.time) else "no step saved"
        return f"Result(status={self.status!r}, rows={len(self.time)}, end={end}, contacts={self.contact_names})"

    def plot(
        self, kind: str, ax: Axes | None = None, contact: str | None = None, film: str | None = None,
        row: int | None = None, channel: str | None = None, speed: str | None = None, bearing: str | None = None,
        gear: str | None = None, theme: str = "light", width: float | None = None,
    ) -> Axes:  # fmt: skip
        """Draw one kind of plot on the matplotlib axes `ax` (new ones if None) and return them.

        contact: name of the contact that is drawn; None: the first one (with friction, for friction plots). film,
        bearing, gear: likewise the oil film, bearing and gear pair; row: saved step of maps of films and loads of
        bearings, and of maps of contacts with small sliding, the last one if None. channel: history of "spectrum" and
        "waterfall", as of `spectrum`; speed: body whose rotation is the reference, for orders or speed instead of
        frequency or time (None). theme, width: "dark" and the width [m] of a printed column; of new axes. Kinds:
        docs/plots.md, `warpffrf plot --list`. Raises InputError for an unknown kind, contact, film, bearing, gear
        pair, history or body, and for data that the run does not have.

        >>> axes = result.plot("ripple", contact="lower-upper")
        """
        from warpffrf.output.plots import figure

        return figure.plot(self, kind, ax, contact, film, row, channel, speed, bearing, gear, theme, width)

    def summary(
        self, *, contact: str | None = None, film: str | None = None, row: int | None = None, theme: str = "light",
        width: float | None = None,
    ) -> Figure:  # fmt: skip
        """A matplotlib Figure with every plot for which the run has data; contact, film, row, theme, width [m]: as of
        `plot`. Raises InputError as `plot`.

        >>> result.summary(theme="dark").savefig("summary.png")
        """
        from warpffrf.output.plots import figure

        return figure.summary(self, contact, film, row, theme=theme, width=width)

    def picture(
        self, path: str | os.PathLike[str], field: str = "displacement", *, time: float | None = None,
        view: str | None = None, deformation_factor: float | None = None, relative_to: str | None = None,
        theme: str = "light", width: float | None = None, overwrite: bool = False,
    ) -> Path:  # fmt: skip
        """Draw the bodies at the saved step nearest to `time` [s], the last one if None, into the picture `path` (.png,
        .pdf, .svg); requires neither screen nor viewer.

        field: quantity of the skin colours: "displacement", "pressure", with friction "traction", "slip", "state" and
        "wear", and "von_mises" for bodies reduced with `stress={"skin": "skin"}`. view: "front" (from -y), "side" (from
        +x), "top", "iso", or the name of a contact or film for a close-up; None: one that suits the extents of the
        bodies. deformation_factor [-]: magnification of the elastic displacement; None: chosen from 1, 2, 5, 10, ...,
        1 in a close-up. relative_to: name of an interface, whose motion is then neither shown as displacement nor
        magnified, of the bodies that have it; "start": the whole motion of flexible bodies since the first saved step;
        None: their user frames. theme, width: "dark" and the width [m] of a printed column. Raises
        InputError for a field that no body has, a time outside of the run, an unknown view or theme, a factor that is
        not positive, and an existing file, unless `overwrite` is set and warpffrf wrote it.
        """
        from warpffrf.output.plots.animation import write_still

        return write_still(
            self, path, field, time=time, factor=deformation_factor, view=view, relative_to=relative_to, theme=theme,
            width=width, overwrite=overwrite,
        )  # fmt: skip

    def animate(
        self, path: str | os.PathLike[str], field: str = "displacement", *, every: int | None = None, fps: float = 15.0,
        view: str | None = None, deformation_factor: float | None = None, relative_to: str | None = None,
        theme: str = "light", overwrite: bool = False, progress: bool = True,
    ) -> Path:  # fmt: skip
        """Draw the bodies over the run into `path`, a .gif, or an .mp4 (requires the program ffmpeg); camera and colour
        scale are the same in all frames.

        field, view, deformation_factor, relative_to, theme, overwrite: as of `picture`. every: number of saved steps
        per frame, None: at most 100 frames; fps [1/s]: frames per second; progress: report the progress on stderr. An
        interrupted animation leaves no file. Raises InputError as `picture`, for another file ending, and for an .mp4
        without ffmpeg.
        """
        from warpffrf.output.plots.animation import write_animation

        with speaking(progress):
            return write_animation(
                self, path, field, every=every, fps=fps, factor=deformation_factor, view=view,
                relative_to=relative_to, theme=theme, overwrite=overwrite, progress=progress,
            )  # fmt: skip

    def small_sliding_page(self, contact: str | None = None, times: Vector | None = None) -> Figure:
        """A matplotlib Figure of a contact with small sliding, the first one if None: pressure, state and loss at
        saved steps nearest to the `times` [s], three of the run if None. Raises InputError for an unknown contact, and
        for times outside of the run."""
        from warpffrf.output.plots.small_sliding import small_sliding_figure

        return small_sliding_figure(self, contact, times)

    def to_xarray(self) -> xarray.Dataset:
        """An `xarray.Dataset` with the names, units and frames of the results file; requires the optional package
        xarray."""
        from warpffrf.output.files.table import to_xarray

        return to_xarray(self)

    def to_dataframe(self) -> Any:
        """A `pandas.DataFrame` of every history with one row per saved step: index `time` [s], columns such as
        `contact_force_z[roller on plate]`, their units in `.attrs["units"]`. Fields over the patch and modal
        coordinates are only in `to_xarray`. Raises ImportError without the optional package pandas.

        >>> bool(result.to_dataframe()["contact_force_z[lower-upper]"].iloc[0] < 0.0)  # N
        True
        """
        from warpffrf.output.files.table import to_dataframe

        return to_dataframe(self)

    def to_csv(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Write the table of `to_dataframe` as comma-separated values, with names and units in the first line; does not
        require pandas. Raises InputError for a path that does not end in .csv, and for an existing file, unless
        `overwrite` is set and it is such a table."""
        from warpffrf.output.files.table import write_csv

        return write_csv(self, path, overwrite=overwrite)

    def to_vtkhdf(
        self, path: str | os.PathLike[str], *, stride: int = 1, overwrite: bool = False, progress: bool = True
    ) -> Path:
        """Write every `stride`-th saved step into one VTKHDF file at `path`, for ParaView 5.13 and pyvista: a block for
        each body and small-sliding contact. Fields on the skins: displacement, pressure, friction, and for bodies
        reduced with `stress={"skin": "skin"}` stress and von Mises stress. progress: report the progress on stderr.

        Raises InputError for a path that does not end in .vtkhdf, a stride below 1, a scene without flexible bodies,
        and an existing file, unless `overwrite` is set and warpffrf wrote it. Raises OSError where the disk is full.
        """
        from warpffrf.output.files.vtkhdf import write_time_series

        with speaking(progress):
            return write_time_series(self, path, stride=stride, overwrite=overwrite, progress=progress)

    def save(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Write the run as one HDF5 file at `path`; `Result.load` reads it, also to continue the run. Raises InputError
        for an existing file, unless `overwrite` is set and warpffrf wrote it."""
        from warpffrf.output.files.results import write_results

        return write_results(self, path, overwrite=overwrite)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Result:
        """Read the results file at `path`, or the folder `.unfinished` of a run that has not ended. Raises InputError
        for a file that is missing, damaged, of another kind or of a newer version."""
        from warpffrf.output.files.results import read_history
        from warpffrf.output.files.unfinished import is_unfinished, read_unfinished

        return cls(read_unfinished(Path(path).expanduser()) if is_unfinished(path) else read_history(path))


def _named(items: dict[str, Any], kind: str, name: str) -> Any:
    if name not in items:
        known = ", ".join(f"'{n}'" for n in items) or "none"
        raise InputError(f"the result has no {kind} called '{name}'; {_meant(name, list(items))}it has: {known}")
    return items[name]


def _meant(name: str, known: Sequence[str]) -> str:
    """The question for the name probably meant: that of the same two bodies, else the most similar one; or ""."""
    first, _, second = str(name).partition("-")
    if second and f"{second}-{first}" in known:
        return f"did you mean '{second}-{first}' (the order counts)? "
    near = nearest(name, known)
    return f"did you mean '{near}'? " if near else ""
