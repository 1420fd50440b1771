"""Pictures of sessions, windows and plots: as files for reports, and as colours for animations."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Literal

import numpy as np
import pygame
from numpy.typing import NDArray

from components.camera import Camera, Viewport
from components.model import Model
from components.toolbar import Toolbar
from components.view import MARGIN, Plot, Status, View, drawn_places
from game.documents import models
from game.session import Session
from systems.render.labels import Placed
from systems.render.marks import Owner, Picture, Points
from systems.render.pdf import as_pdf
from systems.render.picture import compose
from systems.render.plots import draw_plot
from systems.render.pygame_canvas import Canvas
from systems.render.raster import load_raster
from systems.render.svg import as_svg
from systems.render.theme import Colour, load_theme

WHITE, BLACK = (255, 255, 255, 255), (0, 0, 0, 255)

Size = tuple[int, int]
Background = Literal["theme", "white", "transparent"]
Colours = NDArray[np.uint8]


def render(
    session: Session, path: str | Path, size: Size, theme: str = "light", background: Background = "theme"
) -> None:
    """Draw a session to a file in the format of its suffix, without a display. Raises OSError if it cannot be written."""
    session.update_view()
    view = on_paper(session.view, Camera(viewport=Viewport(0, 0, *size)))
    view.camera.fit(drawn_places(session.model), MARGIN, view.room, view.pixel_ratio)
    write([(session.model, view)], path, size, theme, background)


def on_paper(view: View, camera: Camera | None = None) -> View:
    """A view without what only a person at the window needs: status bar, panels, toolbar, and what is pointed at."""
    return replace(
        view,
        camera=camera or view.camera,
        toolbar=Toolbar(),
        heading="",
        status=Status(time=None, speed=view.status.speed),
        readouts=(),
        shares=False,
        preview=None,
        pointer=None,
        help=0,
    )


def write(
    stages: Sequence[tuple[Model, View]],
    path: str | Path,
    size: Size,
    theme: str = "light",
    background: Background = "theme",
) -> None:
    """Draw models in their views to a file in the format of its suffix, as a whole or not at all. Raises OSError."""
    colours, path = load_theme(theme), Path(path)
    if background == "white":
        colours = replace(colours, background=WHITE)
    pictures = [compose(model, view, colours) for model, view in stages]
    if background == "transparent":
        pictures = [replace(picture, background=None) for picture in pictures]
    title = stages[0][0].title or "Pinjoint"
    match path.suffix.lower():
        case ".svg":
            named = [
                (picture, partial(path_of, model)) for picture, (model, _) in zip(pictures, stages, strict=True)
            ]
            models.replace(path, as_svg(named, size, title))
        case ".pdf":
            models.replace(path, as_pdf(pictures, size, title))
        case _:
            drawn = _clear if background == "transparent" else _opaque
            save(drawn(pictures, size), path)


def path_of(model: Model, owner: Owner) -> str:
    """The path of an element that marks belong to, such as "rods.AB"."""
    table, row = owner
    return f"{table}.{model.tables[table].names[row]}"


def save(surface: pygame.Surface, path: Path) -> None:
    """Write a picture in the format of its suffix, as a whole or not at all. Raises OSError."""
    made = io.BytesIO()
    pygame.image.save(surface, made, path.suffix)
    models.replace(path, made.getvalue())


def _opaque(pictures: Sequence[Picture], size: Size) -> pygame.Surface:
    surface, canvas = pygame.Surface(size, depth=32), Canvas(load_raster)
    for picture in pictures:
        canvas.draw(surface, picture)
    return surface


def _clear(pictures: Sequence[Picture], size: Size) -> pygame.Surface:
    """Pictures without a background, as colours with opacities.

    A pixel of a colour c and an opacity a shows a c over black and a c + 255 (1 − a) over white.
    """
    over_black, over_white = (_colours(_over(pictures, size, ground)) for ground in (BLACK, WHITE))
    lighter = over_white.astype(np.int64) - over_black
    opacity = np.clip(255 - lighter.max(axis=2), 0, 255)
    colour = np.minimum(255 * over_black.astype(np.int64) // np.maximum(opacity, 1)[:, :, None], 255)
    pixels = np.dstack([colour, opacity]).astype(np.uint8)
    return pygame.image.frombuffer(pixels.tobytes(), size, "RGBA")


def _over(pictures: Sequence[Picture], size: Size, ground: Colour) -> pygame.Surface:
    whole = Picture(Viewport(0, 0, *size), ground)
    return _opaque([whole, *pictures], size)


def _colours(surface: pygame.Surface) -> Colours:
    """The colours of a surface, shape (height, width, 3)."""
    return np.ascontiguousarray(pygame.surfarray.array3d(surface).transpose(1, 0, 2))


def frame(session: Session, size: Size, theme: str, around: Points, placed: Placed | None = None) -> Colours:
    """A moment of a run with its status as colours, shape (height, width, 3), showing all these points (n, 2).

    placed: where labels were in the last of several pictures, see compose().
    """
    session.update_view()
    status = replace(session.view.status, hint="")  # a picture takes no keys
    camera = Camera(viewport=Viewport(0, 0, *size))
    view = replace(session.view, camera=camera, toolbar=Toolbar(), heading="", status=status)
    view.camera.fit(around, MARGIN, view.room, view.pixel_ratio)
    return _colours(_opaque([compose(session.model, view, load_theme(theme), placed)], size))


def plot_png(plot: Plot, path: Path, theme: str = "light", size: Size = (900, 560)) -> None:
    """Draw a plot to a PNG file, without a display. Raises OSError if it cannot be written."""
    colours, unit = load_theme(theme), 1.5
    box = 16.0 * unit, 8.0 * unit, size[0] - 32.0 * unit, size[1] - 16.0 * unit
    marks = draw_plot(plot, box, colours, unit, None)
    save(_opaque([Picture(Viewport(0, 0, *size), colours.background, marks)], size), path)
