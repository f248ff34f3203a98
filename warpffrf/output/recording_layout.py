"""The arrangement of views that a recording opens with."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.frames import largest

HEADROOM = 1.1  # of the largest value of a plot
CLOSE_UP_DISTANCE = 0.9  # eye to patch, in widths of the body


def blueprint(recorder: Any) -> Any:
    """Machine and close-up on the left; legend, patch map and plots on the right; tabs for the solver and the
    explanations."""
    import rerun.blueprint as rrb

    result = recorder.result
    duration = float(result.time[-1] - result.time[0])
    forces = [f"+ {recorder.path('world', 'forces', c.name)}/**" for c in recorder.contacts]
    surfaces = [f"+ {recorder.path('world', name)}/**" for name in result.view.bodies]
    machine = rrb.Spatial3DView(
        origin="/world",
        contents=["+ /world", *surfaces, *forces],
        name=f"Machine: elastic deformation magnified {recorder.factor:g} times",
        eye_controls=_machine_eye(recorder),
        line_grid=False,
    )
    close_ups = [_close_up(recorder, contact) for contact in recorder.contacts]
    maps = [
        rrb.Spatial2DView(
            origin=recorder.path("patch_map", c.name),
            name=f"Pressure on the unwrapped patch '{c.name}'",
            background=[255, 255, 255, 255],
        )
        for c in recorder.contacts
    ]
    contacts = recorder.contacts
    plots = [
        _from_zero("/plots/force", "Contact force [kN]", [c.force_magnitude * 1e-3 for c in contacts]),
        _from_zero("/plots/peak_pressure", "Largest pressure [MPa]", [c.peak_pressure * 1e-6 for c in contacts]),
        _from_zero("/plots/half_width", "Half-width of the patch [µm]", [c.half_width * 1e6 for c in contacts]),
    ]
    legend = rrb.Spatial2DView(origin="/legend", name="Colours, fixed over the run", background=[255, 255, 255, 255])
    left = rrb.Vertical(machine, *_tabs(close_ups), row_shares=[5, 4] if close_ups else [1])
    right = rrb.Vertical(legend, *_tabs(maps), *plots, row_shares=[3, *([4] if maps else []), 2.5, 2.5, 2.5])
    solver = rrb.Grid(
        rrb.TimeSeriesView(
            origin="/solver/iterations", contents=["/solver/iterations", "/solver/factorisations"], name="Newton"
        ),
        rrb.TimeSeriesView(origin="/solver/active_modes", name="Active stress modes"),
        rrb.TimeSeriesView(origin="/solver/energy_residual", name="Energy residual [-]"),
        rrb.TimeSeriesView(origin="/solver/step_size", name="Step size [s]"),
        name="Solver",
    )
    return rrb.Blueprint(
        rrb.Tabs(
            rrb.Horizontal(left, right, column_shares=[3, 2], name="Contact"),
            solver,
            rrb.TextDocumentView(origin="/about", name="What this shows"),
            active_tab=0,
        ),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline="time", loop_mode="all", playback_speed=_speed(duration)),
        auto_views=False,
        auto_layout=False,
    )


def _from_zero(origin: str, name: str, values: list[np.ndarray]) -> Any:
    """A plot whose scale starts at zero, so that round-off does not look like a signal."""
    import rerun.blueprint as rrb

    top = largest(values)
    axis = rrb.ScalarAxis(range=(0.0, HEADROOM * top)) if top > 0.0 else None
    return rrb.TimeSeriesView(origin=origin, name=name, axis_y=axis)


def _tabs(views: list[Any]) -> list[Any]:
    import rerun.blueprint as rrb

    return views if len(views) <= 1 else [rrb.Tabs(*views)]


def _speed(duration: float) -> float:
    from warpffrf.output.recorder import PLAYBACK_SECONDS

    return duration / PLAYBACK_SECONDS if duration > 0.0 else 1.0


def _machine_eye(recorder: Any) -> Any:
    """From the front right, a little above, far enough to see every body in the first row."""
    import rerun.blueprint as rrb

    positions = np.stack([m.position[0] for m in recorder.result.history.bodies.values()])
    positions = positions[np.all(np.isfinite(positions), axis=1)]
    center = positions.mean(axis=0) if len(positions) else np.zeros(3)
    reach = recorder.size + (float(np.linalg.norm(positions - center, axis=1).max()) if len(positions) else 0.0)
    return rrb.EyeControls3D(
        position=center + reach * np.array([0.55, -1.3, 0.45]), look_target=center, eye_up=(0.0, 0.0, 1.0)
    )


def _close_up(recorder: Any, contact: Any) -> Any:
    """The patch seen in its own frame: the eye is fixed there, so it follows the patch."""
    import rerun.blueprint as rrb

    origin = recorder.path("world", "contacts", contact.name)
    first = recorder.path("world", contact.view.first_body.name)
    z = np.asarray(contact.view.first.grid.z)
    distance = CLOSE_UP_DISTANCE * max(float(z[-1] - z[0]), 4.0 * recorder.patch_reach(contact))
    return rrb.Spatial3DView(
        origin=origin,
        contents=["+ $origin/**", f"+ {first}/**", f"- {first}/frame"],
        name=f"Close-up following the patch on '{contact.view.first_body.name}': height and colour = pressure",
        eye_controls=rrb.EyeControls3D(
            position=distance * np.array([0.75, -0.45, 0.5]), look_target=(0.0, 0.0, 0.0), eye_up=(0.0, 0.0, 1.0)
        ),
        line_grid=False,
    )
