"""`python -m game` is `pinjoint`."""

from game.cli import main

raise SystemExit(main())
