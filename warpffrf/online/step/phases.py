"""Phases of a step, the participants that put launches into them, and the check of the order.

A participant names the launches that it adds to each phase; within a phase they stand in the order of the participants.
The order is checked, not described: a scratch array that a launch reads, or changes, has to be set by one before it,
unless it is declared as `carried`, and within a phase nothing is read that is set anew after it. Phase `commit` is for
what remembers a history, which not every accepted attempt adds to (`warpffrf_kernels.step.proximal`). Whether
kernels mark rightly what they read, set and change is checked against their source (`tests/kernels/test_signatures.py`)
and with scratch that holds NaN between attempts (`tests/online/test_program.py`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import warp as wp

from warpffrf.online.step.launches import DECLARED, Launch
from warpffrf_kernels.core.declaration import Declaration

ATTEMPT = ("begin", "predict", "remember")
MOVE_AND_LOAD = ("move", "load")
CONTACT = ("locate", "few", "shift", "cells", "displace", "close", "slide", "sum", "push")
EVALUATION = (*MOVE_AND_LOAD, *CONTACT)
JUDGEMENT = ("balance", "store", "mean", "unbalanced")
SOLUTION = (
    "assemble", "eliminate", "respond", "condense", "press", "increase", "follow", "displace", "correct", "stick",
    "increase_again", "answer", "advance",
)  # fmt: skip
ITERATION = (*EVALUATION, *JUDGEMENT, *SOLUTION)
RECORD = ("measure", "record", "close_row")
DECISION = (
    "finish",
    "project",
    "estimate",
    "book",
    "judge",
    "decide",
    "keep",
    "commit",
    "restore",
    "watch",
    *RECORD,
    "count",
)
REPEATED = {"increase_again": ("increase", "friction_pair")}
"""A phase that is another one, where the scene has something."""
PHASES = tuple(dict.fromkeys(p for p in (*ATTEMPT, *ITERATION, *DECISION) if p not in REPEATED))


class Loop:
    """Launches that are repeated while the array `condition` is not zero; it is set to one before."""

    def __init__(self, condition: str, body: Sequence[Launch | Loop]) -> None:
        self.condition, self.body = condition, list(body)


Part = Launch | Loop


class Participant:
    """What takes part in a step where the scene has `when`: launches by phase."""

    def __init__(self, name: str, when: str = "", **phases: Sequence[Part]) -> None:
        for phase in phases:
            if phase not in PHASES:
                raise TypeError(f"participant {name!r}: {phase!r} is no phase; choose from {', '.join(PHASES)}")
        self.name, self.when, self.phases = name, when, phases


Placed = tuple[tuple[str, ...], Part]
"""What the scene must have, and what is launched then."""


def collect(participants: Sequence[Participant], phase: str) -> list[Placed]:
    """All parts of a phase in the order of the participants."""
    of, needed = REPEATED.get(phase, (phase, ""))
    return [
        (tuple(name for name in (participant.when, needed) if name), part)
        for participant in participants
        for part in participant.phases.get(of, ())
    ]


def record(parts: Sequence[Placed], arrays: Mapping[str, Any], sizes: Mapping[str, int], device: str) -> None:
    """Launch the parts that the scene has, or record them where a graph is being captured."""
    for needs, part in parts:
        if not all(sizes[name] for name in needs):
            continue
        if isinstance(part, Launch):
            if part.present(sizes):
                part.go(arrays, sizes, device)
        else:
            arrays[part.condition].fill_(1)
            body = [((), inner) for inner in part.body]
            wp.capture_while(arrays[part.condition], lambda body=body: record(body, arrays, sizes, device))


def launches(parts: Sequence[Placed], sizes: Mapping[str, int]) -> Iterator[tuple[Launch, bool]]:
    """The launches that a scene of these sizes has, loops opened, and whether each is repeated by a loop."""
    for needs, part in parts:
        if not all(sizes[name] for name in needs):
            continue
        if isinstance(part, Loop):
            yield from ((inner, True) for inner, _ in launches([((), inner) for inner in part.body], sizes))
        elif part.present(sizes):
            yield part, False


def complaints(
    phases: Sequence[tuple[str, Sequence[Placed]]],
    sizes: Mapping[str, int],
    declared: Mapping[str, Declaration] = DECLARED,
) -> list[str]:
    """What is wrong with the order in a scene of these sizes: launches that read what nothing has set before them."""
    placed = [(phase, list(launches(parts, sizes))) for phase, parts in phases]
    set_by_some = {name for _, here in placed for launch, _ in here for name in launch.written}
    known = {
        name
        for name, d in declared.items()
        if d.carried or 0 in d.shape(sizes) or (d.zero_without and name not in set_by_some)
    }
    found = []
    for phase, here in placed:
        read_here: dict[str, str] = {}
        for launch, repeated in here:
            needed = launch.changed | (launch.read - launch.written)
            for name in sorted(needed - known):
                does = "changes" if name in launch.changed else "reads"
                found.append(
                    f"phase {phase!r}: {launch.label} {does} {name}, which nothing has set before; put what sets it "
                    "into an earlier phase, or declare it as carried"
                )
            for name in sorted((launch.written - launch.read) & set(read_here)):
                if not declared[name].carried and not repeated:
                    found.append(
                        f"phase {phase!r}: {launch.label} sets {name} anew after {read_here[name]} has read it; give "
                        "them phases of their own"
                    )
            read_here |= {name: launch.label for name in launch.read - launch.written}
            known |= launch.written
    return list(dict.fromkeys(found))
