"""What pictures are made of: every mode, in windows of three sizes, without a display.

They depend on nothing but the program: no saved models, time by steps, fixed windows.
"""

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

os.environ.setdefault("SDL_VIDEODRIVER", "dummy")

import pygame

from pinjoint import Session
from pinjoint.components.tags import Hovered
from pinjoint.components.view import drawn_positions, magnified
from pinjoint.documents.library import data_in
from pinjoint.systems.render.backends.pygame_canvas import Canvas
from pinjoint.systems.render.marks import Picture
from pinjoint.systems.render.picture import compose_all
from pinjoint.systems.render.theme import load_theme
from tests.systems.render.frame_models import all_supports, portal_at_rest

FOLDER = Path(__file__).parent
NOWHERE = Path("nowhere")  # in place of the person's saved models; there is no such folder
EMPTY = {"format": "pinjoint model", "version": 1}


@dataclass(frozen=True)
class Window:
    """So many pixels, and so many of them for each point."""

    width: int
    height: int
    ratio: float = 1.0


Scene = Callable[[Window], Session]
LARGE = 2000  # pixels: wider pictures are kept at a quarter of their size
WINDOWS = {
    "small": Window(640, 480),
    "usual": Window(1000, 720),
    "large": Window(3840, 2160, magnified(2160, 2160, 1.0)),
}


def drawn(name: str, window: Window) -> pygame.Surface:
    """The picture of that name; a large one as seen from a distance, so that its file is small."""
    surface = painted(pictures(name, window), window)
    return surface if window.width < LARGE else pygame.transform.smoothscale_by(surface, 0.25)


def painted(shown: list[Picture], window: Window) -> pygame.Surface:
    """Pictures, one above the other."""
    surface = pygame.Surface((window.width, window.height), depth=32)
    canvas = Canvas()
    for picture in shown:
        canvas.draw(surface, picture)
    return surface


def pictures(name: str, window: Window) -> list[Picture]:
    """What it consists of, one above the other."""
    with data_in(NOWHERE):
        return composed(SCENES[name](window))


def composed(session: Session) -> list[Picture]:
    """What a session shows now."""
    session.update_view()
    theme = load_theme(session.view.theme)
    return compose_all(session.stages, theme)


def opened(window: Window, source: object = "isostatic") -> Session:
    session = Session.open(source)  # type: ignore[arg-type]
    session.resize(window.width, window.height, window.ratio)
    session.view.fit(session.model)
    return session


def pressed(window: Window, *keys: str, source: object = "isostatic", theme: str = "light") -> Session:
    session = opened(window, source)
    session.view.theme = theme
    for key in keys:
        session.press(key)
    return session


def shown(session: Session) -> Session:
    """The pictures that are looked for are read."""
    while session.busy:
        session.frame(0.0)
    return session


def _simulation_at_rest(window: Window) -> Session:
    session = opened(window)
    session.settings.displacement_scale = 50.0
    session.press("i")
    session.press("space")
    session.run(until="rest")
    return session


def _properties(window: Window) -> Session:
    session = opened(window)
    session.click(*session.particles["B"].position)
    session.press("return")
    return session


def _save(window: Window) -> Session:
    session = pressed(window, "s")
    session.type("my bridge")
    return session


def _load(window: Window) -> Session:
    """Narrowed down to few examples, so that a new one need not change the picture."""
    session = pressed(window, "d")
    session.type("hyperstatic")
    return shown(session)


def _drawing_a_force(window: Window) -> Session:
    """A selected rod, a tool in hand and what it is about to draw."""
    session = opened(window, "hyperstatic")
    session.click(0.75, 1.5)
    session.press("f", session.point(*session.particles["B"].position))
    session.point(0.4, 1.2)
    return session


def _drawing_a_wall(window: Window) -> Session:
    """From the foot of the stairs, with the floor selected."""
    session = opened(window, "staircase")
    session.select(session.table("walls")["floor"])
    session.point(2.0, 0.0)
    session.press("w")
    session.point(1.0, -0.4)
    return session


def _force_method_of_a_frame(window: Window) -> Session:
    """The virtual work of a portal whose right foot lets go sideways."""
    session = pressed(window, "k", "k", source="portal")
    session.click(*session.model.particles["D"].position)
    for key in ("x", "k", "k", "k", "k"):
        session.press(key)
    return session


def _force_method(*keys: str) -> Scene:
    """The guide with this pressed; a click picks BD, away from where AC crosses it."""

    def scene(window: Window) -> Session:
        session = pressed(window, "k", source="hyperstatic")
        for key in keys:
            if key == "click":
                model, _ = session.stages[0]
                between = model.rods["BD"].between
                x, y = (drawn_positions(model)[list(between)] * [[0.7], [0.3]]).sum(axis=0).tolist()
                session.click(x, y)
            else:
                session.press(key)
        return session

    return scene


def _mechanism_refused(window: Window) -> Session:
    """An isostatic structure without one of its rods moves."""
    session = pressed(window, "k", "k")
    model, _ = session.stages[0]
    session.click(*drawn_positions(model)[list(model.rods["AB"].between)].mean(axis=0).tolist())
    return session


def _panels(window: Window) -> Session:
    """Theory, energies and a plot beside a selected rod that yields."""
    session = opened(window, "hyperstatic_yield")
    session.select(session.rods["CD"])
    for key in ("o", "m", "j", "i"):
        session.press(key)
    session.run(time=0.5)
    return session


def _all_properties(window: Window) -> Session:
    return pressed(window, "ctrl+a", "return", source="hyperstatic")


def _notice(window: Window) -> Session:
    """A long sentence above the status line."""
    session = pressed(window, "e", source="isostatic_collapse")
    session.select(session.particles["B"])
    return session


def _menu(window: Window) -> Session:
    """The menu of a particle, one entry chosen by a key."""
    session = opened(window, "hyperstatic")
    session.click(0.0, 1.5, "right click")
    session.press("down")
    return session


def _menu_of_canvas(window: Window) -> Session:
    session = opened(window, "hyperstatic")
    session.press("right click", session.view.camera.middle)
    return session


def _free_bodies(window: Window) -> Session:
    """Rods and joints apart, and the equilibrium of one."""
    session = pressed(window, "e", "x", source="isostatic")
    session.select(session.particles["B"])
    return session


def _pointed(window: Window) -> Session:
    """What a rod says under the pointer."""
    session = pressed(window, "i", "e", source="isostatic")
    rod = session.rods["BC"]
    session.point(*drawn_positions(session.model)[list(rod.between)].mean(axis=0).tolist())
    session.model.tag_only([rod], Hovered)
    return session


def _table(window: Window) -> Session:
    """The results of a frame in statics, the largest moments first, and a rod that was chosen."""
    session = pressed(window, "q", "n", source="two_storey_frame")
    session.lister.press(("head", 7))
    session.lister.press(("head", 7))
    session.act("fit")
    session.select(session.rods["CD"])
    return session


def _moments(window: Window) -> Session:
    """A portal at rest with its bending moments."""
    session = opened(window, portal_at_rest())
    session.settings.displacement_scale = 20.0
    session.document.get_ready()
    session.press("i")
    session.press("i")
    return session


def _shears(window: Window) -> Session:
    """Every kind of support, in the last theme but one, with shears."""
    session = pressed(window, "i", "i", "i", source=all_supports(), theme="colour-blind")
    session.run(time=0.004)
    return session


def _members_apart(window: Window) -> Session:
    """Members and joints of a portal at rest, apart, with the equilibrium of its beam."""
    session = opened(window, portal_at_rest())
    session.document.get_ready()
    session.press("x")
    session.select(session.rods["BC"])
    return session


PICKED = ("k", "click")
SCENES: dict[str, Scene] = {
    "empty": lambda window: pressed(window, source=EMPTY),
    "pause": pressed,
    "pause-dark": lambda window: pressed(window, "i", "e", source="hyperstatic", theme="dark"),
    "pause-colour-blind": lambda window: pressed(window, "i", "e", source="hyperstatic", theme="colour-blind"),
    "pause-colour-blind-dark": lambda window: pressed(
        window, "i", "e", source="hyperstatic", theme="colour-blind-dark"
    ),
    "drawing-a-force": _drawing_a_force,
    "drawing-a-wall": _drawing_a_wall,
    "simulation-at-rest": _simulation_at_rest,
    "panels": _panels,
    "notice": _notice,
    "free-bodies": _free_bodies,
    "pointed": _pointed,
    "table": _table,
    "frame-moments": _moments,
    "statics": lambda window: pressed(window, "q", source="portal"),
    "frame-shears": _shears,
    "frame-free-bodies": _members_apart,
    "properties": _properties,
    "properties-of-all": _all_properties,
    "save": _save,
    "load": _load,
    "force-method-1": _force_method(),
    "force-method-2": _force_method("k"),
    "force-method-2-refused": _mechanism_refused,
    "force-method-3": _force_method(*PICKED),
    "force-method-4": _force_method(*PICKED, "k", "i"),
    "force-method-5": _force_method(*PICKED, "k", "k"),
    "force-method-6": _force_method(*PICKED, "k", "k", "k"),
    "force-method-of-a-frame": _force_method_of_a_frame,
    "force-method": _force_method(*PICKED, "k", "k", "k", "k"),
    "help": lambda window: pressed(window, "f1"),
    "menu": _menu,
    "menu-of-canvas": _menu_of_canvas,
}
ALONE_IN_LAYOUT = {
    "frame-free-bodies",
    "notice",
    "properties-of-all",
    "menu-of-canvas",
    *(f"force-method-{part}" for part in ("1", "2", "3", "5")),
}
IN_OTHER_SIZES = (
    ("usual", "force-method-4"),
    ("usual", "drawing-a-wall"),
    ("usual", "free-bodies"),
    ("usual", "frame-free-bodies"),
    ("large", "simulation-at-rest"),
    ("large", "properties"),
    ("large", "force-method"),
)
# What is kept as a picture, by the name of its file; layouts are tested in all scenes and sizes.
GOLDEN: dict[str, tuple[str, Window]] = {
    **{name: (name, WINDOWS["small"]) for name in SCENES if name not in ALONE_IN_LAYOUT},
    **{f"{name}-{size}": (name, WINDOWS[size]) for size, name in IN_OTHER_SIZES},
}
