r"""Discretisation error of the cells of patches in a run: sampled saved steps evaluated again on finer cells.

At a saved step the poses and global coordinates are known, and with quasi-static local modes they determine the
pressures. These are computed again on the cells of the run and on other ones, nearly twice as many strips and rows, or
half as many for patches that have `MANY` cells; the bodies are constrained to their positions, in one proximal step
towards the static state so short that nothing moves. Both omit the damping of the law. The patches are evaluated one by
one, while all others have `FEW` cells, both times: their loads on the bodies are nearly the same, and their errors
cancel. The error e of cells falls with the square of their number (docs/studies/patch_cells.md), so that the difference
d is e - e/4 for finer ones, 4 e - e for coarser ones.

Pressures as a field have an error at the edge of the patch, which crosses cells: it is of first order, and of either
sign from one number of cells to another. As means over the boxes of the coarser cells
[`warpffrf.model.half_space`] two fields differ by d, d^2 = e^2 + (e/2)^2 for finer and e^2 + (2 e)^2 for
coarser ones.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from warpffrf.model import rotation as rot
from warpffrf.model.contact import Contact
from warpffrf.model.errors import InputError
from warpffrf.model.half_space import Boxes, squares
from warpffrf.online.compile.patches.plan import PatchPlan
from warpffrf.online.engine import Engine
from warpffrf.online.history.history import ContactHistory, History
from warpffrf.online.history.record import history_from_rows

SAMPLED = 3  # saved steps that are evaluated: that of the largest force, and two others between
MARGIN = 1.5  # of half-widths to either side, for which finer cells have near tables
HELD = 1e-9  # s/m of the length of the scene: 1e9 m/s2, which no contact gives a body, move it by 1e-9 of its length
MANY = 800  # cells of a patch that are compared with fewer: four times as many take 64 times as long
# of the required error: estimates scatter about it with the position of cells relative to the edge of the patch
ABOUT = 2.0
STEPS = 3  # the width of a patch follows the pressures of the previous step: a fourth step changes a force by 1e-6
FEW = (5, 9)  # strips and rows at most
TOUCHING = 0.1  # of the largest force of a pair: below it relative errors are meaningless


@dataclass(frozen=True)
class CellCheck:
    """Discretisation errors of a contact, the largest of the evaluated saved `rows`: of the `force` over it, of the
    largest `pressure` over it, of pressures as a `field` (root mean square); by `finer` or by coarser ones.
    No rows where no state was found on the others.
    """

    force: float
    pressure: float
    field: float
    rows: tuple[int, ...]
    finer: bool

    def note(self, contact: Contact, cells: tuple[int, int]) -> str:
        """The line for the report; cells: strips across and rows along."""
        label = f"contact {contact.name!r}: a patch of {cells[0]} x {cells[1]} cells"
        if not self.rows:
            return f"{label} was not compared with another one, whose pressures were not found at the saved steps"
        text = (
            f"{label} adds errors of about {self.force:.2%} to the force, {self.pressure:.2%} to the largest pressure, "
            f"{self.field:.1%} to pressures (RMS), estimated with nearly {'twice' if self.finer else 'half'} as many "
            f"in both directions at {len(self.rows)} saved steps"
        )
        if max(self.force, self.pressure) <= ABOUT * contact.cell_error:
            return text
        if contact.cells is None:
            return f"{text}, more than cell_error={contact.cell_error:g}; use a smaller one, or cells="
        return f"{text}; use more strips or rows in cells= where that matters"


def cell_check_notes(engine: Engine, checks: Mapping[int, CellCheck]) -> list[str]:
    """One note for each contact of `engine` whose cells carried a load, by its number."""
    return [
        check.note(
            engine.scene.finite_sliding[i], (engine.compiled.patches[i].columns, len(engine.compiled.patches[i].z))
        )
        for i, check in checks.items()
    ]


def check_cells(engine: Engine, history: History, sampled: int = SAMPLED) -> dict[int, CellCheck]:
    """Changes by finer cells by number of the contact, at most `sampled` saved steps of `history` each; of contacts
    with one plan those of the one with the largest force."""
    scene, plans = engine.scene, engine.compiled.patches
    found = {i: history.contacts[scene.finite_sliding[i].name] for i in plans}
    forces = {i: np.linalg.norm(record.force, axis=1) for i, record in found.items()}
    if not any(np.any(force > 0.0) for force in forces.values()):
        return {}
    alike: dict[int, list[int]] = {}  # contacts by their plan, which all pairs of teeth of two gears share
    for i, plan in plans.items():
        alike.setdefault(id(plan), []).append(i)
    few, widths = {}, {}
    for group in alike.values():
        plan, ends = plans[group[0]], np.array([_widths(found[i], forces[i]) for i in group])
        width = widths[group[0]] = float(ends[:, 0].min()), float(ends[:, 1].max())
        size = min(plan.columns, FEW[0]), min(len(plan.z), FEW[1])
        few |= dict.fromkeys(group, plan.spread(scene.finite_sliding[group[0]], *size, *width))
    checks = {}
    for group in alike.values():
        i = max(group, key=lambda one: forces[one].max(initial=0.0))
        plan, loaded = plans[i], _loaded(forces[i])
        if not len(loaded):
            continue
        rows = _sampled(loaded, forces[i], sampled)
        size = plan.columns, len(plan.z)
        finer = size[0] * size[1] < MANY
        across, along = (2 * n - 1 if finer else (n + 1) // 2 | 1 for n in size)
        other = plan.spread(scene.finite_sliding[i], across, along, *widths[group[0]])
        at_own, at_other = (_at_rest(engine, history, rows, i, {**few, i: cells}) for cells in (plan, other))
        apart = [
            _apart(at_own[t], at_other[t]) for t in rows if t in at_own and t in at_other and at_own[t].force > 0.0
        ]
        second, first = (4.0 / 3.0, 1.0 / np.hypot(1.0, 0.5)) if finer else (1.0 / 3.0, 1.0 / np.hypot(1.0, 2.0))
        force, largest, field = np.max([np.zeros(3), *apart], axis=0) * np.array([second, second, first])
        seen = tuple(rows) if apart else ()
        check = CellCheck(float(force), float(largest), float(field), seen, finer)
        checks |= {k: check for k in group if np.any(forces[k] > 0.0)}
    return checks


@dataclass(frozen=True, eq=False)
class _Found:
    """Force [N] and pressures of a patch."""

    force: float
    field: Boxes

    @classmethod
    def of(cls, record: ContactHistory) -> _Found:
        """Of the last row of a contact with cells."""
        cells, p = record.cells, record.pressure[-1]
        if cells is None:
            raise TypeError("the contact has no cells")
        x = cells.half_width[-1] * np.linspace(-1.0, 1.0, len(p) + 1)
        z, half = cells.z[-1], 0.5 * cells.length[-1]
        return cls(float(np.linalg.norm(record.force[-1])), Boxes(x, np.append(z - half, z[-1] + half[-1]), p))


def _apart(own: _Found, other: _Found) -> np.ndarray:
    """Difference of the other cells in force, largest pressure and field."""
    apart, size = squares(other.field, own.field)
    largest = other.field.p.max() / own.field.p.max()
    return np.array([abs(other.force / own.force - 1.0), abs(largest - 1.0), np.sqrt(apart / size)])


def _loaded(force: np.ndarray) -> np.ndarray:
    """Rows of a history of forces that are a significant part of the largest."""
    return np.flatnonzero(force > TOUCHING * force.max(initial=0.0))


def _widths(found: ContactHistory, force: np.ndarray) -> tuple[float, float]:
    """Half-widths [m] for which cells are made, by the rows in which the `force` is a significant part of the largest;
    by all, where there are none.
    """
    if found.cells is None:
        raise TypeError("the contact has no cells")
    loaded = _loaded(force)
    width = found.cells.half_width[loaded] if len(loaded) else found.cells.half_width
    return float(width.min()) / MARGIN, float(width.max()) * MARGIN


def _sampled(rows: np.ndarray, force: np.ndarray, count: int) -> list[int]:
    """The one of `rows` with the largest force, and others evenly spread, `count` at most."""
    spread = rows[np.linspace(0, len(rows) - 1, count).round().astype(int)]
    spread[count // 2] = rows[np.argmax(force[rows])]
    return sorted({int(t) for t in spread})


def _at_rest(
    engine: Engine, history: History, rows: list[int], number: int, patches: Mapping[int, PatchPlan]
) -> dict[int, _Found]:
    """Force and pressures of the contact with that number, at those saved `rows` where they are found with the bodies
    constrained.
    """
    try:
        held = Engine(
            engine.scene, device=str(engine.compiled.device), settings=engine.settings, patches=patches,
            turned=engine.state.turned.numpy()[0],
        )  # fmt: skip
    except (InputError, MemoryError, RuntimeError):  # not enough memory for them
        return {}
    held.rates_to_zero()
    name = engine.scene.finite_sliding[number].name
    values = {}
    for t in rows:
        held.control(status=0)
        _put(held, history, t)
        for _ in range(STEPS):
            held.static_step(HELD * float(held.compiled.model.length))
        if np.any(held.word("status")):
            continue
        held.save_now()
        values[t] = _Found.of(history_from_rows(held.compiled, held.saved()).contacts[name])
    return values


def _put(engine: Engine, history: History, t: int) -> None:
    """Bodies and clock of `engine` as saved in row t."""
    state = engine.state
    r, p, q = (array.numpy().copy() for array in (state.r, state.p, state.q))
    for i, body in enumerate(engine.scene.bodies):
        motion = history.bodies[body.name]
        r[:, i] = motion.position[t] + rot.matrix(motion.rotation[t]) @ body.center_of_mass
        p[:, i] = motion.rotation[t]
        first = engine.compiled.modal_start[i]
        q[:, first : first + body.mode_count] = motion.modal[t]
    for array, values in ((state.r, r), (state.p, p), (state.q, q)):
        array.assign(values)
    engine.clock(time=history.time[t], start_time=history.time[t])
