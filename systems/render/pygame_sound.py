"""Sound: a short tone for every impact, yield, snap and collapse that is seen, made when it is first heard."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pygame
from numpy.typing import NDArray

from pinjoint.systems.base import Phase, System

RATE = 22_050  # samples a second
_OF_A_KILOGRAM = (
    660.0  # Hz, of the impact of 1 kg; heavier ones sound lower, by the fourth root of the mass, as plates do
)
LOWEST, HIGHEST = 90.0, 2500.0  # Hz
_AT_A_TIME = 3  # impacts of a frame that are heard, the strongest
AGAIN = 1.0  # s after which the same event is heard again
# Of other events: from and to which frequency the tone glides (Hz), how long it lasts (s), and its share of noise.
TONES = {
    "yield": (240.0, 170.0, 0.3, 0.25),
    "hinge": (240.0, 170.0, 0.3, 0.25),
    "buckling": (500.0, 250.0, 0.15, 0.1),
    "snap-through": (300.0, 900.0, 0.2, 0.1),
    "collapse": (95.0, 45.0, 0.9, 0.6),
}


def tone(begin: float, end: float, seconds: float, noise: float) -> NDArray[np.int16]:
    """Samples of a struck tone that glides from one frequency (Hz) to another and dies away; noise: its share of that."""
    time = np.arange(int(RATE * seconds)) / RATE
    phase = 2.0 * np.pi * np.cumsum(begin * (end / begin) ** (time / seconds)) / RATE
    wave = 0.75 * np.sin(phase) + 0.25 * np.sin(2.76 * phase)  # the second mode of a free bar
    hiss = np.random.default_rng(0).uniform(-1.0, 1.0, len(time))
    fading = np.exp(-6.0 * time / seconds) * np.minimum(time / 0.002, 1.0)
    return (20_000.0 * fading * ((1.0 - noise) * wave + noise * hiss)).astype(np.int16)


class PygameSound(System):
    """Plays what happened since the last frame, where sound is wanted and there is a device; else it looks at nothing."""

    name = "render.sound"
    phase = Phase.RENDER
    after = ("render.view",)
    reads = ("state", "view")

    def __init__(self) -> None:
        self.silent = False  # there is no device
        self._tones: dict[tuple[float, ...], pygame.mixer.Sound] = {}
        self._told: Any = None  # what the chronicle told last
        self._lately: dict[
            tuple[str, tuple[str, ...]], float
        ] = {}  # events, and for how long (s) they are not heard again
        self._impacts: Any = None
        self._count, self._strongest = 0, 0.0

    def process(self, frame: Any) -> None:
        """Play the impacts and events of a frame in which time passed."""
        session = frame.session
        if self.silent or not session.view.sound or not session.busy:
            return
        told = session.document.chronicle.newest
        for heard, loudness in (*self._events(told, frame.elapsed), *self._struck(session)):
            if not self.silent:
                self._play(heard, loudness)

    def _events(self, told: Any, elapsed: float) -> Iterator[tuple[tuple[float, ...], float]]:
        """Tones of what was told since the last frame, with their loudness from 0 to 1; what goes on is heard once."""
        self._lately = {what: left - elapsed for what, left in self._lately.items() if left > elapsed}
        if told is self._told:
            return
        self._told, before = told, set(self._lately)
        self._lately |= {(one.kind, one.elements): AGAIN for one in told if one.kind in TONES}
        yield from ((TONES[kind], 0.8) for kind in {kind for kind, _ in self._lately.keys() - before})

    def _struck(self, session: Any) -> Iterator[tuple[tuple[float, ...], float]]:
        """Tones of the strongest impacts since the last frame, by the lighter of the two that met and the impulse."""
        impacts, mass = session.impacts, session.model.particles.mass
        if impacts is not self._impacts:
            self._impacts, self._count, self._strongest = impacts, len(impacts), 0.0
        since, self._count = min(self._count, len(impacts)), len(impacts)
        if since == self._count:
            return
        impulse = impacts.impulse[since:]
        self._strongest = max(self._strongest, float(impulse.max()))
        for number in np.argsort(impulse)[: -_AT_A_TIME - 1 : -1].tolist():
            loudness = float(impulse[number]) / max(self._strongest, 1e-300)
            if loudness > 1e-3:  # of the strongest; else contacts that come to rest
                met = [int(row[since + number]) for row in (impacts.first, impacts.second)]
                lighter = min(float(mass[row]) for row in met if row < len(mass))
                pitch = min(max(_OF_A_KILOGRAM * lighter**-0.25, LOWEST), HIGHEST)
                pitch = 440.0 * 2.0 ** (round(12.0 * math.log2(pitch / 440.0)) / 12.0)  # so that few are made
                yield (pitch, pitch, 0.2, 0.1), math.sqrt(loudness)  # s that it lasts, and begins

    def _play(self, heard: tuple[float, ...], loudness: float) -> None:
        if not pygame.mixer.get_init():
            try:
                with _quietly():
                    pygame.mixer.init(RATE, -16, 1, 512)
            except pygame.error:
                self.silent = True
                return
        if heard not in self._tones:
            self._tones[heard] = pygame.mixer.Sound(buffer=tone(*heard).tobytes())
        self._tones[heard].set_volume(loudness)
        self._tones[heard].play()


@contextmanager
def _quietly() -> Iterator[None]:
    """Without what drivers write to standard error where there is no device."""
    kept, nothing = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nothing)
