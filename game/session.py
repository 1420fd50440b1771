"""Session: one model in the program, with or without a window; what scripts and tests drive."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from components.camera import Viewport
from components.environment import Environment
from components.field import FieldError, Vector
from components.handle import Handle
from components.load import Load, loads_end
from components.model import Model
from components.particle import Particle
from components.paths import resting
from components.rod import Rod
from components.settings import Settings
from components.spelling import missing
from components.table import Table
from components.tags import Selected
from components.view import View
from game.commands.reports.curve import goal_of
from game.documents import models
from game.documents.document import missing_mods
from game.documents.history.history import History
from game.documents.history.timeline import Timeline
from game.documents.open_documents import Desk, Desks, ModelFile, file_of
from game.editor.actions import ACTIONS, WHILE_DRAWING
from game.editor.frame import Frame, Unseen, frame_systems
from game.editor.gestures import Gesture
from game.editor.host import Autosaves, Prepares, Window
from game.editor.scenes import Scenes, Stage, all_scenes, scene_systems
from game.editor.toolbar import toolbar_of
from game.editor.view_model import make_room, show
from game.mods.mod import FAULTS
from game.registry import SYSTEMS
from systems.base import EVENT_INTERVAL, Phase, StopReason, System
from systems.catalogue import step_systems
from systems.collision.impacts import Impacts
from systems.edit.pull import Pull
from systems.edit.refusal import Refusal
from systems.input.bindings import FORMS, TEXT, action_for, key_named
from systems.physics.pace import natural_pace
from systems.run.energy import Energy
from systems.run.real_time import TimeScale
from systems.run.simulation import Simulation
from systems.run.system import Time
from systems.schedule import Plan, Schedule

if TYPE_CHECKING:
    from game.editor.clipboard import Part
    from game.scripts.script import Script
    from systems.statics.events import Event
    from systems.statics.path import Curve
    from systems.statics.verify import Comparison

CLICKS = ("click", "ctrl+click", "drag", "ctrl+drag")  # the pointer may slip a little in a click on a button
ON_TOOLBAR = (*CLICKS, "wheel up", "wheel down")
DEFAULT_LIMIT = 60.0  # s of simulated time in which a model is expected to come to rest


class Session:
    """A model with its run, its scenes and its undo log.

    >>> s = Session.open("isostatic")
    >>> s.run(until="rest")
    'at rest'
    >>> round(s.rods["AB"].axial_force, 4)
    -28.3428
    """

    def __init__(
        self,
        model: Model,
        systems: Iterable[System] = (),
        view: View | None = None,
        file: ModelFile = ModelFile(),  # noqa: B008 (it cannot be changed)
    ) -> None:
        self.pull = Pull()
        scenes = all_scenes()
        self._time = Time()
        ours = [*frame_systems(), self._time, *scene_systems(), *step_systems(), self.pull]
        self.schedule = Schedule(
            [*ours, *(make() for make in SYSTEMS), *systems],
            wanted={scene.name: scene.systems for scene in scenes},
        )
        self.desks = Desks(model, self.schedule, self.pull, file)
        self.scenes = Scenes(scenes)
        self.view: View = view or View()
        self.gesture: Gesture | None = None
        self._clipboard = ""
        self.copied: tuple[str, Part] | None = None  # what was put on the clipboard last, as text and as data
        self.notice = ""
        self.window: Window | None = None
        self.on_press: Callable[[str, Vector | None], None] | None = None  # a recorder listens here
        self.on_resize: Callable[[], None] | None = None  # and here
        self.autosave: Autosaves | None = None  # keeps unsaved work, in a window
        self.preparation: Prepares | None = None  # compiles ahead of need, in a window
        # A script is shown in a window: input is not for the scenes, and no time passes by itself.
        self.performing = False
        self.footer: View | None = None  # what stands below the picture meanwhile
        self.lesson: Script | None = None  # that a person asked for
        self.awaited: Simulation | None = None  # something could not be done without its step program
        self._blank = Model()  # what the footer is drawn over
        self.faults_told = len(FAULTS)  # of mods; the others are shown
        self.offer_tools()
        self._begin_at_desk()

    @classmethod
    def open(
        cls,
        source: str | Path | Mapping[str, Any],
        systems: Iterable[System] = (),
        mods: Iterable[str | Path] = (),
    ) -> Session:
        """Open a model file, a bundled model by name, or a document. Raises ModelError.

        systems: further ones for this session. mods: folders of mods to load first, for the whole program;
        raises ModError if one of them cannot be used.
        """
        if folders := list(mods):
            from game.mods import load_all

            load_all(folders)
        return cls(models.load(source), systems, file=file_of(source))

    # --- files -------------------------------------------------------------------------------------

    @property
    def desk(self) -> Desk:
        """The model that is open, with its run, its log and its file."""
        return self.desks.current

    @property
    def file(self) -> ModelFile:
        """Where the model is saved again, and its name."""
        return self.desk.file

    def save(self, path: str | Path) -> None:
        """Write the model, with its present state, to a file."""
        self.simulation.account_for_edits()
        models.save(self.model, Path(path))

    def save_as(self, path: str | Path) -> None:
        """Write the model to a file that is its own from now on. Raises ModelError."""
        path = Path(path)
        self.save(path)
        self.desk.file = ModelFile.at(path)
        self.desk.saved = self.model.revision
        self.notice = f"Saved as '{path.stem}'."

    def __reduce_ex__(self, protocol: object) -> NoReturn:
        raise TypeError(
            "A session cannot be copied or pickled; save its model, and open that in another session."
        )

    def __repr__(self) -> str:
        name, model = self.file.name or "untitled", self.model
        size = f"{model.particles.count} particles, {model.rods.count} rods"
        return f"<Session '{name}': {size}, {self.scene}, t = {self.time:.6g} s>"

    def open_here(self, source: str | Path | Mapping[str, Any] | None) -> None:
        """Go on with another model, a new one if None; undo goes back to this one. Raises ModelError."""
        if source is None:
            self.adopt(Model())
        else:
            self.adopt(models.load(source), file_of(source))

    def adopt(self, model: Model, file: ModelFile = ModelFile()) -> None:  # noqa: B008
        """Go on with another model. Unsaved work stays open; undo goes back to it."""
        self.leave_gesture()
        self.desks.add(model, file)
        self._begin_at_desk()

    def _begin_at_desk(self) -> None:
        make_room(self)
        self.view.fit(self.model)
        if missing := missing_mods(self.model):
            self.notice = (
                f"This model holds data of mods that are not loaded: {', '.join(missing)}. They are kept and"
                " saved again, but have no effect."
            )
        if self.time_passes:
            self.history.begin_run()

    # --- the model ---------------------------------------------------------------------------------

    @property
    def model(self) -> Model:
        """The model that is open."""
        return self.desk.model

    @property
    def simulation(self) -> Simulation:
        """Its run."""
        return self.desk.simulation

    @property
    def timeline(self) -> Timeline:
        """The moments of its run to go back to."""
        return self.desk.timeline

    @property
    def history(self) -> History:
        """Its undo log."""
        return self.desk.history

    @property
    def particles(self) -> Table[Particle]:
        """Particles by name."""
        return self.model.particles

    @property
    def rods(self) -> Table[Rod]:
        """Rods by name."""
        return self.model.rods

    @property
    def loads(self) -> Table[Load]:
        """Loads by name."""
        return self.model.loads

    def table(self, name: str) -> Table[Any]:
        """The elements of any kind by name, those that mods add included: session.table("walls")["floor"]."""
        if name not in self.model.tables:
            raise KeyError(missing("tables", name, self.model.tables))
        return self.model.tables[name]

    @property
    def environment(self) -> Environment:
        """What acts on every particle."""
        return self.model.environment

    @property
    def settings(self) -> Settings:
        """How the model is computed and drawn."""
        return self.model.settings

    @property
    def time(self) -> float:
        """Simulated time (s)."""
        return self.model.clock.time

    @property
    def clock(self) -> TimeScale:
        """How fast time passes in the window."""
        return self.desk.live.clock

    @property
    def energy(self) -> Energy:
        """The energy account of the run."""
        return self.simulation.energy

    @property
    def impacts(self) -> Impacts:
        """The impacts of the run so far, in columns."""
        return self.simulation.impacts

    @property
    def message(self) -> str:
        """What the scene asks or refuses, why the run stopped, or what to beware of; "" if there is nothing to say."""
        simulation = self.simulation
        said = (
            self.fault
            or self.scenes.active.message
            or (simulation.message if simulation.armed else "")  # else it is about what was before an edit
            or simulation.warning
            or simulation.note
            or self.notice
        )
        return " ".join([*filter(None, [said]), *(remark.message for remark in self.remarks)])

    @property
    def remarks(self) -> tuple[Event, ...]:
        """What the run did that a slowly growing load would not have done, once it is at rest."""
        return self.desk.assessment.remarks

    @property
    def fault(self) -> str:
        """The mod that failed last and why, until Escape is pressed; "" if none did."""
        return FAULTS[-1] if len(FAULTS) > self.faults_told else ""

    # --- time --------------------------------------------------------------------------------------

    def run(
        self,
        until: str | None = None,
        *,
        time: float | None = None,
        steps: int | None = None,
        limit: float = DEFAULT_LIMIT,
    ) -> str:
        """Let time pass: until "rest" (at most `limit` s of simulated time), by `time` s, or by `steps`.

        Returns "at rest", "time reached", "limit reached" or "diverged"; `message` says more. Raises ValueError.
        """
        if sum(option is not None for option in (until, time, steps)) != 1 or until not in (None, "rest"):
            raise ValueError('Say how far to run: until="rest", time=SECONDS or steps=NUMBER, one of them.')
        limit = _forward("limit", limit)
        time = None if time is None else _forward("time", time)
        steps = None if steps is None else int(_forward("steps", steps, whole=True))
        self.act_in_scene()
        self._note_beginning()
        self.history.begin_run()
        self.timeline.begin()
        reached = "time reached"
        with self.without_frames():
            if until is not None:
                reached = "limit reached"
                self.simulation.run_until_rest(self.time + limit)
            elif time is not None:
                self.simulation.run_to(self.time + time)
            elif steps is not None:
                self.simulation.advance(steps)
        if self.simulation.reason is not StopReason.REST and steps is None:
            self.timeline.clear()  # the last step was a short one, which stepping back does not take again
        if not self.time_passes:
            self.history.end_run()
        ended = {StopReason.REST: "at rest", StopReason.DIVERGED: "diverged"}
        return ended.get(self.simulation.reason, reached)

    @contextmanager
    def without_frames(self) -> Iterator[None]:
        """While time passes inside, systems of phase EVENTS run every EVENT_INTERVAL steps, and when it has passed."""
        simulation, frame = self.simulation, Unseen(self, 0.0)
        if self.performing or not self.schedule.runs_headless(Phase.EVENTS, simulation.scene, self.model):
            yield
            return

        def follow() -> int:
            beyond = self.model.clock.steps % EVENT_INTERVAL
            if beyond == 0:
                self.schedule.run(Phase.EVENTS, frame, headless=True)
            return EVENT_INTERVAL - beyond

        simulation.watchers.append(follow)
        try:
            yield
        finally:
            simulation.watchers.remove(follow)
        self.schedule.run(Phase.EVENTS, frame, headless=True)

    def settle(self, factors: Sequence[float] | float = (1.0,)) -> str:
        """Go to the static equilibrium at each load factor in turn, without letting time pass.

        Can be undone. Returns "equilibrium", or "mechanism", "collapse" or "limit reached" with the last
        good state; `message` says more. Time moves on to the end of the last load history. Raises ValueError.
        """
        from systems.statics.settle import settle

        found, strain = settle(self.model, factors), self.rods.plastic_strain.copy()
        with self.model.transaction("settle"):
            self.model.give("particles.displacement", found.final.displacement)
            self.model.give("particles.velocity", np.zeros_like(found.final.displacement))
            self.model.give("rods.plastic_strain", found.final.plastic_strain)
            time = max(self.time, loads_end(self.model))
            self.model.give("clock.time", np.array([time]))
            self.model.give("clock.origin", np.array([time]))
            self.model.give("clock.origin_steps", np.array([self.model.clock.steps]))
            if len(found.final.contacts) and not self.simulation.driver.exact:
                self.model.clock.paths = resting(found.final.contacts, 1000.0 * found.final.contact_force)
        self.notice = found.account
        yielded = np.flatnonzero(found.final.plastic_strain != strain)
        if len(yielded) and not found.events:  # at once: what it began from is beyond the strengths
            named = (
                f"{len(yielded)} rods have" if len(yielded) > 1 else f"{self.name(self.rods[yielded[0]])} has"
            )
            self.notice += f" {named} yielded at once."
        self.notice = " ".join(filter(None, [self.notice, self.schedule.left_out_of_statics(self.model)]))
        return found.status

    def compare(self) -> Comparison:
        """The run as it is now beside linear and exact theory: `rows` of every element, and the `worst`.

        >>> s = Session.open("isostatic")
        >>> s.compare().worst("linear").title
        'displacement y of particle B'
        """
        return self.desk.assessment.comparison()

    def load_path(self, factor: float = 1.0, *, until: str | None = None, points: int = 500) -> Curve:
        """The load–displacement curve, through limit points, up to a load factor or a displacement "B.y=-2.5".

        Changes nothing. Its arrays are load_factor (k,), displacement (k, particles, 2) in m, axial_force
        (k, rods) in kN and stable (k,); complete: False if it could not be followed so far. Raises ValueError.
        """
        from systems.statics.path import load_path

        if points < 2:
            raise ValueError(f"points is {points}; a curve has at least 2.")
        return load_path(self.model, goal_of(self.model, factor, until), points=points)

    def restart(self) -> None:
        """Go back to the beginning of time, keeping all edits. Can be undone."""
        if self.desk.beginning is None or self.at_beginning:
            return
        self.history.end_run()
        self.history.begin_run()
        self.desk.beginning.restore(self.model)
        self.model.writable("particles.velocity")[self.particles.fixed] = 0.0  # supported since
        self.simulation.start_anew()
        self.timeline.clear()
        self.history.end_run()
        if self.time_passes:
            self.history.begin_run()

    def step(self, steps: int = 1) -> bool:
        """Go by so many fixed steps, back if negative; False if one cannot go back that far (or is at rest).

        Going back stops where something was edited: undo takes that back.
        """
        steps = operator.index(steps)
        target = self.model.clock.steps + steps
        self.act_in_scene()
        self._note_beginning()
        if not self.has_program(self.simulation):
            return False
        self.history.end_run()
        self.history.begin_run(single=True)
        self.get_ready()  # so that the moment that stepping back may return to is
        if steps >= 0:
            with self.timeline.recording():
                self.simulation.advance(steps)
        else:
            self.timeline.go_to(max(target, self.timeline.first))
        self.history.end_run()
        if self.time_passes:
            self.history.begin_run()
        return bool(self.model.clock.steps == target)

    @property
    def pace(self) -> float:
        """Simulated seconds per second shown that suit the model as it is now, whatever a person chose."""
        return natural_pace(self.model)  # found anew: the clock's may be from any earlier frame

    def _note_beginning(self) -> None:
        if self.at_beginning:
            self.desk.begin()

    @property
    def at_beginning(self) -> bool:
        """True if no time has passed, or restarting took it back."""
        beginning = self.desk.beginning
        return beginning is None or self.model.clock.steps == beginning.columns["clock.steps"][0]

    # --- editing -----------------------------------------------------------------------------------

    @property
    def can_undo(self) -> bool:
        """True if there is something to take back."""
        return self.history.can_undo or self.desks.can_move(-1)

    @property
    def can_redo(self) -> bool:
        """True if there is something to repeat."""
        return self.history.can_redo or self.desks.can_move(1)

    def undo(self) -> str:
        """Take back the last edit or run, or the opening of the model; returns what it was, or ""."""
        return self._through_log(self.history.undo()) if self.history.can_undo else self._to_desk(-1)

    def redo(self) -> str:
        """Repeat what was taken back; returns what it was, "" if there is nothing."""
        return self._through_log(self.history.redo()) if self.history.can_redo else self._to_desk(1)

    def _to_desk(self, by: int) -> str:
        self.leave_gesture()
        opening = self.desks.move(by)
        if opening:
            self._begin_at_desk()
        return opening

    def _through_log(self, title: str) -> str:
        if self.time_passes:
            self.history.begin_run()
        return title

    @property
    def selected(self) -> list[Handle]:
        """The selected elements, in order of creation."""
        return self.model.tagged(Selected)

    @property
    def has_selected(self) -> bool:
        """True if anything is selected."""
        return self.model.any_tagged(Selected)

    def select(self, *handles: Handle) -> None:
        """Select exactly these elements; none: deselect."""
        self.model.tag_only(handles, Selected)

    def name(self, handle: Handle) -> str:
        """An element as a sentence begins with it, such as "Rod AB"."""
        described = self.model.describe(handle)
        return described[:1].upper() + described[1:]

    @property
    def clipboard(self) -> str:
        """What was copied, here or, with a window, in any program."""
        return self.window.copied() if self.window is not None else self._clipboard

    @clipboard.setter
    def clipboard(self, text: str) -> None:
        self._clipboard = text
        if self.window is not None:
            self.window.copy(text)

    # --- scenes and actions --------------------------------------------------------------------------

    @property
    def scene(self) -> str:
        """The name of the active scene."""
        return self.scenes.active.name

    @property
    def time_passes(self) -> bool:
        """True while frames let time pass in the model that is open."""
        return self.schedule.is_active(self._time, self.scene)

    def plan(self, scene: str | None = None) -> Plan:
        """Which systems run in a scene (by default the active one) with the model, in order, and why others do not.

        >>> Session.open("isostatic").plan("pause").left_out["run.time"]
        'not active in pause, only in simulation'
        """
        return self.simulation.planned(scene or self.scene)

    def act(self, name: str, pixel: Vector | None = None) -> None:
        """Perform a named action with the pointer at a pixel; what it refuses is said in `notice`."""
        if name not in ACTIONS:
            raise ValueError(missing("actions", name, ACTIONS))
        if name not in WHILE_DRAWING:
            self.leave_gesture()
        try:
            ACTIONS[name](self, pixel if pixel is not None else self.pointer)
        except (Refusal, FieldError) as error:
            self.notice = str(error)
        self.scenes.apply(self)
        make_room(self)
        self.offer_tools()

    def offer_tools(self) -> None:
        """Let the toolbar show what can be done now; behind a panel it stays as it was."""
        if self.scene not in FORMS:
            self.view.toolbar = toolbar_of(self)

    def leave_gesture(self) -> None:
        """End what is being drawn or dragged, because something else begins."""
        gesture, self.gesture = self.gesture, None
        if gesture is not None:
            gesture.leave(self)

    @property
    def pointer(self) -> Vector:
        """The pixel where the pointer is; the middle of the view if it is outside."""
        return self.view.pointer or self.view.camera.middle

    def press(self, key: str, pixel: Vector | None = None) -> None:
        """Press a key, such as "k", "escape" or "ctrl+z"; one that means nothing in this scene does nothing.

        Raises ValueError if no key is called so.
        """
        self.press_named(key_named(key), pixel)

    def press_named(self, key: str, pixel: Vector | None) -> None:
        """Press a key or button by the name that bindings know it by, or type a text."""
        if key.startswith(TEXT):
            self.type(key.removeprefix(TEXT))
            return
        pixel = pixel if pixel is not None else self.pointer
        name = self._action_at(key, pixel)
        if key == "escape" and self.fault and self.scene not in FORMS:
            self.faults_told = len(FAULTS)
        elif name is not None:
            if self.on_press is not None:
                self.on_press(key, pixel)
            if self.time_passes:
                self.get_ready()
            self.notice = ""
            self.act(name, pixel)

    def _action_at(self, key: str, pixel: Vector) -> str | None:
        """What a key or button does, with the pointer at a pixel: on the toolbar, clicks do what it offers.

        Where the keys are listed, Escape leaves the list and nothing else.
        """
        if key == "escape" and self.view.help:
            return "close help"
        if key not in ON_TOOLBAR or self.scene in FORMS or not self.view.strip.contains(pixel):
            return action_for(self.scene, key)
        buttons = self.view.toolbar.buttons(self.view.camera.viewport, self.view.pixel_ratio)
        hit = (button.tool for button in buttons if button.contains(pixel))
        return next((tool.action for tool in hit if tool.enabled and key in CLICKS), None)

    def resize(self, width: int, height: int, pixel_ratio: float = 1.0) -> None:
        """The window has so many pixels now, and so many for each point."""
        self.view.camera.viewport, self.view.pixel_ratio = Viewport(0, 0, width, height), pixel_ratio
        if self.view.fitted:
            self.view.fit(self.model)
        if self.on_resize is not None:
            self.on_resize()
        self.scenes.active.resized(self)

    def type(self, text: str) -> None:
        """Type text into the selected box of properties, save and load."""
        if self.on_press is not None:
            self.on_press(TEXT + text, None)
        self.scenes.active.type(self, text)
        self.scenes.apply(self)

    def expect(self, text: str) -> None:
        """Raise ExpectationError, an AssertionError, unless a text such as "scene = pause" is true.

        Also "rods.AB.axial_force ≈ -28.34 ± 0.01", "energy.imbalance < 1"; see game/scripts/script.py.
        """
        from game.scripts.expectation import expect

        expect(self, text)

    def click_box(self, title: str) -> None:
        """Select the box with that title. Raises LookupError if there is none."""
        self.scenes.active.click_box(self, title)

    @property
    def boxes(self) -> dict[str, str]:
        """What the boxes of this scene contain, by their titles."""
        return self.scenes.active.boxes

    def point(self, x: float, y: float) -> Vector:
        """Move the pointer to a point of the model (m); returns its pixel. Raises ValueError."""
        if not (math.isfinite(x) and math.isfinite(y)):
            raise ValueError(f"The point is ({x}, {y}); give finite coordinates, in m.")
        self.scenes.active.finish()
        x, y = self.focus[1].camera.to_pixels((x, y)).tolist()
        self.focus[1].pointer = x, y
        return x, y

    def click(self, x: float, y: float, button: str = "click") -> None:
        """Click at a point of the model (m); `button` may be "ctrl+click"."""
        self.press(button, self.point(x, y))

    def drag(self, start: Vector, end: Vector, button: str = "click") -> None:
        """Drag from one point of the model (m) to another; `button` may be "ctrl+click"."""
        self.grab(*start, button)
        self.drag_to(*end)
        self.drop()

    def grab(self, x: float, y: float, button: str = "click") -> None:
        """Begin to drag at a point of the model (m); time may pass until `drop`."""
        self.press(button.replace("click", "drag"), self.point(x, y))

    def drag_to(self, x: float, y: float) -> None:
        """Drag what is held to a point of the model (m)."""
        self.press("drag to", self.point(x, y))

    def drop(self) -> None:
        """Let go of what is held."""
        self.press("drop")

    # --- frames --------------------------------------------------------------------------------------

    def frame(self, elapsed: float) -> Frame:
        """One frame, `elapsed` s after the last: input, edit, step, events and render. Raises ValueError."""
        frame = Frame(self, _forward("elapsed", elapsed))
        for phase in Phase:
            self.schedule.run(phase, frame)
        return frame

    def act_in_scene(self) -> None:
        """Let time pass under the systems of the active scene; where time stands still, under those of simulation."""
        self.simulation.act_in(self.scene if self.time_passes else "simulation")

    def get_ready(self) -> None:
        """Account for edits as if a frame had begun, so that what follows does not depend on when frames do."""
        self._note_beginning()
        if not self.simulation.halted and self.has_program(self.simulation):
            self.simulation.advance(0)

    def advance(self, elapsed: float) -> None:
        """Let the time of one frame pass in the model, under the laws that act in the active scene."""
        self.act_in_scene()
        self._note_beginning()
        if self.simulation.halted or not self.has_program(self.simulation):
            return
        with self.timeline.recording():
            self.desk.live.frame(elapsed)

    def has_program(self, simulation: Simulation) -> bool:
        """False while the step program is compiled elsewhere, which is said; without a window it is compiled here."""
        self.awaited = None if self.waited_for(simulation) is None else simulation
        return self.awaited is None

    def waited_for(self, simulation: Simulation) -> float | None:
        """Seconds that a step program has been waited for, or None if it can be had at once."""
        return self.preparation.waits_for(simulation) if self.preparation is not None else None

    @property
    def focus(self) -> tuple[Model, View]:
        """The model that a pointer picks from, and its view."""
        return self.scenes.active.focus(self)

    @property
    def stages(self) -> Sequence[Stage]:
        """What the active scene shows: models, each in its view, and the toolbar if it has one."""
        stages = list(self.scenes.active.stages(self))
        if self.scene not in FORMS:
            stages.append((self.view.toolbar, self.view))
        if self.footer is not None:
            stages.append((self._blank, self.footer))
        return stages

    @property
    def busy(self) -> bool:
        """True while frames change something without a person's doing."""
        return self.scenes.active.busy(self)

    def update_view(self) -> None:
        """Bring what the view says about the run up to date."""
        show(self)
        self.offer_tools()


def _forward(name: str, value: float, *, whole: bool = False) -> float:
    """How far a run goes, which a script said. Raises ValueError."""
    number = isinstance(value, int | np.integer | (np.integer if whole else float | np.floating))
    if not number or isinstance(value, bool) or not math.isfinite(value):
        kind = "whole" if whole else "finite"
        raise ValueError(f"{name} is {value!r}; it must be a {kind} number.")
    if value >= 2**63:
        raise ValueError(f"{name} is {value}; it must be below 2^63.")
    if value < 0:
        raise ValueError(f"{name} is {value}; time only runs forward: undo or restart goes back.")
    return float(value)
