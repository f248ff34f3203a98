"""`ReducedBody`: the result of the offline reduction and input of the simulation.

Its data are in `data`, its contact surfaces in `contact_surface`.
"""

from __future__ import annotations

import functools
import importlib
import importlib.metadata
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from warpffrf.model.arguments import RotationLike, Vector
from warpffrf.model.files.paths import checked_output_path
from warpffrf.model.messages import reprs
from warpffrf.model.messages.named_arguments import named_arguments
from warpffrf.model.reduced.craig_bampton import CraigBampton, craig_bampton
from warpffrf.model.reduced.data import ReducedBodyData
from warpffrf.model.reduced.file import content_hash, read_reduced_body, write_reduced_body
from warpffrf.model.reduced.measured_modes import ModeComparison, compare_modes
from warpffrf.model.reduced.summary import summary
from warpffrf.model.reduced.thermal import Expansion, Warmth, expansion


@named_arguments
@dataclass(frozen=True, eq=False, repr=False)
class ReducedBody(reprs.Shown, ReducedBodyData):
    """A flexible body, reduced: mass properties, global modes, interfaces, contact surfaces, skin, and provenance.

    Modes are M-orthonormal (modal mass 1 kg), K-orthogonal and M-orthogonal to rigid motion (Tisserand frame). It has
    mass [kg], center_of_mass (3,) [m, user frame], inertia (3, 3) [kg m2] about it in user axes, the frequencies (m,)
    [Hz] of its m global modes, and by name its interfaces (ports for joints and forces), contact_surfaces (with their
    local modes), matched faces (faces in small-sliding contact) and stress (points of stress evaluation). surface is
    the skin for visualisation, report contains quality measures and provenance the history; inertia_terms, cross and
    matched_compliance [m/N] are the effects of rotation, of loads on several surfaces and of loads on matched faces,
    thermal its temperature and thermal expansion (`ReducedBodyData`).
    """

    def _facts(self) -> dict[str, Any]:
        """The many arrays are summarised by `info`."""
        named = {
            "interfaces": self.interfaces,
            "contact": self.contact_surfaces,
            "matched": self.matched,
            "stress": self.stress,
        }
        found = {what: reprs.names(items) for what, items in named.items() if items}
        sizes = {"global_modes": len(self.frequencies), "local_modes": self.local_modes}
        return {"mass": f"{self.mass:.5g} kg", **sizes, **found}

    def save(self, path: str | Path, *, overwrite: bool = False) -> Path:
        """Write one HDF5 file; returns its path. Raises `InputError` where it cannot be written, and for a file that
        exists, unless `overwrite` is set and warpffrf wrote it."""
        return write_reduced_body(self, checked_output_path(path, "reduced body", overwrite=overwrite))

    @classmethod
    def load(cls, path: str | Path) -> ReducedBody:
        """Read the file at `path` that `save` wrote. Raises `InputError` for a missing, damaged, or other-schema
        file."""
        return read_reduced_body(cls, Path(path))

    def content_hash(self) -> str:
        """sha256 over all arrays (not over report and provenance)."""
        return content_hash(self)

    def info(self) -> str:
        """Readable summary with the quality report.

        >>> print(roller.info())  # doctest: +ELLIPSIS
        reduced body...
        """
        return summary(self)

    def expansion(self, state: Warmth) -> Expansion:
        """Thermal expansion in a state of `body.thermal` [`warpffrf.model.reduced.thermal`], the body free of loads.
        Raises `InputError` for a body that was reduced without `thermal=`."""
        return expansion(self, state)

    def craig_bampton(self) -> CraigBampton:
        """Stiffness and mass over the motions of the interfaces and fixed-interface modes, for other programs: exact
        for the global modes of this body (`warpffrf.model.reduced.craig_bampton`). Raises `InputError` for a body
        without interfaces, or with fewer modes than their motions need."""
        return craig_bampton(self)

    def mesh_error(
        self, finer: ReducedBody, *, half_width: float | None = None, interface: str | None = None
    ) -> dict[str, float]:
        """Relative error of the force at a given approach due to this body's mesh in contacts with
        `grid="contact_fixed"`, by contact surface; negative: too soft (`warpffrf.model.reduced.mesh_error`).

        finer: the body reduced on another mesh with contact_fixed=True, from the same interfaces and surfaces; half the
        element size is fine enough. half_width [m]: of the patch, None for 0.005 of the smallest radius of curvature.
        interface: the fixed one, None for the first; a body without interfaces is free, as it was reduced. Raises
        `InputError` for bodies that do not correspond, and where no surface has a far field on both.
        """
        from warpffrf.model.reduced.mesh_error import mesh_error

        return mesh_error(self, finer, half_width, interface)

    def compare_modes(
        self,
        path: str | Path,
        *,
        length_unit: str,
        position: Vector = (0.0, 0.0, 0.0),
        rotation: RotationLike = (0.0, 0.0, 0.0, 1.0),
        least_mac: float = 0.8,
    ) -> ModeComparison:
        """Compare the modes of this free body with measured ones, of a universal file with the points (datasets 15 or
        2411) and mode shapes (55), or with those of Ansys in a modal result file `.rst` (extra `ansys`): modal
        assurance criteria and pairs of modes (`warpffrf.model.reduced.measured_modes`). `.updated_body()` and
        `.damping()` take frequencies and ratios over.

        path: the file; length_unit: of its coordinates, one of m, cm, mm, um, in, ft; position [m], rotation: pose of
        the axes of the measurement in the user frame. least_mac [-]: smallest criterion of a pair. The body must have
        been measured free, or on soft supports. Raises `InputError` for files that are damaged or without modes,
        measured points far from the body, and bodies without vibration modes.
        """
        return compare_modes(self, path, length_unit, position, rotation, least_mac)

    def quality_page(self, path: str | Path, *, theme: str = "light", overwrite: bool = False) -> Path:
        """Write a picture of the body's quality: mode shapes, compliance decay, frequencies covered, key figures;
        theme: "light" or "dark".

        The ending of `path` chooses the format (.png, .pdf, .svg). Raises `InputError` where it cannot be written, or
        exists and `overwrite` is not set.
        """
        return _output("plots.quality_page").write_quality_page(self, path, theme=theme, overwrite=overwrite)

    def plot_modes(self, count: int = 8) -> Any:
        """A matplotlib Figure of the shapes of the first `count` elastic modes: deformed skins in colour, red at the
        largest displacement, over the undeformed one in grey. Numbers and frequencies [Hz] are those of the free body.

        Raises `InputError` for a count below 1, and a body without skin or without elastic modes.
        """
        return _output("plots.quality_page").modes_figure(self, count)

    def show(
        self,
        mode: int | None = None,
        *,
        path: str | Path | None = None,
        frames: int = 60,
        scale: float | None = None,
        overwrite: bool = False,
    ) -> Any:
        """Animate a mode in rerun: in its viewer, or written to `path` (.rrd), which `rerun FILE` opens.

        Modes are numbered as finite-element programs number those of a free body: 1 to 6 are the rigid motions, 7 is
        the first elastic mode. None: the elastic modes one after the other, one cycle each. `frames`: images per cycle.
        `scale`: largest displacement drawn, as a fraction of the body's largest extent. Returns
        `warpffrf.output.recording.show.ShownModes`. Raises `InputError` for a mode that the body does not have, and for
        a file that exists where `overwrite` is not set.
        """
        return _output("recording.show").show_modes(
            self, mode, path=path, frames=frames, scale=scale, overwrite=overwrite
        )


def _output(module: str) -> Any:
    """A module of the output package. It imports the model, not vice versa: a plotting method imports it by name when
    called, so that the model does not depend on a viewer."""
    return importlib.import_module(f"warpffrf.output.{module}")


@functools.cache
def _version(name: str) -> str:
    """Version of a distribution; reading it takes milliseconds, and every run states it."""
    return importlib.metadata.version(name)


def library_versions(names: tuple[str, ...]) -> dict[str, str]:
    """Versions of installed distributions, for provenance; 'not installed' where there is none."""
    found = {}
    for name in names:
        try:
            found[name] = _version(name)
        except importlib.metadata.PackageNotFoundError:
            found[name] = "not installed"
    return found
