"""What a session asks, refuses and says, and what else can be seen, besides the scenes that are kept as pictures."""

import tempfile
from pathlib import Path

from pinjoint import Session
from pinjoint.components.view import Page, Status, View
from pinjoint.documents import models
from pinjoint.documents.autosave import Autosave, unkept
from pinjoint.documents.library import data_folder, models_folder
from pinjoint.editor.scenes.form import FormScene
from pinjoint.editor.scenes.load import Load
from pinjoint.editor.view_model import READYING
from tests.golden.scenes import EMPTY, Scene, Window, opened, pressed, shown
from tests.reference.models import model, particle, rod

LONG_NAME = "a footbridge of the second term, with its handrail"
SENTENCE = "Rod BC of the upper chord yields in compression at 96.3 % of the load."


MEMBER = model(
    [particle("A", 0, 0, fixed=[True, True], fixed_rotation=True), particle("B", 4, 0)],
    [rod("A", "B", section="IPE 200", distributed_force=[0, -5])],
)


def _hinging(window: Window) -> Session:
    """The tool that hinges, over an end."""
    session = opened(window, MEMBER)
    session.view.tool = "hinge"
    x, y = session.point(0.0, 0.0)
    session.view.pointer = x + 16.0 * window.ratio, y
    session.frame(0.0)
    return session


def _menu_of_member(window: Window) -> Session:
    session = opened(window, MEMBER)
    session.press("right click", session.point(1.0, 0.0))
    return session


def _saved(*names: str) -> None:
    """The person has saved models with these names."""
    models_folder().mkdir(parents=True, exist_ok=True)
    for name in names:
        models.save(models.load("isostatic"), models_folder() / f"{name}.json")


def _welcome(window: Window) -> Session:
    session = opened(window, EMPTY)
    load = session.scenes["load"]
    assert isinstance(load, Load)
    load.welcome = True
    session.act("load")
    return session


def _recovery(window: Window) -> Session:
    """A crash left something behind, which is to be discarded."""
    left = Path(tempfile.mkdtemp(dir=data_folder()))
    models.save(models.load("isostatic"), left / f"dead.1.{LONG_NAME}.json")
    (left / "dead.lock").touch()
    session = opened(window)
    session.autosave = Autosave(left)
    session.press("d")
    for key in ("down", "right", "return"):
        session.press(key)
    session.autosave.close([])
    return session


def _saving(*typed: str) -> Scene:
    """What Return says to a name."""

    def scene(window: Window) -> Session:
        _saved("bridge", LONG_NAME, "bridge 2")
        session = pressed(window, "s")
        for text in typed:
            session.press("ctrl+a")
            session.type(text)
            session.press("return")
        return shown(session)

    return scene


def _loading(text: str) -> Scene:
    def scene(window: Window) -> Session:
        _saved("bridge", LONG_NAME)
        session = pressed(window, "d")
        session.type(text)
        session.press("return")
        return shown(session)

    return scene


def _file_changed(window: Window) -> Session:
    _saved(LONG_NAME)
    session = opened(window, models_folder() / f"{LONG_NAME}.json")
    models.save(models.load("tower"), models_folder() / f"{LONG_NAME}.json")
    session.press("ctrl+s")
    return session


def _properties(source: object, *titles: str, select: str = "", typed: str = "x") -> Scene:
    """The boxes of an element, some with what they cannot be."""

    def scene(window: Window) -> Session:
        session = opened(window, source)
        if select:
            table, name = select.split(".")
            session.select(session.model.tables[table][name])
        session.press("return")
        for title in titles:
            session.click_box(title)
            session.type(typed)
        return session

    return scene


def _refused(source: object, *names: str) -> Scene:
    """Boxes of several elements, all of which hold what they cannot be."""

    def scene(window: Window) -> Session:
        session = opened(window, source)
        session.select(*(element for element in [*session.particles, *session.rods] if element.name in names))
        session.press("return")
        form = session.scenes.active
        assert isinstance(form, FormScene)
        for box in form.form.boxes:
            box.problem = "must be something else than what it is"
        return session

    return scene


def _noticed(text: str, *, problem: bool = False) -> Scene:
    """A sentence that the program says, over a model with all panels."""

    def scene(window: Window) -> Session:
        session = pressed(window, "i", "e")
        session.notice = text
        if problem:
            session.simulation.note = text
        return session

    return scene


def _panels(source: object, *keys: str, select: str = "", time: float = 0.01) -> Scene:
    def scene(window: Window) -> Session:
        session = opened(window, source)
        if select:
            session.select(session.rods[select])
        for key in keys:
            session.press(key)
        session.run(time=time)
        session.update_view()
        return session

    return scene


def _plots(window: Window) -> Session:
    """Of two rods and a particle, while it runs."""
    session = opened(window, "hyperstatic_yield")
    for handle in (session.rods["CD"], session.rods["AB"], session.particles["C"]):
        session.select(handle)
        session.press("o")
    session.press("space")
    for _ in range(3):
        session.run(time=0.01)
        session.frame(0.0)
    return session


def _lesson(window: Window) -> Session:
    """A lesson is played: its words stand below."""
    session = opened(window)
    session.footer = View()
    low = round(min(112.0 * window.ratio, window.height - 1))
    session.footer.page = Page((f"Now {SENTENCE} {SENTENCE}",))
    session.footer.status = Status(time=None, state="Lesson", hint="Space goes on     Esc ends it")
    session.resize(window.width, window.height - low, window.ratio)
    session.footer.camera.viewport = type(session.view.camera.viewport)(
        0, window.height - low, window.width, low
    )
    session.footer.pixel_ratio = 1.25 * window.ratio
    return session


def _drawn(
    key: str,
    *points: tuple[float, float],
    source: object = "hyperstatic",
    typed: str = "",
    accept: bool = False,
) -> Scene:
    """A tool in hand, and what it is about to draw; typed: what is typed of it, and perhaps refused."""

    def scene(window: Window) -> Session:
        session = opened(window, source)
        session.press(key, session.point(*points[0]))
        session.point(*points[1])
        session.type(typed)
        if accept:
            session.press("return")
        return session

    return scene


def _pulled(window: Window) -> Session:
    session = pressed(window, "space")
    session.press("drag", session.point(1.0, 1.0))
    session.press("drag to", session.point(1.6, 1.3))
    session.frame(1.0 / 60.0)
    return session


def _boxed(window: Window) -> Session:
    session = opened(window, "warren_bridge")
    session.press("drag", session.point(-0.5, -0.5))
    session.press("drag to", session.point(3.0, 2.0))
    return session


def _pointed(window: Window) -> Session:
    """The pointer rests on a button of the toolbar."""
    session = opened(window)
    session.view.pointer = 18.0 * window.ratio, 150.0 * window.ratio
    return session


def _released_twice(window: Window) -> Session:
    """The table of two unknowns, the longest working there is of few rods."""
    session = pressed(window, "k", "k", source="braced_portal")
    session.click(*_middle(session, session.rods.names[-1]))
    for key in ("k",) * 5:
        session.press(key)
    return session


def _middle(session: Session, rod: str) -> tuple[float, float]:
    (x0, y0), (x1, y1) = session.particles.position[list(session.model.rods[rod].between)].tolist()
    return 0.35 * x0 + 0.65 * x1, 0.35 * y0 + 0.65 * y1


def _mechanism(window: Window) -> Session:
    """A structure that the force method cannot solve."""
    return pressed(window, "k", source="pendulum")


STATES: dict[str, Scene] = {
    "welcome": _welcome,
    "recovery": _recovery,
    "load-not-found": _loading("isostatik"),
    "load-nothing": _loading(""),
    "save-replaces": _saving("bridge"),
    "save-replaces-long": _saving(LONG_NAME),
    "save-refused": _saving("a/b?"),
    "save-too-long": _saving(3 * LONG_NAME),
    "file-changed": _file_changed,
    "properties-environment": _properties("isostatic"),
    "properties-refused": _properties(
        "isostatic", "stiffness", "damping coefficient", "density", select="rods.AB", typed="-"
    ),
    "properties-refused-below": _properties("isostatic", "mass", select="particles.A", typed="-5"),
    "properties-all-refused": _refused("isostatic", "A", "AB"),
    "properties-member": _properties(MEMBER, "section", select="rods.AB", typed="IPE 205"),
    "properties-clamped": _properties(MEMBER, "applied moment", select="particles.A"),
    "hinging": _hinging,
    "menu-member": _menu_of_member,
    "properties-grid": lambda window: pressed(window, "g", "return"),
    "properties-wall": _properties("staircase", select="walls.floor"),
    "notice-long": _noticed(" ".join([SENTENCE] * 6)),
    "problem-long": _noticed(" ".join([SENTENCE] * 6), problem=True),
    "unkept": _noticed(
        unkept(Path("/home/somebody/.local/share/pinjoint"), OSError(28, "No space left on device"))
    ),
    "compiling": _noticed(READYING.format(seconds=12.0)),
    "settled": lambda window: pressed(window, "e", source="hyperstatic_yield"),
    "snapped": lambda window: pressed(window, "e", source="snap_through"),
    "all-panels": _panels("hyperstatic_yield", "m", "j", "i", "o", select="CD"),
    "all-plots": _plots,
    "all-panels-of-discs": _panels("hard_disc_gas", "j", "m"),
    "impacts": _panels("newtons_cradle", time=1.0),
    "mode": lambda window: pressed(window, "b", source="warren_bridge"),
    "buckling": lambda window: pressed(window, "b", source="eulers_columns"),
    "cables": lambda window: pressed(window, "e", source="hanging_net"),
    "lesson": _lesson,
    "drawing-a-rod": _drawn("l", (0.0, 0.0), (1.2, 0.3)),
    "typing-a-rod": _drawn("l", (0.0, 0.0), (1.2, 0.3), typed="1.5 m@30"),
    "typing-a-load-refused": _drawn("f", (0.0, 1.5), (0.9, 1.9), typed="20 kN/m", accept=True),
    "drawing-a-velocity": _drawn("v", (0.0, 1.5), (0.9, 1.9)),
    "pulling": _pulled,
    "selecting": _boxed,
    "tooltip": _pointed,
    "force-method-again": _released_twice,
    "force-method-refused": _mechanism,
    **{
        f"help-{scene}": (lambda window, key=key: pressed(window, key, "f1"))
        for scene, key in (
            ("simulation", "space"),
            ("properties", "return"),
            ("save", "s"),
            ("load", "d"),
            ("force-method", "k"),
        )
    },
}
