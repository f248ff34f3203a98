"""What every demo says and leaves behind: figures beside the values they must have, results, recording, picture."""

from __future__ import annotations

import json
import logging
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import warpffrf as wf

log = logging.getLogger("warpffrf")


@dataclass(frozen=True)
class Check:
    """A computed figure beside the value it must have, in SI units.

    `source` says where the expected value comes from. `tolerance` is the largest difference, over `scale` where the
    expected value is zero or no measure of what matters, else over the expected value; `shown_in` and `factor` are the
    unit of the table.
    """

    name: str
    computed: float
    expected: float
    source: str
    tolerance: float
    shown_in: str = "-"
    factor: float = 1.0
    scale: float | None = None

    @property
    def error(self) -> float:
        """Difference over `scale`, or over the expected value."""
        return (self.computed - self.expected) / (self.expected if self.scale is None else self.scale)

    @property
    def passed(self) -> bool:
        """Whether the difference is within the tolerance; a NaN is not."""
        return bool(abs(self.error) <= self.tolerance)

    def describe(self) -> dict[str, Any]:
        """Plain data for summary.json."""
        return {**asdict(self), "error": float(self.error), "passed": self.passed}


def table(checks: Sequence[Check]) -> str:
    """The checks as text, one a line."""
    labels = [f"{c.name} [{c.shown_in}]" for c in checks]
    width = max(34, max(map(len, labels), default=0) + 2)
    lines = [f"{'':<{width}}{'computed':>15}{'expected':>15}{'difference':>12}"]
    for label, c in zip(labels, checks, strict=True):
        verdict = "" if c.passed else f"  FAILED: more than {c.tolerance:.1g}"
        values = f"{c.computed * c.factor:>15.9g}{c.expected * c.factor:>15.9g}{c.error:>+12.1e}"
        lines.append(f"{label:<{width}}{values}  {c.source}{verdict}")
    return "\n".join(lines)


def finish(
    stem: Path, results: dict[str, wf.Result], checks: Sequence[Check], panels: Sequence[Any], *, frames: int
) -> int:
    """Write the runs, the recording of the first, the picture of `panels` and summary.json; print the table.

    stem: folder / name of the demo. The first of `results` becomes `stem`.h5 and .rrd, the others `stem`.KEY.h5.
    Returns 0 when every run completed and every check passed, else 1.
    """
    from warpffrf.output.plots.panels import save_panels
    from warpffrf.output.recording.recorder import record

    first, *others = results
    written = [results[first].save(stem.with_suffix(".h5"), overwrite=True).name]
    written += [results[key].save(stem.with_name(f"{stem.name}.{key}.h5"), overwrite=True).name for key in others]
    info = record(results[first], stem.with_suffix(".rrd"), max_frames=frames, overwrite=True)
    written.append(save_panels(panels, stem.with_suffix(".png"), overwrite=True).name)
    summary = {
        "status": {key: result.status for key, result in results.items()},
        "checks": [c.describe() for c in checks],
        "counters": {key: result.history.counters for key, result in results.items()},
    }
    (stem.parent / "summary.json").write_text(json.dumps(summary, indent=2) + "\n", encoding="utf-8")
    print(table(checks))
    print(f"written to {stem.parent}: {', '.join(written)}, summary.json and .rrd ({info.frames} frames); see it with")
    print(f"  rerun {stem.with_suffix('.rrd')}")
    for key, result in results.items():
        if result.status != "completed":
            log.error("the run '%s' ended early, %s: %s", key, result.status, result.message)
    good = all(result.status == "completed" for result in results.values()) and all(c.passed for c in checks)
    return 0 if good else 1


def writable_folder(out: str | Path) -> Path:
    """The folder `out`, made where it is missing; raises `InputError` for one that cannot be."""
    folder = Path(out).expanduser()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise wf.InputError(f"demo: cannot write to {folder}: {error}; choose another folder with --out") from None
    return folder
