"""Contact sheets to look at: `python -m tests.golden.contact FOLDER` draws everything at many sizes."""

import argparse
from pathlib import Path

import pygame

from tests.golden.scenes import SCENES, Window, painted
from tests.golden.states import STATES, seen
from tests.golden.test_texts import SIZES

CELL = 640, 480  # pixels, of each picture on a sheet
COLUMNS, ROWS = 3, 3


def main() -> None:
    """Sheets of nine pictures each, by the size of the window."""
    parser = argparse.ArgumentParser(prog="python -m tests.golden.contact", description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--size", choices=SIZES, action="append", help="of the windows; else all")
    parser.add_argument("--only", default="", help="what the names of what is drawn contain")
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    names = [name for name in (SCENES | STATES) if options.only in name]
    for size in options.size or SIZES:
        for number in range(0, len(names), COLUMNS * ROWS):
            sheet = _sheet(names[number : number + COLUMNS * ROWS], SIZES[size])
            pygame.image.save(
                sheet, options.folder / f"{size.replace(' ', '-')}-{number // (COLUMNS * ROWS)}.png"
            )


def _sheet(names: list[str], window: Window) -> pygame.Surface:
    factor = min(CELL[0] / window.width, CELL[1] / window.height, 1.0)
    cell = round(factor * window.width), round(factor * window.height)
    sheet = pygame.Surface((COLUMNS * (cell[0] + 8), ROWS * (cell[1] + 8)), depth=32)
    sheet.fill((90, 90, 90))
    for place, name in enumerate(names):
        row, column = divmod(place, COLUMNS)
        picture = pygame.transform.smoothscale(painted(seen(name, window), window), cell)
        sheet.blit(picture, (column * (cell[0] + 8) + 4, row * (cell[1] + 8) + 4))
    return sheet


if __name__ == "__main__":
    main()
