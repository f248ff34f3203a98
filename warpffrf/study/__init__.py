"""Many runs of one scene: `speed_error` compares the computing time and the errors of settings, `sweep` runs the scene
at many values of its parameters, `warm_equilibrium` and `warm_up` repeat it until bodies and films have their
temperatures. The modules are loaded at first use."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from warpffrf.study.speed_against_error.study import speed_error
    from warpffrf.study.sweeps.outcome import open_sweep
    from warpffrf.study.sweeps.sweep import sweep
    from warpffrf.study.warm import WarmRun, warm_equilibrium, warm_up

__all__ = ["WarmRun", "open_sweep", "speed_error", "sweep", "warm_equilibrium", "warm_up"]

# public name -> module; packages must not have the names of their functions, or importing one would hide the other
_WHERE = {
    "WarmRun": "warpffrf.study.warm",
    "open_sweep": "warpffrf.study.sweeps.outcome",
    "speed_error": "warpffrf.study.speed_against_error.study",
    "sweep": "warpffrf.study.sweeps.sweep",
    "warm_equilibrium": "warpffrf.study.warm",
    "warm_up": "warpffrf.study.warm",
}


def __getattr__(name: str) -> Any:
    if name not in _WHERE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(_WHERE[name]), name)


def __dir__() -> list[str]:
    return __all__
