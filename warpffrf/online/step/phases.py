"""Phases of a step, and the participants that add launches to them.

A participant names the launches that it adds to each phase; within a phase they follow the order of the participants.
The tests check the order of every program that they create (`tests/launch_order`), from what kernels read and write
according to their source: a scratch array that a launch reads or changes must be set by an earlier launch, unless it is
declared as `carried`, and within a phase nothing is read that a later launch overwrites. They also run scenes with
scratch filled with NaN between attempts (`tests/online/run/test_program.py`). Phase `commit` is for quantities with a
history, to which not every accepted attempt adds (`warpffrf_kernels.step.proximal`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import warp as wp

from warpffrf.online.step.launches import Launch

ATTEMPT = ("begin", "predict", "remember")
MOVE_AND_LOAD = ("move", "load")
CONTACT = ("locate", "shift", "cells", "displace", "close", "slide", "sum", "push")
EVALUATION = (*MOVE_AND_LOAD, *CONTACT)
JUDGEMENT = ("balance", "store", "mean", "unbalanced")
SOLUTION = (
    "assemble", "eliminate", "assemble_compliance", "condense", "solve_normal", "increase", "back_substitute",
    "displace", "correct", "solve_tangential",
    "increase_again", "recover", "advance",
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
"""Replaces a phase by another one if the scene has something."""
PHASES = tuple(dict.fromkeys(p for p in (*ATTEMPT, *ITERATION, *DECISION) if p not in REPEATED))


class Loop:
    """Launches that are repeated while the array `condition` is nonzero; it is set to one before."""

    def __init__(self, condition: str, body: Sequence[Launch | Loop]) -> None:
        self.condition, self.body = condition, list(body)


Part = Launch | Loop


class Participant:
    """A part of the step, present if the scene has `when`: launches by phase."""

    def __init__(self, name: str, when: str = "", **phases: Sequence[Part]) -> None:
        for phase in phases:
            if phase not in PHASES:
                raise TypeError(f"participant {name!r}: {phase!r} is no phase; choose from {', '.join(PHASES)}")
        self.name, self.when, self.phases = name, when, phases


Placed = tuple[tuple[str, ...], Part]
"""What the scene must have, and what is then launched."""


def collect(participants: Sequence[Participant], phase: str) -> list[Placed]:
    """All parts of a phase in the order of the participants."""
    of, needed = REPEATED.get(phase, (phase, ""))
    return [
        (tuple(name for name in (participant.when, needed) if name), part)
        for participant in participants
        for part in participant.phases.get(of, ())
    ]


def record(parts: Sequence[Placed], arrays: Mapping[Any, Any], sizes: Mapping[str, int], device: str) -> None:
    """Launch the parts that the scene has, or record them while a graph is being captured."""
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
    """The launches of a scene of these sizes, with loops expanded, and whether each is repeated by a loop."""
    for needs, part in parts:
        if not all(sizes[name] for name in needs):
            continue
        if isinstance(part, Loop):
            yield from ((inner, True) for inner, _ in launches([((), inner) for inner in part.body], sizes))
        elif part.present(sizes):
            yield part, False
