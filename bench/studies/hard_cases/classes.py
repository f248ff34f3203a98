"""Classes of a run: pass, degraded, fail, refused, and silent, which must not occur.

Three things are looked at, each right, degraded or wrong: the energy ledger, the joints at the saved steps, and the
case's own comparisons. With L = numerical + contact_grid the ledger gains max(L - running min L) and loses
max(running max L - L), over the energy at hand; joints are off by the largest change of a row that they hold, over the
scene's length or in rad. Of a run that was completed

    all right                                          pass
    the worst is degraded                              degraded
    something is wrong, and the run says so            fail
    something is wrong, and nothing is said            silent

A run says so by a note that warns (`WARNS`; notes that tell what was done, or that a grid is coarse, which says nothing
of motion or energy, do not count unless the case says so), or by an error budget that states at least `STATED` of the
error. One that ends early with a message is a fail, wrong input is refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from studies.hard_cases.case import Finding, Ledger
from warpffrf.model.checks.redundancy import scene_length
from warpffrf.model.errors import InputError
from warpffrf.model.joints.base import value
from warpffrf.online.history.record import marker_motion
from warpffrf.output.result import Result

PASS, DEGRADED, FAIL, REFUSED, SILENT = CLASSES = ("pass", "degraded", "fail", "refused", "silent")
JOINTS = (1e-8, 1e-6)  # of the length of the scene, or rad: projected positions leave round-off; more is noted
STATED = 1.0 / 3.0  # of an error: what an error budget may be too small by
WARNS = (
    "smaller step", "reduce step", "shorter step", "step_error=", "results are wrong", "does not resolve",
    "pass through", "that nothing supplied", "left the table", "is not kept",
)  # fmt: skip


@dataclass
class Verdict:
    """Class of a run, why, and all comparisons."""

    kind: str
    why: str
    findings: list[Finding] = field(default_factory=list)

    @property
    def worst(self) -> Finding | None:
        """The finding furthest beyond its limit."""
        if not self.findings:
            return None
        return max(self.findings, key=lambda f: (f.level, _beyond(f)))


def _beyond(finding: Finding) -> float:
    """Error over limit; a limit of zero lets nothing pass but zero."""
    if finding.bad == 0.0:
        return 0.0 if finding.error == 0.0 else np.inf
    return float(np.nan_to_num(finding.error / finding.bad, nan=np.inf))


def ledger_findings(result: Result, limits: Ledger) -> list[Finding]:
    """What the run has gained and lost, over the energy at hand."""
    L = np.asarray(result.energy["numerical"] + result.energy["contact_grid"])
    hand = max(result.energy_scale, limits.floor)
    if not len(L) or hand == 0.0:
        return []
    gain = float(np.max(L - np.minimum.accumulate(L))) / hand
    loss = float(np.max(np.maximum.accumulate(L) - L)) / hand
    return [Finding("energy gained", gain, *limits.gain), Finding("energy lost", loss, *limits.loss)]


def joint_violation(result: Result) -> float:
    """Largest change since the start of a row that a joint holds, and largest difference of a driven coordinate and its
    signal, over the scene's length or in rad."""
    scene, bodies, count = result.history.scene, result.history.bodies, len(result.time)
    length, most = scene_length(scene), 0.0
    driven = {(drive.joint.name, drive.row): drive for drive in scene.drives}
    for drive in driven.values():
        off = result.joint(drive.joint.name).named(drive.coordinate) - drive.position()(result.time)
        if drive.quantity == "velocity":  # prescribes no place
            off = off - off[:1]
        most = max(most, float(np.abs(off).max(initial=0.0)) / (length if drive.row.is_length else 1.0))
    for joint in scene.joints:
        (x_a, A_a, _), (x_b, A_b, _) = (
            marker_motion(p, m, bodies, count) for p, m in zip(joint.ports, joint.frames(), strict=True)
        )
        for row in joint.rows:
            if (joint.name, row) in driven:
                continue
            c = value(row, x_a, A_a, x_b, A_b)
            most = max(most, float(np.abs(c - c[:1]).max(initial=0.0)) / (length if row.is_length else 1.0))
    return most


def warnings_of(notes: Sequence[str], said: Sequence[str] = ()) -> list[str]:
    """Notes that warn of results; `said`: other words that a case takes for a warning."""
    return [note for note in notes if any(word in note for word in (*WARNS, *said))]


def stated_error(result: Result) -> float:
    """The largest error that the budget of the run states, 0 where there is none."""
    try:
        return max((line.size for line in result.error_budget() if line.found), default=0.0)
    except InputError:
        return 0.0


def judge(result: Result, own: Sequence[Finding], limits: Ledger, said: Sequence[str] = ()) -> Verdict:
    """The class of a run that was made; `own`: the case's comparisons, `said`: words of notes that warn of them."""
    if result.status != "completed":
        return Verdict(FAIL, f"{result.status}: {result.message}", list(own))
    findings = [*ledger_findings(result, limits), *own]
    if result.history.scene.joints:
        findings.append(Finding("joints off", joint_violation(result), *JOINTS))
    found = Verdict(PASS, "", findings)
    worst = found.worst
    if worst is None or worst.level == 0:
        return found
    found.kind, found.why = DEGRADED, f"{worst.of} {worst.error:.3g}"
    if worst.level == 1:
        return found
    if warnings := warnings_of(result.history.notes, said):
        found.kind, found.why = FAIL, f"{found.why}; the run says: {warnings[0]}"
        return found
    stated = stated_error(result)
    if stated >= STATED * min(worst.error, 1.0):
        found.kind, found.why = FAIL, f"{found.why}; its error budget says {stated:.2g}"
        return found
    found.kind = SILENT
    return found
