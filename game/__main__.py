"""The program: `pinjoint`, or `python -m game`."""

from game.interrupts import unheard


def main() -> int:
    """Run the command line; returns the exit status."""
    with unheard():
        from game.commands import command_line
    return command_line.main()


if __name__ == "__main__":
    raise SystemExit(main())
