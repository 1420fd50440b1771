"""Force method: the guided solution of a hyperstatic structure, three systems side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

from components.camera import Camera, Viewport
from components.model import Model
from components.view import Page, Status, View
from game.scenes.base import Scene

if TYPE_CHECKING:
    from game.force_method import Guide
    from game.session import Session

HEAD, FOOT, ROW = 46.0, 30.0, 19.0  # points: the message, the status line, a line of the working
PARTS = 7
WIDE = 1.1  # width / height from which the sets stand side by side


class ForceMethod(Scene):
    """The seven parts of the force method. `guide` is None if the structure cannot be solved."""

    name = "force method"

    def __init__(self) -> None:
        self.guide: Guide | None = None
        self._problem = ""
        self._blank = Model()
        self._head, self._foot = View(page=Page(), legend=False), View(page=Page(), legend=False)

    def enter(self, session: Session) -> None:
        from game.force_method import Guide  # scipy is imported only here
        from systems.statics.force_method import ForceMethodError

        self._problem = ""
        try:
            self.guide = Guide(session.model, session.schedule, session.view)
        except ForceMethodError as error:
            self.guide, self._problem = None, str(error)

    def exit(self, session: Session) -> None:
        self.guide = None

    def advance(self, session: Session, elapsed: float) -> None:
        for running in self.guide.running if self.guide else []:
            running.live.frame(elapsed)

    def busy(self, session: Session) -> bool:
        running = self.guide.running if self.guide else []
        return any(not one.live.simulation.halted for one in running)

    def hint(self, session: Session) -> str:
        return self.guide.hint if self.guide else "Esc back to pause"

    def focus(self, session: Session) -> tuple[Model, View]:
        self.stages(session)  # places the sets
        if self.guide is None:
            return self._blank, self._foot
        return self.guide.sets[0].model, self.guide.sets[0].view

    def stages(self, session: Session) -> list[tuple[Model, View]]:
        """The message, the sets, and the working with the status line."""
        guide, ratio = self.guide, session.view.pixel_ratio
        page = Page(guide.working(), guide.table()) if guide else Page()
        whole = session.view.canvas
        head = round(HEAD * ratio)
        foot = min(round((FOOT + ROW * _rows(page)) * ratio), round(0.45 * whole.height))
        self._head.heading = guide.message if guide else self._problem
        self._foot.page = page
        part = f"Part {guide.part} of {PARTS}" if guide else "Not possible"
        self._foot.status = Status(time=None, state=part, hint=self.hint(session))
        middle = Viewport(whole.left, whole.top + head, whole.width, max(whole.height - head - foot, 1))
        self._place(self._head, Viewport(whole.left, whole.top, whole.width, head), ratio)
        self._place(self._foot, Viewport(whole.left, middle.top + middle.height, whole.width, foot), ratio)
        return [(self._blank, self._head), *self._sets(middle, ratio), (self._blank, self._foot)]

    def _sets(self, middle: Viewport, ratio: float) -> list[tuple[Model, View]]:
        if self.guide is None:
            return [(self._blank, View(Camera(viewport=middle), page=Page(), legend=False, pixel_ratio=ratio))]
        shown = []
        for index, (one, caption) in enumerate(zip(self.guide.sets, self.guide.captions(), strict=True)):
            viewport = _third(middle, index)
            if one.view.camera.viewport != viewport or one.view.pixel_ratio != ratio:
                self._place(one.view, viewport, ratio)
                one.view.fit(one.model)
            one.view.caption = caption
            shown.append((one.model, one.view))
        for index in range(len(shown), 3):
            empty = View(Camera(viewport=_third(middle, index)), page=Page(), legend=False, pixel_ratio=ratio)
            shown.append((self._blank, empty))
        return shown

    @staticmethod
    def _place(view: View, viewport: Viewport, ratio: float) -> None:
        view.camera.viewport, view.pixel_ratio = viewport, ratio


def _rows(page: Page) -> int:
    return len(page.lines) + len(page.table) + (1 if page.lines or page.table else 0)


def _third(middle: Viewport, index: int) -> Viewport:
    """One of three equal parts: beside each other in a wide window, else above each other."""
    if middle.width >= WIDE * middle.height:
        edges = [middle.left + middle.width * i // 3 for i in range(4)]
        return Viewport(edges[index], middle.top, edges[index + 1] - edges[index], middle.height)
    edges = [middle.top + middle.height * i // 3 for i in range(4)]
    return Viewport(middle.left, edges[index], middle.width, edges[index + 1] - edges[index])
