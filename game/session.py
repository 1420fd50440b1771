"""Session: the program with or without a window, as scripts and tests drive it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NoReturn

import pinjoint.editor.actions
import pinjoint.lessons.actions  # noqa: F401 (they register them)
from pinjoint.components.camera import Viewport
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import Vector
from pinjoint.components.language import begun, joined, listed, marked, tr
from pinjoint.components.mistake import Mistake, WrongValue
from pinjoint.components.model import Model
from pinjoint.components.rod import Rod, bends
from pinjoint.components.settings import NO_DIAGRAMS, PAUSE, STATICS
from pinjoint.components.toolbar import Tool
from pinjoint.components.view import View, lesson_share
from pinjoint.components.wording import missing
from pinjoint.documents.format import ModelError, missing_mods
from pinjoint.documents.open_documents import ModelFile
from pinjoint.editor.actions.typing import takes_typing, type_with_tool
from pinjoint.editor.frame import Actions, Exaggerate, Frame, ShowView
from pinjoint.editor.readouts import readouts
from pinjoint.editor.routing import BUTTONS, Press
from pinjoint.editor.scenes import all_scenes, scene_systems
from pinjoint.editor.scenes.files import FileScene
from pinjoint.editor.sliders import sliders_of
from pinjoint.editor.view_model import exaggerate, follow, offer_tools, show
from pinjoint.headless import Headless, forward
from pinjoint.lessons.course import Course, take_up_lesson
from pinjoint.mods.mod import blamed_on_mod, check_mods, switched_off
from pinjoint.scripts.expectation import check
from pinjoint.scripts.script import Script, ScriptError
from pinjoint.systems.base import Phase, System
from pinjoint.systems.edit.dividing import divide
from pinjoint.systems.input.actions import ACTIONS, FILES, FORMS, LIVE, SIMULATION, TABLE, TEXT
from pinjoint.systems.run.system import Time
from pinjoint.systems.schedule import Plan

MODEL, SCRIPT = ".json", ".jsonl"  # files that a person may drop on the window
FARTHEST = 1e9  # pixels from the corner of the window to which a click may be
_SAID = {  # where a key does nothing that does something in pause
    SIMULATION: marked("{action}: press Space to pause first."),
    STATICS: marked("{action}: no time passes in statics. Space runs, Q leaves it."),
}
LARGEST_SIDE, LARGEST_RATIO = 65_536, 64.0  # of a window, in pixels, and in pixels per point


class Session(Headless):
    """The program as scripts drive it, with or without a window: open documents with their runs, scenes and undo logs.

    >>> s = Session.open("isostatic")
    >>> s.run(until="rest")
    'at rest'
    >>> round(s.rods["AB"].axial_force, 4)
    -28.3428
    """

    course: Course | None

    def __init__(
        self,
        model: Model,
        systems: Iterable[System] = (),
        view: View | None = None,
        file: ModelFile = ModelFile(),  # noqa: B008 (it cannot be changed)
    ) -> None:
        seen = [Exaggerate(), Actions(), ShowView(), Time(), *scene_systems()]
        super().__init__(model, systems, view, file, all_scenes(), seen)
        self.recorder: Any = None  # pinjoint.scripts.playing.Recorder, told of every press and change of size
        self._clicked: tuple[object, ...] | None = None  # what took the last press, if that was a click
        self.extent = self.view.camera.viewport.width, self.view.camera.viewport.height  # of the window
        self.documents.on_leave, self.documents.on_begin = self._leave_document, self._begin_document
        offer_tools(self)
        self._begin_document()

    def __reduce_ex__(self, protocol: object) -> NoReturn:
        raise TypeError(
            tr("A session cannot be copied or pickled. Save its model, and open that in another session.")
        )

    def __repr__(self) -> str:
        name, model = self.document.file.name or "untitled", self.model
        size = f"{model.particles.count} particles, {model.rods.count} rods"
        return f"<Session '{name}': {size}, {self.scene}, t = {self.time:.6g} s>"

    # --- editing -----------------------------------------------------------------------------------

    def divide(self, rod: Rod | str, parts: int = 2) -> list[Rod]:
        """Divide a rod that bends into equal parts, which then are selected; undo joins them. Raises Refusal.

        >>> portal = {"format": "pinjoint model", "version": 1}
        >>> portal["particles"] = [{"name": "A", "position": [0, 0]}, {"name": "B", "position": [4, 0]}]
        >>> portal["rods"] = [{"name": "AB", "between": ["A", "B"], "bending_stiffness": 4000}]
        >>> [part.name for part in Session.open(portal).divide("AB", 2)]
        ['AB 1', 'AB 2']
        """
        made = divide(self.model, [self.rods[rod] if isinstance(rod, str) else rod], parts)
        self.select(*made)
        return made

    # --- pictures ------------------------------------------------------------------------------------

    def picture(self, path: str | Path, size: tuple[int, int] = (1280, 800), theme: str = "light") -> None:
        """Draw what is shown now to a .png, .svg, .pdf, .jpg or .bmp file; without bars and panels.

        Raises ValueError for other files and sizes, OSError if it cannot be written.
        """
        from pinjoint.pictures import render

        render(self, path, size, theme)

    def _repr_png_(self) -> bytes:
        """What a notebook shows of it."""
        from pinjoint.pictures import drawn

        return drawn(self, ".png", (960, 600))

    # --- scenes and actions --------------------------------------------------------------------------

    def plan(self, scene: str | None = None) -> Plan:
        """Which systems run in a scene (by default the active one) with the model, in order, and why others do not.

        >>> Session.open("isostatic").plan("pause").left_out["run.time"]
        "not active in 'pause', only in simulation"
        """
        return self.simulation.planned(scene or self.scene)

    def act(self, name: str, pixel: Vector | None = None) -> None:
        """Perform a named action with the pointer at a pixel; what it refuses is said in `notice`.

        Raises ValueError if there is none, and ModError if a mod fails meanwhile, which is switched off then.
        """
        if name not in ACTIONS:
            raise ValueError(missing(marked("actions"), name, ACTIONS))
        action, failed = ACTIONS[name], switched_off()
        if not action.while_drawing:
            self.leave_gesture()
        if not action.in_menu:
            self.view.menu = None
        exaggerate(self)
        follow(self)
        gesture = self.gesture
        try:
            action.perform(self, pixel if pixel is not None else self.view.pixel)
        except Mistake as error:
            self.notice = str(error)
        self.scenes.apply(self)
        take_up_lesson(self)
        if not self.view.steady or self.gesture is not gesture:  # while a hand drags, frames do
            offer_tools(self)
        self._make_room()
        if self.window is None:  # in one, the fault is shown
            check_mods(failed)

    def _leave_document(self) -> None:
        """Another document comes into use."""
        self.leave_gesture()
        self.view.all_diagrams = False

    def _begin_document(self) -> None:
        """Show the document that is open now, with its sliders, from the first frame on."""
        model, view = self.model, self.view
        self.scenes.show_state(self)
        view.sliders, view.arrow_scales = sliders_of(self), {}
        self._make_room()
        view.fit(model)
        if model.settings.diagrams != NO_DIAGRAMS:
            view.all_diagrams, view.quantity = True, model.settings.diagrams
        if model.rods.count:
            view.rigid = bends(model)
        self.notice = missing_mods(model) or self.notice
        self._go_on()

    def _make_room(self) -> None:
        """Fit the model beside panels that are large enough to cover it.

        Called after actions, never because of time or frames, so that a recording is replayed in the same picture.
        """
        view = self.view
        wanted = (
            view.wanted - {TABLE} or view.free_bodies or any(readout.is_large for readout in readouts(self))
        )
        table = self.lister.wanted if view.legend else (0.0, 0.0)
        view.share(self.model, shares=view.legend and bool(wanted), table=table)
        if table[0]:
            self.lister.follow()

    def press(self, key: str, pixel: Vector | None = None) -> None:
        """Press a key, such as "k", "escape" or "ctrl+z"; one that means nothing in this scene does nothing.

        Raises ValueError if no key is called so.
        """
        key = ACTIONS.key_named(key)
        if key.startswith(TEXT):
            self.type(key.removeprefix(TEXT))
            return
        if key.startswith(FILES):
            self._record(key, pixel)
            self._open_files(key.removeprefix(FILES).splitlines())
            return
        pixel = self.view.pixel if pixel is None else _near(pixel)
        press = Press(self, key, pixel)
        if key in BUTTONS and self.course is not None:
            self.course.writes = False
        here = self.scene, self.view.menu is not None, self.view.help > 0, press.hit and press.hit.action
        if key == "double click" and self._clicked not in (None, here):
            return  # its first click led here, and the second is not meant for what is here
        if key == "escape" and EXTENSIONS.last_fault(self.faults_seen) and self.scene not in FORMS:
            self.faults_seen = len(EXTENSIONS.faults)
        elif press.action is not None:
            self.notice, self._clicked = "", here if key == "click" else None
            self._record(key, pixel)
            if self.scenes.time_passes and self.readiness.lets(self.simulation):
                self.document.get_ready()
            self.view.pressed = press.hit
            left = self._left_for_tools() if press.for_tools else ""
            if press.action != left:  # the tool that opens a scene closes it, too
                self.act(press.action, press.at)
        elif self.scene in _SAID and (found := ACTIONS.at(PAUSE, key)) and not ACTIONS.at(self.scene, key):
            self.notice = tr(_SAID[self.scene], action=begun(tr(found[1].title)))

        elif key == "click" and press.hit is not None and isinstance(press.hit.item, Tool):
            self._say_why_not(press.hit.item)

    def _say_why_not(self, tool: Tool) -> None:
        """Say why a button does nothing now, as its key does, which would take a tool in hand, though."""
        self.notice = ""
        if tool.key and not ACTIONS[tool.action].hint:
            self.press(tool.key)
        binding = ACTIONS.offer(tool.action, self.scene)
        if binding is not None and not self.notice:
            scenes = listed([tr(scene) for scene in binding.scenes])
            here = EXTENSIONS.acts_in(self.scene, binding.scenes)
            said = marked("{action}: there is nothing here yet that it could act on.")
            said = said if here else marked("{action}: only in {scenes}.")
            self.notice = tr(said, action=begun(tool.title), scenes=scenes)

    def _record(self, key: str, pixel: Vector | None) -> None:
        if self.recorder is not None:
            self.recorder.press(key, pixel)

    def _left_for_tools(self) -> str:
        """Leave a scene in which tools do not act, for the one in which they do; returns its name, or ""."""
        scene, tools = self.scene, self.scenes.active.tools
        if tools == scene:
            return ""
        self.scenes.request(*dict.fromkeys(("pause", tools)))
        self.scenes.apply(self)
        offer_tools(self)
        return scene

    def _open_files(self, paths: Iterable[str]) -> None:
        """Open model files and play recorded sessions, as when they are dropped on the window; undo goes back.

        What is wrong with a file is said in `notice`, and the others are opened.
        """
        self.view.menu = None
        opened, problems = [], []
        for path in map(Path, paths):
            try:
                self._open_file(path)
            except (ModelError, ScriptError) as error:
                problems.append(str(error))
            else:
                opened.append(path.stem)
        take_up_lesson(self)
        if opened:
            self.scenes.request_from_pause(self.settings.opens_in if self.lesson is None else PAUSE)
            self.scenes.apply(self)
        said = tr("Opened {models}. Ctrl+Z goes back.", models=listed(opened)) if opened else ""
        self.notice = joined([*problems, said])
        scene = self.scenes.active
        if isinstance(scene, FileScene):
            scene.form.message = self.notice
        offer_tools(self)

    def _open_file(self, path: Path) -> None:
        """Open a model file, or play a recorded session. Raises ModelError or ScriptError; then nothing has changed.

        The document in use stays open unless it is empty.
        """
        if path.is_dir():
            raise ModelError("'{name}' is a folder; drop the model files that are in it.", name=path.name)
        if path.suffix.lower() not in (MODEL, SCRIPT):
            raise ModelError(
                "'{name}' is not a model: Pinjoint opens model files ({model}) and recorded sessions ({script}).",
                name=path.name,
                model=MODEL,
                script=SCRIPT,
            )
        script = Script(path) if path.suffix.lower() == SCRIPT else None
        if script is None or not script.task_count:  # a lesson opens its models itself
            source = path if script is None else script.source
            self.documents.open(source, keep=self.model.particles.count > 0)
        self.lesson = script or self.lesson

    def resize(self, width: int, height: int, pixel_ratio: float = 1.0) -> None:
        """Adapt to a new size of the window, in pixels, with `pixel_ratio` pixels per point. Raises ValueError."""
        if not (
            1 <= width <= LARGEST_SIDE and 1 <= height <= LARGEST_SIDE and 0.0 < pixel_ratio <= LARGEST_RATIO
        ):
            raise WrongValue(
                "The size is {width:g} × {height:g} pixels, {ratio:g} to a point; give sides from 1 to {most}, and at"
                " most {largest:g} to a point.",
                width=width,
                height=height,
                ratio=pixel_ratio,
                most=LARGEST_SIDE,
                largest=LARGEST_RATIO,
            )
        self.extent = width, height
        card = self.course.view if self.course is not None else None
        taken_right, taken_below = lesson_share(width, height, pixel_ratio) if card is not None else (0, 0)
        left, top = width - taken_right, height - taken_below
        self.view.camera.viewport, self.view.pixel_ratio = Viewport(0, 0, left, top), pixel_ratio
        if card is not None:
            place = (left, 0, taken_right, height) if taken_right else (0, top, width, taken_below)
            card.camera.viewport, card.pixel_ratio = Viewport(*place), pixel_ratio
        if self.view.fitted:
            self.view.fit(self.model)
        if self.recorder is not None:
            self.recorder.resize()
        self.scenes.active.resized(self)

    def type(self, text: str) -> None:
        """Type text into the selected box of properties, save and load."""
        self._record(TEXT + text, None)
        if self.course is not None and self.course.awaits_number and self.scene in LIVE:
            self.course.type(text)
        elif takes_typing(self):
            type_with_tool(self, text)
        else:
            self.scenes.active.type(self, text)
        self.scenes.apply(self)

    def expect(self, text: str) -> None:
        """Raise AssertionError unless a text such as "scene = pause" is true.

        Also "rods.AB.axial_force ≈ -28.34 ± 0.01", "energy.imbalance < 1"; see game/scripts/script.py.
        """
        for expected, got in check(self, text):
            raise AssertionError(tr("expected {expected}, got {got}", expected=expected, got=str(got)))

    def click_box(self, title: str) -> None:
        """Select the box with that title. Raises LookupError if there is none."""
        self.scenes.active.click_box(self, title)

    @property
    def boxes(self) -> dict[str, str]:
        """Texts of the boxes of the active scene, by their titles."""
        return self.scenes.active.boxes

    def point(self, x: float, y: float) -> Vector:
        """Move the pointer to a point of the model (m); returns its pixel. Raises ValueError."""
        if not (math.isfinite(x) and math.isfinite(y)):
            raise WrongValue("The point is ({x}, {y}); give finite coordinates, in m.", x=x, y=y)
        self.scenes.active.finish()
        view = self.stages[0][1]
        view.pointer = x, y = _near(view.camera.to_pixels((x, y)).tolist())
        return x, y

    def click(self, x: float, y: float, button: str = "click") -> None:
        """Click at a point of the model (m); `button` may be "ctrl+click", "double click" or "right click"."""
        self._clicked = None  # a double click is meant for what is there, wherever the last click was
        self.press(button, self.point(x, y))

    def drag(self, start: Vector, end: Vector, button: str = "click") -> None:
        """Drag from one point of the model (m) to another; `button` may be "ctrl+click".

        For time to pass meanwhile, press "drag", "drag to" and "drop" one by one, each at a `point`.
        """
        self.press(button.replace("click", "drag"), self.point(*start))
        self.press("drag to", self.point(*end))
        self.press("drop")

    # --- frames --------------------------------------------------------------------------------------

    def frame(self, elapsed: float) -> Frame:
        """One frame, `elapsed` s after the last: input, edit, step, events and render. Raises ValueError, ModError."""
        frame, failed = Frame(self, forward("elapsed", elapsed)), switched_off()
        try:
            for phase in Phase:
                self.schedule.run(phase, frame)
        except Exception as error:
            if not blamed_on_mod(error):
                raise
        if self.window is None:  # in one, the fault is shown
            check_mods(failed)
        return frame

    def update_view(self, elapsed: float = 0.0) -> None:
        """Bring what the view says about the run up to date, so many seconds after the last time."""
        show(self, elapsed)
        offer_tools(self)
        if self.course is not None:
            self.course.show_card()


def _near(pixel: Sequence[float]) -> Vector:
    """A pixel at a distance from the window that computes. Raises ValueError."""
    x, y = pixel
    if not (abs(x) <= FARTHEST and abs(y) <= FARTHEST):
        raise WrongValue(
            "The pixel ({x:g}, {y:g}) is too far from what is shown; take a nearer place.", x=x, y=y
        )
    return x, y
