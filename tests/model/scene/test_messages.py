"""What a script hears: lines on stderr unless the application has set up logging, and how it becomes quiet."""

import io
import logging
import subprocess
import sys
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from warpffrf.model.messages import progress
from warpffrf.model.messages.progress import quiet, speaking

log = logging.getLogger("warpffrf")
REDUCE = """
import warpffrf as wf
mesh = wf.mesh.roller(0.05, 0.015, 0.02, sectors=8, layers=1, axial=1, order=1)
{before}
wf.reduce(mesh, wf.Material(2.1e15, 0.3, 7850), modes=2, cache=False{options})
{after}
"""


@contextmanager
def unheard() -> Iterator[None]:
    """As in a script: no handler (those of pytest are hung up when a test begins), no level set."""
    before = log.handlers, log.propagate, log.level
    log.handlers, log.propagate = [], False
    log.setLevel(logging.NOTSET)
    yield
    log.handlers, log.propagate = before[:2]
    log.setLevel(before[2])


def script(before: str = "", options: str = "", after: str = "") -> str:
    """The standard error of a script that reduces a body of a nearly rigid material."""
    code = REDUCE.format(before=before, options=options, after=after)
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stderr


def test_a_script_hears_what_is_done_and_the_warnings() -> None:
    said = script().splitlines()
    assert said[0].startswith("reduce: 'roller', ") and "done in" in said[-1]
    assert sum("the speed of sound" in line for line in said) == 1


def test_quiet_scripts_hear_the_warnings_alone() -> None:
    for said in (script("wf.quiet()"), script(options=", progress=False")):
        assert len(said.splitlines()) == 1 and "the speed of sound" in said


def test_an_application_with_logging_gets_what_it_asked_for() -> None:
    own = "import logging; logging.basicConfig(format='app: %(message)s', level='{}')"
    at_warning, at_info = (script(own.format(level)).splitlines() for level in ("WARNING", "INFO"))
    assert len(at_warning) == 1 and len(at_info) > 2
    assert all(line.startswith("app: ") for line in at_warning + at_info)
    silent = "import logging; logging.getLogger('warpffrf').addHandler(logging.NullHandler())"
    assert script(silent) == ""


def test_nothing_stays_behind(capsys: pytest.CaptureFixture) -> None:
    with unheard(), speaking():
        log.info("heard")
        with speaking(False):
            log.info("not heard, the inner call is quiet")
            with speaking():
                log.info("not heard either")
            log.warning("a doubt")
        log.info("heard again")
    with unheard():
        log.info("not heard any more")
        assert capsys.readouterr().err.splitlines() == ["heard", "a doubt", "heard again"]
        with speaking(), pytest.raises(ZeroDivisionError), speaking():
            _ = 1 / 0
        assert log.handlers == [] and log.level == logging.NOTSET


def test_levels_of_the_user_stay(capsys: pytest.CaptureFixture) -> None:
    with unheard():
        quiet()
        with speaking():
            log.info("not heard")
            log.getChild("mesh").warning("a doubt")
        assert log.level == logging.WARNING
    assert capsys.readouterr().err == "a doubt\n"


def test_threads_hear_their_own_lines(capsys: pytest.CaptureFixture) -> None:
    def silent() -> None:
        with speaking(False):
            log.info("of a quiet call")

    with unheard(), speaking():
        thread = threading.Thread(target=silent)
        thread.start()
        thread.join()
        log.info("of this call")
    assert capsys.readouterr().err == "of this call\n"


def test_a_process_without_standard_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stderr", None)
    with unheard(), speaking():
        log.warning("nobody hears it")


def test_progress_shows_the_time_left(capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    with unheard(), speaking():
        bar = progress.Progress("simulate", 100, enabled=True)
        for done in range(1, 101):
            now[0] += 0.5
            bar.update(done)
        bar.close()
    said = capsys.readouterr().err.splitlines()
    # a line every 10 s of the 50 s, the first behind 3 s: at 3.5, 14, 24.5, 35, 45.5 s
    assert said[0] == "simulate: 7 of 100 steps, about 46 s left"
    assert len(said) == 5 and said[-1] == "simulate: 91 of 100 steps, about 4 s left"


def test_time_left_is_that_of_steps_alone(capsys: pytest.CaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
    """What comes before the first step, 100 s of kernels that are compiled, is no time of a step: 96 at 0.5 s each."""
    now = [0.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    with unheard(), speaking():
        bar = progress.Progress("simulate", 200, enabled=True)
        for now[0] in (50.0, 100.0):
            bar.update(0)
        for now[0], done in ((101.0, 4), (151.0, 104)):
            bar.update(done)
        runs = progress.Progress("sweep", 100, enabled=True, unit="run", done=90)  # that an earlier sweep has run
        for now[0], done in ((200.0, 91), (260.0, 92), (320.0, 93)):
            runs.update(done)
        modules = progress.Progress("compile kernels", 34, enabled=True, unit="module", timed=False)
        for now[0], done in ((330.0, 1), (345.0, 2)):
            modules.update(done)
    assert capsys.readouterr().err.splitlines() == [
        "simulate: 4 of 200 steps",
        "simulate: 104 of 200 steps, about 48 s left",
        "sweep: 91 of 100 runs",
        "sweep: 92 of 100 runs, about 480 s left",
        "sweep: 93 of 100 runs, about 420 s left",
        "compile kernels: 1 of 34 modules",
        "compile kernels: 2 of 34 modules",
    ]


def test_the_clock_of_a_bar_begins_with_its_first_step(monkeypatch: pytest.MonkeyPatch) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    now = [0.0]
    monkeypatch.setattr(sys, "stderr", Terminal())
    bar = progress.Progress("simulate", 200, enabled=True)
    assert bar.bar is not None
    monkeypatch.setattr(bar.bar, "_time", lambda: now[0])
    for now[0], done in ((50.0, 0), (100.0, 4), (150.0, 104)):
        bar.update(done)
    said = bar.bar.format_dict
    assert said["elapsed"] == 50.0 and said["n"] == 104 and said["initial"] == 4
    assert said["rate"] is None or said["rate"] == pytest.approx(2.0)
    bar.close()
    untimed = progress.Progress("compile kernels", 34, enabled=True, unit="module", timed=False)
    assert untimed.bar is not None and "<" not in str(untimed.bar)
    untimed.close()


def test_a_notebook_has_a_bar(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its standard error is no terminal; without widgets the bar is text, and nothing is said of missing widgets."""
    import types

    said = io.StringIO()
    monkeypatch.setattr(sys, "stderr", said)
    assert progress.Progress("simulate", 10, enabled=True).bar is None
    for name in ("tqdm.auto", "tqdm.autonotebook"):  # which look where they are when they are imported
        monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.setitem(sys.modules, "ipykernel.zmqshell", types.ModuleType("ipykernel.zmqshell"))
    monkeypatch.setitem(sys.modules, "IPython", types.SimpleNamespace(get_ipython=object))
    monkeypatch.setitem(sys.modules, "ipywidgets", None)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        bar = progress.Progress("simulate", 10, enabled=True)
    assert bar.bar is not None and not bar.logs
    bar.update(4)
    bar.update(6)
    assert bar.bar.n == 6 and "simulate" in said.getvalue()
    bar.close()
    for name in ("tqdm.auto", "tqdm.autonotebook"):
        sys.modules.pop(name, None)
