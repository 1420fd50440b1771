"""The program: `pinjoint`, or `python -m game`."""

from game.interrupts import unheard


def main() -> int:
    """Run the command line; returns the exit status."""
    with unheard():
        from game import cli
    return cli.main()


if __name__ == "__main__":
    raise SystemExit(main())
