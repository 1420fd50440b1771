"""The modders' guide, followed literally in an empty folder; and the examples in docstrings."""

import doctest
import importlib
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from pinjoint import mods
from pinjoint.commands.command_line import main
from pinjoint.systems.base import ACCOUNTS
from pinjoint.systems.input.actions import ACTIONS, FORMS
from pinjoint.systems.program.compiler import Choice

GUIDE = Path(__file__).parents[2] / "assets" / "mods" / "README.md"
BLOCK = re.compile(r"(?:^`([\w./]+)`:\n\n)?^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def run_command(line: str) -> None:
    words = shlex.split(line)
    if words[0] == "pytest":
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *words[1:]]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout
    else:
        assert words[0] == "pinjoint"
        main(words[1:])


def test_the_guide_works_at_the_first_try(
    tmp_path: Path,
    unloaded: None,
    compiling: None,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    blocks = BLOCK.findall(GUIDE.read_text(encoding="utf-8"))
    assert len(blocks) > 10
    for path, language, text in blocks:  # kernels are compiled to be checked, and one program
        monkeypatch.setattr(Choice, "proved", ("pinjoint." if "arcade" in text else "",))
        if path:
            Path(path).parent.mkdir(exist_ok=True)
            Path(path).write_text(text, encoding="utf-8")
        elif language == "sh":
            for line in text.splitlines():
                run_command(line)
        elif language == "python":
            exec(compile(text, "a snippet of the guide", "exec"), {"__name__": "guide"})
        else:
            assert language == "text"
    output = capsys.readouterr()
    assert output.err == ""
    assert "breeze 0.1: no problems" in output.out
    assert not mods.FAULTS


def test_the_guide_names_all_that_can_be_registered_called_and_chosen() -> None:
    guide = " ".join(GUIDE.read_text(encoding="utf-8").split())
    methods = [name for name, method in vars(mods.App).items() if callable(method) and name[0] != "_"]
    for name in methods:
        assert name in ("withdraw", "catalogues") or f"`{name}(" in guide, name  # which Pinjoint calls
    in_forms = {action.name for action, b in ACTIONS.bound() if set(b.scenes) <= set(FORMS)}
    listed = set(guide.partition("besides the ones in forms: ")[2].partition(".")[0].split(", "))
    assert listed == {name for name in ACTIONS if "." not in name} - in_forms
    for account in ACCOUNTS:
        assert f'"{account}"' in guide


@pytest.mark.parametrize(
    "module", ["pinjoint.components", "pinjoint.systems.base", "pinjoint", "pinjoint.mods", "pinjoint.api"]
)
def test_what_is_public_exists_and_is_documented(module: str) -> None:
    public = importlib.import_module(module)
    for name in getattr(public, "__all__", [name for name in vars(public) if name[0] != "_"]):
        thing = getattr(public, name)
        assert not callable(thing) or thing.__doc__ or not hasattr(thing, "__module__"), name


OTHERS = "components", "systems.base", "mods", "session", "checks", "mods.app", "api"


@pytest.mark.parametrize("module", [f"pinjoint.{name}" for name in OTHERS])
def test_the_examples_in_docstrings_are_true(module: str) -> None:
    found = doctest.testmod(importlib.import_module(module))
    assert found.failed == 0
    assert found.attempted > 0 or module == "pinjoint.mods.app"
