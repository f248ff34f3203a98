"""Result of a sweep: its opened folder; data are read on request."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from warpffrf.model.errors import InputError, unknown_name
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.study.sweeps.folder import Folder
from warpffrf.study.sweeps.job import TIME
from warpffrf.study.sweeps.table import TIME_OF_RUN, axes_of, opened, values_of, variables_of

if TYPE_CHECKING:
    import xarray

    from warpffrf.study.sweeps.reading.sensitivities import Sensitivities
    from warpffrf.study.sweeps.reading.surface import Surface

COMPLETED = "completed"
FIRST_FAILED = 5  # rows whose messages are in a report


@named_arguments
class Sweep(reprs.Shown):
    """The rows of a sweep and their results, in the folder `path`.

    `sweep["upper.load"]`, `sweep["peak"]`, `sweep["status"]`: one variable, (run, ...), read from the file alone;
    unknown names raise InputError. Quantities have the units and frames of `Result.to_xarray`; values that a run does
    not have are NaN.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path).expanduser()
        self.definition: dict[str, Any] = Folder(self.path).definition()

    @property
    def count(self) -> int:
        """Number of rows, including those not yet run."""
        return int(self.definition["count"])

    @property
    def parameter_names(self) -> list[str]:
        """Names of the parameters."""
        return list(self.definition["parameters"])

    @property
    def output_names(self) -> list[str]:
        """Names of the outputs."""
        return list(self.definition["outputs"])

    @property
    def counts(self) -> dict[str, int]:
        """Number of rows of each status, "" for those not yet run."""
        return dict(Counter(map(str, self["status"])))

    @property
    def status(self) -> str:
        """completed, or unfinished if rows have not been run; failed rows count as run."""
        return "unfinished" if "" in self.counts else COMPLETED

    def __getitem__(self, name: str) -> np.ndarray:
        with opened(Folder(self.path).table) as file:
            known = variables_of(file)
            if name in known:
                return values_of(file, name)
            if name in self.definition["outputs"]:
                return np.full(self.count, np.nan)  # no run has it yet
            if name == TIME and TIME_OF_RUN in known:
                raise InputError(
                    f"sweep: runs have different times, a common {name!r} does not exist; see {TIME_OF_RUN!r}"
                )
            raise unknown_name("sweep: variable", name, list(dict.fromkeys([*known, *self.output_names])))

    def about(self, name: str) -> tuple[tuple[str, ...], str]:
        """Names of the axes of a variable after `run`, and its unit; neither for an output that no run has yet. Raises
        InputError for an unknown name."""
        with opened(Folder(self.path).table) as file:
            if name in variables_of(file):
                return axes_of(file[name]), str(file[name].attrs.get("units", ""))
        self[name]
        return (), ""

    def failed(self) -> list[dict[str, Any]]:
        """A dict for each row that was run and not completed: run, status, message, and its parameters."""
        status, message = self["status"], self["message"]
        columns = {name: self[name].tolist() for name in self.parameter_names}
        return [
            {"run": int(n), "status": status[n], "message": message[n], **{k: v[n] for k, v in columns.items()}}
            for n in np.flatnonzero((status != COMPLETED) & (status != ""))
        ]

    def to_xarray(self) -> xarray.Dataset:
        """An `xarray.Dataset` with the parameters as coordinates along `run`; variables are read on access. Close it,
        or use it as a context, before the sweep continues. Raises ImportError without the optional packages xarray and
        h5netcdf."""
        try:
            import h5netcdf  # noqa: F401
            import xarray
        except ImportError as error:
            raise ImportError("to_xarray needs xarray and h5netcdf: pip install 'warpffrf[arrays]'") from error
        table = Folder(self.path).table
        with opened(table):  # the file is a table, but xarray may still misread its layout
            return xarray.open_dataset(table, engine="h5netcdf").set_coords(self.parameter_names)

    def to_dataframe(self) -> Any:
        """A `pandas.DataFrame` of quantities with one value per row: index `run`, parameters first. Raises ImportError
        without the optional package pandas."""
        try:
            import pandas
        except ImportError as error:
            raise ImportError("to_dataframe needs pandas: pip install 'warpffrf[tables]'") from error
        with opened(Folder(self.path).table) as file:
            rest = [name for name in file if name not in self.parameter_names and file[name].shape == (self.count,)]
            order = [*self.parameter_names, *(n for n in self.output_names if n in rest)]
            order += [name for name in rest if name not in order and name != "run" and self._is_row(file[name])]
            found = {name: values_of(file, name) for name in order}
        return pandas.DataFrame(found, index=pandas.RangeIndex(self.count, name="run"))

    @staticmethod
    def _is_row(data: Any) -> bool:
        """Whether the first axis of an array is the rows, and not another axis of the same length."""
        return not data.is_scale

    def plot(
        self, output: str, *, x: str | None = None, y: str | None = None, hue: str | None = None,
        style: str | None = None, col: str | None = None, kind: str | None = None, component: str | int | None = None,
        where: Mapping[str, Any] | None = None, theme: str = "light", width: float | None = None,
        path: str | os.PathLike[str] | None = None, overwrite: bool = False,
    ) -> Any:  # fmt: skip
        """A matplotlib Figure of an output: over the parameter `x` or over time, or over `x` and `y`.

        x, hue, style, col: parameters of the axis, the colour, the dashes, and the panels; default of x: the first that
        varies; of hue and style: the next ones for rows that share values of x. Rows that differ in x alone are
        connected. An output over time has one line per row. kind: "map", or y=: cells of a whole grid, triangles
        between the rows of a sample, and points if further parameters vary; the rows with the least and the largest
        value are marked. component: of a vector, "x", "y", "z", or a number. where: {parameter: value}, selects rows.
        Rows without a value are marked with a cross, and the title counts them. theme, width: "dark", and the width [m]
        of a printed column, as of `Result.plot`. path: file to write, .png, .pdf or .svg. Raises InputError for unknown
        names and themes, values that no row has, and outputs of several numbers per row.
        """
        from warpffrf.study.sweeps.reading.plot import plot

        return plot(
            self, output, x=x, y=y, hue=hue, style=style, col=col, kind=kind, component=component, where=where,
            theme=theme, width=width, path=path, overwrite=overwrite,
        )  # fmt: skip

    def response(
        self, output: str, *, component: str | int | None = None, where: Mapping[str, Any] | None = None
    ) -> Surface:
        """A response surface of an output between the rows: called with {parameter: value} it returns the output there,
        and it has `error`, `minimum()`, `maximum()` and `report()`.

        Splines on a whole grid, thin-plate splines for other rows (`warpffrf.study.sweeps.reading.surface`); rows
        without a value are omitted, and its note states how many. component, where: as of `plot`. Raises InputError for
        outputs over time and of several numbers per row, parameters that are texts, and too few rows.
        """
        from warpffrf.study.sweeps.reading.surface import surface

        return surface(self, output, component, where)

    def sensitivities(
        self, output: str, *, component: str | int | None = None, where: Mapping[str, Any] | None = None
    ) -> Sensitivities:
        """Sobol indices of an output, first and total order, with confidence intervals: from the rows of a sample
        "saltelli:N", else from the response surface, as the result states
        (`warpffrf.study.sweeps.reading.sensitivities`).

        component, where: as of `plot`. Raises InputError if rows of a "saltelli:N" have no value, if all values are
        equal, and as `response`.
        """
        from warpffrf.study.sweeps.reading.sensitivities import sensitivities

        return sensitivities(self, output, component, where)

    def page(self, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
        """Write the sweep as one HTML page with embedded pictures: definition, statuses of rows, failed rows, outputs
        over parameters, maps, sensitivities, times, versions, and the call. Returns its path. Raises InputError for a
        path that does not end in .html or cannot be written, and an existing page, unless overwrite is set."""
        from warpffrf.study.sweeps.reading.page import write_page

        return write_page(self, path, overwrite=overwrite)

    def report(self) -> str:
        """Definition, statuses, times, and the first messages of rows that failed."""
        about, counts = self.definition, self.counts
        seconds = self["wall_seconds"]
        ran = seconds[np.isfinite(seconds)]
        lines = [
            f"sweep             {about['title']}, {self.count} rows of {about['call']}"
            + (f", sample {about['sample']}, seed {about['seed']}" if about["sample"] else ""),
            *(f"parameter         {name}: {text}" for name, text in about["parameters"].items()),
            *(f"output            {name}: {text}" for name, text in about["outputs"].items()),
            "rows              " + ", ".join(f"{n} {status or 'not run yet'}" for status, n in counts.items()),
        ]
        if len(ran):
            lines.append(f"seconds of a run  median {np.median(ran):.3g}, largest {ran.max():.3g}, sum {ran.sum():.4g}")
        failed = self.failed()
        for row in failed[:FIRST_FAILED]:
            values = ", ".join(f"{name}={row[name]}" for name in self.parameter_names)
            lines.append(f"row {row['run']:<13} {row['status']} at {values}: {row['message']}")
        if len(failed) > FIRST_FAILED:
            lines.append(f"                  and {len(failed) - FIRST_FAILED} more; see Sweep.failed()")
        return "\n".join(lines)

    def _facts(self) -> dict[str, Any]:
        rows = {status or "not run yet": n for status, n in self.counts.items()}
        return {"path": str(self.path), "parameters": self.parameter_names, "outputs": self.output_names, **rows}

    def __repr__(self) -> str:
        return f"Sweep({str(self.path)!r}, rows={self.count}, parameters={self.parameter_names})"


@named_arguments
def open_sweep(path: str | os.PathLike[str]) -> Sweep:
    """The sweep in the folder `path`, which may be running or interrupted. Runs of a stopped sweep that are not in its
    table are first merged into it; for a sweep that another process runs the table is in its last written state. Raises
    InputError for a folder that is no sweep, and for a damaged table."""
    folder = Folder(path)
    folder.definition()
    if folder.waiting():
        try:
            folder.hold()
        except InputError:  # another process runs it
            return Sweep(path)
        try:
            folder.gather()
        finally:
            folder.release()
    return Sweep(path)
