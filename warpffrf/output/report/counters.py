"""Lines of the report on how the solver did: what it counted, in words that need no knowledge of it.

Keys of `History.counters` stay as they are; this is how a report says them. What counts events that a run may do
without, such as steps that were halved, is told where there were any.
"""

from __future__ import annotations

from typing import Any

TOLD = {  # name of a counter -> its words in a report, of a number that is always told
    "steps": "steps",
    "build_seconds": "preparation [s]",
    "loop_seconds": "time stepping [s]",
    "finish_seconds": "evaluation [s]",
    "outer_columns": "other unknowns",
}
EXPLAINED = {  # what these words mean
    "build_seconds": "with kernels that were compiled or loaded",
    "seconds_in_graph": "kernels alone",
    "outer_columns": "solved for together: 6 a body, modes that couple, one a held direction",
}
IN_BRACKETS = {"loop_seconds": "seconds_in_graph"}
WHERE_THERE = {  # told where they are not zero
    "rejected_steps": "halved steps",
    "coarse_steps": "coarse steps",
    "repeated_steps": "repeated steps",
    "impulsive_steps": "impulsive steps",
    "forgetful_steps": "implicit steps",
    "dense_fallbacks": "dense solves",
}
MEANINGS = {
    "rejected_steps": "taken again in halves",
    "coarse_steps": "less accurate than asked for, and as short as steps may be",
    "repeated_steps": "taken again as impacts",
    "impulsive_steps": "with an impact",
    "forgetful_steps": "by implicit Euler, where friction or a pretension changes over",
    "dense_fallbacks": "where the sparse solver met a pivot too small",
}
IN_NEWTON = {"max_iterations", "mean_iterations"}


def counter_lines(history: Any) -> list[str]:
    """One line a counter."""
    counters = history.counters
    lines, brackets = [], set(IN_BRACKETS.values())
    if len(history.iterations) > 1:
        every_step = counters.get("steps", 0) <= len(history.iterations) - 1  # else rows sum over steps
        lines.append(
            f"newton            mean {history.iterations[1:].mean():.2f}, "
            f"largest {int(history.iterations[1:].max())} iterations a {'step' if every_step else 'saved row'}"
        )
    for name, value in counters.items():
        if name in brackets or (name in IN_NEWTON and lines) or (name in WHERE_THERE and not value):
            continue
        words = TOLD.get(name) or WHERE_THERE.get(name) or name.replace("_", " ")
        meaning = EXPLAINED.get(name) or MEANINGS.get(name, "")
        if (inner := IN_BRACKETS.get(name, "")) in counters:
            meaning = f"{counters[inner]:.6g} of them {EXPLAINED[inner]}"
        lines.append(f"{words:<17} {value:.6g}" + (f", {meaning}" if meaning else ""))
    return lines
