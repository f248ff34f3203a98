"""The ledger of energies, the watch over it, and the rows that are saved."""

from __future__ import annotations

from warpffrf.online.step.launches import once, threads
from warpffrf.online.step.phases import Participant
from warpffrf_kernels.step import commit, energy_watch, ledger, record

LEDGER = Participant(
    "ledger",
    book=[threads(ledger.balance_energy)],
    watch=[threads(energy_watch.watch_energy)],
    close_row=[threads(record.close_row)],
    count=[once(commit.count_attempts)],
)
