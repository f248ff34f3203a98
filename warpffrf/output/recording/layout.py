"""The arrangement of views that a recording opens with."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.geometry.places import rotate
from warpffrf.output.plots.colors import LEAST, largest, legend_rows
from warpffrf.output.plots.friction import full_slip
from warpffrf.output.recording.contact_scene import (
    CONTACT_PLOTS,
    FRICTION_PLOTS,
    TITLES,
    Series,
    contact_series,
    machine_series,
    plot_kinds,
    relief_name,
)

HEADROOM = 1.1  # of the largest value of a plot
CLOSE_UP_DISTANCE = 0.9  # eye to patch, in widths of the body
PLAYBACK_SECONDS = 12.0  # how long the viewer takes to play a run, however short the run
MOST_PLOTS = 4  # beside the machine; all are in a tab of their own


def blueprint(recorder: Any) -> Any:
    """Machine and close-up on the left; legend, patch map and plots on the right; tabs for the plots of the machine,
    the solver and the explanations."""
    import rerun.blueprint as rrb

    result = recorder.result
    duration = float(result.time[-1] - result.time[0])
    bodies = [f"+ {recorder.path('world', name)}/**" for name in result.view.bodies]
    bodies += [f"+ {path}" for path in recorder.shapes.paths()]
    forces = [f"+ {recorder.path('world', 'forces', c.name)}/**" for c in recorder.contacts]
    arrows = ["+ /world/joint_arrows/**", "+ /world/force_arrows/**", "+ /world/lumped_arrows/**"]
    rigid = [recorder.path("world", name) for name, body in result.view.bodies.items() if body.reduced is None]
    hidden = [f"- {path}/{shape}" for path in rigid for shape in ("box", "bars")]
    # what touches comes first; rigid bodies and arrows of joints then have a view of their own
    contents = [*bodies, *forces, *hidden] if recorder.contacts else [*bodies, *arrows]
    machine = _machine_view(recorder, contents)
    close_ups = [_close_up(recorder, scene, field) for scene in recorder.scenes for field in scene.fields]
    close_ups += [scene.view(field) for scene in recorder.small_sliding_scenes for field in scene.fields]
    maps = [_map(scene, field) for scene in recorder.scenes for field in scene.fields]
    contacts = recorder.contacts
    series = machine_series(result)
    machine_plots = [
        rrb.TimeSeriesView(origin=f"/plots/{kind}", name=title, axis_y=_axis(_of_kind(series, kind)))
        for kind, title in plot_kinds(result).items()
    ]
    plots = (
        machine_plots[:MOST_PLOTS]
        if not contacts
        else [
            _from_zero("force", [c.force_magnitude * 1e-3 for c in contacts]),
            _from_zero("peak_pressure", [c.peak_pressure * 1e-6 for c in contacts]),
            _from_zero("half_width", [_widths(c) * 1e6 for c in contacts]),
        ]
    )
    legend = rrb.Spatial2DView(origin="/legend", name="Colours, fixed over the run", background=[255, 255, 255, 255])
    legends = [legend] if recorder.scales else []
    left = rrb.Vertical(machine, *_tabs(close_ups), row_shares=[5, 4] if close_ups else [1])
    shares = [1.0 + legend_rows(recorder.scales)] * len(legends) + [4.0] * bool(maps) + [2.5] * len(plots)
    right = rrb.Vertical(*legends, *_tabs(maps), *plots, row_shares=shares)
    solver = rrb.Grid(
        rrb.TimeSeriesView(
            origin="/solver/iterations", contents=["/solver/iterations", "/solver/factorisations"], name="Newton"
        ),
        rrb.TimeSeriesView(origin="/solver/active_hats", name="Active hats or cells"),
        rrb.TimeSeriesView(
            origin="/solver/energy_residual", name="Energy residual [-]", axis_y=_axis([result.energy_residual], 1.0)
        ),
        rrb.TimeSeriesView(origin="/solver/step_size", name="Step size [s]"),
        name="Solver",
    )
    return rrb.Blueprint(
        rrb.Tabs(
            rrb.Horizontal(left, right, column_shares=[3, 2], name="Contact" if contacts else "Machine"),
            *_friction_tab(recorder),
            *_machine_tab(recorder, machine_plots, [*bodies, *arrows]),
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


def _machine_view(recorder: Any, contents: list[str]) -> Any:
    import rerun.blueprint as rrb

    return rrb.Spatial3DView(
        origin="/world",
        contents=["+ /world", *contents],
        name=f"Machine: elastic deformation magnified {recorder.factor:g} times" if recorder.bodies else "Machine",
        eye_controls=_machine_eye(recorder),
        line_grid=False,
    )


def _machine_tab(recorder: Any, plots: list[Any], contents: list[str]) -> list[Any]:
    """All plots of joints, forces and energies; beside them, where the first tab is about contact, the machine."""
    import rerun.blueprint as rrb

    if not plots:
        return []
    name, grid = "Joints, forces, energies", rrb.Grid(*plots, name="Joints, forces, energies")
    return [rrb.Horizontal(_machine_view(recorder, contents), grid, name=name) if recorder.contacts else grid]


def _from_zero(kind: str, values: list[np.ndarray]) -> Any:
    """A plot of a kind of `CONTACT_PLOTS` whose scale starts at zero, so that round-off does not look like a signal."""
    import rerun.blueprint as rrb

    top = largest(values)
    axis = rrb.ScalarAxis(range=(0.0, HEADROOM * top)) if top > 0.0 else None
    return rrb.TimeSeriesView(origin=f"/plots/{kind}", name=CONTACT_PLOTS[kind], axis_y=axis)


def _of_kind(series: list[Series], kind: str) -> list[np.ndarray]:
    """The curves in the plot of a kind."""
    return [values for path, _, values in series if path[:2] == ("plots", kind)]


def _axis(values: list[np.ndarray], size: float = 0.0) -> Any:
    """The scale of a plot whose curves move by less than `LEAST` of their largest value, or of the `size` that they may
    have: round-off; None, the viewer's, of others."""
    import rerun.blueprint as rrb

    seen = np.concatenate([v[np.isfinite(v)] for v in values] or [np.zeros(0)])
    if not seen.size:
        return None
    low, high = float(seen.min()), float(seen.max())
    least = LEAST * max(abs(low), abs(high), size)
    middle = 0.5 * (low + high)
    return rrb.ScalarAxis(range=(middle - 0.5 * least, middle + 0.5 * least)) if high - low < least else None


def _tabs(views: list[Any]) -> list[Any]:
    import rerun.blueprint as rrb

    return views if len(views) <= 1 else [rrb.Tabs(*views)]


def _speed(duration: float) -> float:
    return duration / PLAYBACK_SECONDS if duration > 0.0 else 1.0


def _machine_eye(recorder: Any) -> Any:
    """From the front right, a little above, far enough to see every body all the time."""
    import rerun.blueprint as rrb

    result = recorder.result
    centers = np.concatenate(
        [
            motion.position + np.stack([rotate(p, body.center_of_mass[None])[0] for p in motion.rotation])
            for motion, body in zip(result.history.bodies.values(), result.view.bodies.values(), strict=True)
        ]
    )
    centers = centers[np.all(np.isfinite(centers), axis=1)]
    low, high = (centers.min(axis=0), centers.max(axis=0)) if len(centers) else (np.zeros(3), np.zeros(3))
    center = 0.5 * (low + high)
    reach = recorder.size + 0.5 * float(np.linalg.norm(high - low))
    return rrb.EyeControls3D(
        position=center + reach * np.array([0.55, -1.3, 0.45]), look_target=center, eye_up=(0.0, 0.0, 1.0)
    )


def _close_up(recorder: Any, scene: Any, field: str) -> Any:
    """The patch seen in its own frame: the eye is fixed there, so it follows the patch."""
    import rerun.blueprint as rrb

    contact, window = scene.contact, scene.window
    first = recorder.path("world", contact.view.first_body.name)
    distance = CLOSE_UP_DISTANCE * max(window.high - window.low, 4.0 * window.reach)
    return rrb.Spatial3DView(
        origin=scene.world(),
        contents=[f"+ {scene.world(relief_name(field))}", f"+ {first}/**", f"- {first}/frame"],
        name=f"{_titled(recorder, scene, field)}: close-up following the patch on '{contact.view.first_body.name}'",
        eye_controls=rrb.EyeControls3D(
            position=distance * np.array([0.75, -0.45, 0.5]), look_target=(0.0, 0.0, 0.0), eye_up=(0.0, 0.0, 1.0)
        ),
        line_grid=False,
    )


def _titled(recorder: Any, scene: Any, field: str) -> str:
    """What a view shows, and of which pair where there are several."""
    return TITLES[field] + (f" '{scene.contact.name}'" if len(recorder.scenes) > 1 else "")


def _map(scene: Any, field: str) -> Any:
    """One field on the unwrapped patch."""
    import rerun.blueprint as rrb

    arrows = [f"+ {scene.map('traction_arrows')}"] if field == "traction" else []
    return rrb.Spatial2DView(
        origin=scene.map(),
        contents=[f"+ {scene.map('axes')}", f"+ {scene.map(field)}", *arrows],
        name=f"{_titled(scene.recorder, scene, field)}, unwrapped patch",
        background=[255, 255, 255, 255],
    )


def _friction_tab(recorder: Any) -> list[Any]:
    """Maps of traction and state beside each other, and the histories of friction."""
    import rerun.blueprint as rrb

    scenes = [scene for scene in recorder.scenes if scene.contact.has_friction]
    if not scenes:
        return []
    maps = [_tabs([_map(scene, field) for scene in scenes]) for field in ("traction", "state")]
    series = [one for scene in scenes for one in contact_series(scene.contact)]
    most = [full_slip(scene.contact) for scene in scenes]
    plots = [
        rrb.TimeSeriesView(
            origin=f"/plots/{kind}", name=title,
            axis_y=_axis(_of_kind(series, kind), max(sizes.get(kind, 0.0) for sizes in most)),
        )
        for kind, title in FRICTION_PLOTS.items()
    ]  # fmt: skip
    legend = rrb.Spatial2DView(origin="/legend", name="Colours, fixed over the run", background=[255, 255, 255, 255])
    left = rrb.Vertical(legend, *[view for views in maps for view in views], row_shares=[2, *[3] * len(maps)])
    return [rrb.Horizontal(left, rrb.Grid(*plots, grid_columns=2), column_shares=[2, 3], name="Friction")]


def _widths(contact: Any) -> np.ndarray:
    """The half-widths that are plotted."""
    return contact.half_widths if contact.patch_kind == "point" else contact.half_width
