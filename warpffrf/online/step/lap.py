"""Small-sliding contacts: forces of their cells, loads on bodies and modes, tangents, and what a step stores."""

from __future__ import annotations

from warpffrf.online.step.launches import blocks, threads
from warpffrf.online.step.phases import Participant
from warpffrf_kernels.laps import keeping, retained, solve

LAP = Participant(
    "laps",
    when="lap_group",
    predict=[threads(solve.look_ahead, "lap_group")],
    load=[blocks(solve.solve_laps, "lap_group", lap_z_flat="lap_z"), threads(retained.push_laps)],
    assemble=[blocks(retained.stiffen_by_laps), threads(retained.turn_laps)],
    keep=[blocks(keeping.keep_laps, "lap_group")],
    commit=[blocks(keeping.commit_laps, "lap_group")],
    record=[threads(keeping.record_laps, "lap_cell")],
)
