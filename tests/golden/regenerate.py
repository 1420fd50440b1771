"""Write the golden pictures anew: python -m tests.golden.regenerate [NAME…]; look at each before keeping it."""

import sys

import pygame

from tests.golden.scenes import FOLDER, GOLDEN, drawn


def main() -> None:
    """Write those that are named, or all."""
    for name in sys.argv[1:] or GOLDEN:
        pygame.image.save(drawn(*GOLDEN[name]), FOLDER / f"{name}.png")
        print(f"{name}.png")


if __name__ == "__main__":
    main()
