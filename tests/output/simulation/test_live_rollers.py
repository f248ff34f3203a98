"""The page with the sliders of two rollers: what its server takes and refuses, and a browser that moves a slider."""

from __future__ import annotations

import json
import threading
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import PROGRAM, Browser  # pyright: ignore[reportMissingImports]

import live_rollers
import warpffrf as wf
from live_rollers import FASTEST, FRAME, SLIDERS, STEP, Live, server


class Still:
    """What a page needs of a simulation, without one."""

    def __init__(self) -> None:
        self.inputs, self.time, self.status, self.message = {"load": 1e4, "speed": 0.0}, 0.0, wf.Status.COMPLETED, ""
        self.seen: list[float] = []
        pair = live_rollers.rollers.PAIR
        self.outputs = {
            f"contact_pressure[{pair}]": np.array([[0.0, 1e9], [np.nan, 2e9]]),
            f"contact_force[{pair}]": np.array([0.0, 0.0, -1e4]),
            "body_angular_velocity_y[upper]": 0.5,
        }

    def step(self) -> wf.Status:
        self.time += STEP
        self.seen.append(self.inputs["speed"])
        return self.status


@pytest.fixture
def still() -> Iterator[tuple[Live, str]]:
    live = Live(Still())  # type: ignore[arg-type]
    pages = server(live, 0)
    threading.Thread(target=pages.serve_forever, daemon=True).start()
    yield live, f"http://127.0.0.1:{pages.server_port}"
    pages.shutdown()
    pages.server_close()


def asked(address: str, data: bytes | None = None) -> tuple[int, str]:
    try:
        with urllib.request.urlopen(address, data, timeout=60) as reply:
            return reply.status, reply.read().decode()
    except urllib.error.HTTPError as error:
        return error.code, error.read().decode()


def test_values_and_pictures(still: tuple[Live, str]) -> None:
    live, address = still
    code, page = asked(address + "/")
    assert code == 200
    assert json.dumps(SLIDERS) in page
    assert asked(address + "/", b'{"speed": 0.5}') == (200, json.dumps({"load": 1e4, "speed": 0.5}))
    assert live.follow(real_time=False)
    assert live.sim.seen == pytest.approx(0.5 * np.arange(1, FRAME + 1) / FRAME)  # type: ignore[attr-defined]
    code, picture = asked(address + "/picture")
    found = json.loads(picture)
    assert found["speed"] == 0.5
    assert found["time"] == pytest.approx(FRAME * STEP)
    assert found["pressure"] == [[0.0, 1e9], [0.0, 2e9]]


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b'{"spid": 1}', "no slider 'spid'"),
        (b'{"speed": 1e9}', "speed is from 0"),
        (b'{"load": NaN}', "load is from 2000"),
        (b'{"load": "much"}', "JSON object of numbers"),
        (b"[1, 2]", "JSON object of numbers"),
        (b"\xff", "JSON object of numbers"),
        (b"9" * 2000, "up to 1000 bytes"),
    ],
)
def test_refused_values(still: tuple[Live, str], data: bytes, said: str) -> None:
    live, address = still
    code, text = asked(address + "/", data)
    assert code == 400
    assert said in json.loads(text)["error"]
    assert live.wanted == {"load": 1e4, "speed": 0.0}
    assert asked(address + "/other")[0] == 404


@pytest.mark.slow
@pytest.mark.skipif(PROGRAM is None, reason="Chromium is not installed")
def test_a_slider_moves_the_rollers(tmp_path: Path) -> None:
    """A click on the sliders in a browser: speed and load follow, the upper roller is carried along, and the patch is
    drawn with the pressure."""
    live = Live(wf.Simulation(live_rollers.scene(), step=STEP, start="equilibrium"))
    pages = server(live, 0)
    threading.Thread(target=pages.serve_forever, daemon=True).start()
    browser = Browser(tmp_path / "profile", f"http://127.0.0.1:{pages.server_port}")
    seen = "document.getElementById('state').textContent"
    browser.wait_until(seen)

    def middle(name: str, share: float) -> Any:
        box = browser.value(
            f"(b => [b.left, b.top, b.width, b.height])(document.getElementById('{name}').getBoundingClientRect())"
        )
        return box[0] + share * box[2], box[1] + 0.5 * box[3]

    browser.click(*middle("speed", 0.5))
    browser.click(*middle("load", 0.9))
    browser.wait_until("document.getElementById('load_text').value.startsWith('18')")
    sent = threading.Event()
    for _ in range(600):  # until the server has both
        if live.wanted["speed"] > 0.0 and live.wanted["load"] > 15e3:
            break
        sent.wait(0.1)
    assert live.wanted["speed"] == pytest.approx(0.5 * FASTEST, rel=0.02)
    assert live.wanted["load"] == pytest.approx(18.2e3, rel=0.03)  # the thumb of a slider has a width
    for _ in range(15):
        assert live.follow(real_time=False), live.sim.message
    found = json.loads(live.picture)
    assert found["speed"] == live.wanted["speed"]
    assert found["upper"] == pytest.approx(-found["speed"], rel=0.05)
    assert -found["force"][2] == pytest.approx(live.wanted["load"], rel=0.05)
    browser.wait_until(f"{seen}.includes('t = {found['time']:.2f} s')")
    drawn = browser.value(
        "(c => [...c.getContext('2d').getImageData(0, 0, c.width, c.height).data])(document.getElementById('patch'))"
    )
    red = np.array(drawn).reshape(-1, 4)[:, 0]
    assert red.size == np.size(found["pressure"])
    assert red.max() == 255
    assert (red == 0).sum() == (np.array(found["pressure"]) <= 0.0).sum()
    browser.picture(tmp_path / "rollers.png")
    print(tmp_path / "rollers.png")
    browser.close()
    pages.shutdown()
    pages.server_close()


def test_frames_are_at_the_pace_of_the_clock(still: tuple[Live, str]) -> None:
    live, _ = still
    assert live.follow()
    assert live.pace is not None
    assert live.pace.steps == FRAME
