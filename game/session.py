"""Session: one model in the program, with or without a window; what scripts and tests drive."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from components.environment import Environment
from components.field import Vector
from components.load import Load
from components.model import Model
from components.particle import Particle
from components.rod import Rod
from components.settings import Settings
from components.snapshot import Snapshot
from components.table import Table
from components.tags import Selected
from components.view import Status, View
from components.world import Handle
from game import models
from game.actions import ACTIONS
from game.catalogue import step_systems
from game.clock import FrameClock
from game.history import History
from game.scenes import Scenes, all_scenes
from game.schedule import Schedule
from game.simulation import Energy, Simulation
from systems.base import Phase, StopReason, System
from systems.input.bindings import action_for, help_lines
from systems.physics.pace import natural_pace

COMPILING = "Preparing the step program for this kind of model; a few seconds, only the first time."
DEFAULT_LIMIT = 60.0  # s of simulated time in which a model is expected to come to rest


@dataclass
class Frame:
    """What frame systems are given: the session, the time since the last frame, and its actions.

    pressed: (key or button, pixel) in the order in which a person pressed them; see input/bindings.py.
    """

    session: Session
    elapsed: float
    pressed: list[tuple[str, Vector]] = field(default_factory=list)


class Window(Protocol):
    """What a window does for actions that only make sense in one."""

    def toggle_full_screen(self) -> None:
        """Fill the screen, or stop doing so."""

    def screenshot(self) -> str:
        """Save a picture of the window; returns where."""


class Session:
    """A model with its run, its scenes and its undo log.

    >>> s = Session.open("isostatic")
    >>> s.run(until="rest")
    'at rest'
    >>> round(s.rods["AB"].axial_force, 4)
    -28.3428
    """

    def __init__(self, model: Model, systems: Iterable[System] = (), view: View | None = None) -> None:
        self.model = model
        self.schedule = Schedule([*step_systems(), *systems])
        self.simulation = Simulation(model, self.schedule)
        self.history = History(model, self.simulation.forget)
        self.scenes = Scenes(all_scenes())
        self.clock = FrameClock()
        self.view = view or View()
        self.view.fit(model)
        self.notice = ""
        self.window: Window | None = None
        self.on_press: Callable[[str, Vector | None], None] | None = None  # a recorder listens here
        self._beginning: Snapshot | None = None
        self._pace_revision = -1

    @classmethod
    def open(cls, source: str | Path | Mapping[str, Any], systems: Iterable[System] = ()) -> Session:
        """Open a model file, a bundled model by name, or a document. Raises ModelError."""
        return cls(models.load(source), systems)

    def save(self, path: str | Path) -> None:
        """Write the model, with its present state, to a file."""
        models.save(self.model, Path(path))

    # --- the model ---------------------------------------------------------------------------------

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
    def energy(self) -> Energy:
        """The energy account of the run."""
        return self.simulation.energy

    @property
    def message(self) -> str:
        """Why the run stopped, or what to beware of; "" if there is nothing to say."""
        return self.simulation.message or self.simulation.warning or self.notice

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

        Returns "at rest", "time reached", "limit reached" or "diverged"; `message` says more.
        """
        if sum(option is not None for option in (until, time, steps)) != 1 or until not in (None, "rest"):
            raise ValueError('Say how far to run: until="rest", time=SECONDS or steps=NUMBER, one of them.')
        if (time is not None and not time >= 0.0) or (steps is not None and steps < 0):
            raise ValueError("Time only runs forward; undo or restart goes back.")
        self._note_beginning()
        self.history.begin_run()
        reached = "time reached"
        if until is not None:
            reached = "limit reached"
            self.simulation.run_until_rest(self.time + limit)
        elif time is not None:
            self.simulation.run_to(self.time + time)
        elif steps is not None:
            self.simulation.advance(steps)
        if self.scene != "simulation":
            self.history.end_run()
        ended = {StopReason.REST: "at rest", StopReason.DIVERGED: "diverged"}
        return ended.get(self.simulation.reason, reached)

    def restart(self) -> None:
        """Go back to the beginning of time, keeping all edits. Can be undone."""
        if self._beginning is None:
            return
        self.history.begin_run()
        self._beginning.restore(self.model)
        self.simulation.forget()
        self.history.end_run()
        if self.scene == "simulation":
            self.history.begin_run()

    def _note_beginning(self) -> None:
        if self._beginning is None or self.model.clock.steps == 0:
            self._beginning = Snapshot.take(self.model)

    # --- editing -----------------------------------------------------------------------------------

    def undo(self) -> bool:
        """Take back the last edit or run; False if there is none."""
        return self._through_log(self.history.undo())

    def redo(self) -> bool:
        """Repeat what was taken back; False if there is nothing."""
        return self._through_log(self.history.redo())

    def _through_log(self, moved: bool) -> bool:
        if self.scene == "simulation":
            self.history.begin_run()
        return moved

    @property
    def selected(self) -> list[Handle]:
        """The selected elements, in order of creation."""
        return self.model.tagged(Selected)

    def select(self, *handles: Handle) -> None:
        """Select exactly these elements; none: deselect."""
        for handle in self.selected:
            if handle not in handles:
                self.model.untag(handle, Selected)
        for handle in handles:
            self.model.tag(handle, Selected)

    # --- scenes and actions --------------------------------------------------------------------------

    @property
    def scene(self) -> str:
        """The name of the active scene."""
        return self.scenes.active.name

    def act(self, name: str, pixel: Vector | None = None) -> None:
        """Perform a named action with the pointer at a pixel (default: the middle of the view)."""
        if name not in ACTIONS:
            raise ValueError(self.model.missing("actions", name, ACTIONS))
        ACTIONS[name](self, pixel if pixel is not None else self.view.camera.middle)
        self.scenes.apply(self)

    def press(self, key: str, pixel: Vector | None = None) -> None:
        """Press a key, such as "k", "escape" or "ctrl+z"; one that means nothing in this scene does nothing."""
        name = action_for(self.scene, key)
        if name is not None:
            if self.on_press is not None:
                self.on_press(key, pixel)
            self.notice = ""
            self.act(name, pixel)

    def click(self, x: float, y: float, button: str = "click") -> None:
        """Click at a point of the model (m); `button` may be "ctrl+click"."""
        pixel = self.view.camera.to_pixels((x, y))
        self.press(button, (float(pixel[0]), float(pixel[1])))

    # --- frames --------------------------------------------------------------------------------------

    def frame(self, elapsed: float) -> Frame:
        """One frame: input → actions → transition → fixed steps → events → picture."""
        frame = Frame(self, elapsed)
        self._phase(Phase.INPUT, frame)
        for key, pixel in frame.pressed:
            self.press(key, pixel)
        self.scenes.apply(self)
        self._phase(Phase.EDIT, frame)
        if self.scenes.active.runs:
            self._steps(elapsed)
        self._phase(Phase.EVENTS, frame)
        self.update_view()
        self._phase(Phase.RENDER, frame)
        return frame

    def _phase(self, phase: Phase, frame: Frame) -> None:
        self.schedule.run(phase, self.scene, self.model, frame)

    def _steps(self, elapsed: float) -> None:
        self._note_beginning()
        if self.simulation.halted or self._announce_compiling():
            return
        self.simulation.advance(0)
        self._find_pace()
        due = self.clock.steps(elapsed, self.model.clock.step_size)
        before = self.simulation.compute_seconds
        taken = self.simulation.advance(due)
        self.clock.took(taken, self.simulation.compute_seconds - before)

    def _announce_compiling(self) -> bool:
        """Let one frame be drawn that says what the person is about to wait for."""
        if self.simulation.ready:
            if self.notice == COMPILING:
                self.notice = ""
            return False
        announced, self.notice = self.notice == COMPILING, COMPILING
        return not announced

    def _find_pace(self) -> None:
        revision = self.simulation.armed_revision
        if revision != self._pace_revision:
            self._pace_revision = revision
            self.clock.natural = natural_pace(self.model)

    @property
    def stages(self) -> list[tuple[Model, View]]:
        """What the active scene shows: models, each in its view."""
        return self.scenes.active.stages(self)

    @property
    def busy(self) -> bool:
        """True while frames change something without a person's doing."""
        return self.scenes.active.runs and not self.simulation.halted

    def update_view(self) -> None:
        """Bring what the view says about the run up to date."""
        view, scene = self.view, self.scenes.active
        view.heading = scene.heading
        view.keys = help_lines(scene.name) if view.help else []
        view.status = Status(
            time=self.time,
            speed=self.clock.shown_pace if self.busy else 0.0,
            state=self._state_word(),
            hint=scene.hint(self),
            problem=self._problem(),
            notice=self.notice,
        )

    def _state_word(self) -> str:
        if self.simulation.halted:
            return "at rest" if self.simulation.reason is StopReason.REST else "diverged"
        if not self.busy:
            return "paused"
        return "running, slower than asked" if self.clock.lagging else "running"

    def _problem(self) -> str:
        if self.simulation.reason is StopReason.DIVERGED and self.simulation.halted:
            return self.simulation.message
        return self.simulation.warning
