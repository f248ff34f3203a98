"""The result of a run as the user sees it: histories by name, derived quantities, a report, and ways out (files,
plots)."""

from __future__ import annotations

import os
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.arguments import Vector
from warpffrf.model.errors import InputError
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.messages.progress import speaking
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
from warpffrf.output.bearings.bearing_result import BearingResult
from warpffrf.output.bodies.skin import Skin
from warpffrf.output.contact.cell_result import CellContactResult
from warpffrf.output.contact.pair_result import PairResult
from warpffrf.output.contact.result import ContactResult, FilmResult
from warpffrf.output.geometry.scene_view import SceneView, scene_view
from warpffrf.output.loops import Hysteresis, channel
from warpffrf.output.small_sliding import SmallSlidingResult
from warpffrf.output.written import Written

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from warpffrf.model.scene import Scene
    from warpffrf.model.sensors import Sensor
    from warpffrf.output.bearings.stiffness import BearingStiffness
    from warpffrf.output.bodies.stress import StressResult
    from warpffrf.output.bodies.stress_below import StressBelow
    from warpffrf.output.report.fold import Pairs
    from warpffrf.output.spectrum import Spectrum
    from warpffrf.output.waterfall import Waterfall


@named_arguments
class Result(reprs.Shown):
    """What a run left behind. Arrays have one row per saved step; SI units; positions in the world, quaternions
    (x, y, z, w).

    `status` is "completed", or says why the run ended early: the arrays then hold everything up to there and
    `message` names the cure.
    """

    def __init__(self, history: History) -> None:
        self.history = history
        self.written: list[Written] = []  # files that `simulate` has written, with their seconds
        self.unwritten: list[str] = []  # what `simulate` could not write, and why
        self.view: SceneView = scene_view(history.scene)

    @property
    def time(self) -> np.ndarray:
        """(T,) s."""
        return self.history.time

    @property
    def status(self) -> str:
        """completed, interrupted, or what stopped the run (not_converged, cycling, capacity, not_finite, ...)."""
        return self.history.status

    @property
    def message(self) -> str:
        """What happened and what to do about it; empty when the run completed."""
        return self.history.message

    @property
    def energy(self) -> dict[str, np.ndarray]:
        """The energy ledger, line -> (T,) J; see `warpffrf.online.history.history.ENERGY_LINES`."""
        return self.history.energy

    @property
    def scene(self) -> Scene:
        """The scene of the run, to go on with: of `simulate(accuracy=)` with what was chosen. Raises InputError for a
        result that was read from a file."""
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
        """Motion of the body called `name`; raises InputError when there is none.

        >>> result.body("upper").position.shape  # (T, 3) m
        (11, 3)
        """
        return _named(self.history.bodies, "body", name)

    def joint(self, name: str) -> JointHistory:
        """Reaction and coordinate of the joint called `name`; raises InputError when there is none."""
        return _named(self.history.joints, "joint", name)

    def force(self, name: str) -> ForceHistory:
        """Force, torque and deformation of the force element called `name`; raises InputError when there is none.

        >>> result.force("press").deformation.shape  # (T, 1) m, of the guide
        (11, 1)
        """
        return _named(self.history.forces, "force", name)

    @property
    def lumped_contact_names(self) -> list[str]:
        """Names of the lumped contacts."""
        return list(self.history.lumped_contacts)

    def lumped_contact(self, name: str) -> LumpedHistory:
        """Force, place, approach and slip of the lumped contact called `name`; raises InputError when there is none."""
        return _named(self.history.lumped_contacts, "lumped contact", name)

    @property
    def film_names(self) -> list[str]:
        """Names of the oil films."""
        return list(self.history.films)

    def film(self, name: str) -> FilmResult:
        """The oil film called `name`; raises InputError when there is none."""
        return _named(self._films, "film", name)

    @cached_property
    def _films(self) -> dict[str, FilmResult]:
        return {name: FilmResult(film, self.view.films[name], self.time) for name, film in self.history.films.items()}

    @cached_property
    def _small_sliding(self) -> dict[str, SmallSlidingResult]:
        return {
            name: SmallSlidingResult(contact, self.view.small_sliding[name], self.time, self.history.bodies)
            for name, contact in self.history.small_sliding.items()
        }

    @property
    def bearing_names(self) -> list[str]:
        """Names of the whole bearings."""
        return list(self.view.bearings)

    def bearing(self, name: str) -> BearingResult:
        """The bearing called `name`: loads, contact angles and patches of its elements, motion of its rings, lives;
        raises InputError when there is none."""
        return BearingResult(self.history, _named(self.view.bearings, "bearing", name))

    def bearing_stiffness(self, name: str, row: int = -1) -> BearingStiffness:
        """Stiffness (6, 6) [N/m, N/rad, N m/rad] of the bearing called `name` about the saved step `row`, by central
        differences of twelve equilibria (`warpffrf.output.bearings.stiffness`); `.left_out` names friction and loads of
        elements that are not in it. NaN, with `.reason`, of a bearing without load. Raises InputError for flexible
        rings that nothing holds, and for a result that was read from a file."""
        from warpffrf.output.bearings.stiffness import bearing_stiffness

        return bearing_stiffness(self.scene, name, self.history, row)

    def hysteresis(self, force: Any, against: Any) -> Hysteresis:
        """A force against a displacement over the run: loops with their losses and equivalent damping
        (`.loop(begin, end)`, `.cycles(period)`), stiffness against load (`.stiffness()`), and plots (`.draw(ax)`).

        force, against: an array (T,) [N, m], or what it is of: `("push", "x")`, of a force, sensor, joint, lap,
        contact, film or body and its component, or a name alone where it has one, as a joint's coordinate or a sensor;
        see `warpffrf.output.loops`. Raises InputError for what there is not.
        """
        F = channel(self, force, "N", "force")
        x = channel(self, against, "m", "displacement")
        return Hysteresis(self.time, F.values, x.values, F.label, x.label, F.unit, x.unit)

    def spectrum(self, history: str | np.ndarray) -> Spectrum:
        """Amplitudes of a history by frequency: `.place` [Hz], `.amplitude`, `.peaks()`, `.report()`, `.draw(ax)`.

        history: the name of a column of `to_dataframe`, as "contact_force_z[roller on plate]", or an array (T,). Raises
        InputError for a name that there is not, fewer than 8 rows and rows without a value.
        """
        from warpffrf.output.spectrum import frequency_spectrum

        return frequency_spectrum(self.time, *self._history(history))

    def orders(self, history: str | np.ndarray, body: str, axis: Any = None) -> Spectrum:
        """The same of a `history` by orders, `.place` [1/turn], of the rotation of the body called `body` about `axis`
        (3,) in the world, that of its mean angular velocity if None; also while its speed changes.

        Raises InputError as `spectrum`, and for a body that turns fewer than 2 times, or back.
        """
        from warpffrf.output.spectrum import order_spectrum

        values, label, units = self._history(history)
        return order_spectrum(self.time, values, self.body(body).angular_velocity, label, units, body, axis)

    def waterfall(
        self, history: str | np.ndarray, speed: str | None = None, *, window: float | None = None, axis: Any = None
    ) -> Waterfall:
        """Spectra of consecutive windows of a history, as of `spectrum`, over time: `.time` (w,) [s], `.frequency` (n,)
        [Hz], `.amplitude` (w, n), `.report()`, `.draw(ax)`; or over the speed of rotation of the body called `speed`
        about `axis` as of `orders`: `.speed` (w,) [turns/s], drawn with lines of orders.

        window: length of a window [s], an eighth of the run if None; frequencies are told to 1 over it. Raises
        InputError as `spectrum`, for fewer than 3 windows or 16 rows in one, and for a speed that does not change.
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
        """The sensor called `name`: `.values` (T, components), `.components`, `.unit`; raises InputError when there is
        none. A stress is evaluated when it is first asked for.

        >>> result.sensor("place").unit
        'm'
        """
        late = self._late_sensors
        if name in late:
            return sensor_history(late[name], sensor_values(late[name], self))
        return _named({**self.history.sensors, **late}, "sensor", name)

    @property
    def _late_sensors(self) -> dict[str, Sensor]:
        """Sensors of a live scene that are evaluated when they are asked for; a file holds the values of all."""
        sensors = getattr(self.history.scene, "sensors", [])
        return {s.name: s for s in sensors if s.name not in self.history.sensors}

    def contact(self, name: str) -> Any:
        """The contact called `name`, a `PairResult`, with small sliding a `SmallSlidingResult`; raises InputError when
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
                history, self.view.pairs[name], self.history.bodies
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
        """Stress [Pa] of the body at the `points` that were named when it was reduced (`reduce(..., stress={name:
        points})`): `.tensor` (T, p, 6), `.von_mises`, `.principal`, `.max_shear`.

        rows: numbers (r,) of the saved steps wanted, negative ones from the end; only: numbers (p,) of the points
        wanted; all if None, which takes 48 bytes per point and step: of many points name the rows. Raises InputError
        for a body without stress points of that name, the message lists those there are, and for rows and points that
        there are not.
        """
        from warpffrf.output.bodies.stress import stress_result

        return stress_result(self, body, points, rows, only)

    def stress_below(
        self, contact: str | None = None, row: int | None = None, depth: np.ndarray | None = None
    ) -> list[StressBelow]:
        """Stress [Pa] in the half-space below the centre of the patch of a contact pair, the first one if None, of the
        pressure of the saved step `row`, the last one that touches if None, without tractions: `.depth` (n,) [m],
        `.tensor` (n, 6), `.von_mises`, `.max_shear`; one for each of Poisson's ratios of its bodies.

        depth: (n,) [m] from the surface, down to 3 half-widths if None. It needs no stress points of the bodies; how it
        is made: `warpffrf.output.bodies.stress_below`. Raises InputError for a pair or row that there is not, a row in
        which nothing touches, and bodies that do not say their material.
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
        """The largest energy at hand in the run [J]: stored, or moved by forces, drives, gravity, dampers and friction.
        Lines that were not booked (NaN) do not count."""
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
        """(T,) [-] what closes the energy balance (ledger line "numerical") over the largest energy at hand;
        positive means gained; NaN where it was not booked."""
        numerical = np.asarray(self.energy.get("numerical", np.zeros(len(self.time))))
        return numerical / self.energy_scale if self.energy_scale > 0.0 else np.zeros_like(numerical)

    def error_budget(self, *, progress: bool = False) -> list[BudgetLine]:
        """What each source of error does to the results: time step, contact grid, sampling points, mesh, inertia terms,
        local modes, iteration (`warpffrf.output.budget`), of equilibria too, and for each figure that a report prints;
        lines of the source "not estimated" say why nothing is known. Made when first asked for, by stepping the run, or
        parts of it, once more with twice the step, and short parts with a quarter of it: up to the time of a short run,
        a fifth of that of a long one. It goes into a file with the results that are saved afterwards. progress: how far
        it is, on stderr.

        Where it cannot be made, of results from a file without one and of the check integrators, it is one line "not
        estimated" of size NaN, whose `basis` is the reason.
        """
        from warpffrf.output.budget import budget

        if not self.history.budget:
            if reason := budget.why_not(self):
                return [BudgetLine(budget.UNKNOWN, "all results", np.nan, f"not made: {reason}")]
            with speaking(progress):
                self.history.budget = budget.error_budget(self, progress=progress)
        return self.history.budget

    def report(self, *, progress: bool = True, pairs: Pairs = "folded") -> str:
        """Status, counters, contact figures at the last saved step, energy balance, the error budget, and everything
        neglected or capped. progress: how far the error budget is, on stderr, where it is made and takes long. pairs:
        four and more contacts, joints, forces or notes that differ in figures and in numbers within names alone are
        "folded" into one, with the least and the largest of each figure and whose they are; "all" tells each by
        itself. Raises InputError for another word.

        >>> print(result.report(progress=False))  # doctest: +ELLIPSIS
        status            completed
        time              0 to 0.002 s, 11 rows saved
        ...
        """
        from warpffrf.output.report.report import report_text

        return report_text(self, progress, pairs)

    def _facts(self) -> dict[str, Any]:
        end = f"{self.time[-1]:.6g} s" if len(self.time) else "no step saved"
        return {**self.history.shown(), "end": end}

    def __repr__(self) -> str:
        end = f"{self.time[-1]:.6g} s" if len(self.time) else "no step saved"
        return f"Result(status={self.status!r}, rows={len(self.time)}, end={end}, contacts={self.contact_names})"

    def plot(
        self, kind: str, ax: Axes | None = None, contact: str | None = None, film: str | None = None,
        row: int | None = None, channel: str | None = None, speed: str | None = None, bearing: str | None = None,
    ) -> Axes:  # fmt: skip
        """Draw one kind of plot on the matplotlib axes `ax` (new ones when None) and return them.

        contact: the contact that is drawn, by name; the first one (with friction, where that is drawn) if None. film,
        bearing: likewise the oil film and the bearing; row: the saved step of their maps and loads, and of maps of
        contacts with small sliding, the last one if None. channel: of "spectrum" and "waterfall" the history, as of
        `spectrum`; speed: the body over whose rotation it is drawn, by orders or speed, over frequency or time if None.
        Kinds: docs/plots.md, `warpffrf plot --list`. Raises InputError for an unknown kind, contact, film, bearing,
        history or body, and what a run has not.

        >>> axes = result.plot("ripple", contact="lower-upper")
        """
        from warpffrf.output.plots import figure

        return figure.plot(self, kind, ax, contact, film, row, channel, speed, bearing)

    def summary(self, *, contact: str | None = None, film: str | None = None, row: int | None = None) -> Figure:
        """A matplotlib Figure with every plot that the run has data for; contact, film, row: as of `plot`. Raises
        InputError as `plot`.

        >>> result.summary().savefig("summary.png")
        """
        from warpffrf.output.plots import figure

        return figure.summary(self, contact, film, row)

    def picture(
        self, path: str | os.PathLike[str], field: str = "displacement", *, time: float | None = None,
        deformation_factor: float | None = None, overwrite: bool = False,
    ) -> Path:  # fmt: skip
        """Draw the bodies at the saved step next to `time` [s], the last one if None, into the picture `path` (.png,
        .pdf, .svg); needs neither screen nor viewer.

        field: what skins are coloured by: "displacement", "pressure", with friction "traction", "slip", "state" and
        "wear", and "von_mises" of bodies reduced with `stress={"skin": "skin"}`. deformation_factor [-]: magnification
        of the elastic displacement, chosen from 1, 2, 5, 10, ... if None. Raises InputError for a field that no body
        has, a time outside of the run, a factor that is not positive, and a file that exists, unless `overwrite` is set
        and warpffrf wrote it.
        """
        from warpffrf.output.plots.animation import write_still

        return write_still(self, path, field, time=time, factor=deformation_factor, overwrite=overwrite)

    def animate(
        self, path: str | os.PathLike[str], field: str = "displacement", *, every: int | None = None, fps: float = 15.0,
        deformation_factor: float | None = None, overwrite: bool = False, progress: bool = True,
    ) -> Path:  # fmt: skip
        """Draw the bodies over the run into `path`, a .gif, or with the program ffmpeg an .mp4; eye and colours hold
        for all frames.

        field, deformation_factor, overwrite: as of `picture`. every: a frame for every so many saved steps, at most
        100 frames if None; fps [1/s]: frames a second; progress: how far it is, on stderr. What is interrupted leaves
        no file. Raises InputError as `picture`, for another ending, and for an .mp4 without ffmpeg.
        """
        from warpffrf.output.plots.animation import write_animation

        with speaking(progress):
            return write_animation(
                self, path, field, every=every, fps=fps, factor=deformation_factor, overwrite=overwrite,
                progress=progress,
            )  # fmt: skip

    def small_sliding_page(self, contact: str | None = None, times: Vector | None = None) -> Figure:
        """A matplotlib Figure of a contact with small sliding, the first one if None: its pressure, state and loss at
        saved steps next to the `times` [s], three of the run if None. Raises InputError for a contact that there is
        not, and times outside of the run."""
        from warpffrf.output.plots.small_sliding import small_sliding_figure

        return small_sliding_figure(self, contact, times)

    def to_xarray(self) -> xarray.Dataset:
        """An `xarray.Dataset` with the names, units and frames of the results file; needs the optional
        package xarray."""
        from warpffrf.output.files.table import to_xarray

        return to_xarray(self)

    def to_dataframe(self) -> Any:
        """A `pandas.DataFrame` of every history, a row for each saved step: index `time` [s], columns as
        `contact_force_z[roller on plate]`, their units in `.attrs["units"]`; fields over the patch and modal
        coordinates are left to `to_xarray`. Needs the optional package pandas, without which it raises ImportError.

        >>> bool(result.to_dataframe()["contact_force_z[lower-upper]"].iloc[0] < 0.0)  # N
        True
        """
        from warpffrf.output.files.table import to_dataframe

        return to_dataframe(self)

    def to_csv(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Write the table of `to_dataframe` as comma-separated values, names and units in the first line; needs no
        pandas. Raises InputError for a path that does not end in .csv, and for a file that exists, unless `overwrite`
        is set and it is such a table."""
        from warpffrf.output.files.table import write_csv

        return write_csv(self, path, overwrite=overwrite)

    def to_vtu(
        self, path: str | os.PathLike[str], *, stride: int = 1, overwrite: bool = False, progress: bool = True
    ) -> Path:
        """Write every `stride`-th saved step as a VTK time series, path: a .pvd, a folder of .vtu comes beside it, that
        ParaView and pyvista open: displacement, pressure, friction, and of bodies that were reduced with
        `stress={"skin": "skin"}` stress and von Mises stress, on the skins. progress: how far it is, on stderr.

        Raises InputError for a path that does not end in .pvd, a stride below 1, a scene without flexible bodies, and
        a .pvd that exists, unless `overwrite` is set.
        """
        from warpffrf.output.files.vtu import write_time_series

        with speaking(progress):
            return write_time_series(self, path, stride=stride, overwrite=overwrite, progress=progress)

    def save(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Write the run as one HDF5 file at `path`; `Result.load` reads it back, also to continue the run. Raises
        InputError for a file that exists, unless `overwrite` is set and warpffrf wrote it."""
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
        raise InputError(f"the result has no {kind} called '{name}'; it has: {known}")
    return items[name]
