"""The program: `pinjoint`, or `python -m game`."""

from game.interrupts import ended_with, quietly_interrupted


def main() -> int:
    """Run the command line; returns the exit status."""
    with quietly_interrupted():
        from game.commands import command_line
    return ended_with(command_line.main())


if __name__ == "__main__":
    raise SystemExit(main())
