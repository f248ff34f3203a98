"""The small scenes launch every kernel between them: what the bounds-checked run (`test_bounds`) rests on."""

from __future__ import annotations

from small_scenes import CASES
from test_signatures import KERNELS

from warpffrf.online import Engine
from warpffrf.online.local_modes import as_local_modes


def test_no_kernel_is_left_out() -> None:
    launched = set()
    for case in CASES.values():
        scene = case.build()
        if not scene.bodies:
            continue  # made where it is run
        options = {name: case.options[name] for name in ("integrator", "step_error") if name in case.options}
        local = as_local_modes(case.options.get("local_modes", "quasi_static"))
        engine = Engine(scene, local_modes=local, **options)
        launched |= {launch.kernel for launch in engine.graph.program.launches()}
    left_out = sorted(name for name, kernel in KERNELS.items() if kernel not in launched)
    assert not left_out, f"no scene of small_scenes launches {', '.join(left_out)}"
