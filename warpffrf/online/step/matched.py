"""Small-sliding contacts: forces of their cells, loads on bodies and modes, tangents, and what a step stores."""

from __future__ import annotations

from warpffrf.online.step.launches import blocks, threads
from warpffrf.online.step.phases import Participant
from warpffrf_kernels.matched import history, retained, solve

MATCHED = Participant(
    "matched",
    when="matched_group",
    predict=[threads(solve.look_ahead, "matched_group")],
    load=[blocks(solve.solve_matched, "matched_group", matched_z_flat="matched_z"), threads(retained.push_matched)],
    assemble=[blocks(retained.stiffen_by_matched), threads(retained.turn_matched)],
    keep=[blocks(history.keep_matched, "matched_group")],
    commit=[blocks(history.commit_matched, "matched_group")],
    record=[threads(history.record_matched, "matched_cell")],
)
