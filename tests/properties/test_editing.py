"""Editing by random actions: nothing crashes, the model stays sound, undo and redo are exact."""

from typing import Any

from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, rule

from pinjoint import Session
from pinjoint.components.toolbar import Tool
from pinjoint.systems.input.actions import ACTIONS, LIVE
from tests.properties.soundness import check_sound, contents
from tests.reference.hits import hits_in
from tests.reference.sessions import put_states_aside

EMPTY = {"format": "pinjoint model", "version": 1}
FRAME = 1.0 / 60.0


class Editing(RuleBasedStateMachine):
    """A person who does anything, on a small area so that things meet; fuzz.py goes on for 10 000 actions."""

    places = st.tuples(st.integers(-4, 4), st.integers(-4, 4)).map(lambda p: (0.5 * p[0], 0.5 * p[1]))

    @initialize(model=st.sampled_from([EMPTY, "isostatic", "collision_i"]))
    def open(self, model: Any) -> None:
        self.session = Session.open(model)
        self.session.view.camera.scale = 100.0
        # most of them
        put_states_aside(self.session, beyond=4 * self.session.simulation.checkpoint().state.nbytes)
        self.start = contents(self.session.model)

    @rule(at=places, key=st.sampled_from("plcfv"))
    def point_and_press(self, at: tuple[float, float], key: str) -> None:
        self.session.point(*at)
        self.session.press(key)

    @rule(
        key=st.sampled_from(
            sorted({b.key for _, b in ACTIONS.bound() if set(b.scenes) & set(LIVE)} - set("sdk"))
        )
    )
    def press(self, key: str) -> None:
        if key not in ("return", "ctrl+o", "ctrl+s", "ctrl+n", "drag middle"):
            self.session.press(key)

    def on_button(self, at: tuple[float, float]) -> bool:
        """Whether a point lies behind the toolbar or the card of an empty model: a click could leave it for good."""
        pixel, session = self.session.point(*at), self.session
        return any(isinstance(hit.item, Tool) and hit.contains(pixel) for hit in hits_in(session))

    @rule(at=places, button=st.sampled_from(["click", "ctrl+click"]))
    def click(self, at: tuple[float, float], button: str) -> None:
        if not self.on_button(at):
            self.session.click(*at, button)

    @rule(start=places, end=places, button=st.sampled_from(["click", "click", "ctrl+click"]))
    def drag(self, start: tuple[float, float], end: tuple[float, float], button: str) -> None:
        if not self.on_button(start):
            self.session.drag(start, end, button)

    @rule(start=places, end=places)
    def grab(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        if not self.on_button(start):
            self.session.grab(*start)
            self.session.drag_to(*end)

    @rule(count=st.integers(1, 4))
    def frames(self, count: int) -> None:
        for _ in range(count):
            self.session.frame(FRAME)

    @rule(steps=st.integers(-300, 300))
    def step(self, steps: int) -> None:
        self.session.leave_gesture()
        self.session.step(steps)

    @rule(key=st.sampled_from(["ctrl+z", "ctrl+z", "ctrl+y"]))
    def go_through_the_log(self, key: str) -> None:
        self.session.press(key)

    @invariant()
    def sound(self) -> None:
        if hasattr(self, "session"):
            check_sound(self.session.model)

    def teardown(self) -> None:
        if not hasattr(self, "session"):
            return
        session = self.session
        session.leave_gesture()
        if session.scene == "simulation":
            session.press("space")
        while session.redo():  # what was taken back and not replaced by anything else
            pass
        end = contents(session.model)
        entries = 0
        while session.undo():
            check_sound(session.model)
            entries += 1
        assert contents(session.model) == self.start
        for _ in range(entries):
            assert session.redo()
        assert contents(session.model) == end
        assert not session.redo()


TestEditing = Editing.TestCase
TestEditing.settings = settings(
    max_examples=25,
    stateful_step_count=40,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)
