"""Canvas: draws pictures on a pygame surface, in windows and, without a display, for files."""

from __future__ import annotations

import io
import math
from collections.abc import Callable, Sequence
from importlib.resources import files
from typing import Any

import numpy as np
import pygame
import pygame.gfxdraw
from numpy.typing import NDArray

from pinjoint.components.camera import Viewport
from pinjoint.components.wording import UNPRINTABLE
from pinjoint.systems.program.compiler import Choice, Compile
from pinjoint.systems.render.backends.raster import Clip, Pixels, Raster, load_raster, stroke_coverage
from pinjoint.systems.render.clip import clip_polygon
from pinjoint.systems.render.marks import Bars, Discs, Fills, Mark, Panel, Picture, Stamps, Strokes, Text
from pinjoint.systems.render.symbols import RIM, turned_parts
from pinjoint.systems.render.theme import Colour
from pinjoint.systems.render.typography import WEIGHTS, capital_height

_Image = tuple[pygame.Surface, tuple[int, int]]  # and where its upper left corner comes to stand

_WHITE, _BLACK = (255, 255, 255, 255), (0, 0, 0, 255)
_FINE = 8  # symbols and corners are drawn this much larger, then reduced
# Shares of their widths by which texts begin before their places.
_SHIFTS = {"left": 0.0, "centre": 0.5, "right": 1.0}
_PHASES = 4  # positions of a symbol within a pixel, each way
_FILLED = 3e4  # pixels, how far away what is filled may reach
_LONGEST = 4000  # characters that are drawn of a text: more than any window is wide
# Bars, discs; and 50 pixels of strokes for each: from there on it pays to load the compiled kernels.
_MANY = 300


class Canvas:
    """Draws pictures; keeps the texts, symbols and panels it has rendered.

    raster: returns the compiled drawing of large pictures, or None while it is being compiled; until then, and where
        nothing is compiled, they take some ten times as long. Once there, it draws few strokes, too: five times as fast.
    """

    def __init__(self, raster: Callable[[], Raster | None] = lambda: None) -> None:
        self._load = raster if Choice.compile is not Compile.NEVER else lambda: None
        self._loaded: Raster | None = None
        if not pygame.font.get_init():
            pygame.font.init()
        self._cache: dict[Any, Any] = {}
        # The cache before: entries used again move to the new one, the others are dropped when that is full.
        self._former: dict[Any, Any] = {}
        self._files = {
            weight: (files("pinjoint.assets") / "fonts" / name).read_bytes() for weight, name in WEIGHTS.items()
        }

    def draw(self, surface: pygame.Surface, picture: Picture) -> None:
        """Draw a picture into its viewport of a surface of 32 bits per pixel."""
        v = picture.viewport
        before = surface.get_clip()
        surface.set_clip(pygame.Rect(*v.box).clip(before))
        try:
            if picture.background is not None:
                surface.fill(picture.background)
            images: list[_Image] = []  # those that follow one another are drawn at once
            for mark in picture.marks:
                match mark:
                    case Text():
                        images.append(self._text(mark))
                    case Stamps():
                        images += self._stamps(mark)
                    case Panel() if mark.radius or mark.outline is not None or mark.fill[3] < 255:
                        images += self._panel(mark)
                    case _:
                        surface.fblits(images)
                        images.clear()
                        self._area(surface, mark)
            surface.fblits(images)
        finally:  # also where a picture cannot be drawn
            surface.set_clip(before)

    def _area(self, surface: pygame.Surface, mark: Mark) -> None:
        match mark:
            case Strokes():
                self._strokes(surface, mark)
            case Fills():
                self._fill(surface, mark)
            case Discs():
                self._discs(surface, mark)
            case Bars() if len(mark.start) > _MANY and (raster := self._raster()):
                raster.bars(_pixels(surface), _clip(surface), mark, _pixel(surface, mark.colour))
            case Bars():
                self._fill(surface, Fills(mark.corners, mark.colour))
            case Panel():
                surface.fill(mark.fill, _box(mark))

    def _kept(self, key: Any, make: Callable[..., Any], *what: Any) -> Any:
        found = self._cache.get(key)
        if found is None:
            if len(self._cache) >= 4000:  # rendered texts, symbols and panels
                self._former, self._cache = self._cache, {}
            found = self._cache[key] = self._former.pop(key, None) or make(*what)
        return found

    # --- lines and areas -----------------------------------------------------------------------------

    def _raster(self) -> Raster | None:
        self._loaded = self._loaded or self._load()
        return self._loaded

    def _strokes(self, surface: pygame.Surface, mark: Strokes) -> None:
        if not len(mark.start):
            return
        if (raster := self._loaded) is None:
            across = np.abs(mark.end - mark.start).max(axis=1).sum() + 2.0 * len(mark.start)
            many = len(mark.start) > _MANY or across * (1.42 * mark.width + 2.0) > 50 * _MANY
            raster = self._raster() if many else None
        if raster is not None:
            raster.strokes(_pixels(surface), _clip(surface), mark, _pixel(surface, mark.colour))
        else:
            _blend(surface, *stroke_coverage(mark.start, mark.end, mark.width), mark.colour)

    def _fill(self, surface: pygame.Surface, mark: Fills) -> None:
        if self._loaded is not None:
            self._loaded.fills(_pixels(surface), _clip(surface), mark, _pixel(surface, mark.colour))
        else:
            _fill(surface, mark.corners, mark.colour)

    # --- symbols and texts ---------------------------------------------------------------------------

    def _panel(self, mark: Panel) -> list[_Image]:
        left, top, *size = _box(mark)
        if min(size) <= 0:  # what a window of some pixels leaves of it
            return []
        key = "panel", *size, mark.radius, mark.fill, mark.outline
        return [(self._kept(key, _rounded, size, mark), (left, top))]

    def _stamps(self, mark: Stamps) -> list[_Image]:
        # Pixels; so far away it is not seen, and can be counted in whole numbers.
        fine = np.floor(np.minimum(np.maximum(mark.at, -1e6), 1e6) * _PHASES + 0.5).astype(np.int64)
        key = mark.symbol, mark.size, mark.unit, mark.ink, mark.hollow, mark.turns
        images, pairs = self._kept(key, dict), []
        whole, phases = fine // _PHASES, fine % _PHASES @ [_PHASES, 1]
        for (x, y), phase in zip(whole.tolist(), phases.tolist(), strict=True):
            if (found := images.get(phase)) is None:
                found = images[phase] = _rendered(mark, phase // _PHASES / _PHASES, phase % _PHASES / _PHASES)
            image, left, top = found
            pairs.append((image, (x + left, y + top)))
        return pairs

    def _discs(self, surface: pygame.Surface, mark: Discs) -> None:
        if len(mark.at) > _MANY and (raster := self._raster()):
            colours = _pixel(surface, mark.ink), _pixel(surface, mark.hollow)
            raster.discs(_pixels(surface), _clip(surface), mark, *colours)
        else:
            fine = np.round(4.0 * mark.radius)
            symbol, unit = ("ring", mark.rim / RIM) if mark.rim else ("disc", 1.0)
            for quarters in sorted(set(fine.tolist())):
                at = mark.at[fine == quarters]
                surface.fblits(self._stamps(Stamps(symbol, at, quarters / 4.0, unit, mark.ink, mark.hollow)))

    def _text(self, mark: Text) -> _Image:
        key = mark.text, mark.size, mark.colour, mark.weight
        image, middle, ascent = self._kept(key, _written, self._font, mark)
        left = mark.x - _SHIFTS[mark.anchor] * image.get_width()
        return image, (round(left), round(mark.y + middle) - ascent)

    def _font(self, size: int, weight: str) -> pygame.font.Font:
        return self._kept(
            ("font", size, weight), lambda: pygame.font.Font(io.BytesIO(self._files[weight]), size)
        )


def _written(font_of: Callable[[int, str], pygame.font.Font], mark: Text) -> tuple[pygame.Surface, float, int]:
    """A text as an image, and the pixels from the middle of its capitals to the line and from that to its top.

    What no font can draw is "�", and there is nothing where there is nothing to see.
    """
    font, text = font_of(mark.size, mark.weight), UNPRINTABLE.sub("�", mark.text[:_LONGEST])
    try:
        image = font.render(text, True, mark.colour[:3])
    except pygame.error:  # of no width, such as a joiner of characters
        image = pygame.Surface((0, 0))
    return image, capital_height(mark.size) / 2, font.get_ascent()


def _box(mark: Panel) -> tuple[int, int, int, int]:
    """Left, top, width and height in whole pixels."""
    left, top = round(mark.left), round(mark.top)
    return left, top, round(mark.left + mark.width) - left, round(mark.top + mark.height) - top


def _fill(surface: pygame.Surface, corners: NDArray[np.float64], colour: Colour) -> None:
    """Fill polygons with corners (n, k, 2), rounded to whole pixels; those that 16 bits cannot tell are cut."""
    far = (np.abs(corners) > _FILLED).any(axis=(1, 2))
    cut = [clip_polygon(polygon, np.full(2, -_FILLED), np.full(2, _FILLED)) for polygon in corners[far]]
    for polygons in (corners[~far], *(polygon[None] for polygon in cut if len(polygon) > 2)):
        for polygon in np.round(polygons).astype(np.int64).tolist():
            pygame.gfxdraw.filled_polygon(surface, polygon, colour)


def _pixels(surface: pygame.Surface) -> Pixels:
    """The pixels of a surface of 32 bits per pixel, shape (rows, columns); the last ones may be padding."""
    pixels: Pixels = np.frombuffer(surface.get_buffer(), dtype=np.uint32)  # type: ignore[call-overload]
    return pixels.reshape(surface.get_height(), surface.get_pitch() // 4)


def _pixel(surface: pygame.Surface, colour: Colour) -> np.uint32:
    """A colour as a pixel of that surface."""
    return np.uint32(surface.map_rgb(colour[:3]))


def _clip(surface: pygame.Surface) -> Clip:
    clip = surface.get_clip()
    return clip.left, clip.top, clip.right, clip.bottom


def _blend(
    surface: pygame.Surface,
    x: NDArray[np.int32],
    y: NDArray[np.int32],
    amount: NDArray[np.uint8],
    colour: Colour,
) -> None:
    """Blend a colour into pixels by amounts of 1 to 255, inside the surface's clip."""
    clip = surface.get_clip()
    inside = (x >= clip.left) & (x < clip.right) & (y >= clip.top) & (y < clip.bottom)
    if not inside.all():
        x, y, amount = x[inside], y[inside], amount[inside]
    pixels = _pixels(surface)
    old = pixels[y, x].view(np.uint8).reshape(-1, 4).astype(np.uint16)
    new = np.array([_pixel(surface, colour)]).view(np.uint8).astype(np.uint16)
    part = (amount.astype(np.uint16) * np.uint16(colour[3]) + np.uint16(127)) // np.uint16(255)
    part = part[:, None]
    mixed = (old * (np.uint16(255) - part) + new * part + np.uint16(127)) // np.uint16(255)
    pixels[y, x] = mixed.astype(np.uint8).view(np.uint32).ravel()


def _rendered(mark: Stamps, phase_x: float, phase_y: float) -> tuple[pygame.Surface, int, int]:
    """A symbol's image, and where its top left pixel lies relative to the pixel of its origin."""
    parts = turned_parts(mark)
    phase = np.array([phase_x, phase_y])
    everything = np.concatenate([corners for _, corners in parts])
    low = np.floor(everything.min(axis=0)).astype(int) - 1
    size = np.ceil(everything.max(axis=0)).astype(int) + 2 - low
    large = pygame.Surface((size * _FINE).tolist(), pygame.SRCALPHA)
    large.fill((*mark.ink[:3], 0))
    for role, corners in parts:
        colour = mark.ink if role == "ink" else mark.hollow
        pygame.draw.polygon(large, colour, ((corners + phase - low) * _FINE).round().tolist())
    return pygame.transform.smoothscale(large, size.tolist()), int(low[0]), int(low[1])


def _rounded(size: Sequence[int], mark: Panel) -> pygame.Surface:
    """A box with smooth corners: one no larger than its corners need, with its middle stretched."""
    least = 2 * math.ceil(mark.radius) + 5  # the column and row in the middle are part of no corner
    small = _small_rounded((min(size[0], least), min(size[1], least)), mark)
    whole = pygame.Surface(size, pygame.SRCALPHA)
    columns, rows = (  # of the small one, the middle ones repeated
        np.maximum(np.minimum(np.arange(n), short // 2), np.arange(n) - (n - short))
        for n, short in zip(size, small.get_size(), strict=True)
    )
    _pixels(whole)[:, : size[0]] = _pixels(small)[rows][:, columns]
    return whole


def _small_rounded(size: tuple[int, int], mark: Panel) -> pygame.Surface:
    """A box with smooth corners, drawn finely and then reduced, in a time that grows with its area."""
    fine = 4
    large = pygame.Surface((size[0] * fine, size[1] * fine), pygame.SRCALPHA)
    edge = mark.outline or mark.fill
    large.fill((*edge[:3], 0))
    radius = round(mark.radius * fine)
    box = large.get_rect()
    if mark.outline is not None:
        pygame.draw.rect(large, mark.outline, box, border_radius=radius)
        box = box.inflate(-2 * fine, -2 * fine)
        radius = max(radius - fine, 0)
    pygame.draw.rect(large, mark.fill, box, border_radius=radius)
    return pygame.transform.smoothscale(large, size)


# --- files, without a display ---------------------------------------------------------------------------


def as_image(pictures: Sequence[Picture], size: tuple[int, int], suffix: str, *, clear: bool) -> bytes:
    """Pictures, each in its viewport of an image of that size in pixels, as the contents of a file of that suffix.

    clear: a PNG without a background, in colours with opacities. A pixel of a colour c and an opacity a shows a c over black
    and a c + 255 (1 − a) over white.
    """
    if not clear:
        return encoded(_drawn(pictures, size), suffix)
    frame = Viewport(0, 0, *size)
    over_black, over_white = (
        as_colours([Picture(frame, ground), *pictures], size).astype(np.int64) for ground in (_BLACK, _WHITE)
    )
    opacity = np.clip(255 - ((over_white - over_black).sum(axis=2) + 1) // 3, 0, 255)
    scale = np.maximum(opacity, 1)[:, :, None]
    colour = np.minimum((255 * over_black + scale // 2) // scale, 255)
    pixels = np.dstack([colour, opacity]).astype(np.uint8)
    return encoded(pygame.image.frombuffer(pixels.tobytes(), size, "RGBA"), ".png")


def as_colours(pictures: Sequence[Picture], size: tuple[int, int]) -> NDArray[np.uint8]:
    """Pictures as colours, shape (height, width, 3)."""
    return np.ascontiguousarray(pygame.surfarray.array3d(_drawn(pictures, size)).transpose(1, 0, 2))


def encoded(surface: pygame.Surface, suffix: str) -> bytes:
    """A surface as the contents of a file of that suffix."""
    made = io.BytesIO()
    pygame.image.save(surface, made, suffix)
    return made.getvalue()


def _drawn(pictures: Sequence[Picture], size: tuple[int, int]) -> pygame.Surface:
    surface, canvas = pygame.Surface(size, depth=32), Canvas(load_raster)
    for picture in pictures:
        canvas.draw(surface, picture)
    return surface
