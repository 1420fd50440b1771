"""Images: pictures as pixels, in files and as colours, without a display."""

from __future__ import annotations

import io
from collections.abc import Sequence

import numpy as np
import pygame
from numpy.typing import NDArray

from pinjoint.components.camera import Viewport
from pinjoint.systems.render.marks import Picture
from pinjoint.systems.render.pygame_canvas import Canvas
from pinjoint.systems.render.raster import load_raster

Size = tuple[int, int]
Colours = NDArray[np.uint8]

_WHITE, _BLACK = (255, 255, 255, 255), (0, 0, 0, 255)


def as_image(pictures: Sequence[Picture], size: Size, suffix: str) -> bytes:
    """Pictures, each in its viewport of an image of that size in pixels, as the contents of a file of that suffix."""
    return encoded(_drawn(pictures, size), suffix)


def as_clear_png(pictures: Sequence[Picture], size: Size) -> bytes:
    """The same without a background, as colours with opacities.

    A pixel of a colour c and an opacity a shows a c over black and a c + 255 (1 − a) over white.
    """
    frame = Viewport(0, 0, *size)
    over_black, over_white = (
        as_colours([Picture(frame, ground), *pictures], size).astype(np.int64) for ground in (_BLACK, _WHITE)
    )
    opacity = np.clip(255 - ((over_white - over_black).sum(axis=2) + 1) // 3, 0, 255)
    scale = np.maximum(opacity, 1)[:, :, None]
    colour = np.minimum((255 * over_black + scale // 2) // scale, 255)
    pixels = np.dstack([colour, opacity]).astype(np.uint8)
    return encoded(pygame.image.frombuffer(pixels.tobytes(), size, "RGBA"), ".png")


def as_colours(pictures: Sequence[Picture], size: Size) -> Colours:
    """Pictures as colours, shape (height, width, 3)."""
    return np.ascontiguousarray(pygame.surfarray.array3d(_drawn(pictures, size)).transpose(1, 0, 2))


def encoded(surface: pygame.Surface, suffix: str) -> bytes:
    """A surface as the contents of a file of that suffix."""
    made = io.BytesIO()
    pygame.image.save(surface, made, suffix)
    return made.getvalue()


def _drawn(pictures: Sequence[Picture], size: Size) -> pygame.Surface:
    surface, canvas = pygame.Surface(size, depth=32), Canvas(load_raster)
    for picture in pictures:
        canvas.draw(surface, picture)
    return surface
