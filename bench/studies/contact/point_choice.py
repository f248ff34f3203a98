r"""Which points for quadrature "reduced": non-negative least squares beside DEIM and Q-DEIM, on one training set.

`python -m studies.contact.point_choice` writes docs/studies/point_choice.md. A minute.

A function f on a contact surface, a gap or the pressure of a layer, is taken at few points x_p of each strip between
two columns; what the hats get of it is A f, A (hats of both columns, points) of a strip:

    all points                 A = Psi^T W             Gauss points and their weights W, as "full" has them
    least squares (`cubature`) A = Psi_P^T W_P         weights W_P > 0 of a few points
    interpolation              A = Psi^T W U (P^T U)^-1      DEIM, Q-DEIM: f by modes U between few points

U are left singular vectors of the fields f of the training set of `offline.contact.training`, strip by strip, each
family scaled to size one; the more modes, the more points, one each.

    error         |A f - (A f)_all| over |(A f)_all| of the families, gaps and displacements; the worst of the PATCHES
                  that were trained, and of as many that were not
    definiteness  the tangent of F(u) = sum over strips A p(g), p = k <-g>, g = g_0 + Psi_P u, is K = -A p' Psi_P. With
                  positive weights that is Psi_P^T (k W_P) Psi_P >= 0. Of interpolation it is not even symmetric:
                  |K - K^T|/|K|, and the least eigenvalue of (K + K^T)/2 over the largest, worst of patches held out
    energy        F is the gradient of an energy if and only if K is symmetric. Work of F over a closed cycle of u, the
                  surface tilted across and along by turns, over the sum of what it does and takes on the way; the
                  worst of patches held out. Run the other way round, what is lost is gained

ECSW, of which ours is a variant without simulations: C. Farhat, P. Avery, T. Chapman, J. Cortial, Int. J. Numer. Meth.
Engng 98, 2014; empirical cubature: J. A. Hernandez, M. A. Caicedo, A. Ferrer, CMAME 313, 2017.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scenes.rollers import STEEL
from studies.contact.interpolation_points import Array, constant, deim, interpolation, qdeim
from studies.speed.step_time import BORE, RADIUS, WIDTH
from warpffrf.model.mesh import roller
from warpffrf.model.reduced.contact_surface import ContactSurface, Sampling
from warpffrf.model.surfaces import CrownedCylinder, Cylinder
from warpffrf.offline import ContactGrid, reduce
from warpffrf.offline.contact.cubature import PATCHES, Places, all_points, choose_sampling, patch_fields
from warpffrf.study.markdown import table

MADE = "Made by `python -m studies.contact.point_choice`; do not edit.\n"
WANTED = (0.05, 0.01, 0.002)  # errors of the worst training family
TILT = 0.5  # of the depth of a patch
CYCLE = 400  # steps of a closed cycle: forces are linear by pieces, so that the sum errs by some 1/CYCLE^2
CROWN = 0.4  # m
ROUND_OFF = 1e-12  # of a tangent: sums of some hundred numbers
TRAINED, HELD_OUT = range(PATCHES), range(PATCHES, 2 * PATCHES)
CHOICES: dict[str, Callable[[Array], Array]] = {"DEIM": deim, "Q-DEIM": qdeim}


@dataclass(frozen=True, eq=False)
class Rule:
    """Points of a strip: `places`, and A (2 rows, n) [m^2] from values there to the hats of its two columns."""

    name: str
    places: Places
    A: Array
    constant: float | None = None  # c of an interpolation

    @property
    def B(self) -> Array:
        """Values (2 rows, n) of these hats at the points."""
        return hats_at(self.places, len(self.A) // 2)

    def forces(self, values: Array) -> Array:
        """What hats get (strips + 1, rows) of a function with `values` (strips, n) at the points."""
        found = values @ self.A.T
        rows = len(self.A) // 2
        out = np.zeros((len(values) + 1, rows))
        out[:-1] += found[:, :rows]
        out[1:] += found[:, rows:]
        return out

    def tangent(self, pressed: Array) -> Array:
        """sum over strips A diag(pressed) B^T ((strips + 1) rows, same), `pressed` (strips, n) where p' = -1."""
        rows, B = len(self.A) // 2, self.B
        size = (len(pressed) + 1) * rows
        K = np.zeros((size, size))
        for s, on in enumerate(pressed):
            at = slice(s * rows, (s + 2) * rows)
            K[at, at] += (self.A * on) @ B.T
        return K


def hats_at(places: Places, rows: int) -> Array:
    """Values (2 rows, n) of the hats of the two columns of a strip at `places`."""
    along = places.along(rows)
    return np.concatenate([along * (1.0 - places.x), along * places.x])


def every_point(surface: ContactSurface) -> Rule:
    """The Gauss points of quadrature "full"."""
    places, weight = all_points(surface)
    return Rule("all", places, hats_at(places, surface.grid.rows) * weight)


def by_sampling(surface: ContactSurface, sampling: Sampling) -> Rule:
    """Points and weights of `choose_sampling`."""
    places = Places.of(surface, sampling.fraction, sampling.row, sampling.zeta)
    return Rule("least squares", places, hats_at(places, surface.grid.rows) * sampling.weight)


def by_interpolation(every: Rule, U: Array, name: str) -> Rule:
    """As many points as there are modes U (n, m)."""
    at = CHOICES[name](U)
    p = every.places
    places = Places(p.x[at], p.row[at], p.zeta[at], p.z[at], p.measure[at])
    return Rule(name, places, every.A @ interpolation(U, at), constant(U, at))


def strips_of(surface: ContactSurface, places: Places, numbers: Iterable[int]) -> Iterator[Array]:
    """Fields (strips, n) of the patches of these numbers: gap, response, gap, ..., in all strips that they touch."""
    for _, field, patch in patch_fields(surface, numbers):
        at = field(places)
        yield np.array([at(shift) for shift in range(-patch.reach - 1, patch.reach + 1)])


def modes_of(surface: ContactSurface, every: Rule) -> Array:
    """Left singular vectors (n, m) of the training fields at all points, as many as they span."""
    fields = [hats_at(every.places, surface.grid.rows)]
    fields += [f / np.linalg.norm(f) for f in strips_of(surface, every.places, TRAINED)]
    U, sizes, _ = np.linalg.svd(np.concatenate(fields).T, full_matrices=False)
    return U[:, sizes > len(U) * np.finfo(float).eps * sizes[0]]


@dataclass(frozen=True)
class Found:
    """Figures of a rule (module docstring), as fractions; `constant` None of least squares."""

    name: str
    points: int
    trained: float
    held_out: float
    asymmetry: float
    eigenvalue: float
    energy: float
    constant: float | None


def error(surface: ContactSurface, rule: Rule, every: Rule, numbers: Iterable[int]) -> float:
    """The worst family's."""
    worst, numbers = 0.0, list(numbers)
    pairs = zip(strips_of(surface, rule.places, numbers), strips_of(surface, every.places, numbers), strict=True)
    for few, full in pairs:
        # the first and the last column's hats are cut: as in training, they do not count
        target = every.forces(full)[1:-1]
        worst = max(worst, float(np.linalg.norm(rule.forces(few)[1:-1] - target) / np.linalg.norm(target)))
    return worst


def measured(surface: ContactSurface, rule: Rule, every: Rule) -> Found:
    """Figures of a rule."""
    asymmetry, least, energy = 0.0, np.inf, 0.0
    for gap in gaps(surface, rule.places):
        K = rule.tangent(gap < 0.0)
        size = np.linalg.norm(K)
        if size == 0.0:
            continue  # a patch that lies between the points
        asymmetry = max(asymmetry, float(np.linalg.norm(K - K.T) / size))
        values = np.linalg.eigvalsh(0.5 * (K + K.T))
        least = min(least, float(values[0] / np.abs(values).max()))
        energy = max(energy, abs(work_of_cycle(surface, rule, gap)))
    return Found(
        rule.name, len(rule.places.x), error(surface, rule, every, TRAINED), error(surface, rule, every, HELD_OUT),
        asymmetry, least, energy, rule.constant,
    )  # fmt: skip


def gaps(surface: ContactSurface, places: Places) -> Iterator[Array]:
    """Gaps (strips, n) of the patches held out."""
    for number, field in enumerate(strips_of(surface, places, HELD_OUT)):
        if number % 2 == 0:
            yield field


def work_of_cycle(surface: ContactSurface, rule: Rule, gap: Array) -> float:
    """Work of F on hats that go up and down in a closed cycle, over the work that it does and takes in all; see the
    module. The cycle has tilts across and along, a quarter of a period apart."""
    rows, columns = surface.grid.rows, len(gap) + 1
    depth = -float(gap.min())
    across = np.repeat(np.linspace(-1.0, 1.0, columns), rows).reshape(columns, rows)
    along = np.tile(np.linspace(-1.0, 1.0, rows), (columns, 1))
    B = rule.B
    angle = 2.0 * np.pi * (np.arange(CYCLE) + 0.5) / CYCLE
    net = both = 0.0
    for a in angle:
        u = TILT * depth * (across * np.cos(a) + along * np.sin(a))
        du = TILT * depth * (along * np.cos(a) - across * np.sin(a)) * 2.0 * np.pi / CYCLE
        now = gap + np.concatenate([u[:-1], u[1:]], axis=1) @ B
        done = float(np.sum(rule.forces(np.maximum(-now, 0.0)) * du))
        net, both = net + done, both + abs(done)
    return net / both if both else 0.0


def fewest(surface: ContactSurface, every: Rule, U: Array, name: str, wanted: float) -> Rule | None:
    """The interpolation by the fewest modes whose worst training family errs by `wanted` at most; None where that of
    all modes errs by more."""
    for m in range(1, U.shape[1] + 1):
        rule = by_interpolation(every, U[:, :m], name)
        if error(surface, rule, every, TRAINED) <= wanted:
            return rule
    return None


def bodies() -> dict[str, ContactSurface]:
    """Contact surfaces of the study by name."""
    mesh = {"sectors": 240, "layers": 6, "axial": 6, "grading": 1.4, "order": 1}
    found = {}
    for name, shape, crown in (("straight", Cylinder(), None), ("crowned", CrownedCylinder(crown_radius=CROWN), CROWN)):
        body = reduce(
            roller(RADIUS, BORE, WIDTH, crown_radius=crown, **mesh), STEEL, interfaces={"bore": "rigid"},
            contact={"rim": shape}, modes=10, grid=ContactGrid(contact_fixed=False), progress=False,
        )  # fmt: skip
        found[name] = body.contact_surfaces["rim"]
    return found


def study(surface: ContactSurface) -> list[tuple[float, Found]]:
    """Wanted error and figures of all choices that reach it; "all" first."""
    every = every_point(surface)
    U = modes_of(surface, every)
    rows = [(0.0, measured(surface, every, every))]
    for wanted in WANTED:
        rules = [by_sampling(surface, choose_sampling(surface, wanted))]
        for name in CHOICES:
            found = fewest(surface, every, U, name, wanted)
            rules += [found] if found else []
        equal = len(rules[0].places.x)
        rules += [by_interpolation(every, U[:, :equal], name) for name in CHOICES if equal <= U.shape[1]]
        rows += [(wanted, measured(surface, rule, every)) for rule in rules]
    return rows


def shown(value: float, form: str) -> str:
    """A figure, "0" where it is round-off."""
    return "0" if abs(value) < ROUND_OFF else format(value, form)


def lines(rows: list[tuple[float, Found]]) -> list[list[str]]:
    """Rows of the table."""
    return [
        [
            f"{wanted:.1%}" if wanted else "", f.name, str(f.points), f"{f.trained:.2%}", f"{f.held_out:.2%}",
            shown(f.asymmetry, ".1%"), shown(f.eigenvalue, "+.1%"), f"{f.energy:.2%}",
            "" if f.constant is None else f"{f.constant:.1f}",
        ]
        for wanted, f in rows
    ]  # fmt: skip


def page(found: dict[str, list[tuple[float, Found]]]) -> str:
    """The page of docs/studies."""
    head = [
        "wanted", "choice", "points", "error, trained", "held out", "not symmetric", "least eigenvalue",
        "energy of a cycle", "c",
    ]  # fmt: skip
    sheets = "\n".join(f"## {name.capitalize()}\n\n{table(head, lines(rows))}" for name, rows in found.items())
    by_modes = [f for rows in found.values() for _, f in rows if f.constant is not None]
    ours = [f for rows in found.values() for _, f in rows if f.constant is None]
    c, most = max(f.constant for f in by_modes if f.constant), max(f.points for f in by_modes)
    asymmetry, energy = max(f.asymmetry for f in by_modes), max(f.energy for f in by_modes)
    negative, closes = -min(f.eigenvalue for f in by_modes), max(f.energy for f in ours)
    return f"""# Few points of a contact: least squares beside DEIM and Q-DEIM

{MADE}
Contact surfaces of two rollers (R {RADIUS * 1e3:.0f} mm, width {WIDTH * 1e3:.0f} mm, 240 columns, 7 rows), straight
and with a crown of {CROWN:g} m. A function on the surface, the gap or the pressure of a layer, is taken at few points
of each strip between two columns. *Least squares*: points and positive weights of `ContactGrid(sampling_error=)`.
*DEIM* (Chaturantabut and Sorensen 2010), *Q-DEIM* (Drmac and Gugercin 2016): interpolation by modes of the same
training set,
gaps and displacements of {PATCHES} patches, one point a mode; once with the fewest modes that reach the wanted error,
once with as many points as least squares. *All*: the Gauss points of "full". How each figure is defined:
`bench/studies/contact/point_choice.py`.

- *error*: of the weak values of gaps and displacements, the worst patch, of those trained and of {PATCHES} others
- *not symmetric*, *least eigenvalue* over the largest: of the tangent of a layer at the points, the worst of the others
- *energy of a cycle*: gained or lost in a closed cycle of the surface, of the work that the layer does and takes
- *c*: |(P^T U)^-1|, how much farther than the best approximation the interpolation may be

{sheets}
What to read from it. Interpolation needs more points for an error in some rows and fewer in others, Q-DEIM the fewer of
the two: it has to represent the training set only, where least squares also integrate products of hats and global
modes to the wanted error, keep the areas of all hats exactly, and have positive weights. c is {c:.1f} at most: as
interpolation it is sound. But what it makes of a layer is not the force of an elastic one. Hats are loaded with other
weights than their displacements are read with; the tangent is up to {asymmetry:.0%} unsymmetric, its symmetric
part has negative eigenvalues of up to {negative:.1%} of the largest, and a closed cycle gains, or loses, up to
{energy:.1%} of the work. More points make this less, at {most} it is not gone. Of positive weights the tangent
is symmetric and not negative to round-off, and the cycle closes to {closes:.0e}, the error of its {CYCLE} steps. The
active set of the solver and the energy ledger rest on both. So points are chosen by least squares with positive
weights, as in ECSW (Farhat, Avery, Chapman and Cortial 2014) and empirical cubature (Hernandez, Caicedo and Ferrer
2017).
"""


def main(folder: Path) -> None:
    """Writes the page to `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    found = {name: study(surface) for name, surface in bodies().items()}
    (folder / "point_choice.md").write_text(page(found), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("docs/studies"))
