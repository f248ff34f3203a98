r"""Measured modes of a body: compared with the computed ones, and taken over.

**Comparison.** A measured shape psi (d,), real or complex, and the computed shape phi at the same places and directions
have the modal assurance criterion (Allemang, Brown 1982, Proc. 1st IMAC, 110)

    MAC = |phi^H psi|^2 / (phi^H phi  psi^H psi),

1 for proportional shapes, 0 for orthogonal ones. A measured point takes the displacement of the nearest point of the
body's skin, linear over its triangles. Directions in which no mode of the file moves a point were not measured.
Computed modes of equal frequency (`EQUAL`), such as the bending modes of a round shaft, are determined up to a
combination: for each of them the criterion of the best combination counts, |P psi|^2/|psi|^2 with the projector P on
their shapes. Pairs, one to one, are those with the largest sum of criteria; those below `least_mac` are dropped.

**Update.** With M-orthonormal modes Phi of the mesh, frequencies omega, and measured ones w of the pairs,

    K' = K + M Phi diag(w^2 - omega^2) Phi^T M

has the same modes, with the measured frequencies; all others stay, and so does the residual compliance beyond the
modes, K'^+ - Phi w^-2 Phi^T = K^+ - Phi omega^-2 Phi^T, as Phi^T M annihilates it. It is the least change of K, in the
norm that M defines, that does so (Baruch, Bar Itzhak 1978, AIAA Journal 16, 346, for shapes that are orthogonal
already). Mass, shapes, interfaces, stress per deformation and contact surfaces of the body are those of the mesh;
stiffening by loads is not changed. Measured damping is diagonal in the modes, C = M Phi diag(2 zeta w) Phi^T M.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.arguments import RotationLike, Vector
from warpffrf.model.damping import Damping, damping_ratios
from warpffrf.model.errors import InputError, require_array, require_number, unknown_name
from warpffrf.model.mesh.files.raw_mesh import LENGTH_UNITS
from warpffrf.model.mesh.files.rst_modes import read_rst
from warpffrf.model.mesh.files.unv_modes import read_modes
from warpffrf.model.messages.named_arguments import named_arguments

if TYPE_CHECKING:
    from warpffrf.model.reduced.body import ReducedBody

Array = np.ndarray
WHAT = "compare_modes"
NEAR = 0.02  # of the extent of the skin: the largest distance of a measured point from it
EQUAL = 1e-3  # relative difference of computed frequencies that count as equal
ALIKE = 0.9  # criterion between computed modes above which the measured points do not distinguish them
RANK = 1e-6  # of the largest singular value of the shapes of equal frequency
LISTED = 0.05  # criteria above which the report lists them


@named_arguments
@dataclass(frozen=True, eq=False)
class ModeComparison:
    """Measured and computed modes of a body, returned by `ReducedBody.compare_modes`.

    `mac` (t, c) is the modal assurance criterion of the t measured with the c computed vibration modes, `pairs` the
    modes (measured, computed), numbered from 0, that are taken for the same, with `pair_mac`. `measured_frequencies`
    (t,) [Hz] and `measured_damping` (t,) ratios are those of the file, `points` (n, 3) [m, user frame] the measured
    points, `distances` (n,) [m] theirs from the skin, and `notes` say what is doubtful or not used.
    """

    body: ReducedBody
    mac: Array
    pairs: tuple[tuple[int, int], ...]
    pair_mac: Array
    measured_frequencies: Array
    measured_damping: Array
    points: Array
    distances: Array
    notes: tuple[str, ...]

    def report(self) -> str:
        """Table of the measured modes with their partners, differences of frequency, damping, and notes."""
        f, partner = self.body.frequencies, dict(self.pairs)
        head = (
            f"{'measured':>8}  {'Hz':>12}  {'damping %':>9}  {'computed':>8}  {'Hz':>12}  {'higher by':>12}  {'MAC':>6}"
        )
        lines = [f"measured modes at {len(self.points)} points, computed modes of the free body", "", head]
        for i, (g, zeta) in enumerate(zip(self.measured_frequencies, self.measured_damping, strict=True)):
            line = f"{i:>8}  {g:>12.6g}  {100.0 * zeta + 0.0:>9.4g}"
            if i in partner:
                k = partner[i]
                off = f"{100.0 * (f[k] / g - 1.0):+.3g} %" if g > 0.0 else ""
                mac = self.pair_mac[list(partner).index(i)]
                line += f"  {k:>8}  {f[k]:>12.6g}  {off:>12}  {mac:>6.3f}"
            else:
                best = np.argsort(-self.mac[i])[:2]
                others = ", ".join(f"{k}: {self.mac[i, k]:.2f}" for k in best if self.mac[i, k] > LISTED)
                line += f"  {'none':>8}  MAC {others}" if others else f"  {'none':>8}"
            lines.append(line)
        alone = [str(k) for k in range(self.mac.shape[1]) if k not in set(partner.values())]
        lines += ["", f"computed modes without a partner: {', '.join(alone) or 'none'}"]
        return "\n".join([*lines, *(f"note: {note}" for note in self.notes)])

    __str__ = report

    def __repr__(self) -> str:
        t, c = self.mac.shape
        return f"ModeComparison({len(self.pairs)} pairs of {t} measured and {c} computed modes)"

    def updated_body(self) -> ReducedBody:
        """The body with the measured frequencies of the pairs, its modes, all other frequencies and the residual
        compliance as they are (module docstring): K' = K + M Phi diag(w^2 - omega^2) Phi^T M. Modes keep their numbers,
        so frequencies may be out of order. Raises `InputError` without pairs, and for a measured frequency of 0."""
        if not self.pairs:
            raise InputError(f"updated_body: no measured mode corresponds to a computed one\n{self.report()}")
        frequencies = self.body.frequencies.copy()
        for i, k in self.pairs:
            if not self.measured_frequencies[i] > 0.0:
                raise InputError(f"updated_body: measured mode {i} has 0 Hz, and belongs to the elastic mode {k}")
            frequencies[k] = self.measured_frequencies[i]
        changes = ", ".join(
            f"{k}: {self.body.frequencies[k]:.5g} to {frequencies[k]:.5g}" for _, k in sorted(self.pairs)
        )
        report = dict(self.body.report)
        report["notes"] = [*report.get("notes", []), f"measured frequencies were taken over [Hz], of modes {changes}"]
        computed = self.body.provenance.get("computed_frequencies", self.body.frequencies.tolist())
        provenance = {**self.body.provenance, "computed_frequencies": computed}
        body = replace(self.body, frequencies=frequencies, report=report, provenance=provenance)
        body.provenance["content_hash"] = body.content_hash()
        return body

    def damping(self, rest: Damping = None) -> Array:
        """Ratios (m,) for `scene.add_body(damping=)`: of the pairs the measured ones, of all other modes those of
        `rest`, a rule as `add_body` takes it. Raises `InputError` for a measured ratio that is negative."""
        ratios = damping_ratios(rest, self.body.frequencies, "damping: rest").copy()
        for i, k in self.pairs:
            if self.measured_damping[i] < 0.0:
                raise InputError(
                    f"damping: measured mode {i} has the negative ratio {self.measured_damping[i]:.3g}; correct it in "
                    "the file"
                )
            ratios[k] = self.measured_damping[i]
        return ratios


def compare_modes(
    body: ReducedBody, path: str | Path, length_unit: str, position: Vector, rotation: RotationLike, least_mac: float
) -> ModeComparison:
    """See `ReducedBody.compare_modes`."""
    import scipy.optimize

    if length_unit not in LENGTH_UNITS:
        raise unknown_name("length unit", length_unit, LENGTH_UNITS)
    least = require_number(least_mac, f"{WHAT}: least_mac", positive=True)
    if least > 1.0:
        raise InputError(f"{WHAT}: least_mac must lie between 0 and 1, got {least:g}")
    origin = require_array(position, f"{WHAT}: position", (3,))
    A = rot.matrix(rot.orientation(rotation, f"{WHAT}: rotation"))
    found = (read_rst if Path(path).suffix.lower() == ".rst" else read_modes)(Path(path))
    points = origin + LENGTH_UNITS[length_unit] * found.points @ A.T
    facts = body.report.get("quality", {}).get("frequencies", {})
    held = facts.get("vibration_modes")
    count = len(body.frequencies) if held is None else min(int(held), len(body.frequencies))
    if not count or not len(body.surface.triangles):
        raise InputError(f"{WHAT}: the body has no {'vibration modes; reduce with modes=' if not count else 'skin'}")
    computed, distances = _at(body, points, count)
    seen = np.any(found.shapes != 0.0, axis=0)  # directions, in the axes of the measurement
    psi, phi = found.shapes[:, seen], (computed @ A)[:, seen]
    norm = np.linalg.norm(psi, axis=1)
    if not np.all(norm > 0.0):
        raise InputError(f"{WHAT}: measured mode {int(np.argmin(norm))} does not move any point; leave it out")
    own = np.linalg.norm(phi, axis=1)
    psi = psi / norm[:, None]
    phi = np.divide(phi, own[:, None], out=np.zeros_like(phi), where=own[:, None] > 0.0)
    mac = np.abs(psi.conj() @ phi.T) ** 2
    combined = mac.copy()
    groups = _equal(body.frequencies[:count])
    for group in groups:
        U, s, _ = np.linalg.svd(phi[group].T, full_matrices=False)
        combined[:, group] = np.sum(np.abs(psi.conj() @ U[:, s > RANK * s[0]]) ** 2, axis=1)[:, None]
    rows, columns = scipy.optimize.linear_sum_assignment(-combined)
    pairs = {int(i): int(k) for i, k in zip(rows, columns, strict=True) if combined[i, k] >= least}
    for group in groups:  # within a group in the order of the frequencies
        members = sorted((i for i, k in pairs.items() if k in group), key=lambda i: found.frequencies[i])
        pairs.update(zip(members, sorted(pairs[i] for i in members), strict=True))
    pair_mac = np.array([combined[i, k] for i, k in pairs.items()])
    notes = [*found.notes, *_doubts(phi, groups, seen)]
    return ModeComparison(
        body, mac, tuple(pairs.items()), pair_mac, found.frequencies, found.damping, points, distances, tuple(notes)
    )


def _doubts(phi: Array, groups: list[list[int]], seen: Array) -> list[str]:
    """What makes the comparison doubtful."""
    notes = []
    if not np.all(seen):
        notes.append(f"{int(np.sum(~seen))} of {seen.size} directions of the points were not measured")
    together = {k: n for n, group in enumerate(groups) for k in group}
    alike = np.argwhere(np.triu(np.abs(phi @ phi.T) ** 2 > ALIKE, 1))
    for i, k in alike.tolist():
        if together.get(i, -1) != together.get(k, -2):
            notes.append(f"computed modes {i} and {k} look alike at the measured points; measure at more of them")
    for group in groups:
        notes.append(
            f"computed modes {', '.join(map(str, group))} have equal frequencies: the criterion of their best "
            "combination counts"
        )
    return notes


def _equal(frequencies: Array) -> list[list[int]]:
    """Groups of two and more modes of equal frequency."""
    groups: list[list[int]] = []
    for k, f in enumerate(frequencies):
        if groups and abs(f - frequencies[groups[-1][-1]]) <= EQUAL * abs(f):
            groups[-1].append(k)
        else:
            groups.append([k])
    return [group for group in groups if len(group) > 1]


def _at(body: ReducedBody, points: Array, count: int) -> tuple[Array, Array]:
    """Shapes (count, n, 3) of the body at the nearest points of its skin, and the distances (n,) [m]."""
    from trimesh.triangles import closest_point, points_to_barycentric

    skin = body.surface
    corners = np.asarray(skin.points, dtype=np.float64)[skin.triangles]
    middle = corners.mean(axis=1)
    radius = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)
    extent = float(np.ptp(skin.points, axis=0).max())
    shapes = np.zeros((count, len(points), 3))
    distances = np.zeros(len(points))
    for n, x in enumerate(points):
        away = np.linalg.norm(middle - x, axis=1)
        near = np.flatnonzero(away - radius <= away.min() * (1.0 + 1e-12))
        closest = closest_point(corners[near], np.broadcast_to(x, (len(near), 3)))
        size = np.linalg.norm(closest - x, axis=1)
        best = int(np.argmin(size))
        distances[n] = size[best]
        share = points_to_barycentric(corners[near[best]][None], closest[best][None])[0]
        nodes = skin.triangles[near[best]]
        shapes[:, n] = np.einsum("kic,i->kc", np.asarray(skin.modes[:count], dtype=np.float64)[:, nodes], share)
    if np.any(distances > NEAR * extent):
        n = int(np.argmax(distances))
        raise InputError(
            f"{WHAT}: the measured point at ({', '.join(f'{v:.6g}' for v in points[n])}) m lies {distances[n]:.3g} m "
            f"from the body, of {extent:.3g} m extent; check length_unit, position and rotation of the measurement"
        )
    return shapes, distances
