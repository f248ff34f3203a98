"""Two rollers with friction that are driven by hand: a page with sliders for load and speed, and the patch.

    python bench/live_rollers.py                  serves the page at http://127.0.0.1:8000 until Ctrl-C
    python bench/live_rollers.py --measure 60     60 s in real time without a page, and what became of the deadlines

The page is at the pace of the clock (`Simulation.run(real_time=True)`): a slow machine shows a load above 100 %, and
the picture is late. The lower roller is driven, the upper one is pressed on it and braked by a damper on its axle.
"""

from __future__ import annotations

import argparse
import json
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import numpy as np

import warpffrf as wf
from demos import rolling_friction as rollers
from warpffrf.output.pace import Pace

PAGE = Path(__file__).with_name("live_rollers.html")
STEP = 1e-3  # s
FRAME = 20  # steps between two looks at the sliders
FASTEST = 0.9 * rollers.QUICK.spacing / (rollers.OUTER_RADIUS * STEP)  # rad/s: the patch advances by a cell per step
SLIDERS = {"load": (2e3, 20e3), "speed": (0.0, FASTEST)}  # N, rad/s: least and most
BRAKE = 50.0  # N m s/rad on the axle of the upper roller: the patch slips where the load is light and the speed high
MOST_BYTES = 1000  # of a request


def scene(size: rollers.Size = rollers.QUICK) -> wf.Scene:
    """The rollers of the demo rolling-friction, without its flywheel, with load and speed as inputs."""
    load, speed = wf.signals.Input("load", 10e3, unit="N"), wf.signals.Input("speed", unit="rad/s")
    mesh = wf.mesh.roller(
        rollers.OUTER_RADIUS, rollers.BORE_RADIUS, rollers.WIDTH, sectors=size.sectors, layers=size.layers,
        axial=size.axial, order=2,
    )  # fmt: skip
    roller = wf.reduce(
        mesh, rollers.STEEL, interfaces={"bore": "rigid"}, contact={"rim": wf.surfaces.Cylinder()}, modes=0,
        grid=wf.ContactGrid(tangential=True, contact_fixed=True), progress=False,
    )  # fmt: skip
    made = wf.Scene()
    lower = made.add_body(roller, name="lower")
    upper = made.add_body(roller, name="upper", position=(0, 0, 2 * rollers.OUTER_RADIUS))
    contact = made.add(
        wf.Contact(
            lower["rim"], upper["rim"], friction=rollers.FRICTION, name=rollers.PAIR, grid="contact_fixed",
            cells=size.patch,
        )
    )  # fmt: skip
    made.close_gap(contact)
    place = upper["bore"].world_point()
    carriage = made.add_rigid_body(rollers.CARRIAGE_MASS, rollers.CARRIAGE_INERTIA, name="carriage", position=place)
    axle = made.add(wf.joints.Revolute(made.ground, lower["bore"], axis=(0, 1, 0), name="axle"))
    made.add(wf.joints.Prismatic(made.ground, carriage, axis=(0, 0, 1), name="guide"))
    second = made.add(wf.joints.Revolute(carriage, upper["bore"], axis=(0, 1, 0), name="upper_axle"))
    made.add(wf.joints.Drive(axle, speed, quantity="velocity", name="motor"))
    made.add(wf.forces.JointSpringDamper(second, stiffness=0.0, damping=BRAKE, name="brake"))
    made.add(wf.forces.PointForce(carriage, (0.0, 0.0, load.scaled(-1.0)), name="press"))
    return made


class Live:
    """A simulation that follows `wanted` values, and its last picture as JSON, which other threads read and set."""

    def __init__(self, sim: wf.Simulation) -> None:
        self.sim, self.wanted = sim, {name: sim.inputs[name] for name in SLIDERS}
        self.stop = threading.Event()
        self.pace: Pace | None = None
        self.picture = self._picture()

    def want(self, text: bytes) -> None:
        """Set what the sliders say, a JSON object of values by name. Raises `InputError`."""
        try:
            given = json.loads(text)
            values = {name: float(value) for name, value in given.items()}
        except (TypeError, ValueError, AttributeError) as error:
            raise wf.InputError(f"values are a JSON object of numbers by name ({error})") from error
        for name, value in values.items():
            if name not in SLIDERS:
                raise wf.InputError(f"there is no slider {name!r}; known: {', '.join(SLIDERS)}")
            least, most = SLIDERS[name]
            if not least <= value <= most:
                raise wf.InputError(f"{name} is from {least:g} to {most:g}, got {value:g}")
        self.wanted |= values

    def follow(self, real_time: bool = True) -> bool:
        """Make the steps of a frame; the inputs reach what is wanted within it. Whether it goes on."""
        sim, begin = self.sim, {name: self.sim.inputs[name] for name in SLIDERS}
        goal = dict(self.wanted)
        pace = Pace()

        def step() -> bool:
            share = (pace.steps + 1) / FRAME
            for name, value in goal.items():
                sim.inputs[name] = begin[name] + share * (value - begin[name])
            return sim.step() == wf.Status.COMPLETED

        if real_time:
            pace.run(step, FRAME * STEP, FRAME)
        else:
            while pace.steps < FRAME and step():
                pace.steps += 1
        self.pace = pace
        self.picture = self._picture()
        return sim.status == wf.Status.COMPLETED

    def _picture(self) -> str:
        """The present as JSON."""
        sim, pair = self.sim, rollers.PAIR
        pressure = np.asarray(sim.outputs[f"contact_pressure[{pair}]"])
        force = np.asarray(sim.outputs[f"contact_force[{pair}]"])
        found = {
            "time": sim.time,
            "load": sim.inputs["load"],
            "speed": sim.inputs["speed"],
            "upper": float(sim.outputs["body_angular_velocity_y[upper]"]),  # type: ignore[arg-type]
            "force": force.tolist(),
            "pressure": np.nan_to_num(pressure).round(-3).tolist(),
            "pace": str(self.pace or ""),
            "status": str(sim.status),
            "message": sim.message,
        }
        return json.dumps(found)


def server(live: Live, port: int = 8000) -> ThreadingHTTPServer:
    """A server of the page and its pictures, for this machine only; port 0: any that is free."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            if self.path == "/":
                page = PAGE.read_text(encoding="utf-8").replace("SLIDERS", json.dumps(SLIDERS))
                self.reply(200, page, "text/html; charset=utf-8")
            elif self.path == "/picture":
                self.reply(200, live.picture)
            else:
                self.reply(404, json.dumps({"error": "there is / and /picture"}))

        def do_POST(self) -> None:
            length = self.headers.get("Content-Length", "")
            try:
                if not length.isdigit() or int(length) > MOST_BYTES:
                    raise wf.InputError(f"a request has up to {MOST_BYTES} bytes")
                live.want(self.rfile.read(int(length)))
                self.reply(200, json.dumps(live.wanted))
            except wf.InputError as error:
                self.reply(400, json.dumps({"error": str(error)}))

        def reply(self, code: int, text: str, kind: str = "application/json") -> None:
            data = text.encode()
            self.send_response(code)
            self.send_header("Content-Type", kind)
            self.send_header("Content-Length", str(len(data)))
            self.send_header("Cache-Control", "no-store")
            self.end_headers()
            self.wfile.write(data)

        def log_message(self, format: str, *args: Any) -> None:
            pass

    return ThreadingHTTPServer(("127.0.0.1", port), Handler)


def measure(duration: float) -> Pace:
    """What becomes of the deadlines of `duration` [s] at half of the fastest speed."""
    sim = wf.Simulation(scene(), step=STEP, start="equilibrium")
    sim.inputs["speed"] = 0.0
    for n in range(100):
        sim.inputs["speed"] = 0.5 * FASTEST * (n + 1) / 100
        sim.step()
    begin = time.process_time()
    sim.run(duration, real_time=True)
    assert sim.pace is not None
    print(f"{sim.status}: {sim.pace}; {100 * (time.process_time() - begin) / duration:.3g} % of one core")
    return sim.pace


def main() -> None:
    """Serve the page, or measure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--measure", type=float, metavar="SECONDS")
    parser.add_argument("--port", type=int, default=8000)
    chosen = parser.parse_args()
    if chosen.measure:
        measure(chosen.measure)
        return
    live = Live(wf.Simulation(scene(), step=STEP, start="equilibrium"))
    pages = server(live, chosen.port)
    threading.Thread(target=pages.serve_forever, daemon=True).start()
    print(f"http://127.0.0.1:{pages.server_port}")
    try:
        while live.follow():
            pass
        print(live.sim.message)
    except KeyboardInterrupt:
        pass
    pages.shutdown()


if __name__ == "__main__":
    main()
