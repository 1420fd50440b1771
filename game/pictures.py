"""Pictures of sessions, windows and plots: as files for reports, and as colours for animations."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from pinjoint.components.camera import Camera, Rectangle, Viewport
from pinjoint.components.mistake import WrongValue
from pinjoint.components.model import Model
from pinjoint.components.slider import SliderStack
from pinjoint.components.toolbar import Toolbar
from pinjoint.components.view import MARGIN, Plot, Status, View
from pinjoint.documents import models
from pinjoint.editor.view_model import exaggerate
from pinjoint.systems.render.backends.pdf import as_pdf
from pinjoint.systems.render.backends.svg import as_svg
from pinjoint.systems.render.labels.placing import Placed
from pinjoint.systems.render.marks import Owner, Picture, Points
from pinjoint.systems.render.picture import compose, compose_all
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.render.ui.plots import draw_plot

Session = Any  # pinjoint.session.Session, which draws itself by this module
Size = tuple[int, int]
Background = Literal["theme", "white", "transparent"]

_IMAGES = ".png", ".jpg", ".bmp"
_WHITE = (255, 255, 255, 255)
_USUAL = 1280, 800  # pixels; in larger pictures type and lines grow
SIDES = range(16, 16385)  # pixels


def render(
    session: Session, path: str | Path, size: Size, theme: str = "light", background: Background = "theme"
) -> None:
    """Draw a session to a file in the format of its suffix, without a display. Raises OSError, ValueError."""
    path = Path(path)
    models.replace(path, drawn(session, path.suffix, size, theme, background))


def drawn(
    session: Session, suffix: str, size: Size, theme: str = "light", background: Background = "theme"
) -> bytes:
    """A session as the content of a file with that suffix."""
    if not all(side in SIDES for side in size):
        raise WrongValue(
            "{width} x {height} is no size of a picture; give whole numbers of pixels, each from 16 to 16384.",
            width=size[0],
            height=size[1],
        )
    exaggerate(session)
    session.update_view()
    view = on_paper(session.view, Camera(viewport=Viewport(0, 0, *size)))
    view.pixel_ratio = _pixel_ratio(size)
    view.fit(session.model)
    return _made([(session.model, view)], suffix, size, theme, background)


def _pixel_ratio(size: Size) -> float:
    """Pixels per point, so that a large picture on paper is read as well as a usual one."""
    return max(min(side / usual for side, usual in zip(size, _USUAL, strict=True)), 1.0)


def on_paper(view: View, camera: Camera | None = None) -> View:
    """A view without what only a person at the window needs: bars, panels, sliders, and what is pointed at."""
    return replace(
        view,
        camera=camera or view.camera,
        toolbar=Toolbar(),
        sliders=SliderStack(),
        heading="",
        status=Status(time=None, speed=view.status.speed),
        readouts=(),
        shares=False,
        table=(0.0, 0.0),
        aside=None,
        preview=None,
        pointer=None,
        pointed=None,
        help=0,
        advises=False,
    )


def write(
    stages: Sequence[tuple[Model, View]],
    path: str | Path,
    size: Size,
    theme: str = "light",
    background: Background = "theme",
) -> None:
    """Draw models in their views to a file in the format of its suffix, as a whole or not at all. Raises OSError."""
    path = Path(path)
    models.replace(path, _made(stages, path.suffix, size, theme, background))


def _made(
    stages: Sequence[tuple[Model, View]], suffix: str, size: Size, theme: str, background: Background
) -> bytes:
    colours = load_theme(theme)
    if background == "white":
        colours = replace(colours, background=_WHITE)
    pictures = compose_all(stages, colours)
    paths = [partial(path_of, model) for model, _ in stages]
    if background == "transparent":
        pictures = [replace(picture, background=None) for picture in pictures]
    elif len(stages) > 1:  # which leave the place of the toolbar free
        pictures = [Picture(Viewport(0, 0, *size), colours.background), *pictures]
        paths = [paths[0], *paths]
    named, title = list(zip(pictures, paths, strict=True)), stages[0][0].title or "Pinjoint"
    return _as_file(named, size, suffix, title, clear=background == "transparent")


def _as_file(
    named: Sequence[tuple[Picture, Callable[[Owner], str]]],
    size: Size,
    suffix: str,
    title: str,
    *,
    clear: bool = False,
) -> bytes:
    """Pictures, each with what names the owners of its marks, as the content of a file with that suffix."""
    pictures, suffix = [picture for picture, _ in named], suffix.lower()
    if suffix == ".svg":
        return as_svg(named, size, title)
    if suffix == ".pdf":
        return as_pdf(pictures, size, title)
    if suffix not in _IMAGES:
        endings = ", ".join((*_IMAGES, ".svg", ".pdf"))
        raise WrongValue("{file}: choose a file that ends with one of {endings}.", file=suffix, endings=endings)
    from pinjoint.systems.render.backends.pygame_canvas import as_image  # pygame takes a while to import

    return as_image(pictures, size, suffix, clear=clear)


def path_of(model: Model, owner: Owner) -> str:
    """The path of an element that marks belong to, such as "rods.AB"."""
    table, row = owner
    return f"{table}.{model.tables[table].names[row]}"


def frame(
    session: Session, size: Size, theme: str, around: Points, placed: Placed | None = None
) -> NDArray[np.uint8]:
    """A moment of a run with its status as colours, shape (height, width, 3), showing all these points (n, 2).

    placed: where labels were in the last of several pictures, see compose().
    """
    from pinjoint.systems.render.backends.pygame_canvas import as_colours

    session.update_view()
    status = replace(session.view.status, hint="")  # a picture takes no keys
    camera = Camera(viewport=Viewport(0, 0, *size))
    view = replace(session.view, camera=camera, toolbar=Toolbar(), sliders=SliderStack(), status=status)
    view.heading, view.advises, view.pixel_ratio = "", False, _pixel_ratio(size)
    view.camera.fit(around, MARGIN, view.room, view.pixel_ratio)
    return as_colours([compose(session.model, view, load_theme(theme), placed)], size)


def plot_picture(plot: Plot, path: Path, theme: str = "light") -> None:
    """Draw a plot to a PNG, SVG or PDF file, without a display. Raises OSError if it cannot be written."""
    colours, unit, size = load_theme(theme), 1.5, (900, 560)
    box = Rectangle(16.0 * unit, 8.0 * unit, size[0] - 32.0 * unit, size[1] - 16.0 * unit)
    marks = draw_plot(plot, box, colours, unit, None)
    picture = Picture(Viewport(0, 0, *size), colours.background, marks)
    models.replace(path, _as_file([(picture, lambda owner: "")], size, path.suffix, plot.x_title))
