"""The README and its further pages are kept true: Python and commands do what is shown, keys exist, links lead somewhere."""

import ast
import io
import json
import re
import shlex
from contextlib import redirect_stdout
from decimal import Decimal
from pathlib import Path

import pytest

from pinjoint.commands.command_line import main
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.documents import models
from pinjoint.systems.input.actions import ACTIONS

ROOT = Path(__file__).parents[2]
README = ROOT / "README.md"
TEXT = README.read_text(encoding="utf-8")
PAGES = [
    README,
    *(
        page
        for top in ("components", "systems", "game", "assets", "tests")
        for page in sorted((ROOT / top).rglob("README.md"))
    ),
]


def str_of(page: Path) -> str:
    """A page as tests call it."""
    return str(page.relative_to(ROOT))


def blocks(language: str, text: str = TEXT) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", text, flags=re.DOTALL)


GUIDE = ROOT / "assets" / "mods" / "README.md"  # tests/mods/test_guide.py follows it
WITH_PYTHON = [page for page in PAGES if page != GUIDE and blocks("python", page.read_text(encoding="utf-8"))]


def anchors(text: str) -> set[str]:
    """What links can point to in a page: its headings, in lower case and with hyphens."""
    headings = re.findall(r"^#+ (.*)$", text, flags=re.MULTILINE)
    return {re.sub(r"[^\w -]", "", heading.lower()).replace(" ", "-") for heading in headings}


def test_the_readme_is_short() -> None:
    assert TEXT.count("\n") <= 250


# --- what is shown is what comes out ---------------------------------------------------------------------

NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?…?")
# a smaller number is an error of rounding or of a tolerance: only its order of magnitude is compared
NOISE = 1e-7


def alike(shown: str, found: str) -> bool:
    """Whether a text that a page shows stands for one that was printed: the same words, and numbers as rounded.

    A number may be off by half a unit of the last digit shown; by a whole one if "…" follows, where it was cut off.
    """
    if " ".join(NUMBER.sub("#", shown).split()) != " ".join(NUMBER.sub("#", found).split()):
        return False
    return all(map(_same_number, NUMBER.findall(shown), NUMBER.findall(found)))


def _same_number(shown: str, found: str) -> bool:
    digits = Decimal(shown.rstrip("…"))
    unit = float(Decimal((0, (1,), int(digits.as_tuple().exponent))))
    wanted, got = float(digits), float(found)
    if 0.0 < abs(wanted) < NOISE:
        return abs(got) < 10.0 * abs(wanted)
    return abs(got - wanted) <= unit * (1.0 if shown.endswith("…") else 0.5) * (1.0 + 1e-9)


@pytest.mark.parametrize(
    ("shown", "found", "same"),
    [
        ("at rest", "at rest", True),
        ("at rest", "diverged", False),
        ("-28.34277", "-28.342768144406364", True),
        ("-28.34278", "-28.342768144406364", False),
        ("-10.00001…", "-10.00001968717655", True),
        ("(0.0007, -0.0015)", "(0.00070584, -0.00144225)", False),
        ("(0.0007…, -0.0015…)", "(0.00070584, -0.00144225)", True),
        ("AB  1.6e-09  no", "AB 3.2e-10 no", True),
        ("AB  1.6e-09  no", "AB 3.2e-08 no", False),
        ("AB  1.6e-09", "AB 1.6e-09 no", False),
        ("4", "5", False),
    ],
)
def test_numbers_are_compared_as_they_are_rounded(shown: str, found: str, same: bool) -> None:
    assert alike(shown, found) is same


@pytest.mark.parametrize("page", WITH_PYTHON, ids=str_of)
def test_the_python_of_a_page_prints_what_its_comments_say(
    page: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """What follows "→" in the comment of a line that prints is what it prints."""
    names: dict[str, object] = {}
    monkeypatch.chdir(tmp_path)
    for block in blocks("python", page.read_text(encoding="utf-8")):
        for statement in ast.parse(block).body:
            printed = io.StringIO()
            with redirect_stdout(printed):
                exec(compile(ast.Module([statement], []), str(page), "exec"), names)
            source = ast.get_source_segment(block, statement) or ""
            comment = block.splitlines()[(statement.end_lineno or 1) - 1].partition("  # ")[2]
            if source.startswith("print(") and "→" in comment:
                expected = comment.partition("→")[2].strip()
                assert alike(expected, printed.getvalue()), f"{source} prints {printed.getvalue()}"


SESSIONS = [
    (page, *session.partition("\n")[::2])
    for page in PAGES
    for text in blocks("text", page.read_text(encoding="utf-8"))
    for session in text.split("$ pinjoint ")[1:]
]


@pytest.mark.parametrize(("page", "command", "shown"), SESSIONS, ids=lambda part: str(part).partition("\n")[0])
def test_a_command_prints_what_a_page_shows(
    page: Path, command: str, shown: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """A page may show a part of the lines, one after the other."""
    assert main(shlex.split(command)) == 0
    wanted, lines = shown.splitlines(), capsys.readouterr().out.splitlines()
    starts = range(len(lines) - len(wanted) + 1)
    assert any(all(map(alike, wanted, lines[start:])) for start in starts), "\n".join(lines)


def test_the_picture_of_a_frame_is_the_plan(capsys: pytest.CaptureFixture[str]) -> None:
    (picture,) = (text for text in blocks("text") if "for phase in Phase" in text)
    assert main(["plan", "isostatic", "--format", "json"]) == 0
    phases = json.loads(capsys.readouterr().out)["phases"]
    assert re.findall(r"\b[A-Z]+\b", picture) == [phase.upper() for phase in phases]
    named = re.findall(r"\b[a-z]+\.[a-z]+\b", picture.partition("INPUT")[2])
    assert len(named) > len(phases)
    assert set(named) <= {name for names in phases.values() for name in names}


# --- keys ------------------------------------------------------------------------------------------------


def test_the_table_of_keys_is_that_of_the_program() -> None:
    """On its page all of them; in the README keys that do something in the window."""
    page = (ROOT / "systems" / "input" / "README.md").read_text(encoding="utf-8")
    assert table_of_keys() in page, "paste the output of: python -m tests.architecture.test_readme"
    keys = {readable(binding.key) for _, binding in ACTIONS.bound()}
    section = TEXT.partition("## Keys")[2].partition("\n## ")[0]
    rows = [line.split("|")[1:5] for line in section.splitlines() if line.startswith("| ")][2:]
    for one, _, other, _ in rows:
        assert set(re.split(r", | and ", f"{one.strip()}, {other.strip()}")) <= keys


def readable(key: str) -> str:
    """As the README writes keys: "ctrl+shift+z" → "Ctrl+Shift+Z"."""
    return "+".join(part[:1].upper() + part[1:] for part in re.split(r"(?<=\w)\+", key))


def table_of_keys() -> str:
    """The README's table of keys, to be pasted there when bindings change."""
    merged: dict[tuple[str, str], list[str]] = {}
    for _, binding in ACTIONS.bound():
        if binding.title:
            merged.setdefault((binding.key, binding.title), []).extend(binding.scenes)
    rows = [f"| {readable(key)} | {', '.join(scenes)} | {title} |" for (key, title), scenes in merged.items()]
    return "\n".join(["| key | in | does |", "| --- | --- | --- |", *rows])


@pytest.mark.parametrize("page", PAGES, ids=str_of)
def test_every_link_leads_somewhere(page: Path) -> None:
    for link in re.findall(r"\]\((?!https?:)([^)]*)\)", page.read_text(encoding="utf-8")):
        path, _, anchor = link.partition("#")
        target = (page.parent / path) if path else page
        assert target.exists(), link
        assert not anchor or anchor in anchors(target.read_text(encoding="utf-8")), link


@pytest.mark.parametrize("page", PAGES, ids=str_of)
def test_every_command_exists(page: Path) -> None:
    for block in blocks("sh", page.read_text(encoding="utf-8")):
        for word in re.findall(r"(?:^|bin/)pinjoint ([\w-]+)", block, flags=re.MULTILINE):
            assert word.isupper() or word in EXTENSIONS.commands or word in models.bundled(), word


LONG = ("open", "bench", "sweep", "play")  # or with a window, or tried elsewhere
WITHOUT_WINDOW = [
    words
    for line in re.findall(r"^pinjoint (.*)$", "".join(blocks("sh")), flags=re.MULTILINE)
    if (words := shlex.split(line, comments=True))[0] in set(EXTENSIONS.commands) - set(LONG) and len(words) > 1
]


@pytest.mark.parametrize("words", WITHOUT_WINDOW, ids=" ".join)
def test_every_command_does_what_it_says(
    words: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("RECORD.csv").write_text("0,0\n0.1,1\n0.2,0\n", encoding="utf-8")
    assert main(words) == 0
    if "--output" in words:
        assert Path(words[words.index("--output") + 1]).stat().st_size > 0


if __name__ == "__main__":
    print(table_of_keys())
