"""Output of `warpffrf info FILE` for a mesh, a reduced body, the results of a run, or a sweep."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from warpffrf.model.errors import InputError
from warpffrf.model.material import Material

if TYPE_CHECKING:
    from warpffrf.output.report.fold import Pairs

STEEL_DENSITY = 7850.0  # kg/m3
ROUND_OFF = 1e-12  # of the largest moment of inertia: smaller products are round-off and printed as zero
HDF5_SIGNATURE = b"\x89HDF\r\n\x1a\n"


def describe_file(
    path: Path,
    *,
    length_unit: str | None,
    density: float | None,
    part: int | str | None = None,
    page: Path | None = None,
    overwrite: bool = False,
    pairs: Pairs = "folded",
) -> str:
    """Summary of the file as text: sizes, bounding box, mass, inertia, and warnings.

    length_unit, part, density [kg/m3]: used for meshes only; the default density is that of the file's materials, else
    of steel. page: file for the picture of a reduced body's quality, or for the HTML page of a sweep. pairs: as in
    `Result.report`.

    Raises `InputError` for a file that is missing or of unknown kind, for a mesh without `length_unit` or with several
    bodies and no `part`, for a page that cannot be written, and for a page of another kind of file.
    """
    from warpffrf.output.files.unfinished import is_unfinished

    if is_unfinished(path):
        _no_page(page, path)
        return _results(path, pairs)
    if path.is_dir() and (found := _sweep(path, page, overwrite)) is not None:
        return found
    if not path.is_file():
        raise InputError(f"there is no file {str(path)!r}")
    with path.open("rb") as file:
        start = file.read(len(HDF5_SIGNATURE))
    if start == HDF5_SIGNATURE:
        return _hdf5(path, page, overwrite, pairs)
    from warpffrf.model.mesh.files.reader import SUFFIXES

    if path.suffix.lower() in SUFFIXES:
        _no_page(page, path)
        return _mesh(path, length_unit, part, density)
    known = ", ".join(SUFFIXES)
    raise InputError(f"{path.name} is neither a mesh ({known}) nor a reduced body or results file (.h5)")


def _mesh(path: Path, length_unit: str | None, part: int | str | None, density: float | None) -> str:
    from warpffrf.model import mesh as meshes
    from warpffrf.model.mesh.files.raw_mesh import LENGTH_UNITS

    if length_unit is None:
        units = ", ".join(LENGTH_UNITS)
        raise InputError(
            f"{path.name}: a mesh file does not define its unit of length; add --length-unit, one of {units}"
        )
    mesh = meshes.read(path, length_unit=length_unit, part=part)
    if density is None and mesh.report().mass is not None:
        return str(mesh.report())
    rho = STEEL_DENSITY if density is None else density
    # the mass depends on the density alone; the moduli of steel avoid warnings about them
    return str(mesh.report(Material(210e9, 0.3, rho))) + f"\n  note: mass at {rho:g} kg/m3"


def _hdf5(path: Path, page: Path | None, overwrite: bool, pairs: Pairs) -> str:
    import h5py

    from warpffrf.model.files.sealed_file import verify
    from warpffrf.model.reduced.file import MARK
    from warpffrf.output.files.results import FORMAT

    verify(path, path.name, "write it again")
    try:
        with h5py.File(path, "r") as file:
            kind = str(file.attrs.get("format"))
    except (OSError, RuntimeError) as error:
        raise InputError(f"{path.name} is damaged ({error}); write it again") from None
    if kind == MARK:
        return _reduced_body(path, page, overwrite)
    if kind == FORMAT:
        _no_page(page, path)
        return _results(path, pairs)
    raise InputError(f"{path.name} is an HDF5 file, but neither a reduced body nor results of warpffrf")


def _no_page(page: Path | None, path: Path) -> None:
    if page is not None:
        raise InputError(
            f"{path.name} is neither a reduced body nor a sweep; leave out --page (the page of a run: warpffrf report)"
        )


def _reduced_body(path: Path, page: Path | None, overwrite: bool) -> str:
    from warpffrf.model.reduced.body import ReducedBody

    body = ReducedBody.load(path)
    lines = [body.info(), f"  {'box':<15} {_box(body.surface.points)}", *_inertia(body.inertia)]
    if page is not None:
        lines.append(f"quality page written to {body.quality_page(page, overwrite=overwrite)}")
    return "\n".join(lines)


def _results(path: Path, pairs: Pairs) -> str:
    from warpffrf.output.report.fold import Entry, Figure, folded
    from warpffrf.output.result import Result

    result = Result.load(path)
    entries = []
    for body in result.view.bodies.values():
        kind = "rigid" if body.reduced is None else "flexible"
        figures = [Figure("", f"{body.mass:.6g} kg, {kind}", inline=True)]
        if body.reduced is not None:
            figures.append(Figure("box", _box(body.reduced.surface.points)))
        entries.append(Entry("body", (body.name,), figures))
    bodies = [line for entry in folded(entries, pairs) for line in entry.lines()]
    return "\n".join([f"results {path.name}", *bodies, result.report(pairs=pairs)])


def _sweep(path: Path, page: Path | None, overwrite: bool) -> str | None:
    """Report of the sweep in a folder; None for another folder."""
    from warpffrf.study import open_sweep
    from warpffrf.study.sweeps.folder import is_sweep

    if not is_sweep(path):
        return None
    found = open_sweep(path)
    lines = [found.report()]
    if page is not None:
        lines.append(f"page written to {found.page(page, overwrite=overwrite)}")
    return "\n".join(lines)


def _vector(values: np.ndarray) -> str:
    return "(" + ", ".join(f"{v:.6g}" for v in values) + ")"


def _box(points: np.ndarray) -> str:
    size = np.ptp(points, axis=0)
    return f"{' x '.join(f'{s:.6g}' for s in size)} m"


def _inertia(inertia: np.ndarray) -> list[str]:
    """The full tensor; principal moments alone would not show that a body is tilted."""
    head = "  inertia about the centre [kg m2]"
    inertia = np.where(np.abs(inertia) > ROUND_OFF * np.abs(inertia).max(), inertia, 0.0)
    return [head, *("    " + "".join(f"{v:>14.6g}" for v in row) for row in inertia)]
