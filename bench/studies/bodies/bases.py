"""Bases of global modes: error of the interface receptance against the size; under a minute.

One body, all bases: error of the interface receptance over a band of frequencies against the size of the basis, and
what the basis costs.
"""

from __future__ import annotations

import textwrap
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy.sparse as sp

from warpffrf.model.material import Material
from warpffrf.model.mesh import Mesh
from warpffrf.offline import bases
from warpffrf.offline.bases.build import build_basis
from warpffrf.offline.bases.modes import attachment_modes
from warpffrf.offline.bases.vibrations import shifted_solver
from warpffrf.offline.elastic import ElasticModel, free_model
from warpffrf.offline.fe import assemble, assign
from warpffrf.offline.interfaces import InterfaceSystem, body_interfaces
from warpffrf.offline.products import Limits
from warpffrf.offline.reduction import one_thread
from warpffrf.study.markdown import table

STEEL = Material(210e9, 0.3, 7850.0, name="steel")
BAND = 10e3  # Hz
DAMPING = 0.01  # ratio; structural, K (1 + 2 i DAMPING), so that full and reduced models are damped alike
LINES = 60  # frequencies over the band, evenly; the natural frequencies come on top
SIZES = (18, 24, 36, 48, 60, 72)  # global modes, attachment modes included
POOL = 120  # vibration modes of the pool of balanced truncation where the size is prescribed
RATIOS = (1.0, 1.5, 2.0, 3.0)  # highest mode over the band, in the table of the a-priori rule

Array = np.ndarray


def arm(counts: tuple[int, int, int] = (5, 4, 30)) -> Mesh:
    """A curved, tapering arm of hex8 without any symmetry in its ends; facet sets `low` and `high`, its end faces."""
    i, j, k = np.meshgrid(*(np.linspace(0.0, 1.0, n + 1) for n in counts), indexing="ij")
    width, height = 0.040 - 0.018 * k, 0.024 - 0.008 * k  # m
    angle = 1.4 * k  # rad along an arc of 0.2 m radius
    radius = 0.2 + width * (i - 0.5)
    x = np.stack([radius * np.cos(angle), height * (j - 0.5) + 0.02 * k**2, radius * np.sin(angle)])
    number = np.arange(i.size).reshape(i.shape)
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    nx, ny, nz = counts
    cells = np.stack([number[a : a + nx, b : b + ny, c : c + nz].ravel() for a, b, c in corners], axis=1)
    points = x.reshape(3, -1).T
    volume = np.linalg.det(points[cells[0, [1, 3, 4]]] - points[cells[0, 0]])
    if volume < 0.0:  # the arc turns the other way than the grid
        cells = cells[:, [4, 5, 6, 7, 0, 1, 2, 3]]
    bare = Mesh(points, {"hex8": cells})
    outer = bare.outer_facets()
    end = {"low": number[:, :, 0], "high": number[:, :, -1]}
    on_end = {name: np.isin(outer.corners["quad4"], nodes) for name, nodes in end.items()}
    sets = {name: outer.kept(np.asarray(np.all(inside, axis=1))) for name, inside in on_end.items()}
    return Mesh(points, bare.cells, sets, name="arm")


@dataclass(frozen=True, eq=False)
class Body:
    """The full model, its unit-energy interface loads, and its flexible receptance H (f, a, a) at `hertz` (f,)."""

    model: ElasticModel
    system: InterfaceSystem
    loads: Array
    hertz: Array
    H: Array
    natural: Array  # Hz, of the free body, in the band


def full_body(mesh: Mesh | None = None) -> Body:
    """The arm, held by a rigid interface at one end and an averaging one at the other, solved at every frequency."""
    mesh = arm() if mesh is None else mesh
    system = InterfaceSystem(mesh.points, body_interfaces(mesh, {"low": "rigid", "high": "average"}))
    K, M = assemble(mesh.points, mesh.cells, assign(mesh, STEEL))
    T = system.T
    K, M = sp.csr_matrix(T.T @ K @ T), sp.csr_matrix(T.T @ M @ T)
    model = free_model(K, M, system.rigid(mesh.points.mean(axis=0)), system.pinned, system.coordinates)
    F = system.loads
    F = F / np.sqrt(np.einsum("na,na->a", F, attachment_modes(model, F)))
    found = build_basis(bases.FreeFree(), model, system, Limits(None, 2.0 * np.pi * BAND))
    natural = found.omega[found.omega <= 2.0 * np.pi * BAND] / (2.0 * np.pi)
    hertz = np.unique(np.concatenate([np.linspace(0.0, BAND, LINES)[1:], natural]))
    P = model.self_equilibrated(F)
    H = []
    for f in hertz:
        stiffness = sp.csr_matrix(model.K * complex(1.0, 2.0 * DAMPING))
        solve = shifted_solver(stiffness, model.M, (2.0 * np.pi * f) ** 2, system.coordinates, f"{f:g} Hz")
        H.append(P.T @ solve(P.astype(complex)))
    return Body(model, system, F, hertz, np.array(H), natural)


@dataclass(frozen=True)
class Entry:
    """One basis: its name, size, largest relative errors over the band of the receptance and of a natural frequency,
    and process time [s] to build it."""

    name: str
    size: int
    error: float
    frequency_error: float
    seconds: float


def measure(body: Body, name: str, options: bases.Basis, limits: Limits) -> Entry:
    """Build a basis and compare its receptance with the full one: max over f of |H - H_r|_2 / |H|_2."""
    start = time.process_time()
    basis = build_basis(options, body.model, body.system, limits)
    seconds = time.process_time() - start
    b = basis.Phi.T @ body.loads
    stiffness = basis.omega**2 * complex(1.0, 2.0 * DAMPING)
    dynamic = 1.0 / (stiffness - (2.0 * np.pi * body.hertz[:, None]) ** 2)
    reduced = b.T @ (dynamic[:, :, None] * b)
    error = np.linalg.norm(body.H - reduced, 2, axis=(1, 2)) / np.linalg.norm(body.H, 2, axis=(1, 2))
    omega = 2.0 * np.pi * body.natural
    off = np.abs(basis.omega[: len(omega)] / omega[: len(basis.omega)] - 1.0)
    return Entry(name, len(basis.omega), float(error.max()), float(off.max()), seconds)


def by_size(body: Body, sizes: Sequence[int] = SIZES) -> list[list[Entry]]:
    """A row of entries for every size of the basis; a size that a basis cannot have is left out."""
    a = body.loads.shape[1]
    none, rows = Limits(None, None), []
    for size in sizes:
        count = Limits(size - a, None)
        cases: list[tuple[str, bases.Basis, Limits]] = [
            ("free-free", bases.FreeFree(), count),
            ("Craig-Bampton", bases.CraigBampton(), count),
            ("balanced", bases.Balanced(pool_modes=POOL, damping=DAMPING), count),
            ("POD", bases.POD(frequencies=tuple(np.linspace(0.0, BAND, 20)), damping=DAMPING), count),
        ]
        if size % a == 0:  # besides the attachment modes, which are the first moment at zero
            points = size // a - 1
            spread = tuple(BAND * (np.arange(points) + 1.0) / points)
            cases.append(("Krylov, points", bases.Krylov(expansion_points=spread, moments=1), none))
            middle = bases.Krylov(expansion_points=(0.5 * BAND,), moments=points)
            cases.append(("Krylov, moments", middle, none))
        rows.append([measure(body, name, options, limits) for name, options, limits in cases])
    return rows


def by_rule(body: Body) -> list[tuple[float, list[Entry]]]:
    """The result of a highest frequency alone, given as a multiple of the band, where a basis takes one."""
    found = []
    for ratio in RATIOS:
        limits = Limits(None, 2.0 * np.pi * ratio * BAND)
        cases: list[tuple[str, bases.Basis]] = [
            ("free-free", bases.FreeFree()),
            ("Craig-Bampton", bases.CraigBampton()),
            ("Krylov", bases.Krylov()),
            ("balanced", bases.Balanced(damping=DAMPING)),
            ("POD", bases.POD(damping=DAMPING)),
        ]
        found.append((ratio, [measure(body, name, options, limits) for name, options in cases]))
    return found


def _shown(error: float) -> str:
    return f"{error:.1e}"


Figures = tuple[Body, list[list[Entry]], list[tuple[float, list[Entry]]]]


def compute() -> Figures:
    """The full body, entries by size, and entries by the highest frequency over the band."""
    with one_thread():
        body = full_body()
        return body, by_size(body), by_rule(body)


def page(figures: Figures) -> str:
    """The Markdown page."""
    body, rows, rule = figures
    names = list(dict.fromkeys(entry.name for row in rows for entry in row))
    errors, costs = [], []
    for row in rows:
        entries = {entry.name: entry for entry in row}
        base = entries["free-free"].seconds
        size = str(entries["free-free"].size)
        errors.append([size, *(_shown(entries[n].error) if n in entries else "" for n in names)])
        costs.append([size, *(f"{entries[n].seconds / base:.1f}" if n in entries else "" for n in names)])
    rule_names = [entry.name for entry in rule[0][1]]
    ruled = [[f"{ratio:g}", *(f"{e.size}: {_shown(e.error)}" for e in entries)] for ratio, entries in rule]
    shown = ", ".join(f"{f / 1e3:.2f}" for f in body.natural)
    what = f"""A curved, tapering steel arm, {body.model.size} dofs of linear hexahedra, a rigid interface on one end
face and an averaging one on the other: 12 loads, each scaled to unit static energy. Its free modes in the band 0 to
{BAND / 1e3:g} kHz: {shown} kHz. The error is the largest of |H - H_r| / |H| (spectral norm, flexible part of the 12 x
12 interface receptance) over {len(body.hertz)} frequencies of the band, those of the modes among them; structural
damping 2 x {DAMPING:.0%} in both models; H by one complex factorisation of the full model per frequency. Every basis
has the 12 attachment modes of the interfaces, so that all are exact at rest; size counts them."""
    return f"""# Bases of global modes compared

{textwrap.fill(what, 120)}

![error against size](bases.png)

## Error against size

Prescribed sizes; directions that depend on others are dropped, so that large Krylov and POD spaces are a little smaller
than the row says (the picture has the true sizes). *Krylov, points*: one moment at each of evenly spread points up to
the top of the band; *Krylov, moments*: several moments at the middle of the band. *Balanced*: pool of {POOL} modes.
*POD*: snapshots at 20 frequencies of the band.

{table(["size", *names], errors)}
## Offline cost

Processor time over that of the free-free basis of the same size. The factorisation of K, which all share, is left out;
those of shifted matrices are counted.

{table(["size", *names], costs)}
## What a highest frequency alone gives

`max_frequency` as a multiple of the band: size and error. For the modal bases (CMS) it is the a-priori rule that
engineers use: all modes up to one and a half to three times the band. For Krylov it sets the default expansion points,
for balanced truncation half the range of the pool (the size follows from the tolerance), for POD the frequencies of the
snapshots (the size follows from the tolerance): their size or their error is known only afterwards.

{table(["max_frequency / band", *rule_names], ruled)}
## What to take from it

{_reading(rows, rule)}"""


def _reading(rows: list[list[Entry]], rule: list[tuple[float, list[Entry]]]) -> str:
    """Sentences whose figures are those of the tables."""
    flat = [entry for row in rows for entry in row]

    def first_below(name: str, error: float) -> str:
        sizes = [e.size for e in flat if e.name == name and e.error <= error]
        return str(min(sizes)) if sizes else f"more than {max(e.size for e in flat)}"

    names = list(dict.fromkeys(e.name for e in flat))
    reached = "; ".join(f"{n} {first_below(n, 1e-2)} and {first_below(n, 1e-4)}" for n in names)

    def at_ratios(name: str, value: str) -> str:
        found = [(ratio, next((e for e in entries if e.name == name), None)) for ratio, entries in rule]
        return ", ".join(f"{getattr(e, value):.1e} at {ratio:g}" for ratio, e in found if e is not None)

    points = [
        f"Size at which the error is below 1e-2 and below 1e-4: {reached}.",
        f"Free-free modes follow their rule, error by highest mode over band: {at_ratios('free-free', 'error')}. The "
        "resonances of the free body are exact from the start, and what is missing is a smooth remainder. That is why "
        "they are the default.",
        "Craig-Bampton holds the interfaces, so that the free resonances have to converge; worst error of a natural "
        f"frequency in the band: {at_ratios('Craig-Bampton', 'frequency_error')}. A resonance that is off by a tenth "
        "of its damping is an error of ten percent in the receptance near it, which is what the table shows.",
        "Krylov spaces and POD follow the loads: once past the modes of the band they converge fastest. What they hold "
        "outside of the band, or for loads elsewhere, is not known beforehand; the modal bases see every deformation "
        "up to a frequency, contact included.",
        "Balanced truncation weighs all frequencies of its pool by the energy that an impulse leaves there. It leaves "
        "out modes that the interfaces do not excite, and does not know of the band.",
    ]
    wrapped = (textwrap.fill(p, 120, initial_indent="- ", subsequent_indent="  ") for p in points)
    return "\n".join(wrapped) + "\n"


def picture(figures: Figures, path: Path) -> None:
    """Error against size."""
    from studies.charts import save_curves

    _, rows, _ = figures
    names = list(dict.fromkeys(entry.name for row in rows for entry in row))
    curves = {}
    for name in names:
        entries = [e for row in rows for e in row if e.name == name]
        curves[name] = (np.array([e.size for e in entries]), np.array([e.error for e in entries]))
    labels = ("size of the basis", "largest relative error of the receptance")
    save_curves(curves, path, labels=labels, title=f"Interface receptance, 0 to {BAND / 1e3:g} kHz", log_y=True)
