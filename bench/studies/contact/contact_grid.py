"""The rule for the spacing of a contact grid, measured; a minute or two.

Every figure in the tables is computed by this script; the factors of the rule are written down, rounded up, in
`warpffrf.offline.contact.contact_grid`, and the script says where a measured error exceeds them.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.stats import qmc

from references.half_space.compliances import EllipsePatch, LinePatch
from studies.charts import ErrorPanel, error_charts
from studies.contact.grid_errors import grid_errors, put_on_grid
from studies.contact.grid_on_roller import FINEST_GROWTH, layer_states, roller_half_width, roller_states
from studies.contact.straight_rollers import NAMES
from warpffrf.offline.contact.contact_grid import PATCHES, QUANTITIES, RULES, contact_spacing
from warpffrf.study.markdown import table

DEPTH = 10.0  # half-widths: depth of the half-plane, see `grid_rule`
DEEP = 100.0  # of a large roller
RATIOS = (1, 3, 10)  # of the semi-axes
LINE_BINS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0)  # b/s
ELLIPSE_BINS = LINE_BINS[:6]
SAMPLES = {1: 60, 2: 16}  # quasi-random sizes and positions in a bin, by dimension
PICTURE = "contact_grid.png"


@dataclass(frozen=True, eq=False)
class Sweep:
    """Errors of one patch and traction: `errors` (n, 5) signed, in the order of `QUANTITIES`, at `fineness` b/s (n,);
    `centred` (bins, 5) with a function in the middle of the patch, a single body, at the lower end of each bin."""

    traction: str
    name: str
    bins: tuple[float, ...]
    fineness: np.ndarray
    errors: np.ndarray
    centred: np.ndarray

    def worst(self) -> np.ndarray:
        """(bins, 5) largest absolute error in each bin."""
        bin_of = np.searchsorted(self.bins, self.fineness, side="right") - 1
        return np.array([np.abs(self.errors[bin_of == i]).max(axis=0) for i in range(len(self.bins) - 1)])

    @property
    def patch(self) -> str:
        """The patch of the rule."""
        return self.name.split()[0].rstrip(",")

    @property
    def rule(self) -> np.ndarray:
        """(5, 2) factor and rate of the rule."""
        return np.array([RULES[self.traction, self.patch][q] for q in QUANTITIES])

    def factors(self) -> np.ndarray:
        """(5,) largest error over (s/b)^p."""
        return (np.abs(self.errors) * self.fineness[:, None] ** self.rule[:, 1]).max(axis=0)

    def rates(self) -> np.ndarray:
        """(5,) slope of the worst errors of the bins, by least squares in the logarithms."""
        x = np.log(np.sqrt(np.array(self.bins[1:]) * np.array(self.bins[:-1])))
        return -np.polyfit(x, np.log(self.worst()), 1)[0]


def positions(low: float, high: float, dimension: int, *, pairs: bool, samples: int) -> list[tuple]:
    """(b/s, position, opposite) to look at for `low` <= b/s < `high`: the symmetric positions at both ends and in the
    middle, where the extremes were often found, and `samples` quasi-random ones; a single body, with `pairs` also two.
    """
    found = []
    ends = (low, 0.5 * (low + high), high - 1e-6)  # just inside: the end belongs to the next bin
    for fineness, where in itertools.product(ends, itertools.product((0.0, 0.5), repeat=dimension)):
        found.append((fineness, where, None))
        if pairs:
            found.append((fineness, where, (0.5,) * dimension))
            found.append((fineness, where, (0.0,) * dimension))
    numbers = qmc.Halton(2 * dimension + 1, scramble=False).random(samples + 1)[1:]
    for u in numbers:
        fineness = low + (high - low) * u[0]
        where, facing = tuple(u[1 : 1 + dimension] - 0.5), tuple(u[1 + dimension :] - 0.5)
        found.append((fineness, where, None))
        if pairs:
            found.append((fineness, where, facing))
    return found


def sweep(
    patch: LinePatch | EllipsePatch,
    traction: str,
    bins: tuple[float, ...],
    name: str,
    *,
    alike: bool = True,
    samples: int | None = None,
) -> Sweep:
    """Errors of `patch` on grids of `bins` b/s; alike: the spacings in proportion to the semi-axes, else equal."""
    dimension = len(patch.axes)
    stretch = np.array(patch.axes) if alike else np.ones(dimension)
    fineness, errors, centred = [], [], []
    for low, high in itertools.pairwise(bins):
        count = SAMPLES[dimension] if samples is None else samples
        for n, where, facing in positions(low, high, dimension, pairs=traction == "nodes", samples=count):
            fineness.append(n)
            errors.append(grid_errors(patch, traction, tuple(stretch / n), where, facing))
        centred.append(grid_errors(patch, traction, tuple(stretch / low), (0.0,) * dimension))
    return Sweep(traction, name, bins, np.array(fineness), np.array(errors), np.array(centred))


def measure() -> list[Sweep]:
    """All sweeps, by traction, lines before ellipses."""
    found = []
    for traction in ("nodes", "cells"):
        found.append(sweep(LinePatch(DEPTH), traction, LINE_BINS, "line"))
        found += [sweep(EllipsePatch(r), traction, ELLIPSE_BINS, f"ellipse 1:{r}") for r in RATIOS]
        longest = RATIOS[-1]
        name = f"ellipse 1:{longest}, equal"
        found.append(sweep(EllipsePatch(longest), traction, ELLIPSE_BINS, name, alike=False))
    return found


def exceeded(found: list[Sweep]) -> list[str]:
    """Where a measured error is above the rule."""
    out = []
    for s in found:
        for quantity, measured, limit in zip(QUANTITIES, s.factors(), s.rule[:, 0], strict=True):
            if measured > limit:
                out.append(f"{s.traction}, {s.name}, {quantity}: {measured:.4f} > {limit:g}")
    return out


NAMED = [q.replace("half_", "half-").replace("_", " ") for q in QUANTITIES]


def _percent(value: float) -> str:
    return f"{100.0 * abs(value):.2g} %"


def _error_rows(sweeps: list[Sweep]) -> list[list[str]]:
    rows = []
    for s in sweeps:
        for i, (low, high) in enumerate(itertools.pairwise(s.bins)):
            shown = [f"{_percent(c)} / {_percent(w)}" for c, w in zip(s.centred[i], s.worst()[i], strict=True)]
            rows.append([s.name, f"{low:g} to {high:g}", *shown])
    return rows


def _factor_rows(found: list[Sweep]) -> list[list[str]]:
    rows = []
    for (traction, patch), group in itertools.groupby(found, lambda s: (s.traction, s.patch)):
        for s in group:
            rows.append(
                [traction, s.name, *(f"{c:.3g} ({p:.1f})" for c, p in zip(s.factors(), s.rates(), strict=True))]
            )
        rule = [f"**{c:g} ({p:g})**" for c, p in (RULES[traction, patch][q] for q in QUANTITIES)]
        rows.append([traction, f"**rule, {patch}**", *rule])
    return rows


def _put_rows() -> list[list[str]]:
    rows, patch = [], LinePatch(DEPTH)
    steps = (0.0, 0.25, 0.5)
    for traction, n in itertools.product(("nodes", "cells"), (1, 2, 4, 8)):
        states = [(1.0 / (n + more), x) for more, x in itertools.product(steps, steps)]
        values, projected = np.abs([put_on_grid(patch, traction, s, x) for s, x in states]).max(axis=0)
        best = max(grid_errors(patch, traction, (s,), (x,)).compliance for s, x in states)
        rows.append([traction, str(n), _percent(best), _percent(projected), _percent(values)])
    return rows


def _deep_rows() -> list[list[str]]:
    rows = []
    for depth in (DEPTH, DEEP):
        s = sweep(LinePatch(depth), "nodes", LINE_BINS[:5], f"line, depth {depth:g} b", samples=20)
        rows.append([s.name, *(f"{c:.3g}" for c in s.factors())])
    return rows


def _roller_rows() -> list[list[str]]:
    c, p = RULES["nodes", "line"]["force"]
    return [
        [
            NAMES[r.order],
            f"{1.0 / r.spacing:g}",
            f"{1.0 / r.nodes:g}",
            *map(_percent, (r.centred, r.worst, c * r.spacing**p)),
        ]
        for r in roller_states()
    ]


def _layer_rows() -> list[list[str]]:
    return [
        [NAMES[r.order], f"{r.growth:g}", f"{1e3 * r.half_width:.2g} mm", _percent(r.error), _percent(r.estimate)]
        for r in layer_states()
    ]


def _rule_rows() -> list[list[str]]:
    rows = []
    for patch, error in itertools.product(("line", "ellipse"), (0.05, 0.02, 0.01, 0.005)):
        spacings = [contact_spacing(1.0, error=error, patch=patch, quantity=q) for q in QUANTITIES]
        rows.append([patch, _percent(error), *(f"{s:.2f}" for s in spacings)])
    return rows


def compute() -> tuple[list[Sweep], dict[str, list[list[str]]]]:
    """All sweeps, and the rows of the other tables."""
    rows = {
        "rule": _rule_rows(),
        "deep": _deep_rows(),
        "put": _put_rows(),
        "roller": _roller_rows(),
        "layer": _layer_rows(),
    }
    return measure(), rows


def page(figures: tuple[list[Sweep], dict[str, list[list[str]]]]) -> str:
    """The Markdown page."""
    found, rows = figures
    grid_nodes, cells = (
        table(["patch", "b/s", *NAMED], _error_rows([s for s in found if s.traction == traction]))
        for traction in ("nodes", "cells")
    )
    states, over = sum(len(s.fineness) for s in found), exceeded(found)
    verdict = "No state exceeds the rule." if not over else "Above the rule: " + "; ".join(over) + "."
    return f"""# How fine must a contact grid be?

Hertz's line contact, and elliptic contacts with semi-axes 1:1, 1:3 and 1:10, on an exact elastic half-plane
({DEPTH:g} half-widths deep) and half-space, so that the contact grid is all that is wrong. b is the half-width, s the
spacing of the grid. On ellipses both are taken in the same direction, so that the grid is as elongated as the patch;
once, *equal*, s is the same in both directions and b the smaller semi-axis.

{states} states: sizes b/s, positions of the patch over the grid, and, with nodes, a single body or two equal ones whose
grids lie anywhere against each other. {verdict}

- *compliance*: what the best combination of the functions misses of the mean approach under Hertz's pressure.
- *force*: of the contact at a given approach, pressures non-negative, weak gaps.
- *peak pressure*: as results report it (largest mean over a function). *half-width*: from the second moment.

## The rule

`error <= c (s/b)^p`, derived in `warpffrf/offline/contact/contact_grid.py` and used by `warpffrf.contact_spacing`.
Spacing in half-widths for a wanted error of each quantity, nodes:

{table(["patch", "error", *NAMED], rows["rule"])}
![errors and rule]({PICTURE})

Largest c measured with the p of the rule; in brackets the slope of the worst errors of the bins below.

{table(["traction", "patch", *NAMED], _factor_rows(found))}
Errors of a line contact depend on how deep the body is, because the rest of its compliance does. Largest c:

{table(["nodes", *NAMED], rows["deep"])}
## Centred and worst position

Each entry: patch centred on a function, single body, at the lower end of the bin / worst of all states in the bin.
Centred positions alone would promise too much.

### Nodes

{grid_nodes}
### Cells

{cells}
## A given pressure put on the grid

Error of the mean approach when Hertz's line pressure itself is put on the grid, worst position: best in energy, by L2
projection, by its values at the middles of the functions. Values at points do not keep the force.

{table(["traction", "b/s from", "best", "L2 projection", "values"], rows["put"])}
## On rollers of finite elements

A reduced steel roller (R 50 mm) under a rigid cylinder, half-width {1e3 * roller_half_width():.2g} mm, grids and meshes
of several sizes, first layer of nodes as deep as nodes are apart around. Force at a given approach compared with the
finest mesh of the same elements (nodes b/16 apart) with the grid of its nodes. The rule is for the grid alone. It holds
on linear cells (hex8) where two fall on a spacing, and on quadratic ones (hex27) with nodes as far apart as the
functions; linear cells as coarse as the grid add an error of the same size.

{table(["elements", "b/s", "b/node spacing", "centred", "worst position", "rule"], rows["roller"])}
## Layers of cells that grow inwards

The same roller, layers that grow from one to the next; linear cells 8, quadratic nodes 4 in a half-width of
{1e3 * roller_half_width():.2g} mm. Mean error of the force over positions, compared with the finest quadratic mesh with
growth {FINEST_GROWTH:g}, and the estimate of `warpffrf/offline/contact/mesh_error.py`, which `reduce` reports
(`line_mesh_error`) and adds to what the rule promises.

{table(["elements", "growth", "half-width", "force", "estimate"], rows["layer"])}"""


def picture(figures: tuple[list[Sweep], dict[str, list[list[str]]]], path: Path) -> None:
    """Errors of all states with nodes compared with the rule."""
    found, rows = figures[0], []
    for patch in PATCHES:
        sweeps = [s for s in found if (s.traction, s.patch) == ("nodes", patch)]
        sizes = 1.0 / np.concatenate([s.fineness for s in sweeps])
        errors = np.abs(np.concatenate([s.errors for s in sweeps]))
        rows.append(
            [
                ErrorPanel(f"{patch}: {name}", sizes, errors[:, i], *RULES["nodes", patch][q])
                for i, (q, name) in enumerate(zip(QUANTITIES, NAMED, strict=True))
            ]
        )
    error_charts(rows, "spacing over half-width  s/b", path)
