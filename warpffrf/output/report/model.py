"""What a run modelled, as entries of one sentence each: bodies, and the items between them, as `Scene.describe` gives
them, with similar ones grouped. Numbers are in SI units."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from warpffrf.model.messages.reprs import names
from warpffrf.output.geometry.scene_view import BodyView, SceneView
from warpffrf.output.report.fold import Entry, Figure, Pairs, folded

KINDS = {
    "joints": "joint", "drives": "drive", "forces": "force", "contacts": "contact",
    "lumped_contacts": "lumped contact", "films": "film",
}  # fmt: skip
PORTS = ("a", "b", "port", "joint")  # keys that say where an item acts
SIGNAL = ("breaks", "coefficients")  # keys of a piecewise polynomial
ASIDE = ("name", "kind", "type", *PORTS)
MOST = 6  # numbers that are listed
ROUND_OFF = 1e-14  # m, and of other quantities: smaller numbers are zero
AXES = ("axis_point", "axis_direction")  # of a surface, in the frame of the body
OF_BODIES = ("position", "velocity", "angular_velocity")  # stated where they are not zero


def modelled(view: SceneView, pairs: Pairs = "folded") -> list[Entry]:
    """An entry for each body, bearing and item of the scene of a run. pairs: as of a report."""
    said = {body["name"]: body for body in view.description.get("bodies", ())}
    entries = [Entry("body", (name,), _body(body, said.get(name, {}))) for name, body in view.bodies.items()]
    for name, bearing in view.bearings.items():
        text = f"{bearing['kind']} bearing, {_facts(bearing['geometry'])}"
        entries.append(Entry("bearing", (name,), [Figure("", text, inline=True)]))
    for where, kind in KINDS.items():
        for item in view.description.get(where, ()):
            entries.append(Entry(kind, (item["name"],), [Figure("", item_text(item), inline=True)]))
    return folded(entries, pairs)


def _body(body: BodyView, said: Mapping[str, Any]) -> list[Figure]:
    parts = ["rigid" if body.reduced is None else "flexible", f"{body.mass:.6g} kg"]
    if body.reduced is not None:
        size = " x ".join(f"{x:.4g}" for x in np.ptp(body.reduced.surface.points, axis=0))
        mesh = body.reduced.provenance.get("mesh_name")
        parts += [f"{size} m", f"{len(body.reduced.frequencies)} global and {body.reduced.local_modes} local modes"]
        parts += [f"mesh '{mesh}'"] if mesh else []
    alike: dict[str, list[str]] = {}
    for name, shape in body.shapes.items():
        said_of = {key: value for key, value in shape.describe().items() if key not in AXES}
        alike.setdefault(_text(said_of), []).append(name)
    parts += [f"{'surface' if len(own) == 1 else 'surfaces'} {names(own)}: {text}" for text, own in alike.items()]
    parts += [f"{_words(key)} {_text(said[key])}" for key in OF_BODIES if np.any(said.get(key, 0.0))]
    return [Figure("", ", ".join(parts), inline=True)]


def item_text(item: Mapping[str, Any]) -> str:
    """The kind of an item, the places where it acts, and its numbers."""
    kind = [_words(item["kind"])] if "kind" in item else []
    places = [_place(item[key]) for key in PORTS if item.get(key)]
    where = [f"on {' and '.join(places)}"] if places else []
    return ", ".join(part for part in (" ".join([*kind, *where]), _facts(item)) if part)


def _facts(item: Mapping[str, Any]) -> str:
    """Keys and values, without what is not given."""
    if {*item} > {*SIGNAL}:
        return f"{_facts({key: value for key, value in item.items() if key not in SIGNAL})}, {_signal(item)}"
    shown = {key: value for key, value in item.items() if key not in ASIDE and not _is_empty(value)}
    return ", ".join(f"{_words(key)} {_text(value)}" for key, value in shown.items())


def _place(port: Any) -> str:
    """A port, surface or joint in words."""
    if isinstance(port, str):
        return f"'{port}'"
    if not isinstance(port, Mapping):
        return f"{port[0]}['{port[1]}']"
    point = port.get("point")
    if port.get("interface"):
        return f"{port['body']}['{port['interface']}']"
    return f"{port['body']} at {_text(point)}" if point is not None and np.any(point) else str(port["body"])


def _text(value: Any) -> str:
    """A value of a description in words."""
    if isinstance(value, Mapping):
        if {*value} == {*SIGNAL}:
            return _signal(value)
        kind, facts = _words(str(value.get("kind", ""))), _facts(value)
        return f"{kind} ({facts})" if kind and facts else kind or f"({facts})"
    if _is_number(value):
        return f"{0.0 if abs(value) < ROUND_OFF else value:.6g}"
    if isinstance(value, str) or not isinstance(value, Sequence):
        return str(value)
    if len(value) > MOST and all(_is_number(v) for v in value):
        return f"{len(value)} numbers"
    return f"({', '.join(_text(v) for v in value)})"


def _signal(signal: Mapping[str, Any]) -> str:
    """A piecewise polynomial: its value, or its range at its breaks."""
    pieces = np.asarray(signal["coefficients"], dtype=float)
    if not np.any(pieces[:, 1:]) and np.ptp(pieces[:, 0]) == 0.0:
        return _text(float(pieces[0, 0]))
    low, high = pieces[:, 0].min(), pieces[:, 0].max()
    return f"varying in time, {low:.6g} to {high:.6g} at its {len(pieces)} breaks"


def _is_empty(value: Any) -> bool:
    return value is None or (isinstance(value, Sequence | Mapping) and all(v is None for v in value))


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _words(key: str) -> str:
    return key.replace("_", " ")
