"""The energy ledger, its monitoring, and the saved rows."""

from __future__ import annotations

from warpffrf.online.step.launches import blocks, once, threads
from warpffrf.online.step.phases import Participant
from warpffrf_kernels.step import energy_watch, ledger, record, step_control

LEDGER = Participant(
    "ledger",
    book=[blocks(ledger.balance_energy)],
    watch=[blocks(energy_watch.watch_energy)],
    close_row=[threads(record.close_row)],
    count=[once(step_control.count_attempts)],
)
