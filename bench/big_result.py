"""Memory and time of a result with many rows and a large skin: `python bench/big_result.py [--json FILE] [--large]`.

A roller whose skin has stress at every node rolls on a plane; the run is written to a file, and each thing that is done
with that file is done in a process of its own, whose peak resident memory is reported. Films and VTKHDF files are
written twice, with more frames the second time: what one frame more takes is what grows with their number. `--large`:
1,000 rows and 100,800 nodes instead of 200 rows and 25,200. Fails where anything takes 2 GiB or more.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from memory import imported, measured

SECTORS, LARGE_SECTORS = 300, 1200  # 84 nodes of the skin each
ROWS, LARGE_ROWS = 200, 1000
APPROACH, STEP, SPIN = 30e-6, 1e-4, 10.0  # m, s, rad/s
FEW, MORE = 5, 20  # frames
MOST = 2.0 * 2**30  # byte


def make(file: str, sectors: int, rows: int) -> int:
    """Reduce the roller, let it roll and write the results; nodes of its skin."""
    import warpffrf as wf

    radius = 0.05
    mesh = wf.mesh.roller(radius, 0.015, 0.02, sectors=sectors, layers=15, axial=27, order=1)
    body = wf.reduce(
        mesh, wf.Material(210e9, 0.3, 7850.0), interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()},
        modes=4, stress={"skin": "skin"}, grid=wf.ContactGrid(contact_fixed=False), cache=False, progress=False,
    )  # fmt: skip
    scene = wf.Scene(gravity=(0.0, 0.0, 0.0))
    roller = scene.add_body(
        body, name="roller", position=(0.0, 0.0, radius - APPROACH), angular_velocity=(0.0, SPIN, 0.0)
    )
    plane = scene.ground.surface(
        wf.surfaces.Plane(origin=(0, 0, 0), outward=(0, 0, 1), direction=(0, 1, 0)), name="plane"
    )
    scene.add(wf.Contact(roller["rim"], plane, name="pair"))
    axle = scene.add(wf.joints.Revolute(scene.ground, roller["bore"], axis=(0, 1, 0)))
    scene.add(wf.joints.Drive(axle, SPIN, quantity="velocity"))
    result = wf.simulate(
        scene, (rows - 1) * STEP, step=STEP, start="initial", results=file, overwrite=True, progress=False
    )
    if result.status != "completed":
        raise SystemExit(f"the run ended early: {result.message}")
    return len(body.surface.points)


def opened(file: str) -> Any:
    """The result in the file."""
    from warpffrf.output.result import Result

    return Result.load(file)


def timed(case: str, file: str, folder: str, frames: int) -> float:
    """Seconds of one case, opening the file included."""
    begin = time.perf_counter()
    CASES[case](opened(file), Path(folder) / f"{case.replace(' ', '_')}_{frames}", frames)
    return time.perf_counter() - begin


def _every(result: Any, frames: int) -> int:
    return max((len(result.time) - 1) // (frames - 1), 1)


def _recorded(color: str) -> Callable[..., Any]:
    def write(result: Any, out: Path, frames: int) -> Any:
        from warpffrf.output.recording.recorder import record

        return record(result, out.with_suffix(".rrd"), color=color, max_frames=frames, overwrite=True)

    return write


CASES: dict[str, Callable[..., Any]] = {
    "open": lambda r, out, n: r,
    "report": lambda r, out, n: r.report(progress=False),
    "plot summary": lambda r, out, n: r.summary().savefig(out.with_suffix(".png")),
    "to_dataframe": lambda r, out, n: r.to_dataframe(),
    "to_csv": lambda r, out, n: r.to_csv(out.with_suffix(".csv"), overwrite=True),
    "to_xarray": lambda r, out, n: r.to_xarray(),
    "save": lambda r, out, n: r.save(out.with_suffix(".h5"), overwrite=True),
    "stress of 5 rows": lambda r, out, n: r.stress("roller", "skin", rows=range(5)).von_mises,
    "picture": lambda r, out, n: r.picture(out.with_suffix(".png"), "von_mises", overwrite=True),
    "record": _recorded("displacement"),
    "record von Mises": _recorded("von_mises"),
    "animate": lambda r, out, n: r.animate(
        out.with_suffix(".gif"), "von_mises", every=_every(r, n), overwrite=True, progress=False
    ),
    "to_vtkhdf": lambda r, out, n: r.to_vtkhdf(
        out.with_suffix(".vtkhdf"), stride=_every(r, n), overwrite=True, progress=False
    ),
}  # fmt: skip
BY_FRAMES = ("record", "record von Mises", "animate", "to_vtkhdf")


def shown(row: dict[str, Any]) -> dict[str, Any]:
    """`row`, printed."""
    rest = f"{row['seconds']:8.1f} {row['file_bytes'] / 1e6:9.1f}" if "seconds" in row else ""
    print(f"{row['case']:18s} {row.get('frames') or '':>6}  {row['peak_bytes'] / 2**20:8.0f} {rest}", flush=True)
    return row


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="write machine, versions and rows to this file")
    parser.add_argument("--large", action="store_true", help="1,000 rows and 100,800 nodes")
    parser.add_argument("--all-frames", action="store_true", help="draw and write every saved row, which takes long")
    parser.add_argument("--results", type=Path, help="keep the results file here, or take it from here")
    given = parser.parse_args()
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # inherited by the processes
    if not sys.platform.startswith(("linux", "darwin")):
        raise SystemExit("this system does not tell the peak memory of a process; nothing was measured")
    saved = LARGE_ROWS if given.large else ROWS
    print("case               frames  peak MiB  seconds  files MB")
    rows = [shown({"case": "import", "peak_bytes": measured(imported)[0]})]
    with tempfile.TemporaryDirectory() as folder:
        file = str(given.results or Path(folder) / "run.h5")
        if not Path(file).exists():
            peak, nodes = measured(make, file, LARGE_SECTORS if given.large else SECTORS, saved)
            rows.append(shown({"case": "reduce, run, save", "peak_bytes": peak, "nodes": nodes}))
        for case in CASES:
            counts = ((FEW, saved) if given.all_frames else (FEW, MORE)) if case in BY_FRAMES else (0,)
            for frames in counts:
                peak, seconds = measured(timed, case, file, folder, frames)
                files = [f for f in Path(folder).rglob("*") if f.is_file() and str(f) != file]
                size = sum(f.stat().st_size for f in files)
                for written in files:
                    written.unlink()
                row = {"case": case, "frames": frames, "peak_bytes": peak, "seconds": seconds, "file_bytes": size}
                rows.append(shown(row))
        print(f"results file {Path(file).stat().st_size / 1e6:.0f} MB, {saved} rows")
    if given.json:
        from warpffrf.study.machine import machine

        given.json.write_text(json.dumps({**machine(), "rows": rows}, indent=1) + "\n")
    if max(row["peak_bytes"] for row in rows) >= MOST:
        raise SystemExit("something takes 2 GiB or more")


if __name__ == "__main__":
    main()
