"""The arrangement of views of a recording: at most six at first sight, by what the machine has.

    left    the machine; below it close-ups of contacts and films (tabs), load zones of bearings and orbits of shafts
    right   colours; unwrapped patches and films (tabs); plots, those of contacts first, as many as remain of six

Everything else is in further tabs.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.output.plots.colors import LEAST, legend_rows
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
from warpffrf.output.recording.extent import ABOVE, ALONG, ASIDE, EYE, FRONT, UP, distance, length_text, seen_along
from warpffrf.output.recording.glyphs import triad

HEADROOM = 1.1  # of the largest value of a plot
CLOSE_UP_DISTANCE = 0.9  # eye to patch, in widths of the body
RUN_SECONDS, TURN_SECONDS, MOST_SECONDS = 12.0, 3.0, 60.0  # on the screen: a run at least, a turn, a run at most
MOST_PANELS, MOST_CURVES = 6, 4  # at first sight; of a plot with a legend
WIDE = 1.6  # width over height of the machine above other views
CORNERS = {"LeftTop": (0, 1), "RightTop": (1, 1), "LeftBottom": (0, 0), "RightBottom": (1, 0)}
CORNER = 0.45, 0.4  # part of a plot that a legend covers, along time and values


def blueprint(recorder: Any) -> Any:
    """The views, with tabs for the plots of the machine, friction, the solver and the explanations."""
    import rerun.blueprint as rrb

    result = recorder.result
    contacts = recorder.contacts
    arrows = ["+ /world/joint_arrows/**", "+ /world/force_arrows/**", "+ /world/lumped_arrows/**"]
    inner = {name for bearing in result.view.bearings.values() for name in bearing["contacts"].values()}
    forces = [f"+ {recorder.path('world', 'forces', c.name)}/**" for c in contacts if c.name not in inner]
    loaded = sorted(recorder.scenes, key=lambda scene: -float(scene.contact.force_magnitude.max(initial=0.0)))
    close_ups = [scene.view() for scene in recorder.gear_scenes]
    close_ups += [_close_up(recorder, scene, field) for scene in loaded for field in scene.fields]
    close_ups += [scene.close_up(field) for scene in recorder.film_scenes for field in scene.fields]
    close_ups += [scene.view(field) for scene in recorder.small_sliding_scenes for field in scene.fields]
    maps = [_map(scene, field) for scene in loaded for field in scene.fields]
    maps += [scene.map_view(field) for scene in recorder.film_scenes for field in scene.fields]
    zones, paths = [zone.view() for zone in recorder.load_zones], [orbit.view() for orbit in recorder.orbits]
    legends = [rrb.Spatial2DView(origin="/legend", name="Colours, fixed over the run")] if recorder.scales else []
    series = machine_series(result)
    machine_plots = [_plot(kind, title, _of_kind(series, kind)) for kind, title in plot_kinds(result).items()]
    of_contacts = [one for c in contacts for one in contact_series(c)]
    plots = [_plot(kind, title, _of_kind(of_contacts, kind)) for kind, title in CONTACT_PLOTS.items() if contacts]
    below = [*_tabs(close_ups), *_tabs(zones), *_tabs(paths)][: MOST_PANELS - 3]
    room = MOST_PANELS - 1 - len(below) - len(legends) - bool(maps)
    plots = [*plots, *machine_plots][:room] if len(result.time) > 1 else []
    rows = [rrb.Horizontal(*below)] if len(below) > 1 else below
    machine = _machine_view(recorder, forces or arrows, WIDE if rows else 1.0)
    left = rrb.Vertical(machine, *rows, row_shares=[5, 4] if rows else [1])
    shares = [1.0 + legend_rows(recorder.scales)] * len(legends) + [4.0] * bool(maps) + [2.5] * len(plots)
    right = rrb.Vertical(*legends, *_tabs(maps), *plots, row_shares=shares)
    solver = rrb.Grid(
        rrb.TimeSeriesView(
            origin="/solver/iterations", contents=["/solver/iterations", "/solver/factorisations"], name="Newton"
        ),
        rrb.TimeSeriesView(origin="/solver/active_nodes", name="Active nodes or cells"),
        rrb.TimeSeriesView(
            origin="/solver/energy_residual", name="Energy residual [-]", axis_y=_axis([result.energy_residual], 1.0)
        ),
        rrb.TimeSeriesView(origin="/solver/step_size", name="Step size [s]"),
        name="Solver",
    )
    overview = rrb.Horizontal(left, right, column_shares=[3, 2], name=_kind(recorder)) if shares else left
    return rrb.Blueprint(
        rrb.Tabs(
            overview,
            *_friction_tab(recorder),
            *_machine_tab(recorder, machine_plots, arrows),
            solver,
            rrb.TextDocumentView(origin="/about", name="What this shows"),
            active_tab=0,
        ),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline="time", loop_mode="all", playback_speed=_speed(result)),
        auto_views=False,
        auto_layout=False,
    )


def live_blueprint(recorder: Any, outputs: list[str]) -> Any:
    """The machine of a run that is stepped, and its outputs."""
    import rerun.blueprint as rrb

    legends = [rrb.Spatial2DView(origin="/legend", name="Colours")] if recorder.bodies else []
    plots = [
        rrb.TimeSeriesView(origin=f"/{recorder.path('plots', 'outputs', name).lstrip('/')}", name=name)
        for name in outputs[: MOST_PANELS - 2]
    ]
    panels = [rrb.Vertical(*legends, *plots)] if legends or plots else []
    return rrb.Blueprint(
        rrb.Horizontal(_machine_view(recorder, [], 1.0), *panels),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        rrb.TimePanel(state="collapsed", timeline="time", play_state="following"),
        auto_views=False,
        auto_layout=False,
    )


def _kind(recorder: Any) -> str:
    """Name of the first tab."""
    view = recorder.result.view
    if view.bearings or view.gears:
        return "Bearing" if view.bearings else "Gears"
    return (
        "Contact" if recorder.contacts else "Oil film" if view.films else "Joint" if view.small_sliding else "Machine"
    )


def _machine_view(recorder: Any, arrows: list[str], aspect: float = 1.0) -> Any:
    """All bodies, and arrows, in a view of a width over height."""
    import rerun.blueprint as rrb

    bodies = [recorder.path("world", name) for name in recorder.result.view.bodies]
    solids = [f"+ {recorder.rigid.path(name)}" for name in recorder.rigid.meshes]
    surfaces = [f"+ {recorder.path('world', name, 'surface')}" for name in recorder.bodies]
    frames = [f"{body}/frame" for body in bodies]
    drawn = "to scale" if recorder.factor == 1.0 else f"magnified {recorder.factor:g} times"
    return rrb.Spatial3DView(
        origin=recorder.path("world", EYE),
        contents=["+ /world/triad", *solids, *surfaces, *arrows, *[f"+ {frame}" for frame in frames]],
        name=f"Machine: elastic deformation{recorder.reference.words} {drawn}" if recorder.moves else "Machine",
        eye_controls=_machine_eye(recorder, aspect),
        overrides={frame: rrb.EntityBehavior(visible=False) for frame in frames},  # pyright: ignore[reportArgumentType]
        line_grid=False,
    )


def _machine_tab(recorder: Any, plots: list[Any], arrows: list[str]) -> list[Any]:
    """All plots of joints, forces and energies, with the machine if the first tab shows contacts."""
    import rerun.blueprint as rrb

    if not plots:
        return []
    name, grid = "Joints, forces, energies", rrb.Grid(*plots, name="Joints, forces, energies")
    return [rrb.Horizontal(_machine_view(recorder, arrows), grid, name=name) if recorder.contacts else grid]


def _plot(kind: str, title: str, curves: list[np.ndarray], size: float = 0.0) -> Any:
    """A plot of curves (T,), whose legend is in the emptiest corner, without one for a single and for many curves."""
    import rerun.blueprint as rrb

    shown = 1 < len(curves) <= MOST_CURVES
    legend = rrb.PlotLegend(_emptiest(curves), visible=True) if shown else rrb.PlotLegend(visible=False)
    return rrb.TimeSeriesView(origin=f"/plots/{kind}", name=title, axis_y=_axis(curves, size), plot_legend=legend)


def _emptiest(curves: list[np.ndarray]) -> Any:
    """The corner of a plot in which fewest points of the curves lie."""
    import rerun.blueprint as rrb

    seen = np.concatenate([v[np.isfinite(v)] for v in curves] or [np.zeros(0)])
    low, high = float(seen.min(initial=0.0)), float(seen.max(initial=0.0))

    def covered(right: int, top: int) -> int:
        count = 0
        for values in curves:
            x, y = np.linspace(0.0, 1.0, len(values)), (values - low) / ((high - low) or 1.0)
            x, y = (1.0 - x if right else x), (1.0 - y if top else y)
            count += int(np.sum((x < CORNER[0]) & (y < CORNER[1])))
        return count

    name = min(CORNERS, key=lambda corner: covered(*CORNERS[corner]))
    return getattr(rrb.Corner2D, name)


def _of_kind(series: list[Series], kind: str) -> list[np.ndarray]:
    """The curves in the plot of a kind."""
    return [values for path, _, values in series if path[:2] == ("plots", kind)]


def _axis(values: list[np.ndarray], size: float = 0.0) -> Any:
    """The scale of a plot: from zero, with headroom, where no value is negative, and where all vary by less than
    `LEAST` of their largest value, or of their possible `size`, which is round-off; else None, the viewer's."""
    import rerun.blueprint as rrb

    seen = np.concatenate([v[np.isfinite(v)] for v in values] or [np.zeros(0)])
    if not seen.size:
        return None
    low, high = float(seen.min()), float(seen.max())
    most = max(abs(low), abs(high), size)
    if most == 0.0 or (low < 0.0 and high - low >= LEAST * most):
        return None
    return rrb.ScalarAxis(range=(min(0.0, HEADROOM * low), max(HEADROOM * high, LEAST * most)))


def _tabs(views: list[Any]) -> list[Any]:
    import rerun.blueprint as rrb

    return views if len(views) <= 1 else [rrb.Tabs(*views)]


def _speed(result: Any) -> float:
    """Time of the run per time on the screen: slow enough to follow the body that turns fastest, within limits."""
    time = np.asarray(result.time, dtype=float)
    duration = float(time[-1] - time[0])
    speeds = [np.linalg.norm(m.angular_velocity, axis=1) for m in result.history.bodies.values()]
    turns = [np.trapezoid(np.nan_to_num(speed), time) / (2.0 * np.pi) for speed in speeds]
    seconds = min(max(RUN_SECONDS, TURN_SECONDS * max(turns, default=0.0)), MOST_SECONDS)
    return duration / seconds if duration > 0.0 else 1.0


def _machine_eye(recorder: Any, aspect: float) -> Any:
    """View from the front right, slightly above, or nearly along the axis of a bearing, of all bodies at all times."""
    import rerun.blueprint as rrb

    towards, up = FRONT, UP
    for zone in recorder.load_zones[:1]:
        right, up = seen_along(zone.bearing.axes[0][2])
        towards = ALONG * np.cross(right, up) + ASIDE * right + ABOVE * up
    origin, tips, _ = triad(recorder.outermost)
    away = distance(np.vstack([recorder.outermost, origin, tips]), towards, up, aspect) / recorder.radius
    place = away * towards / np.linalg.norm(towards)
    return rrb.EyeControls3D(position=place, look_target=(0.0, 0.0, 0.0), eye_up=tuple(up))


def _close_up(recorder: Any, scene: Any, field: str) -> Any:
    """Close-up of the patch in its own frame: the fixed view follows the patch."""
    import rerun.blueprint as rrb

    first = recorder.path("world", scene.contact.view.first_body.name)
    return rrb.Spatial3DView(
        origin=scene.world(EYE),
        contents=[f"+ {scene.world(relief_name(field))}", f"+ {scene.world('scale')}", f"+ {first}/surface"],
        name=f"{_titled(recorder, scene, field)}, the bar is {length_text(scene.bar)}",
        eye_controls=rrb.EyeControls3D(
            position=CLOSE_UP_DISTANCE * np.array([0.75, -0.45, 0.5]), look_target=(0.0, 0.0, 0.0),
            eye_up=(0.0, 0.0, 1.0),
        ),
        line_grid=False,
    )  # fmt: skip


def _titled(recorder: Any, scene: Any, field: str) -> str:
    """Title of a view, with the contact's name if there are several."""
    return TITLES[field] + (f" '{scene.contact.name}'" if len(recorder.scenes) > 1 else "")


def _map(scene: Any, field: str) -> Any:
    """One field on the unwrapped patch."""
    import rerun.blueprint as rrb

    arrows = [f"+ {scene.map('traction_arrows')}"] if field == "traction" else []
    return rrb.Spatial2DView(
        origin=scene.map(),
        contents=[f"+ {scene.map('axes')}", f"+ {scene.map(field)}", *arrows],
        name=f"{_titled(scene.recorder, scene, field)}, unwrapped patch",
    )


def _friction_tab(recorder: Any) -> list[Any]:
    """Maps of traction and state side by side, and the histories of friction."""
    import rerun.blueprint as rrb

    scenes = [scene for scene in recorder.scenes if scene.contact.has_friction]
    if not scenes:
        return []
    maps = [_tabs([_map(scene, field) for scene in scenes]) for field in ("traction", "state")]
    series = [one for scene in scenes for one in contact_series(scene.contact)]
    most = [full_slip(scene.contact) for scene in scenes]
    plots = [
        _plot(kind, title, _of_kind(series, kind), max(sizes.get(kind, 0.0) for sizes in most))
        for kind, title in FRICTION_PLOTS.items()
    ]
    legend = rrb.Spatial2DView(origin="/legend", name="Colours, fixed over the run")
    left = rrb.Vertical(legend, *[view for views in maps for view in views], row_shares=[2, *[3] * len(maps)])
    return [rrb.Horizontal(left, rrb.Grid(*plots, grid_columns=2), column_shares=[2, 3], name="Friction")]
