"""Sound: what is heard of a run, where there is a device; nothing where there is none, or nobody wants to hear."""

from typing import Any

import numpy as np
import pygame
import pytest

from pinjoint import Session
from pinjoint.app import App
from pinjoint.documents import models
from pinjoint.documents.preferences import preferred
from pinjoint.systems.render import pygame_sound
from pinjoint.systems.render.pygame_sound import RATE, TONES, PygameSound, tone
from pinjoint.systems.run import real_time
from tests.systems.edit.hand import FRAME


@pytest.fixture(autouse=True)
def keeps_the_pace(monkeypatch: pytest.MonkeyPatch) -> None:
    """Frames take all the steps that are due, on any machine."""
    for limit in ("BUDGET", "LONGEST_STEP", "AT_ONCE"):
        monkeypatch.setattr(real_time, limit, 10.0)


class Listener(PygameSound):
    """Notes what it would play."""

    def __init__(self) -> None:
        super().__init__()
        self.heard: list[tuple[tuple[float, ...], float]] = []

    def _play(self, heard: tuple[float, ...], loudness: float) -> None:
        self.heard.append((heard, loudness))


def listened(name: str | dict[str, Any], seconds: float, **view: Any) -> Listener:
    listener = Listener()
    session = Session(models.load(name), [listener])
    session.view.sound = True
    vars(session.view).update(view)
    session.press("space")
    for _ in range(round(seconds / FRAME)):
        session.frame(FRAME)
    return listener


@pytest.mark.parametrize("heard", [*TONES.values(), (440.0, 440.0, 0.2, 0.1)])
def test_a_tone_has_its_pitch_and_dies_away(heard: tuple[float, float, float, float]) -> None:
    begin, end, seconds, _ = heard
    samples = tone(*heard).astype(float)
    assert len(samples) == pytest.approx(RATE * seconds, abs=1)
    strength = np.abs(np.fft.rfft(samples))
    loudest = np.fft.rfftfreq(len(samples), 1.0 / RATE)[strength.argmax()]
    assert 0.9 * min(begin, end) <= loudest <= 1.1 * max(begin, end)
    assert np.abs(samples[-len(samples) // 10 :]).max() < 0.02 * np.abs(samples).max()


def test_impacts_are_heard_by_mass_and_impulse() -> None:
    def balls(mass: float) -> dict[str, Any]:
        moving = {"name": "A", "position": [0, 0], "velocity": [5, 0], "mass": mass}
        still = {"name": "B", "position": [0.5, 0], "mass": mass}
        return {"format": "pinjoint model", "version": 1, "particles": [moving, still]}

    ((light, loudness),) = listened(balls(0.1), 0.5).heard
    ((heavy, _),) = listened(balls(100.0), 0.5).heard
    assert loudness == 1.0
    assert light[0] > 4.0 * heavy[0]


def test_yields_are_heard_once_and_nothing_if_sound_is_off() -> None:
    assert [heard for heard, _ in listened("overshoot_yield", 3.0).heard] == [TONES["yield"]]
    assert listened("newtons_cradle", 1.0, sound=False).heard == []


def test_of_many_impacts_few_are_heard_in_a_frame() -> None:
    heard = listened("billiards_break", 0.5).heard
    assert 3 <= len(heard) <= 3 * round(0.5 / FRAME)


def test_a_device_is_opened_when_something_is_heard_first(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SDL_AUDIODRIVER", "dummy")
    sound, session = PygameSound(), Session.open("collision_iii")
    session.view.sound = True
    frame = session.frame(0.0)
    sound.process(frame)
    assert not pygame.mixer.get_init()
    session.press("space")
    try:
        for _ in range(20):
            sound.process(session.frame(FRAME))
        assert pygame.mixer.get_init()
        assert not sound.silent
    finally:
        pygame.mixer.quit()


def test_without_a_device_it_is_silent(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("SDL_AUDIODRIVER", "no such driver")
    sound, session = PygameSound(), Session.open("collision_iii")
    session.view.sound = True
    session.press("space")
    for _ in range(20):
        sound.process(session.frame(FRAME))
    assert sound.silent
    assert not pygame.mixer.get_init()
    assert capfd.readouterr().err == ""


def test_one_click_switches_it_off_for_the_next_time_too(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pygame_sound, "PygameSound", Listener)
    app = App(models.load("pendulum"))
    try:
        assert app.session.view.sound
        app.frame(FRAME)
        app.session.act("toggle sound")
        app.frame(FRAME)
        assert (app.session.view.sound, preferred("sound")) == (False, False)
    finally:
        app.close()
