"""How soon one sees what one did in a model of 10 000 rods, from the action to the finished picture; and how many pictures
a second one sees while one drags in statics."""

import gc
import math
import os
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from itertools import count

os.environ.setdefault("SDL_VIDEODRIVER", "dummy")

import numpy as np
import pygame

from pinjoint.app import SELDOM, App
from pinjoint.components.field import Vector
from pinjoint.components.load import SpanLoad
from pinjoint.components.model import Model
from pinjoint.documents import library
from pinjoint.preparation import Preparation
from pinjoint.systems.statics.envelope import States
from tests.benchmarks.models import lattice, storeys

FRAME = 1.0 / 60.0
WINDOW = 1280, 800  # in which one drags
MOST = 50.0  # ms within which one wants to see what one did
ANNOUNCED = "…"  # ends the names of what is worked on after a picture that says so

Row = dict[str, object]


class Hand:
    """Somebody at a window without a display, with a model before them."""

    def __init__(self, model: Model) -> None:
        self._thresholds = gc.get_threshold()
        gc.set_threshold(SELDOM)  # as App.run does
        self.app = App(model, preparation=Preparation())
        self.session = self.app.session
        self._fresh = count(1)  # something else every time: a particle, a place
        while not self.session.simulation.programs.ready:  # nobody is that quick
            self.pause()

    def close(self) -> None:
        """Close the window, and let go of what is still being compiled."""
        self.app.preparation.close()  # type: ignore[union-attr]
        self.app.close()
        gc.set_threshold(*self._thresholds)

    def pause(self) -> None:
        """Look on for a moment."""
        self.frame()
        time.sleep(FRAME)

    def wait(self) -> None:
        """Until what a run needs after the last edit is compiled, which is measured elsewhere."""
        while self.session.readiness.waits_for(self.session.simulation) is not None:
            self.pause()

    def frame(self) -> None:
        """One frame of the window, which has an event to deal with."""
        pygame.event.post(pygame.event.Event(pygame.USEREVENT))
        self.app.frame(FRAME)

    def pixel(self, x: float, y: float) -> Vector:
        """Where a point of the model is on the screen."""
        left, top = self.session.view.camera.to_pixels((x, y)).tolist()
        return left, top

    def press(self, key: str, at: Vector | None = None) -> None:
        """A key or button, with the pointer at a pixel."""
        at = at or self.pixel(0.5, 0.5)
        self.session.view.pointer = at
        self.session.press(key, at)

    def point(self, across: float = 0.0, up: float = 0.0) -> Vector:
        """The pixel of another particle every time, or of a place near it."""
        side = round(self.session.particles.count**0.5)
        column, row = divmod(next(self._fresh) * 7, side - 4)
        return self.pixel(2 + column % (side - 4) + across, 2 + row + up)


Act = Callable[[Hand], None]


def keys(*pressed: str) -> Act:
    """Press these keys."""
    return lambda hand: [hand.press(key) for key in pressed] and None  # type: ignore[func-returns-value]


def nothing(hand: Hand) -> None:
    """See what a frame does."""


def at_particle(*pressed: str) -> Act:
    """Press these keys over a particle."""

    def act(hand: Hand) -> None:
        place = hand.point()
        for key in pressed:
            hand.press(key, place)

    return act


def _force(hand: Hand) -> None:
    x, y = hand.point()
    hand.press("f", (x, y))
    hand.press("f", (x + 30.0, y + 20.0))


def _rod(hand: Hand) -> None:
    x, y = hand.point()
    hand.press("l", (x, y))
    hand.press("l", (x + 2.0 * hand.session.view.camera.scale, y))


def _box(hand: Hand) -> None:
    for key, place in (("drag", (300.0, 200.0)), ("drag to", (600.0, 500.0)), ("drop", (600.0, 500.0))):
        hand.press(key, place)


def _drag(hand: Hand) -> None:
    x, y = hand.point()
    for key, place in (("drag", (x, y)), ("drag to", (x + 9.0, y + 9.0)), ("drop", (x + 9.0, y + 9.0))):
        hand.press(key, place)


def _pull(hand: Hand) -> None:
    x, y = hand.session.view.pixel
    hand.press("drag to", (x + 4.0, y + 3.0))


def look_on(hand: Hand) -> None:
    """Look at what one drew, and think."""
    for _ in range(10):
        hand.pause()


def _type(hand: Hand) -> None:
    hand.session.click_box("stiffness")
    hand.session.type("2")


def _click_support(hand: Hand) -> None:
    hand.session.click(0.0, hand.session.particles.position[:, 1].max() // 2)


# What is done, in this order, and how often; a name without times is done once and not measured.
SESSION: tuple[tuple[str, Act, int], ...] = (
    ("point at a particle", lambda hand: setattr(hand.session.view, "pointer", hand.point()), 7),
    ("zoom", keys("wheel up"), 3),
    ("", keys("home"), 1),
    ("move the view", lambda hand: hand.session.press("drag middle", (5.0, 3.0)), 7),
    ("select a particle", at_particle("click"), 7),
    ("new particle", lambda hand: hand.press("p", hand.point(0.5, 0.25)), 7),
    ("new rod", _rod, 7),
    ("support", at_particle("c"), 7),
    ("force", _force, 7),
    ("delete a particle with its rods", at_particle("click", "delete"), 7),
    ("undo", keys("ctrl+z"), 7),
    ("redo", keys("ctrl+y"), 7),
    ("drag a particle", _drag, 7),
    ("select in a box", _box, 3),
    ("select all", keys("ctrl+a"), 3),
    ("copy all", keys("ctrl+c"), 3),
    ("paste all", keys("ctrl+v"), 1),
    ("undo that", keys("ctrl+z"), 1),
    ("select all", keys("ctrl+a"), 1),
    ("duplicate all", keys("ctrl+d"), 1),
    ("undo that", keys("ctrl+z"), 1),
    ("select all", keys("ctrl+a"), 1),
    ("cut all", keys("ctrl+x"), 1),
    ("undo that", keys("ctrl+z"), 1),
    ("select all", keys("ctrl+a"), 1),
    ("move all", keys("right"), 7),
    ("properties of all", keys("return"), 1),
    ("type into a box of all", _type, 7),
    ("apply to all", keys("escape", "escape"), 1),
    ("undo that", keys("ctrl+z"), 1),
    ("diagrams of all", keys("i"), 4),
    ("", keys("escape"), 1),
    ("new grid", keys("g"), 3),
    ("help", keys("f1"), 3),
    ("", keys("escape"), 1),
    ("save again", keys("ctrl+s"), 3),
    ("open the list of models", keys("d"), 1),
    ("leave it", keys("escape"), 1),
    ("", look_on, 1),
    ("run", keys("space"), 1),
    ("a frame while it runs", nothing, 7),
    ("new particle while it runs", lambda hand: hand.press("p", hand.point(0.5, 0.25)), 7),
    ("delete while it runs", at_particle("click", "delete"), 7),
    ("", look_on, 1),
    ("begin to pull a particle", at_particle("drag"), 1),
    ("pull it", _pull, 7),
    ("let go", keys("drop"), 1),
    ("pause", keys("space"), 1),
    ("a step", keys("."), 7),
    ("a step back", keys(","), 7),
    ("force method", keys("k"), 1),
    ("its first set …", nothing, 1),
    ("its run", nothing, 7),
    ("part 2", keys("k"), 1),
    ("its equilibrium …", nothing, 1),
    ("pick a support", _click_support, 1),
    ("", nothing, 1),
    ("its direction", keys("x"), 1),
    ("the base structure …", nothing, 1),
    ("part 4", keys("k"), 1),
    ("its equilibrium …", nothing, 1),
    ("part 5", keys("k"), 1),
    ("the third set …", nothing, 1),
    ("part 6", keys("k"), 1),
    ("its equilibrium …", nothing, 1),
    ("part 7", keys("k"), 1),
    ("the table …", nothing, 1),
    ("back to pause", keys("escape"), 1),
)


def reactions(*, quick: bool) -> Iterator[Row]:
    """Milliseconds from an action to the picture that shows it: the median, the longest, the median of the processor.

    The last is what counts as in time, for it is what one waits where nothing else keeps the machine busy.
    What the picture before said that it is worked on need not be.
    """
    rods = 2_000 if quick else 10_000
    with library.data_in(), closing(Hand(lattice(rods, damping=1.0))) as hand:
        hand.session.document.save_as(library.data_folder() / "lattice.json")
        for what, act, times in SESSION:
            hand.wait()
            taken = [_milliseconds(hand, act) for _ in range(times)]
            waited, busy = (sorted(column) for column in zip(*taken, strict=True))
            if what:
                processor = busy[len(busy) // 2]
                in_time = "yes" if processor <= MOST else "no"
                yield {
                    "action": what,
                    "rods": hand.session.rods.count,
                    "median_ms": waited[len(waited) // 2],
                    "longest_ms": waited[-1],
                    "processor_ms": processor,
                    "seen_in_time": "announced" if what.endswith(ANNOUNCED) else in_time,
                }


def _milliseconds(hand: Hand, act: Act) -> tuple[float, float]:
    """What one waits, and what the processor works, until it is seen."""
    started, busy = time.perf_counter(), time.process_time()
    act(hand)
    hand.frame()
    return 1e3 * (time.perf_counter() - started), 1e3 * (time.process_time() - busy)


def drags(*, quick: bool) -> Iterator[Row]:
    """Frames that a window would show a second while one drags in statics, without the pauses between them.

    solving_ms: the part of it that the solution takes. pale: how many showed no solution.
    """
    with library.data_in(), closing(Hand(storeys(6, 8))) as hand:
        session, model = hand.session, hand.session.model
        hand.app.size = WINDOW
        particle, frames = session.particles[7 * 8 + 3], 60 if quick else 180
        particle.force = (50.0, 0.0)
        hand.frame()
        for key in ("q", "home"):
            hand.press(key)
        session.select(particle)
        hand.press("ctrl+l")
        hand.wait()
        hand.frame()
        left, right, height = session.view.slider_places[-1].track
        joint = hand.pixel(*session.particles[7 * 4 + 3].position)
        for what, (x, y), far in (
            ("a joint", joint, 60.0),
            ("a slider", (0.5 * (left + right), height), 0.4 * (right - left)),
        ):
            hand.press("drag", (x, y))
            taken, pale = [], 0
            for number in range(frames):
                place = (
                    x + far * math.sin(0.1 * number),
                    y + (0.5 * far * math.sin(0.03 * number) if what == "a joint" else 0.0),
                )
                taken.append(_milliseconds(hand, lambda hand, at=place: hand.press("drag to", at)))
                pale += bool(session.view.provisional)
            hand.press("drop", (x, y))
            waited, busy = (sorted(column) for column in zip(*taken, strict=True))
            started = time.process_time()
            for _ in range(20):
                session.document.statics.settled()
            yield {
                "dragged": what,
                "rods": model.rods.count,
                "frames_per_s": 1e3 / (sum(waited) / frames),
                "median_ms": waited[frames // 2],
                "longest_ms": waited[-1],
                "processor_ms": busy[frames // 2],
                "solving_ms": 50.0 * (time.process_time() - started),
                "pale": pale,
            }


def cases(*, quick: bool) -> Iterator[Row]:
    """Milliseconds of the processor for N, V, M and reactions in so many load cases of a frame, after the first time."""
    model, lot, count = storeys(12, 19), np.random.default_rng(1), 10 if quick else 50
    for case in range(count):
        rows = lot.choice(model.rods.count, 20, replace=False)
        model.create(SpanLoad, 20, rod=rows, case=f"c{case}", start_intensity=(0.0, -4.0), force=(0.0, -5.0))
    chosen = {f"c{case}": {f"c{case}": 1.0} for case in range(count)}
    taken = []
    for _ in range(5):
        started = time.process_time()
        States.superposed(model, chosen, 1.0)
        taken.append(1e3 * (time.process_time() - started))
    yield {"rods": model.rods.count, "cases": count, "first_ms": taken[0], "least_ms": min(taken)}


def report(*, quick: bool) -> dict[str, list[Row]]:
    """Everything this benchmark measures, by table."""
    return {
        "reactions": list(reactions(quick=quick)),
        "drags": list(drags(quick=quick)),
        "cases": list(cases(quick=quick)),
    }
