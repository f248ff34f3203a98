"""The rerun program: commands that open a recording, serve it to a browser and draw a picture of it.

Commands are built here and started by `run`. The viewer requires a screen. A server without a screen serves the
recording to the browser of another machine, or draws it on a virtual screen with the software renderer of Mesa
(Vulkan); pictures of rerun's own `--headless` are incomplete.
"""

from __future__ import annotations

import ipaddress
import os
import shutil
import socket
import subprocess
import sys
import tempfile
from pathlib import Path
from urllib.parse import quote

from warpffrf.model.errors import InputError
from warpffrf.model.files.paths import checked_output_path, written_whole

WINDOW = (1600, 1000)  # points of two pixels each
SCREEN = (6600, 4200)  # pixels: the pointer is in the middle and must not be over the window
PICTURE_SECONDS = 180.0  # timeout; a picture takes about 15 s
DRIVERS = ("/usr/share/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/etc/vulkan/icd.d")
DRIVER_VARIABLES = ("VK_DRIVER_FILES", "VK_ICD_FILENAMES", "VK_ADD_DRIVER_FILES")
LAST_WORDS = 30  # lines of the viewer's output shown after a failure
ENDING = ".rrd"
LOOPBACK = "127.0.0.1"
WEB_PORT, DATA_PORT = 9090, 9876  # defaults of rerun, of the page and of its data


def has_screen() -> bool:
    """Whether a viewer can open: on Linux according to the variables of the window system."""
    linux = sys.platform.startswith("linux")
    return not linux or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


def viewer_command(recording: Path, *, serve: bool = False, bind: str = LOOPBACK) -> list[str]:
    """Command that opens `recording`: the viewer, or with `serve` a server for browsers that listens only on the
    address `bind`. Raises `InputError` for a viewer without screen, a missing recording, an invalid address, and if
    rerun is missing."""
    _require_recording(recording)
    if serve:
        try:
            ipaddress.ip_address(bind)
        except ValueError:
            raise InputError(
                f"view: bind={bind!r} is no address of a machine; give {LOOPBACK}, or 0.0.0.0 for the whole network"
            ) from None
        return [_rerun(), str(recording), "--serve-web", "--bind", bind]
    if not has_screen():
        raise InputError(
            f"view: there is no screen for the viewer; serve=True (--serve) lets a browser open '{recording}', "
            f"or copy it and open it elsewhere with: rerun {recording.name}"
        )
    return [_rerun(), str(recording)]


def served_at(bind: str) -> str:
    """Address for the browser of a server on the address `bind`, and who can reach it. A server on all addresses is
    named by this machine's name."""
    address = ipaddress.ip_address(bind)
    host = socket.gethostname() if address.is_unspecified else f"[{bind}]" if address.version == 6 else bind
    page = f"http://{host}:{WEB_PORT}?url=rerun%2Bhttp%3A%2F%2F{quote(host, safe='')}%3A{DATA_PORT}%2Fproxy"
    if address.is_loopback:
        return (
            f"open {page} on this machine; from another one by a tunnel, "
            f"ssh -L {WEB_PORT}:{host}:{WEB_PORT} -L {DATA_PORT}:{host}:{DATA_PORT} {socket.gethostname()}"
        )
    return f"open {page}; everybody who reaches this machine can"


def picture_command(recording: Path, picture: Path) -> list[str]:
    """Command that draws the initial view of `recording` into `picture` (.png), on the existing screen or a virtual
    one. Raises `InputError` with the missing packages, for a missing recording, and if rerun is missing."""
    _require_recording(recording)
    size = "{}x{}".format(*WINDOW)
    command = [_rerun(), str(recording), "--port", "auto", "--window-size", size, "--screenshot-to", str(picture)]
    if has_screen():
        return command
    missing = [] if shutil.which("xvfb-run") else ["xvfb"]
    if not any(os.environ.get(name) for name in DRIVER_VARIABLES):
        missing += [] if any(any(Path(folder).glob("*.json")) for folder in DRIVERS) else ["mesa-vulkan-drivers"]
    if missing:
        raise InputError(
            f"picture: there is no screen, and a recording is drawn on a virtual one by {' and '.join(missing)} "
            f"(Debian, Ubuntu: apt install {' '.join(missing)}); a picture of the results (.h5) needs neither"
        )
    return ["xvfb-run", "-a", "-s", "-screen 0 {}x{}x24".format(*SCREEN), *command]


def run(command: list[str]) -> int:
    """Run `command` and return its exit code."""
    return subprocess.run(command).returncode


def recording_picture(recording: Path, path: str | os.PathLike[str], *, overwrite: bool = False) -> Path:
    """Draw the initial view of a recording into a .png. Raises `InputError` as `picture_command`, for a path that
    cannot be written or exists, and if the viewer writes no picture."""
    if Path(path).suffix.lower() != ".png":
        raise InputError(f"picture: of a recording it must end in .png, got '{path}'")
    with tempfile.TemporaryDirectory() as folder:
        drawn = Path(folder) / "drawn.png"
        command = picture_command(recording, drawn)
        target = checked_output_path(path, "picture", overwrite=overwrite)
        try:
            said = subprocess.run(command, capture_output=True, text=True, timeout=PICTURE_SECONDS)
        except subprocess.TimeoutExpired:
            raise InputError(f"picture: the viewer drew nothing in {PICTURE_SECONDS:g} s") from None
        if not drawn.is_file():
            words = " ".join((said.stderr or said.stdout).split()[-LAST_WORDS:])
            raise InputError(f"picture: the viewer drew nothing ({words or 'it gives no reason'})")
        with written_whole(target) as partial:
            _sign(drawn, partial)
    return target


def _sign(drawn: Path, signed: Path) -> None:
    """Mark the picture as written by warpffrf, which may replace it."""
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    about = PngInfo()
    about.add_text("Software", "warpffrf")
    with Image.open(drawn) as image:
        image.save(signed, "PNG", pnginfo=about)


def _require_recording(file: Path) -> None:
    if file.suffix.lower() != ENDING or not file.is_file():
        raise InputError(f"'{file}' is no recording ({ENDING})" if file.is_file() else f"'{file}' does not exist")


def _rerun() -> str:
    """The program in the interpreter's folder, or on the path."""
    beside = shutil.which("rerun", path=str(Path(sys.executable).parent))
    found = beside or shutil.which("rerun")
    if found is None:
        raise InputError("the program rerun is missing; it comes with the package rerun-sdk: pip install rerun-sdk")
    return found
