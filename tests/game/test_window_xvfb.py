"""A real window on a virtual display, with real keys and a real mouse: from drawing a triangle to closing."""

import ctypes
import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from pinjoint import Session
from pinjoint.app import FIRST_SIZE
from pinjoint.components.camera import Viewport
from pinjoint.components.field import Vector
from pinjoint.components.form import Box
from pinjoint.documents import models
from pinjoint.documents.library import DATA_VARIABLE
from pinjoint.documents.preferences import CONFIG_VARIABLE
from pinjoint.editor.scenes.form import FormScene
from pinjoint.scripts.script import NEW
from tests.reference.hits import hits_for

MISSING = [name for name in ("Xvfb", "xdotool") if shutil.which(name) is None]
pytestmark = pytest.mark.skipif(bool(MISSING), reason=f"{' and '.join(MISSING)} not installed")

ROOT = Path(__file__).parents[2]
PATIENCE = 150.0  # s that anything may take, such as compiling on a slow machine
# How xdotool calls keys whose names are not their characters.
X_NAMES = {"return": "Return", "escape": "Escape", "ctrl+n": "ctrl+n"}


def wait_for(what: str, found: Callable[[], Any], still: Callable[[], bool] = lambda: True) -> Any:
    """The first true thing that `found` returns; gives up after a while, or when it is not going on `still`."""
    end = time.monotonic() + PATIENCE
    while not (result := found()):
        assert still(), f"the program ended while waiting for {what}"
        assert time.monotonic() < end, f"waited {PATIENCE:g} s in vain for {what}"
        time.sleep(0.02)
    return result


@pytest.fixture(scope="module")
def display() -> Iterator[str]:
    """A virtual display of its own, such as ":3"."""
    reader, writer = os.pipe()
    command = [
        "Xvfb",
        "-displayfd",
        str(writer),
        "-screen",
        "0",
        "1280x1024x24",
        "-nolisten",
        "tcp",
        "-noreset",
    ]
    server = subprocess.Popen(command, pass_fds=[writer], stderr=subprocess.DEVNULL)
    os.close(writer)
    with os.fdopen(reader) as said:
        number = said.readline().strip()
    if not number:
        pytest.skip("Xvfb cannot open a display here")
    yield f":{number}"
    server.terminate()
    server.wait(10)


class ClientMessage(ctypes.Structure):
    """XClientMessageEvent, padded to the size of any XEvent."""

    _fields_ = (
        ("type", ctypes.c_int),
        ("serial", ctypes.c_ulong),
        ("send_event", ctypes.c_int),
        ("display", ctypes.c_void_p),
        ("window", ctypes.c_ulong),
        ("message_type", ctypes.c_ulong),
        ("format", ctypes.c_int),
        ("data", ctypes.c_long * 24),
    )


def close_window(display: str, window: int) -> None:
    """Ask a window to close, as window managers do (ICCCM, WM_DELETE_WINDOW); old xdotools cannot."""
    x = ctypes.CDLL("libX11.so.6")
    x.XOpenDisplay.restype, x.XInternAtom.restype = ctypes.c_void_p, ctypes.c_ulong
    x.XInternAtom.argtypes = ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int
    x.XSendEvent.argtypes = ctypes.c_void_p, ctypes.c_ulong, ctypes.c_int, ctypes.c_long, ctypes.c_void_p
    x.XCloseDisplay.argtypes = (ctypes.c_void_p,)
    connection = x.XOpenDisplay(display.encode())
    protocols, delete = (x.XInternAtom(connection, name, 0) for name in (b"WM_PROTOCOLS", b"WM_DELETE_WINDOW"))
    client_message = 33
    event = ClientMessage(client_message, 0, 1, connection, window, protocols, 32)
    event.data[0] = delete
    x.XSendEvent(connection, window, 0, 0, ctypes.byref(event))
    x.XCloseDisplay(connection)


class Person:
    """Someone at the window: sends real events, and waits until the program has taken each of them.

    The program tells by its recording. A session without a window follows along, to know where things are.
    """

    def __init__(self, display: str, folder: Path) -> None:
        self.models = folder / "data" / "models"
        self._record = folder / "record.jsonl"
        self._environment = {
            **os.environ,
            "DISPLAY": display,
            "SDL_VIDEODRIVER": "x11",
            "SDL_VIDEO_X11_WMCLASS": "pinjoint",  # what to search for
            DATA_VARIABLE: str(folder / "data"),
            CONFIG_VARIABLE: str(folder / "config"),
        }
        self._log = open(folder / "log.txt", "w+", encoding="utf-8")  # noqa: SIM115 (closed in leave)
        self.program = subprocess.Popen(
            [sys.executable, "-m", "pinjoint", "--record", str(self._record)],
            cwd=ROOT,
            env=self._environment,
            stdout=self._log,
            stderr=subprocess.STDOUT,
        )
        self.follower = Session.open(NEW)
        self.follower.scenes.begin(self.follower)
        self.follower.view.camera.viewport = Viewport(0, 0, *FIRST_SIZE)
        self.follower.view.fit(self.follower.model)
        self.window = ""

    def find_window(self) -> None:
        """Wait for the window, and let it have the keys."""
        self.wait_for("the window to take the keys", self._takes_focus)

    def _takes_focus(self) -> bool:
        """A window that is not quite there yet refuses the focus; one that SDL only tries out is gone soon."""
        search = "search", "--onlyvisible", "--class", "pinjoint"
        for window in self.xdotool(*search, may_fail=True).split():
            command = ["xdotool", "windowfocus", "--sync", window]
            done = subprocess.run(command, env=self._environment, capture_output=True, timeout=20, check=False)
            if done.returncode == 0:
                self.window = window
                return True
        return False

    def leave(self) -> None:
        """End everything, whatever came of it."""
        if self.program.poll() is None:
            self.program.kill()
            self.program.wait(10)
        self._log.close()

    def xdotool(self, *words: str, may_fail: bool = False) -> str:
        """What xdotool says to a command."""
        done = subprocess.run(
            ["xdotool", *words],
            env=self._environment,
            capture_output=True,
            text=True,
            check=not may_fail,
            timeout=20,
        )
        return done.stdout.strip()

    def wait_for(self, what: str, found: Callable[[], Any]) -> Any:
        """See wait_for; also gives up when the program has ended."""
        return wait_for(what, found, lambda: self.program.poll() is None)

    @property
    def title(self) -> str:
        """The title of the window."""
        return self.xdotool("getwindowname", self.window)

    @property
    def geometry(self) -> str:
        """Where the window is, and how large."""
        return self.xdotool("getwindowgeometry", self.window)

    @property
    def taken(self) -> list[dict[str, Any]]:
        """What the program has taken so far: its recording, as far as lines are complete."""
        text = self._record.read_text(encoding="utf-8") if self._record.exists() else ""
        lines = text[: text.rfind("\n") + 1].splitlines()
        return [entry for entry in map(json.loads, lines) if "input" in entry]

    def _do(self, key: str, *words: str) -> None:
        """Send events, and wait until the program has taken the last of them."""
        before = len(self.taken)
        self.xdotool(*words)
        self.wait_for(
            f"'{key}' to be taken", lambda: any(entry["input"] == key for entry in self.taken[before:])
        )

    def point(self, pixel: Vector) -> None:
        """Move the mouse."""
        self.xdotool("mousemove", "--window", self.window, *(str(round(number)) for number in pixel))
        self.follower.view.pointer = float(round(pixel[0])), float(round(pixel[1]))

    def press(self, *keys: str) -> None:
        """Press keys, one after the other."""
        for key in keys:
            self._do(key, "key", X_NAMES.get(key, key))
            self.follower.press(key)

    def press_over(self, x: float, y: float, *keys: str) -> None:
        """Press keys with the mouse over a point of the model (m)."""
        self.point(self.follower.point(x, y))
        self.press(*keys)

    def click(self, pixel: Vector) -> None:
        """Click a pixel."""
        self.point(pixel)
        self._do("click", "click", "1")
        self.follower.press("click")

    def click_tool(self, action: str) -> None:
        """Click a button of the toolbar."""
        self.click(hits_for(self.follower, action)[-1].middle)

    def click_box(self, title: str) -> None:
        """Click a box of a panel by its title."""
        scene = self.follower.scenes.active
        assert isinstance(scene, FormScene)
        places = scene.layout(self.follower).places
        place = next(p for p in places if isinstance(p.item, Box) and p.item.title == title)
        self.click((place.left + place.width / 2, place.top + place.height / 2))

    def close_window(self) -> None:
        """Click its close icon: what the frame that a desktop puts around a window sends it then."""
        close_window(self._environment["DISPLAY"], int(self.window))

    def type(self, text: str) -> None:
        """Type a text."""
        self._do(f"text {text[-1]}", "type", "--delay", "30", "--", text)
        self.follower.type(text)


@pytest.fixture
def person(display: str, tmp_path: Path) -> Iterator[Person]:
    person = Person(display, tmp_path)
    try:
        person.find_window()
        yield person
    finally:
        person.leave()


def test_a_triangle_from_drawing_to_closing_the_window(person: Person) -> None:
    a, b, c = (-1.0, -0.5), (0.0, 0.5), (1.0, -0.5)
    for point in (a, b, c):
        person.press_over(*point, "p")
    for start, end in ((a, b), (b, c), (c, a)):
        person.press_over(*start, "l")
        person.press_over(*end, "l")
    person.press_over(*a, "c", "c")
    person.press_over(*c, "c")

    person.click(person.follower.point(*b))
    person.press("return")
    person.click_box("load y")
    person.type("-160")
    person.press("return", "escape")

    person.click_tool("toggle run")
    person.press("space")  # again, since in equilibrium nothing would move
    person.wait_for("time to pass", lambda: person.press("i") or person.taken[-1]["at"] > 0)
    person.press("space", "return", "escape", "s")
    person.type("my triangle")
    path = person.models / "my triangle.json"
    assert not path.exists()
    person.press("return")
    person.wait_for("the file", path.exists)
    person.wait_for("its name in the title", lambda: person.title == "my triangle – Pinjoint")

    person.press("ctrl+n")
    person.wait_for("a new model", lambda: person.title == "Pinjoint")
    person.press("d")
    person.type("my triangle")
    person.press("return")
    person.wait_for("the model again", lambda: person.title == "my triangle – Pinjoint")
    person.close_window()
    assert person.program.wait(PATIENCE) == 0

    saved = models.load(path)
    assert saved.particles.position.tolist() == [list(point) for point in (a, b, c)]
    assert saved.rods.between.tolist() == [[0, 1], [1, 2], [2, 0]]
    assert saved.particles.fixed.tolist() == [[False, True], [False, False], [True, True]]
    assert saved.particles.force.tolist() == [[0.0, 0.0], [0.0, -160.0], [0.0, 0.0]]
    assert saved.clock.time > 0.0
    assert saved.particles.displacement[1, 1] < 0.0
    assert saved.particles.displacement[2].tolist() == [0.0, 0.0]


def test_the_window_is_where_it_was_and_unsaved_work_is_kept(person: Person, display: str) -> None:
    person.xdotool("windowsize", person.window, "900", "600")
    person.xdotool("windowmove", person.window, "60", "40")
    person.wait_for("the size", lambda: "900x600" in person.geometry)
    person.xdotool("mousemove", "--window", person.window, "500", "300")
    person.xdotool("key", "p")
    person.wait_for("a particle", lambda: any(entry["input"] == "p" for entry in person.taken))
    person.close_window()
    assert person.program.wait(PATIENCE) == 0
    (kept,) = (person.models.parent / "autosave").glob("*.json")
    assert models.load(kept).particles.count == 1
    later = Person(display, person.models.parent.parent)
    try:
        later.find_window()
        assert "60,40" in later.geometry
        assert "900x600" in later.geometry
    finally:
        later.leave()
