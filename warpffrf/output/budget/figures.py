r"""Every figure that a report prints, as a quantity of a run, and what an error of one is to another.

A figure is called "creepage of contact 'pair'": its kind, and whose it is. A source of error gives lines for figures by
these names. The force at a given approach is that of which most is known; what a part e of it is to other figures of a
pair follows from contact mechanics, F ~ d^n, n = 1.1 of lines (whose approach has a logarithm), 1.5 of points and 1 of
flat faces, a ~ F^(1/2), F^(1/3), and none. Of the approach a machine gives a part, from none to all: `SHARED` is
between. What joints, force elements and sensors say errs as the forces of contacts at most. Contacts and joints whose
forces the loads give (`balance`) have no error in these, and all of it in the approach.

A figure whose grid or mesh no source speaks of gets a line that says so.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from warpffrf.online.history.history import BudgetLine, History
from warpffrf.output.budget.balance import given_by_loads
from warpffrf.output.budget.quantities import LIGHT, Quantity, machine_size, quantities
from warpffrf.output.contact.cell_result import CellContactResult
from warpffrf.output.contact.result import ContactResult
from warpffrf.output.geometry.scene_view import SceneView

Array = np.ndarray
UNKNOWN = "not estimated"  # the source of a line of a figure that no source speaks of
WORK = "work of friction"  # of the whole run
BALANCE = "balance"  # of what the loads give
OF_TIME = ("time step", "energy ledger", "iteration")  # sources that say nothing of grids and meshes
ON_GRIDS = ("contact", "film")
AS_FORCE = "by what it is of the force"
EXPONENTS = {"line": 1.1, "line_around": 1.1, "point": 1.5, "flat": 1.0}  # of the approach in the force
WIDTHS = {"line": 0.5, "line_around": 0.5, "point": 1.0 / 3.0, "flat": 0.0}  # of the force in half-widths
RUBBED = ("friction power", "wear index", "creepage")
LIFE = {"ball": 3.0}  # of the load in a life; of rollers
OF_ROLLERS = 10.0 / 3.0
LEAST = 1e-14  # of any figure: below, sums of zeros
SORTS = {"reaction": "force", "load": "force", "reaction torque": "torque"}
ARM = 0.1  # of the size of the machine: torques are beside those of its forces with such arms at least
ASKEW = 0.12  # of a force's error in a torque that vanishes: meshes are not symmetric
SHARED = 0.3  # of the error of an approach at a given force: machines give forces, approaches, or neither
MAIN = (
    "force", "stiffness", "pressure", "motion", "deformation", "moment", "loss", "largest friction force",
    "all results", "energy at hand", "smallest gap", "largest pressure",
)  # fmt: skip


def figure(kind: str, owner: str) -> str:
    """The name of one."""
    return f"{kind} of {owner}"


def kind_and_owner(name: str) -> tuple[str, str]:
    """Its kind and whose it is, "" of the whole run."""
    kind, _, owner = name.partition(" of ")
    return (kind, owner) if name != WORK else (name, "")


def is_main(line: BudgetLine) -> bool:
    """Whether it is of a quantity that others follow from, such as forces and motions."""
    return line.source != UNKNOWN and kind_and_owner(line.of)[0] in MAIN


def figures(history: History, view: SceneView) -> dict[str, Quantity]:
    """By name all that are printed of a run, besides those of `quantities`, over their largest value, or over `LIGHT`
    of that of all of their kind, torques over forces with `ARM` of the machine; what is zero, or round-off, in all rows
    is left out."""
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
    """The largest length of its values."""
    return float(np.nan_to_num(np.linalg.norm(quantity.values, axis=1)).max(initial=0.0))


def pair_result(history: History, view: SceneView, name: str) -> Any:
    """The contact called `name` as a result has it."""
    pair = history.contacts[name]
    return (ContactResult if pair.cells is None else CellContactResult)(pair, view.pairs[name], history.bodies)


def _values(history: History, view: SceneView) -> Iterator[tuple[str, str, Any]]:
    """Kind, owner, and values (T, ...) of figures."""
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
    """`lines`, with what they are to other figures, and a line for each figure whose grid or mesh none speaks of."""
    history = result.history
    own = figures(history, result.view)
    own |= {name: q for name, q in quantities(history).items() if _is_force(q)}
    given = given_by_loads(result)
    found = [line for each in lines for line in _by_loads(each, given)]
    found += _of_pairs(result, found, own, given)
    found += _of_machine(result, found, own, given)
    lumped = {f"contact {name!r}" for name in history.lumped_contacts}
    exact = history.marks.static and not any(body.reduced for body in history.scene.bodies)  # but for its iteration
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
    """`line`; of a contact whose force the loads give it is one of the stiffness, and the force has none."""
    kind, owner = kind_and_owner(line.of)
    if kind != "force" or owner not in given or line.source in OF_TIME:
        return [line]
    return [replace(line, of=figure("stiffness", owner)), BudgetLine(line.source, line.of, 0.0, "the loads give it")]


def _of_pairs(result: Any, lines: Sequence[BudgetLine], own: dict[str, Quantity], given: set[str]) -> list[BudgetLine]:
    """What errors of the force of a contact at a given approach are to its other figures, of sources that do not say so
    themselves."""
    found, told = list[BudgetLine](), {(line.source, line.of) for line in lines}
    for name in result.history.contacts:
        owner = f"contact {name!r}"
        if figure("approach", owner) not in own:
            continue
        kind = result.contact(name).patch_kind
        factors = {"approach": 1.0 / EXPONENTS[kind]}
        if owner not in given:
            factors["approach"] *= SHARED
            factors |= {"half-widths": WIDTHS[kind], "peak pressure": WIDTHS[kind] if kind != "flat" else 1.0}
            factors["traction"] = 1.0
        elif figure("traction", owner) in own:
            found.append(BudgetLine(BALANCE, figure("traction", owner), 0.0, "the loads give it"))
        for line in lines:
            if line.of != figure("stiffness" if owner in given else "force", owner) or not line.found:
                continue
            for other, factor in factors.items():
                if factor and figure(other, owner) in own and (line.source, figure(other, owner)) not in told:
                    found.append(BudgetLine(line.source, figure(other, owner), factor * line.size, AS_FORCE, line.cure))
    return found


def _of_machine(
    result: Any, lines: Sequence[BudgetLine], own: dict[str, Quantity], given: set[str]
) -> list[BudgetLine]:
    """What the largest error of the force of a contact or film is to joints, force elements, sensors, and lives,
    of each source that does not say so itself."""
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
    """Why no source speaks of the figure."""
    kind, owner = kind_and_owner(name)
    if owner.startswith("film"):
        return "what its grid does, which takes the film on a finer one"
    if owner.startswith("contact") and kind in RUBBED:
        return "what its grid does to friction, which takes another one"
    if owner.startswith("contact"):
        return "what its grid does, which takes another one"
    if kind == WORK:
        return "what the grids of contacts do to micro-slip, which takes other ones"
    if any(body.reduced is not None for body in result.history.scene.bodies):
        return "what the meshes of bodies do, which takes other ones"
    return "the run has no second one to be held against"


def figure_text(lines: Sequence[BudgetLine]) -> list[tuple[str, str]]:
    """(owner, line of the report) of the figures that are printed: all sources together, as independent ones, and the
    largest; then what is not estimated, and why."""
    owners: dict[str, dict[str, list[BudgetLine]]] = {}
    for line in lines:
        kind, owner = kind_and_owner(line.of)
        owners.setdefault(owner, {}).setdefault(kind, []).append(line)
    found = []
    for owner, kinds in owners.items():
        told, missing = [], dict[str, list[str]]()
        for kind, own in kinds.items():
            known = [line for line in own if line.found]
            if unknown := [line for line in own if not line.found]:
                missing.setdefault(unknown[0].basis, []).append(kind)
            if not known:
                continue
            worst = max(known, key=lambda line: line.size)
            told.append(f"{kind} {100.0 * total(known):.2g} % ({worst.source})")
        text = [", ".join(told)] if told else []
        text += [f"not estimated: {', '.join(kinds)} ({why})" for why, kinds in missing.items()]
        found.append((owner, f"{owner or 'run'}: " + "; ".join(text)))
    return found


def total(lines: Sequence[BudgetLine]) -> float:
    """Of several lines of one figure, the largest of each source, the root of the sum of squares."""
    largest: dict[str, float] = {}
    for line in lines:
        largest[line.source] = max(largest.get(line.source, 0.0), line.size)
    return float(np.linalg.norm(list(largest.values())))
