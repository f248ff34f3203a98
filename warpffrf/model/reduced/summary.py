"""The readable summary of a reduced body: contents, provenance, and quality report."""

from __future__ import annotations

from typing import Any

import numpy as np

from warpffrf.model.reduced.data import ReducedBodyData
from warpffrf.model.reduced.inertia import InertiaTerms
from warpffrf.model.small_sliding import MatchedSurface

LARGEST_SHOWN = 3  # arrays named in the line about memory
SLOWEST_SHOWN = 4  # stages named in the line about time
LISTED_STAGE = 0.05  # of the total time; shorter stages are not named
ROUND_OFF = 1e-12  # of the size: coordinates below it are rounding and shown as zero


def summary(body: ReducedBodyData) -> str:
    """Lines about mass, modes, interfaces, contact surfaces, materials, the reduction path, and quality."""
    f = body.frequencies
    near = ROUND_OFF * float(np.ptp(body.surface.points, axis=0).max()) if len(body.surface.points) else 0.0
    lines = [
        f"reduced body {body.provenance.get('mesh_name') or '(unnamed)'}",
        f"  mass            {body.mass:.6g} kg, centre {_place(body.center_of_mass, near)} m",
        "  inertia         " + ", ".join(f"{v:.6g}" for v in np.diag(body.inertia)) + " kg m2 (diagonal)",
        *_materials(body.provenance.get("contact_materials", {})),
        f"  global modes    {len(f)}" + (f", {f[0]:.6g} to {f[-1]:.6g} Hz" if len(f) else ""),
        f"  local modes     {body.local_modes} (normal){_tangential(body)}",
    ]
    if (terms := body.inertia_terms) is not None:
        lines.append(f"  inertia terms   {_inertia_terms(body, terms, len(f))}")
    for name, i in body.interfaces.items():
        lines.append(f"  interface       {name}: {i.kind}, at {_place(i.point, near)} m")
    for name, s in body.contact_surfaces.items():
        g = s.grid
        length = g.pitch * (g.columns + 1)
        planar = s.shape.profile().planar
        part = f"a length of {length:.4g} m" if planar else f"an arc of {np.degrees(length):.4g} degrees"
        extent = "a full turn" if g.periodic else part
        lines.append(
            f"  contact surface {name}: {type(s.shape).__name__}, {g.columns} x {g.rows} {g.kind} on {extent}, "
            f"compliance {'block-circulant' if len(s.lags) > 1 else 'dense'}, {s.lags.nbytes / 2**20:.3g} MiB"
        )
        if (points := s.sampling) is not None:
            lines.append(
                f"  sampling        {name}: {points.count} points between two columns, worst training error "
                f"{points.training_error:.2g} (required {points.wanted_error:g})"
            )
    lines += [_matched(name, s) for name, s in body.matched.items()]
    lines.append(f"  skin            {len(body.surface.points)} points, {len(body.surface.triangles)} triangles")
    for key, label in (("path", "path"), ("path_reason", "because"), ("dofs", "FE dofs"), ("seconds", "seconds")):
        if key in body.report:
            value = body.report[key]
            lines.append(f"  {label:<15} {value:.3g}" if isinstance(value, float) else f"  {label:<15} {value}")
    lines.extend(quality_lines(body.report))
    for key in ("notes", "warnings"):
        lines.extend(f"  {key[:-1]}: {text}" for text in body.report.get(key, []))
    if digest := body.provenance.get("content_hash"):
        lines.append(f"  content hash    {digest[:16]}")
    return "\n".join(lines)


def quality_lines(report: dict[str, Any]) -> list[str]:
    """The quality report as indented lines; none for a body whose report has no quality."""
    q = report.get("quality")
    if not q:
        return []
    lines = ["  quality"]

    def say(label: str, text: str) -> None:
        lines.append(f"    {label:<13} {text}")

    say("frequencies", _covered(q["frequencies"]))
    for name, share in q["captured"].items():
        say(
            "captured",
            f"with {name} held: mass {_percentages(share['mass'])} (x, y, z), inertia {_percentages(share['inertia'])}",
        )
    residual = q["static"]["worst_load_residual"]
    say("unit loads", "worst residual " + ("not measured" if residual is None else f"{residual:.2g}"))
    if membrane := q.get("membrane"):
        say("membrane", _membrane(membrane))
    for name, share in q["static"]["local_share"].items():
        say("local share", f"{name}: global modes alone miss up to {share:.1%} of a load's own compliance")
    for name, grid in q["contact_grid"].items():
        if grid is None:
            say("contact grid", f"{name}: too few columns to judge")
        else:
            say(
                "contact grid",
                f"{name}: compliance error about {grid['error']:.2g} for a half-width of "
                f"{grid['half_width'] * 1e3:.4g} mm (spacing {grid['spacing'] * 1e3:.4g} mm; without the mesh's own)",
            )
    for name, c in report.get("contact", {}).items():
        ratios = [
            f"{label} {c[key]:.2g}"
            for key, label in (
                ("trace_ratio", "traces"),
                ("eigenvalue_ratio", "compliance"),
                ("residual_eigenvalue_ratio", "local modes"),
            )
            if c.get(key) is not None
        ]
        if ratios:
            say("conditioning", f"{name}: eigenvalue ratios of a window: {', '.join(ratios)}")
    names = list(report.get("contact", {}))
    for i, name in enumerate(names):
        coupled = report["contact"][name].get("coupling", {})
        if found := [f"{other} {coupled[other]:.2g}" for other in names[i + 1 :] if other in coupled]:
            say("coupling", f"local modes of {name} with those of {', '.join(found)} (1: as with their own)")
    dropped = report.get("dependent_directions_dropped", 0)
    say("conditioning", f"{dropped or 'no'} dependent direction{'s' * (dropped > 1)} among the global modes dropped")
    say("memory", _memory(q["memory"]))
    if stages := report.get("stage_seconds"):
        say("time", _stages(stages))
    for text in q["truncated"]:
        say("left out", text)
    return lines


def _place(point: np.ndarray, near: float) -> str:
    """Coordinates of a point; those nearer to zero than `near` [m] are zero."""
    return "(" + ", ".join(f"{v if abs(v) > near else 0.0:.6g}" for v in point) + ")"


def _materials(contact: dict[str, Any]) -> list[str]:
    """One line for each different material at the contact surfaces."""
    surfaces: dict[str, list[str]] = {}
    for name, m in contact.items():
        if m is None:
            text = "unknown, given by matrices"
        else:
            text = f"E {m['youngs_modulus']:.6g} Pa, nu {m['poisson_ratio']:g}, {m['density']:g} kg/m3"
            text = f"{m['name']}, {text}" if m.get("name") else text
        surfaces.setdefault(text, []).append(name)
    return [f"  material        at {', '.join(names)}: {text}" for text, names in surfaces.items()]


def _inertia_terms(body: ReducedBodyData, terms: InertiaTerms, modes: int) -> str:
    """The modes with inertia terms, whether these include the response to rotation, and what stiffens them."""
    text = f"of {'all' if terms.modes == modes else f'the first {terms.modes} of {modes}'} global modes"
    if body.report.get("inertia", {}).get("centrifugal"):
        text += ", with the static response to rotation"
    if terms.stiffening is None:
        return text
    text += f", stiffened by {', '.join(['rotation', *(f'loads on {n}' for n in terms.stiffening.interfaces)])}"
    forms = terms.stiffening.membrane
    return text if forms is None else f"{text}, membrane energy in {len(forms)} squares"


def _matched(name: str, s: MatchedSurface) -> str:
    """One line for the cells of a matched face."""
    text = f"  matched face    {name}: {s.cells} cells by {s.by}, edges {s.size[0]:.4g} to {s.size[1]:.4g} m"
    if not s.pair:
        return f"{text}, of a face"
    first, second = s.covered
    return f"{text}, on {first:.1%} and {second:.1%} of two faces, gap up to {s.distance[1]:.3g} m"


def _tangential(body: ReducedBodyData) -> str:
    """How many tangential local modes there are, where any are."""
    count = 0
    for s in body.contact_surfaces.values():
        tangential = getattr(s, "tangential", None)
        if tangential is not None:
            count += 2 * tangential.grid.columns * tangential.grid.rows
    return f" and {count} (tangential)" if count else ""


def _covered(f: dict[str, Any]) -> str:
    if f["covered"] is None:
        text = "no range is stated for this basis"
    elif not f["vibration_modes"]:
        text = "no vibration modes"
    else:
        counted = f"{f['vibration_modes']} vibration mode" + "s" * (f["vibration_modes"] != 1)
        text = (
            f"{counted}, {f['first']:.6g} to {f['last_vibration']:.6g} Hz; all of the "
            f"FE model up to {f['covered']:.6g} Hz"
        )
    asked = [] if f["max_frequency"] is None else [f"max_frequency {f['max_frequency']:.6g} Hz"]
    asked += [] if f["modes_asked"] is None else [f"modes {f['modes_asked']}"]
    return text + (f" (requested: {', '.join(asked)})" if asked else "")


def _membrane(m: dict[str, Any]) -> str:
    moved = f"; motion on {m['shapes']} shapes, error below {m['motion_left_out']:.2g} of the largest"
    if not m["rank"]:
        return f"no energy kept: motion relieves all but {1.0 - m['relieved']:.2g} of the second-order strain{moved}"
    return (
        f"{m['rank']} squares of {m['modes']} modes ({m['pairs']} products), error below {m['truncation']:.2g} of the "
        f"largest; counts from a strain of {m['bending_strain']:.2g} on{moved}"
    )


def _percentages(values: list[float]) -> str:
    # rounded down: 100 % is shown only for complete data
    return ", ".join(f"{np.floor(v * 1e4 + 1e-6) / 1e2:.2f}" for v in values) + "%"


def _memory(sizes: dict[str, int]) -> str:
    largest = [f"{path} {bytes_text(size)}" for path, size in list(sizes.items())[:LARGEST_SHOWN] if size]
    return f"{bytes_text(sum(sizes.values()))} in arrays; largest: {', '.join(largest)}"


def _stages(stages: dict[str, float]) -> str:
    total = sum(stages.values())
    order = sorted(stages.items(), key=lambda item: -item[1])[:SLOWEST_SHOWN]
    return ", ".join(f"{name} {s:.2g} s" for name, s in order if s >= LISTED_STAGE * total)


def bytes_text(size: int) -> str:
    """A number of bytes with a suitable unit."""
    value = float(size)
    for unit in ("B", "KiB", "MiB"):
        if value < 1024.0:
            return f"{value:.3g} {unit}"
        value /= 1024.0
    return f"{value:.3g} GiB"
