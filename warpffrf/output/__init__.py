"""Results, files, recordings and plots; `simulate` and `equilibrium` as users call them are in
`warpffrf.output.simulate`."""

from __future__ import annotations

from warpffrf.output.contact.cell_result import CellContactResult
from warpffrf.output.contact.result import ContactResult, HertzLine, PatchPressure
from warpffrf.output.result import Result

__all__ = ["CellContactResult", "ContactResult", "HertzLine", "PatchPressure", "Result"]
