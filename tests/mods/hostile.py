"""Mods that are mistaken or mean: what each does, what is said of it, and where that is found."""

from dataclasses import dataclass

KEY = "ctrl+shift+j"  # that the tests press in pause, and in the scene that it leads to
LOAD, WINDOW, RUN = "load", "window", "run"  # when they load, in a window, in a run without one


@dataclass(frozen=True)
class Hostile:
    """A mod 'bad'. said: a part of the sentence that names it. found: where it fails; `mods check` finds all of them."""

    code: str
    said: str
    found: tuple[str, ...] = (WINDOW,)


def plugin(line: str, more: str = "") -> str:
    """A mod whose plugin does one thing."""
    return f"{HEAD}\n{more}\ndef plugin(app):\n    {line}\n"


def layer(marks: str) -> str:
    """A mod with a layer that draws these marks."""
    return plugin("app.layer(draw)", f"def draw(sheet):\n    ink = sheet.theme.ink\n    return {marks}\n")


def panel(readout: str) -> str:
    return plugin("app.panel(read)", f"def read(session):\n    return {readout}\n")


def system(body: str, phase: str = "EVENTS", more: str = "") -> str:
    """A mod with a frame system that does this to a model."""
    return plugin(
        "app.system(Bad)",
        f"""
class Bad(System):
    name = "bad.system"
    phase = Phase.{phase}
    writes = ("particles.velocity",)
    {more}
    def process(self, frame):
        session, model = frame.session, frame.session.model
        {body}
""",
    )


def scene(body: str) -> str:
    """A mod with a scene that the key leads to."""
    return plugin(
        f"app.scene(Bad); app.action('bad.go', key='{KEY}', scenes=('pause',))(go)",
        f"""
class Bad(Scene):
    name = "trap"
    sources = ("pause",)
    {body}

def go(session, pixel):
    session.scenes.request("trap")
""",
    )


def action(body: str) -> str:
    return plugin(
        f"app.action('bad.act', key='{KEY}', scenes=('pause',))(act)", f"def act(session, pixel):\n    {body}\n"
    )


def law(body: str, more: str = "") -> str:
    """A mod with a force on particles."""
    return plugin(
        "app.system(Bad)",
        f"""
@njit(error_model="numpy")
def kernel(particles_mass):
    {body}

class Bad(Law):
    name = "bad.law"
    each = "particles"
    kernel = kernel
    reads = ("particles.mass",)
    {more}
""",
    )


def history(arguments: str) -> str:
    return plugin(
        f"app.history(HistoryKind('bad', {arguments}))",
        "@njit\ndef factor(time, values, first):\n    return 1.0\n",
    )


HEAD = """
import math, os, random, sys, threading, time
import numpy as np
from pinjoint.components import *
from pinjoint.components.view import Page, Plot, Preview
from pinjoint.editor.scenes import Scene
from numba import njit
from pinjoint.systems.base import *
from pinjoint.systems.render.marks import *

class Mean(Exception):
    def __str__(self):
        raise RuntimeError("not even this")

class Sly(str):
    def __repr__(self):
        sys.exit(7)
"""

ANYWHERE = (WINDOW, RUN)

HOSTILE: dict[str, Hostile] = {
    # --- what never runs, or takes what others need ----------------------------------------------------------
    "a plugin that yields": Hostile(
        plugin("app.layer(draw); yield", "def draw(sheet):\n    return []\n"),
        "what plugin(app) returned is a generator, whose code",
        (LOAD,),
    ),
    "a plugin that waits": Hostile(
        f"{HEAD}\nasync def plugin(app):\n    pass\n", "has not run; write it without 'async'", (LOAD,)
    ),
    "a frame that yields": Hostile(system("yield"), "has not run; write it without 'yield'", ANYWHERE),
    "a frame that waits": Hostile(
        system("pass").replace("def process", "async def process"), "write it without 'async'", ANYWHERE
    ),
    "standard output taken away": Hostile(
        plugin("sys.stdout = None"), "It replaced or removed sys.stdout", (LOAD,)
    ),
    "a root of its own": Hostile(plugin("math.sqrt = abs"), "It replaced or removed math.sqrt", (LOAD,)),
    # --- what marks are ------------------------------------------------------------------------------------
    "a colour without opacity": Hostile(
        layer("[Text('hi', 9, 9, 12, (255, 0, 0))]"),
        "Text.colour is (255, 0, 0); it must be of type tuple[int, int, int, int]",
    ),
    "a colour out of range": Hostile(layer("[Panel(9, 9, 9, 9, 1, (256, 0, 0, 9))]"), "go from 0 to 255"),
    "strokes of unequal lengths": Hostile(
        layer("[Strokes(np.zeros((3, 2)), np.zeros((2, 2)), 1.0, ink)]"), "start and end have different numbers"
    ),
    "places that are no numbers": Hostile(
        layer("[Stamps('disc', np.array([[np.nan, 5.0]]), 5.0, 1.0, ink, ink)]"), "Stamps.at contains nan"
    ),
    "a symbol that does not exist": Hostile(
        layer("[Stamps('unicorn', np.zeros((1, 2)), 5.0, 1.0, ink, ink)]"), "there is no such symbol"
    ),
    "a size below zero": Hostile(layer("[Panel(9, 9, -9, 9, 1, ink)]"), "Panel.width contains -9.0"),
    "an anchor that does not exist": Hostile(
        layer("[Text('hi', 9, 9, 12, ink, anchor='top')]"), "choose one of left, centre, right"
    ),
    "a number among the marks": Hostile(
        layer("[5]"), "what the layer draws is 5; it must be of type Strokes | Fills"
    ),
    "a layer that ends the program": Hostile(layer("sys.exit(3)"), "SystemExit: 3"),
    "a layer that interrupts": Hostile(
        plugin("app.layer(draw)", "def draw(sheet):\n    raise KeyboardInterrupt\n"), "KeyboardInterrupt"
    ),
    "a layer that never ends": Hostile(
        plugin("app.layer(draw)", "def draw(sheet):\n    while True:\n        pass\n"), "it ran for more than"
    ),
    "a layer that catches whatever stops it": Hostile(
        plugin(
            "app.layer(draw)",
            "def draw(sheet):\n    n = 0\n    while True:\n        try:\n            n += 1\n        except: pass\n",
        ),
        "it ran for more than",
    ),
    "an exception without words": Hostile(
        plugin("app.layer(draw)", "def draw(sheet):\n    raise Mean\n"), "Mean: its message cannot be read"
    ),
    "an exception that is read for ever": Hostile(
        plugin(
            "app.layer(draw)",
            "class Long(Exception):\n    def __str__(self):\n        while True: pass\n"
            "def draw(sheet):\n    raise Long\n",
        ),
        "Long: its message cannot be read",
    ),
    "a mistake in a file that is none": Hostile(
        plugin("app.layer(draw)", "def draw(sheet):\n    raise SyntaxError('odd', (5, 5, 5, 'x'))\n"),
        "SyntaxError: odd (bad/__init__.py",
    ),
    "marks without end": Hostile(
        plugin("app.layer(draw)", "from itertools import repeat\ndef draw(sheet): return repeat(None)\n"),
        "what the layer draws has more than 1,000,000 entries",
    ),
    "a generator that closes itself": Hostile(
        plugin("app.layer(draw)", "def draw(sheet):\n    yield Mark\n    raise GeneratorExit\n"),
        "GeneratorExit",
    ),
    # --- what panels are -----------------------------------------------------------------------------------
    "a number as a text": Hostile(
        panel("Readout('bad', (('speed', 1.5),))"), "Readout.rows is (('speed', 1.5),); it must be of type"
    ),
    "a text that ends the program when it is written": Hostile(panel("Readout(5)"), "Readout.title is 5"),
    "a button for nothing": Hostile(
        panel("Readout('bad', closes='nothing')"), "names 'nothing' to close it; there is no such action"
    ),
    "a text as several panels": Hostile(panel("'bad'"), "returned is 'bad'; it must be of type Readout"),
    "curves of unequal lengths": Hostile(
        panel("Readout('bad', (), Plot('x', 'y', (('c', np.zeros(2), np.zeros(3)),)))"),
        "the curve 'c' has x of shape",
    ),
    # --- scenes --------------------------------------------------------------------------------------------
    "a hint that is a number": Hostile(scene("hint = lambda self, session: 5"), "what hint returned is 5"),
    "stages that are one": Hostile(
        scene("stages = lambda self, session: session.model"), "what stages returned is <"
    ),
    "a stage with a view that cannot be drawn": Hostile(
        scene("stages = lambda self, session: [(session.model, session.view.__class__(heading=5))]"),
        "View.heading is 5",
    ),
    "a scene that ends the program as it is entered": Hostile(
        scene("enter = lambda self, session: sys.exit(7)"), "SystemExit: 7"
    ),
    "a scene that cannot be left": Hostile(scene("exit = lambda self, session: 1 / 0"), "ZeroDivisionError"),
    "a scene that cannot be made": Hostile(scene("def __init__(self): 1 / 0"), "ZeroDivisionError", (LOAD,)),
    "a scene that is made no second time": Hostile(
        scene(
            "made = []\n    def __init__(self):\n        self.made.append(1)\n        assert len(self.made) < 2"
        ),
        "making the scene 'trap' failed: AssertionError",
        ANYWHERE,
    ),
    "targets in one text": Hostile(scene("targets = 'pause'"), "Bad.targets is 'pause'", (LOAD,)),
    # --- actions -------------------------------------------------------------------------------------------
    "an action that never ends": Hostile(action("while True: pass"), "it ran for more than"),
    "an action that spoils the view": Hostile(action("session.view.heading = 5"), "View.heading is 5"),
    "an action that spoils the camera": Hostile(
        action("session.view.camera.scale = float('nan')"), "the view's camera is at"
    ),
    "an action that says a number": Hostile(action("session.notice = 5"), "the session's notice is 5"),
    "an action that leads nowhere": Hostile(
        action("session.scenes.request('nowhere')"), "There is no scene 'nowhere'"
    ),
    # --- frame systems -------------------------------------------------------------------------------------
    "NaN in a column that is declared": Hostile(
        system("model.writable('particles.velocity')[1] = np.nan"), "velocity x is nan", ANYWHERE
    ),
    "an infinite number while the view is made": Hostile(
        system("model.writable('particles.velocity')[1, 1] = np.inf", "RENDER"), "velocity y is inf"
    ),
    "a frame system that spoils the view": Hostile(
        system("session.view.preview = 'rod'", "EDIT"), "View.preview is 'rod'"
    ),
    "a frame system that never ends": Hostile(system("while True: pass", "INPUT"), "it ran for more than"),
    "columns that are another answer each time": Hostile(
        system("pass", more="adds = property(lambda self: ())"), "Bad.adds is a property", (LOAD,)
    ),
    "a system that is another one each time": Hostile(
        system(
            "pass",
            more="n = []\n    def __init__(self):\n        self.n.append(1)\n"
            "        self.reads = () if len(self.n) < 3 else 5",
        ),
        "making the system 'bad.system' failed: TypeError: Bad.reads is 5",
        ANYWHERE,
    ),
    "a system that needs what is no answer": Hostile(
        system("pass", more="def needs(self, model): return 'yes'"), "it must be of type bool", ANYWHERE
    ),
    "what is no system": Hostile(plugin("app.system(dict)"), "dict", (LOAD,)),
    # --- what is compiled ------------------------------------------------------------------------------------
    "a kernel that draws by chance": Hostile(
        law("return random.random(), 0.0"), "draws random numbers (random)", (RUN,)
    ),
    "a kernel that imports": Hostile(
        law("import json\n    return 0.0, 0.0"), "The kernel of bad.law does not compile", (RUN,)
    ),
    "a kernel that raises": Hostile(
        law("if particles_mass > 0.0:\n        raise ValueError('no')\n    return 0.0, 0.0"),
        "The kernel of bad.law failed: ValueError: no (bad/__init__.py, line",
        (RUN,),
    ),
    "a kernel that returns too much": Hostile(
        law("return 0.0, 0.0, 0.0"), "it must return a pair, the force (fx, fy) in kN", (RUN,)
    ),
    "arrays that are a list": Hostile(
        law("return 0.0, 0.0", "def arrays(self, model): return [1]"),
        "what it returned is [1]; it must be of type Mapping",
        (RUN,),
    ),
    "a flight that is a text": Hostile(
        law("return 0.0, 0.0", "def leaves_flight_exact(self, model): return 'no'"), "of type bool", ()
    ),
    "a history that never says when it ends": Hostile(
        history("{}, factor, 1.0, lambda history: 'never'"), "it must be of type float", (RUN,)
    ),
    "a history that breaks at texts": Hostile(
        history("{}, factor, 1.0, lambda history: 0.0, breaks=lambda history: 'ab'"),
        "what it returned is 'ab'; it must be of type tuple[float, ...]",
        (RUN,),
    ),
    # --- what is registered ------------------------------------------------------------------------------------
    "a key that is a number": Hostile(
        plugin("app.action('bad.a', key=5)(print)"), "AttributeError: 'int' object has no attribute", (LOAD,)
    ),
    "an icon of what no icon has": Hostile(
        plugin("app.action('bad.a', icon=[('blob', (1, 2))])(print)"), "is not a part of an icon", (LOAD,)
    ),
    "a mod that ends the program": Hostile("raise SystemExit(7)", "SystemExit: 7", (LOAD,)),
    "a mod that interrupts": Hostile("raise KeyboardInterrupt", "KeyboardInterrupt", (LOAD,)),
    "a plugin that ends the program": Hostile(plugin("sys.exit()"), "SystemExit", (LOAD,)),
    "a mod that takes numpy away": Hostile(
        "import sys\ndel sys.modules['numpy']\ndef plugin(app): pass",
        "the module 'numpy' in sys.modules",
        (LOAD,),
    ),
    "a mod that replaces a module": Hostile(
        "import sys\nsys.modules['json'] = sys\ndef plugin(app): pass",
        "the module 'json' in sys.modules",
        (LOAD,),
    ),
    "a thread that goes on": Hostile(
        plugin("threading.Thread(target=time.sleep, args=(3.0,), name='watcher').start()"),
        "left the thread 'watcher' running",
        (LOAD,),
    ),
}
