"""Scenes as FMUs (Functional Mock-up Units) for co-simulation: `write_fmu` packs one, `Instance` runs in it."""

from warpffrf.fmu.write import write_fmu

__all__ = ["write_fmu"]
