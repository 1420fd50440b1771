"""What holds for the tests themselves."""

from pathlib import Path

from pinjoint import Session

ROOT = Path(__file__).parents[2]


def test_what_keys_write_is_not_left_in_the_repository() -> None:
    """The key that saves plots writes into the working folder, as a person expects; tests press every key."""
    session = Session.open("isostatic")
    for key in ("o", "ctrl+e"):
        session.press(key)
    assert Path("pinjoint-plot-1.csv").exists()
    assert not list(ROOT.glob("pinjoint-plot-*"))
    assert not Path.cwd().is_relative_to(ROOT)
