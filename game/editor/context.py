"""Context: what actions, gestures and scenes read and change; the base of gestures and scenes.

`pinjoint.session.Session` is the context that scripts drive.
"""

from __future__ import annotations

import operator
import weakref
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from pinjoint.components.camera import Viewport
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.field import Vector
from pinjoint.components.handle import Handle
from pinjoint.components.language import begun, marked, tr
from pinjoint.components.mistake import NotFound, WrongValue
from pinjoint.components.model import Model
from pinjoint.components.settings import HUBS, STATICS, Settings
from pinjoint.components.tags import Selected
from pinjoint.components.view import Preview, View
from pinjoint.documents.open_documents import ModelFile, OpenDocument, OpenDocuments
from pinjoint.editor.listing import Lister
from pinjoint.scripts.script import Script
from pinjoint.systems.base import Mod
from pinjoint.systems.collision.impacts import Impacts
from pinjoint.systems.edit.pull import Pull
from pinjoint.systems.forms.properties import heading
from pinjoint.systems.input.actions import FORMS
from pinjoint.systems.render.model.sheet import Stage
from pinjoint.systems.run.energy import Energy
from pinjoint.systems.run.simulation import Simulation
from pinjoint.systems.run.system import Time
from pinjoint.systems.schedule import Schedule

if TYPE_CHECKING:  # of a window
    from pinjoint.documents.autosave import Autosave


@dataclass(frozen=True)
class Waiting:
    """That a model waits for its program to be compiled: for how long already, and in all, probably (s)."""

    seconds: float
    expected: float


class Readiness:
    """Which simulations are too large to go on before another process has compiled their program; without a window none.

    awaited: the one that was to go on, and waits. finding: what may be needed is being found, a part in every frame.
    """

    awaited: Simulation | None = None
    finding = False

    @property
    def readies(self) -> bool:
        """True while another process gets ready what makes the present run fast."""
        return False

    def waits_for(self, simulation: Simulation) -> Waiting | None:
        """What a simulation waits for; None if it can go on, interpreted or compiled."""
        return None

    def lets(self, simulation: Simulation) -> bool:
        """True if a simulation can go on now; else it is awaited."""
        self.awaited = None if self.waits_for(simulation) is None else simulation
        return self.awaited is None


# --- gestures --------------------------------------------------------------------------------------------


class Gesture:
    """One drag, or one use of a tool. Pixels are where the pointer is.

    hint: the next possible step, for the status line. free: not in steps, as long as Shift is held.
    """

    hint = marked("let go to finish     Esc cancel")
    free = False

    def move(self, context: Context, pixel: Vector) -> None:
        """The pointer moved to a pixel."""

    def drop(self, context: Context, pixel: Vector) -> None:
        """Finish at a pixel. Raises Refusal or FieldError if that cannot be; then nothing has changed."""

    def cancel(self, context: Context) -> None:
        """End as if the gesture had never begun."""

    def leave(self, context: Context) -> None:
        """Something else was begun before it was finished."""
        self.cancel(context)

    def preview(self, context: Context, pixel: Vector) -> Preview | None:
        """The preview while the gesture goes on, with the pointer at a pixel."""
        return None


# --- scenes ----------------------------------------------------------------------------------------------

# The systems that let time pass, for scenes that want what happens in a simulation.
PHYSICS = ("run.*", "physics.*", "plasticity.*", "loads.*", "collision.*", "edit.pull")


class Scene:
    """One mode. Systems say by their `scenes` in which they are active; their keys stand at the actions.

    heading: the word shown top left. targets: scenes that may follow. sources: further scenes that
    this one may follow, which need not know it. systems: names, or patterns such as "physics.*", of systems that
    are active in it although they do not name it; PHYSICS lists those that let time pass.
    like: "simulation", "pause" or "statics", as in which keys, clicks, tools and systems act in it; "": as in none.
    mod: the mod that brought it, if one did; set by the program.
    """

    name: ClassVar[str]
    heading: str = ""
    targets: ClassVar[tuple[str, ...]] = HUBS
    sources: ClassVar[tuple[str, ...]] = ()
    systems: ClassVar[tuple[str, ...]] = ()
    like: ClassVar[str] = ""
    mod: Mod | None = None

    @property
    def tools(self) -> str:
        """The scene whose tools the toolbar offers; one in which they do not act is left when one is clicked."""
        return self.name

    @property
    def message(self) -> str:
        """The question, answer or refusal of the scene; "" if none.

        Of a scene of a mod it stands where notices do; ours show it in a place of their own.
        """
        return ""

    def enter(self, context: Context) -> None:
        """The scene becomes the active one."""

    def exit(self, context: Context) -> None:
        """The scene stops being the active one."""

    def finish(self) -> None:
        """Do the work that waits until a picture has announced it."""

    def zoom(self, context: Context, factor: float, pixel: Vector) -> None:
        """Enlarge the picture by a factor about a pixel."""
        context.view.camera.zoom(factor, pixel)
        context.view.fitted = False

    def pan(self, context: Context, pixels: Vector) -> None:
        """Move the picture by pixels (right, down)."""
        context.view.camera.pan(pixels)
        context.view.fitted = False

    def fit(self, context: Context) -> None:
        """Show everything."""
        context.view.fit(context.model)

    def covers(self, context: Context) -> bool:
        """True if boxes or pictures of models take the whole window, the toolbar included."""
        return False

    def helped(self, context: Context) -> Viewport:
        """The part of the window for the list of keys."""
        return context.view.canvas

    def resized(self, context: Context) -> None:
        """The window has another size."""

    def say_again(self, context: Context) -> None:
        """The language is another one: make what was kept in words again."""

    def busy(self, context: Context) -> bool:
        """True while frames change something without a person's doing, as where time passes."""
        return context.scenes.time_passes and not context.simulation.halted

    def scaled(self, context: Context) -> list[Settings]:
        """The settings of the models whose displacements are drawn to the scale that its slider sets."""
        return [context.model.settings]

    def turn_to(self, context: Context, handle: Handle) -> None:
        """Select an element beside what is done now."""
        context.select(handle)

    def type(self, context: Context, text: str) -> None:
        """Text was typed."""

    def click_box(self, context: Context, title: str) -> None:
        """Select the box with that title. Raises LookupError."""
        raise NotFound(
            "In the scene '{scene}' there are no boxes; go to 'properties', 'save' or 'load' first.",
            scene=self.name,
        )

    @property
    def boxes(self) -> dict[str, str]:
        """Texts of the boxes, by their titles."""
        return {}

    def stages(self, context: Context) -> Sequence[Stage]:
        """The models and forms that are shown, each in its view; a pointer picks from the first."""
        return [(context.model, context.view)]

    def hint(self, context: Context) -> str:
        """The next possible step, for the status line."""
        return ""


class Scenes:
    """The state machine: exactly one scene is active; a requested transition waits for `apply`.

    hub: "pause" or "statics", whichever was active last; others lead back there. time_passes: frames let time pass.
    """

    def __init__(self, scenes: Sequence[Scene]) -> None:
        self._by_name = {scene.name: scene for scene in scenes}
        self.active = scenes[0]
        self.hub = self.active.name
        self.time_passes = False
        self._requested: list[str] = []

    def __getitem__(self, name: str) -> Scene:
        return self._by_name[name]

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all scenes."""
        return tuple(self._by_name)

    def request(self, *names: str) -> None:
        """Ask for a transition, or a chain of them. Raises WrongValue if one is not legal."""
        here = self._by_name[self._requested[-1]] if self._requested else self.active
        for name in names:
            if name not in self._by_name:
                known = ", ".join(self._by_name)
                raise WrongValue("There is no scene '{scene}'; choose from {names}.", scene=name, names=known)
            as_in = self._by_name[here.like].targets if here.like else ()
            if name not in (*here.targets, *as_in) and here.name not in self._by_name[name].sources:
                targets = ", ".join(here.targets)
                raise WrongValue(
                    "From the scene '{here}' one cannot go to '{scene}', only to {scenes}.",
                    here=here.name,
                    scene=name,
                    scenes=targets,
                )
            here = self._by_name[name]
        self._requested.extend(names)

    def show_state(self, context: Context) -> None:
        """Let the model show its static solution in statics and beside the boxes that it leads to, else its state."""
        solved = self.hub == STATICS and self.active.name in (STATICS, *FORMS)
        context.model.show(context.document.statics if solved else None)

    def request_from_pause(self, name: str) -> None:
        """Ask for a scene that is entered from pause or statics, through pause where time passes."""
        way = dict.fromkeys((*(("pause",) if self.active.name == "simulation" else ()), name))
        self.request(*(scene for scene in way if scene != self.active.name))

    def begin(self, context: Context) -> None:
        """Go to the mode in which a person is to meet the model that was opened."""
        self.request_from_pause(context.model.settings.opens_in)
        self.apply(context)

    def apply(self, context: Context) -> None:
        """Make the requested transitions: exit, then enter. From a scene of a mod that is switched off, to pause."""
        if self.active.mod is not None and self.active.mod.off and not self._requested:
            self.request("pause")
        while self._requested:
            name = self._requested.pop(0)
            self.active.exit(context)
            self.active = self._by_name[name]
            self.hub = name if name in HUBS else self.hub
            self.show_state(context)
            self.time_passes = context.schedule.is_active(Time(), name)
            self.active.enter(context)
            if self.time_passes:
                context.document.history.begin_run()
            else:
                context.document.history.end_run()


# --- the context -----------------------------------------------------------------------------------------


class Context:
    """The open documents with their runs, logs and files, what is seen of them, and what a person is doing with them.

    schedule: all systems. notice: the last sentence said. window, autosave: of a window; None without one.
    readiness: which simulations can go on.
    scenes: the mode, and its transitions. gesture: what is being drawn or dragged. footer: the strip below the picture while
    a script is shown in the window; then input is not for the scenes, and no time passes by itself.
    lesson: the script that a person asked for. course: the lessons.course.Course that a person is in.
    lister: the table of results.
    faults_seen: how many faults of mods were shown and taken away.
    """

    def __init__(
        self, model: Model, schedule: Schedule, pull: Pull, scenes: Sequence[Scene], view: View, file: ModelFile
    ) -> None:
        self.schedule = schedule
        self.documents = OpenDocuments(model, schedule, pull, file)
        self._clipboard = ""
        self.notice = ""
        self.window: Any = None  # pinjoint.app.App
        self.autosave: Autosave | None = None
        self.readiness = Readiness()
        self.scenes = Scenes(scenes)
        self.view = view
        view.session = weakref.ref(self)
        self.gesture: Gesture | None = None
        self.footer: View | None = None
        self.lesson: Script | None = None
        self.course: Any = None
        self.lister = Lister(self)
        self._blank = Model()
        self.faults_seen = len(EXTENSIONS.faults)

    # --- documents ---------------------------------------------------------------------------------

    @property
    def document(self) -> OpenDocument:
        """The document that is open, with its run, its log and its file."""
        return self.documents.current

    def save(self, path: str | Path) -> None:
        """Write the model, with its present state, to a file."""
        self.document.save(path)

    @property
    def model(self) -> Model:
        """The model that is open."""
        return self.document.model

    @property
    def simulation(self) -> Simulation:
        """The run of the open document."""
        return self.document.simulation

    @property
    def settings(self) -> Settings:
        """How the model is computed and drawn."""
        return self.model.settings

    @property
    def time(self) -> float:
        """Simulated time (s)."""
        return self.model.clock.time

    @property
    def energy(self) -> Energy:
        """The energy account of the run."""
        return self.simulation.energy

    @property
    def impacts(self) -> Impacts:
        """The impacts of the run so far, in columns."""
        return self.simulation.impacts

    # --- time --------------------------------------------------------------------------------------

    def settle(self, factors: Sequence[float] | float = (1.0,), *, anew: bool = False) -> str:
        """Go to the static equilibrium at each load factor in turn, without letting time pass.

        Can be undone. Returns "equilibrium", "neutral equilibrium" or "unstable equilibrium"; or "mechanism",
        "collapse" or "limit reached" with the last good state; `message` says more. Time moves on to the end of the
        last load history. anew: from the undeformed beginning. Raises ValueError.
        """
        status, self.notice = self.document.settle(factors, anew=anew)
        return status

    def restart(self) -> None:
        """Go back to before it was run or settled, keeping all edits. Can be undone."""
        if not self.document.is_undeformed:
            self.document.restart()
            self._go_on()

    def step(self, steps: int = 1) -> bool:
        """Go by a number of steps, back if negative; False if the run does not reach that far back or is at rest.

        Going back stops where something was edited: undo takes that back.
        """
        steps = operator.index(steps)
        begun, (whole, _) = self.model.clock.steps, self.simulation.moment
        target = (whole if steps > 0 else begun) + steps  # a step that is under way is the first
        self._act_in_scene()
        self.document.note_beginning()
        if not self.readiness.lets(self.simulation):
            return False
        self.document.history.end_run()
        self.document.history.begin_run(single=True)
        try:
            self.document.get_ready()  # so that there is a checkpoint to step back to
            if steps >= 0:
                with self.document.timeline.recording():
                    self.simulation.advance(steps)
            else:
                self.document.timeline.go_to(max(target, self.document.timeline.first))
        finally:
            self.document.history.end_run()
            self._go_on()
            self.document.chronicle.look()
        return bool(self.model.clock.steps == target)

    def _go_on(self) -> None:
        """Begin a new run in the log, if time passes in this scene."""
        if self.scenes.time_passes:
            self.document.history.begin_run()

    def _act_in_scene(self) -> None:
        """Steps that are no frame's are taken as in the active scene; where time stands still, as in simulation."""
        self.simulation.act_in(self.scene if self.scenes.time_passes else "simulation")

    # --- editing -----------------------------------------------------------------------------------

    @property
    def selected(self) -> list[Handle]:
        """The selected elements, in order of creation."""
        return self.model.tagged(Selected)

    def select(self, *handles: Handle) -> None:
        """Select exactly these elements; none: deselect."""
        self.model.tag_only(handles, Selected)

    @property
    def clipboard(self) -> str:
        """The text that was copied last, here or, with a window, in any program."""
        if self.window is not None:
            self._clipboard = self.window.copied()
        return self._clipboard

    @clipboard.setter
    def clipboard(self, text: str) -> None:
        self._clipboard = str.__str__(text)  # also of what is told in a language
        if self.window is not None:
            self.window.copy(text)

    def undo(self) -> str:
        """Take back the last edit or run, or the opening of the document; returns what it was, or ""."""
        history = self.document.history
        if history.can_undo:
            return self._through_log(history.undo())
        return self.documents.move(-1) if self.course is None else ""  # a lesson is left by its button

    def redo(self) -> str:
        """Repeat what was taken back; returns what it was, "" if there is nothing."""
        history = self.document.history
        return self._through_log(history.redo()) if history.can_redo else self.documents.move(1)

    def _through_log(self, title: str) -> str:
        self._go_on()
        return title

    def leave_gesture(self) -> None:
        """End what is being drawn or dragged before something else begins."""
        gesture, self.gesture = self.gesture, None
        if gesture is not None:
            gesture.leave(self)

    # --- scene and view ------------------------------------------------------------------------------

    @property
    def scene(self) -> str:
        """The name of the active scene."""
        return self.scenes.active.name

    @property
    def mode(self) -> str:
        """The scene as in which keys, clicks and tools act now: the active one, or what that is like."""
        return self.scenes.active.like or self.scene

    @property
    def busy(self) -> bool:
        """True while frames change something without a person's doing."""
        return self.scenes.active.busy(self)

    @property
    def stages(self) -> Sequence[Stage]:
        """All that is drawn: models and forms of the active scene, each in its view, toolbar and footer.

        A pointer picks from the first.
        """
        stages = list(self.scenes.active.stages(self))
        if not self.scenes.active.covers(self):
            stages += [(self.lister.listing, self.view)] if self.view.table[0] else []
            stages.append((self.view.toolbar, self.view))
        card = self.course.view if self.course is not None else None
        return stages + [(self._blank, view) for view in (self.footer, card) if view is not None]


def tell(context: Context, value: str, *elements: Handle) -> None:
    """Let the notice say what elements have now."""
    context.notice = tr("{element}: {value}", element=begun(heading(context.model, elements)), value=value)
