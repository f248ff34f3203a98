r"""All quantities of a report, and the propagation of errors between them.

A quantity is named by its kind and owner, such as "creepage of contact 'pair'". Sources of error give lines for
quantities by these names. Errors are best known for the force at a given approach; the effect of a relative error e of
it on other quantities of a contact follows from contact mechanics: F ~ d^n with n = 1.1 for lines (whose approach has a
logarithm), 1.5 for points and 1 for flat faces; a ~ F^(1/2), F^(1/3), and constant. The machine prescribes between none
and all of the approach: `SHARED` is in between. Errors of joints, force elements and sensors are at most those of
contact forces. Contacts and joints whose forces are given by the loads (`balance`) have no error in these, and all of
it in the approach.

On a layer much thinner than its patch is wide the half-width is that of the geometry, F = c d^n with the stiffness c
of the layer, and pressures err with the force. At a given force they follow about the root of c, and half-widths
c^-0.7: `_thin` is between 0 of a half-space and 1 of a layer of twice the half-width and less.

A quantity without an estimate for its grid or mesh gets a line that states this.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from warpffrf.online.history.history import BudgetLine, History
from warpffrf.output.budget.balance import given_by_loads
from warpffrf.output.budget.quantities import LIGHT, Quantity, machine_size, quantities
from warpffrf.output.contact.cell_result import CellContactResult
from warpffrf.output.contact.hertz import flexible_sides
from warpffrf.output.contact.result import ContactResult
from warpffrf.output.geometry.scene_view import SceneView

Array = np.ndarray
UNKNOWN = "not estimated"  # source of the line of a quantity without an estimate
WORK = "work of friction"  # of the whole run
BALANCE = "balance"  # of forces given by the loads
OF_TIME = ("time step", "energy ledger", "iteration")  # sources that do not cover grids and meshes
ON_GRIDS = ("contact", "film")
AS_FORCE = "by what it is of the force"
EXPONENTS = {"line": 1.1, "line_around": 1.1, "point": 1.5, "flat": 1.0}  # exponents of the approach in the force
WIDTHS = {"line": 0.5, "line_around": 0.5, "point": 1.0 / 3.0, "flat": 0.0}  # exponents of the force in half-widths
RUBBED = ("friction power", "wear index", "creepage")
LIFE = {"ball": 3.0}  # exponent of the load in the life; for rollers
OF_ROLLERS = 10.0 / 3.0
LEAST = 1e-14  # of any quantity: smaller values are sums of zeros
SORTS = {"reaction": "force", "load": "force", "reaction torque": "torque"}
ARM = 0.1  # of the size of the machine: torques are relative at least to its forces with such arms
# part of a force's error in a torque that vanishes: meshes are not symmetric; 0.1 to 0.16 of most, 0.45 of a cover of
# four linear cells along
ASKEW = 0.145
SHARED = 0.3  # of the error of an approach at a given force: machines prescribe forces, approaches, or neither
NEGLIGIBLE = LIGHT  # of displacements and energy of the machine: errors of deformations with less are not the largest
MAIN = (
    "force", "stiffness", "pressure", "motion", "deformation", "moment", "loss", "largest friction force",
    "all results", "energy in the system", "smallest gap", "largest pressure",
)  # fmt: skip


def figure(kind: str, owner: str) -> str:
    """The name of a quantity."""
    return f"{kind} of {owner}"


def kind_and_owner(name: str) -> tuple[str, str]:
    """Its kind and owner, "" for the whole run."""
    kind, _, owner = name.partition(" of ")
    return (kind, owner) if name != WORK else (name, "")


def is_main(line: BudgetLine) -> bool:
    """Whether other quantities follow from it, as from forces and motions."""
    return line.source != UNKNOWN and kind_and_owner(line.of)[0] in MAIN


def figures(history: History, view: SceneView) -> dict[str, Quantity]:
    """All quantities of a report by name, in addition to those of `quantities`, relative to their largest value, or to
    `LIGHT` of the largest of their kind, torques to forces with `ARM` of the machine; quantities that are zero, or
    round-off, in all rows are omitted."""
    found, most = list[tuple[str, Quantity]](), dict[str, float]()
    for kind, owner, values in _values(history, view):
        v = np.asarray(values, dtype=float).reshape(len(history.time), -1)
        quantity = Quantity(figure(kind, owner) if owner else kind, v, 0.0)
        sort, size = SORTS.get(kind, kind), _largest(quantity)
        most[sort] = max(most.get(sort, 0.0), size)
        if size > LEAST:
            found.append((sort, replace(quantity, size=size)))
    most["force"] = max(
        most.get("force", 0.0), *(_largest(q) for q in quantities(history).values() if _is_force(q)), 0.0
    )
    least = {sort: LIGHT * size for sort, size in most.items()}
    least["torque"] = max(least.get("torque", 0.0), ARM * machine_size(history) * most["force"])
    return {q.name: q.at_least(least[sort], f"{least[sort]:.2g} in SI units, it is small") for sort, q in found}


def _is_force(quantity: Quantity) -> bool:
    return quantity.name.startswith("force of")


def _largest(quantity: Quantity) -> float:
    """The largest magnitude of its values."""
    return float(np.nan_to_num(np.linalg.norm(quantity.values, axis=1)).max(initial=0.0))


def pair_result(history: History, view: SceneView, name: str) -> Any:
    """The contact called `name` as in a result."""
    pair = history.contacts[name]
    return (ContactResult if pair.cells is None else CellContactResult)(pair, view.pairs[name], history.bodies)


def _values(history: History, view: SceneView) -> Iterator[tuple[str, str, Any]]:
    """Kind, owner, and values (T, ...) of the quantities."""
    for name in history.contacts:
        pair, owner = pair_result(history, view, name), f"contact {name!r}"
        if not np.any(pair.touching):
            continue
        closed = pair.touching
        yield "approach", owner, np.where(closed, pair.approach, 0.0)
        yield "peak pressure", owner, pair.peak_pressure
        yield "half-widths", owner, pair.half_widths
        if pair.has_friction:
            friction = pair.friction
            yield "traction", owner, friction.tangential_force
            yield "creepage", owner, friction.creepage
            yield "friction power", owner, friction.power
            yield "wear index", owner, friction.wear_peak
    for name, lumped in history.lumped_contacts.items():
        closed = np.linalg.norm(lumped.force, axis=1) > 0.0
        yield "approach", f"lumped contact {name!r}", np.where(closed, lumped.approach, 0.0)
    for name, film in history.films.items():
        owner = f"film {name!r}"
        yield "torque", owner, film.torque
        yield "largest pressure", owner, film.largest_pressure
        yield "smallest gap", owner, film.smallest_gap
        yield "friction power", owner, film.friction_power
        yield "feed flow", owner, film.feed_flow
        yield "end flow", owner, film.end_flow
    for name, contact in history.small_sliding.items():
        yield "peak pressure", f"contact {name!r}", contact.pressure.max(axis=1, initial=0.0)
    for name, joint in history.joints.items():
        yield "reaction", f"joint {name!r}", joint.force
        yield "reaction torque", f"joint {name!r}", joint.torque
    for name, force in history.forces.items():
        if not force.deformation.shape[1]:  # a load, which is given
            continue
        yield "load", f"force {name!r}", force.force
        yield "torque", f"force {name!r}", force.torque
    for name, sensor in history.sensors.items():
        yield "values", f"sensor {name!r}", sensor.values
    if "friction" in history.energy:
        yield WORK, "", history.energy["friction"]


def with_all_figures(result: Any, lines: Sequence[BudgetLine]) -> list[BudgetLine]:
    """`lines`, with their effects on other quantities, and a line for each quantity without an estimate for its grid or
    mesh."""
    history = result.history
    own = figures(history, result.view)
    own |= {name: q for name, q in quantities(history).items() if _is_force(q)}
    given = given_by_loads(result)
    shares = {name: q.share for name, q in quantities(history).items()}
    lines = [replace(line, share=shares.get(line.of, 1.0)) for line in lines]
    found = [line for each in lines for line in _by_loads(each, given)]
    found += _of_pairs(result, found, own, given)
    found += _of_machine(result, found, own, given)
    lumped = {f"contact {name!r}" for name in history.lumped_contacts}
    exact = history.samples.static and not any(
        body.reduced for body in history.scene.bodies
    )  # except for its iteration
    deform = any(body.reduced is not None for body in history.scene.bodies)
    of_numbers = {line.of for line in found if line.found and line.source not in OF_TIME}
    of_any = {line.of for line in found if line.found}
    for name in own:
        owner = kind_and_owner(name)[1]
        on_grid = owner.startswith(ON_GRIDS) and owner not in lumped or (name == WORK and history.contacts)
        if exact and not on_grid:
            continue
        if name not in (of_numbers if deform or on_grid else of_any):
            found.append(BudgetLine(UNKNOWN, name, np.nan, _why(name, result)))
    return found


def _by_loads(line: BudgetLine, given: set[str]) -> list[BudgetLine]:
    """`line`; for a contact whose force is given by the loads it is one of the stiffness, and the force has no
    error."""
    kind, owner = kind_and_owner(line.of)
    if kind != "force" or owner not in given or line.source in OF_TIME:
        return [line]
    return [replace(line, of=figure("stiffness", owner)), BudgetLine(line.source, line.of, 0.0, "the loads give it")]


def _of_pairs(result: Any, lines: Sequence[BudgetLine], own: dict[str, Quantity], given: set[str]) -> list[BudgetLine]:
    """Effects of errors of the force of a contact at a given approach on its other quantities, for sources without own
    estimates of them."""
    found, told = list[BudgetLine](), {(line.source, line.of) for line in lines}
    for name in result.history.contacts:
        owner = f"contact {name!r}"
        if figure("approach", owner) not in own:
            continue
        kind = result.contact(name).patch_kind
        factors, thin = {"approach": 1.0 / EXPONENTS[kind]}, _thin(result.contact(name))
        if owner not in given:
            factors["approach"] *= SHARED
            peak = WIDTHS[kind] + (1.0 - WIDTHS[kind]) * thin if kind != "flat" else 1.0
            factors |= {"half-widths": WIDTHS[kind], "peak pressure": peak, "traction": 1.0}
        else:
            factors |= {"half-widths": 0.7 * thin, "peak pressure": 0.5 * thin}  # measured on covers
            if figure("traction", owner) in own:
                found.append(BudgetLine(BALANCE, figure("traction", owner), 0.0, "the loads give it"))
        for line in lines:
            if line.of != figure("stiffness" if owner in given else "force", owner) or not line.found:
                continue
            for other, factor in factors.items():
                if factor and figure(other, owner) in own and (line.source, figure(other, owner)) not in told:
                    found.append(BudgetLine(line.source, figure(other, owner), factor * line.size, AS_FORCE, line.cure))
    return found


def _thin(found: Any) -> float:
    """Twice the half-width of a line over the thickness of the thinnest wall behind it, at most 1; 0 of other
    patches."""
    walls = [
        body.reduced.provenance.get("contact_walls", {}).get(surface.name) or np.inf
        for body, surface in flexible_sides(found.view)
    ]
    if found.patch_kind not in ("line", "line_around") or not walls:
        return 0.0
    return min(2.0 * float(np.max(found.half_widths[:, 0])) / min(walls), 1.0)


def _of_machine(
    result: Any, lines: Sequence[BudgetLine], own: dict[str, Quantity], given: set[str]
) -> list[BudgetLine]:
    """Effects of the largest force error of a contact or film contact on joints, force elements,
    sensors, and lives, for each source without own estimates of them."""
    told, forces = {(line.source, line.of) for line in lines}, dict[str, BudgetLine]()
    for line in lines:
        if line.of.startswith("force of ") and line.found:
            if line.source not in forces or line.size > forces[line.source].size:
                forces[line.source] = line
    found = [
        BudgetLine(BALANCE, name, 0.0, "the loads give it")
        for name in own
        if kind_and_owner(name)[0].startswith("reaction") and kind_and_owner(name)[1] in given
    ]
    for source, line in forces.items():
        basis = f"as the {line.of} at most" if line.size else "the loads give the forces of contacts"
        for name in own:
            owner = kind_and_owner(name)[1]
            if (source, name) in told or owner in given:
                continue
            if owner.startswith(("joint", "force", "sensor")):
                part = max(min(_largest(own[name]) / own[name].size, 1.0), ASKEW)
                found.append(BudgetLine(source, name, part * line.size, basis, line.cure))
        for name in result.bearing_names:
            power = LIFE.get(result.view.bearings[name]["kind"], OF_ROLLERS)
            of = figure("life", f"bearing {name!r}")
            found.append(BudgetLine(source, of, power * line.size, f"{basis}, to the power {power:.3g}", line.cure))
    return found


def _why(name: str, result: Any) -> str:
    """The reason why no source covers the quantity."""
    kind, owner = kind_and_owner(name)
    if owner.startswith("film"):
        return "grid error: requires the film on a finer grid"
    if owner.startswith("contact") and kind in RUBBED:
        return "grid error of friction: requires another grid"
    if owner.startswith("contact"):
        return "grid error: requires another grid"
    if kind == WORK:
        return "grid error of micro-slip: requires other contact grids"
    if any(body.reduced is not None for body in result.history.scene.bodies):
        return "mesh error of bodies: requires other meshes"
    return "there is no second run to compare with"


@dataclass(frozen=True)
class Error:
    """Estimated error of one quantity, a fraction: all sources together, as independent ones, and the largest of them;
    NaN and "" if none is known. missing: why a source is not estimated, or "". share: as of `BudgetLine`."""

    size: float
    source: str
    missing: str
    share: float = 1.0

    def __str__(self) -> str:
        if not self.source:
            return ""
        return f"{100.0 * self.size:.2g} % ({self.source}{part_of(self.share)})"


def part_of(share: float) -> str:
    """The share of a `NEGLIGIBLE` deformation as text, else ""."""
    return f"; it has {share:.1g} of the motion and energy" if share < NEGLIGIBLE else ""


def errors(lines: Sequence[BudgetLine]) -> dict[str, dict[str, Error]]:
    """owner -> kind -> error of each quantity; the owner "" is the whole run."""
    found: dict[str, dict[str, list[BudgetLine]]] = {}
    for line in lines:
        kind, owner = kind_and_owner(line.of)
        found.setdefault(owner, {}).setdefault(kind, []).append(line)
    return {owner: {kind: _error(own) for kind, own in kinds.items()} for owner, kinds in found.items()}


def _error(lines: Sequence[BudgetLine]) -> Error:
    known, unknown = [line for line in lines if line.found], [line for line in lines if not line.found]
    missing = unknown[0].basis if unknown else ""
    if not known:
        return Error(np.nan, "", missing)
    return Error(total(known), max(known, key=lambda line: line.size).source, missing, known[0].share)


def error_text(kinds: Mapping[str, Error]) -> str:
    """The errors of the quantities of one owner, by kind, and those that are not estimated, with the reason."""
    told = [f"{kind} {error}" for kind, error in kinds.items() if error.source]
    missing: dict[str, list[str]] = {}
    for kind, error in kinds.items():
        if error.missing:
            missing.setdefault(error.missing, []).append(kind)
    text = [", ".join(told)] if told else []
    return "; ".join([*text, *(f"not estimated: {', '.join(own)} ({why})" for why, own in missing.items())])


def total(lines: Sequence[BudgetLine]) -> float:
    """Total of several lines of one quantity: root sum of squares of the largest of each source."""
    largest: dict[str, float] = {}
    for line in lines:
        largest[line.source] = max(largest.get(line.source, 0.0), line.size)
    return float(np.linalg.norm(list(largest.values())))
