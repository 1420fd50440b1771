"""Standard output and standard error: closed, full, or of an encoding that lacks letters; and what comes from files."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from pinjoint.commands.command_line import main
from tests.game.commands.test_command_line import MODEL, ROOT, pinjoint

LINUX = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="uses a shell and /dev/full")


def in_shell(line: str) -> subprocess.CompletedProcess[str]:
    """What a line of bash comes to, in which $P is the program."""
    return subprocess.run(
        ["bash", "-c", line],
        cwd=ROOT,
        env=os.environ | {"P": f"{sys.executable} -m pinjoint"},
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=300,
    )


@LINUX
@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
def test_help_can_be_read_in_every_encoding(encoding: str) -> None:
    found = in_shell(
        f"PYTHONIOENCODING={encoding} $P --help | iconv -f {encoding} -t utf-8; exit ${{PIPESTATUS[0]}}"
    )
    assert found.returncode == 0, found.stderr
    assert "  curve " in found.stdout
    assert not found.stderr


def test_json_loses_no_letter_where_the_encoding_lacks_it(tmp_path: Path) -> None:
    path = tmp_path / "accents.json"
    renamed = json.dumps(MODEL, ensure_ascii=False).replace('"B"', '"é–🔬"')
    path.write_text(renamed, encoding="utf-8")
    words = ("run", str(path), "--static", "--format")
    found = pinjoint(*words, "json", PYTHONIOENCODING="ascii")
    assert "é–🔬" in json.loads(found.stdout)["states"][0]["particles"]
    table = pinjoint(*words, "table", PYTHONIOENCODING="ascii")
    assert table.returncode == 0
    assert "???" in table.stdout


@LINUX
@pytest.mark.parametrize(
    ("line", "status", "said"),
    [
        ("$P plan isostatic >&-", 2, "Standard output cannot be written: it is closed. Choose another file."),
        ("$P plan isostatic >/dev/full", 2, "Standard output cannot be written: No space left on device."),
        ("$P --help >/dev/full", 2, "No space left on device"),
        ("$P --version >/dev/full", 2, "No space left on device"),
        ("$P plan nonsense 2>&- <&-", 2, ""),
        ("$P plan isostatic --format json --output /dev/null >&- 2>&-", 0, ""),
    ],
)
def test_closed_and_full_streams_are_told_and_end_well(line: str, status: int, said: str) -> None:
    found = in_shell(line)
    assert found.returncode == status
    assert "Traceback" not in found.stderr
    assert "Exception ignored" not in found.stderr
    assert said in found.stderr
    assert not found.stdout


def test_names_cannot_write_to_the_terminal(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "red.json"
    path.write_text(json.dumps(MODEL).replace('"B"', '"\\u001b[31mred"'), encoding="utf-8")
    assert main(["run", str(path), "--static"]) == 0
    assert main(["run", str(path), "--static", "--set", "particles.\x1b[31mred.radius=-1"]) == 2
    said = capsys.readouterr()
    assert "\\x1b[31mred" in said.out
    assert "\x1b" not in said.out + said.err


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["render", "isostatic", "--size", "²²x²²", "--output", "x.png"], "pixels, such as 1280x800"),
        (["run", "isostatic", "--set", "loads.*.force=1,1"], "the model has no loads"),
        (["run", "FILE", "--set", "loads.*.history=" + "[" * 5000], "history is '[[["),
        (["run", "isostatic", "--set", "rods.*.name=" + "x" * 5000], "There is a rod 'xxxx"),
        (["run", "isostatic", "--static", "--load-factors", "1e308,-1e308,0"], "1e+308 is too large"),
        (["sweep", "isostatic", "--vary", "rods.AB.density=1:2:²"], "'²' is not a count"),
    ],
    ids=lambda given: str(given)[:40],
)
def test_hostile_arguments_are_refused_in_one_short_line(
    words: list[str], sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "loaded.json"
    path.write_text(json.dumps(MODEL | {"loads": [{"on": "B", "force": [1, 0]}]}), encoding="utf-8")
    further = ["--measure", "rods.AB.strain", "--output", str(tmp_path / "x.csv")] * (words[0] == "sweep")
    assert main([str(path) if word == "FILE" else word for word in words] + further) == 2
    said = capsys.readouterr()
    assert sentence in said.err
    assert said.err.count("\n") == 1
    assert len(said.err) < 400


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("[" * 100_000, "line 2: this is nested too deeply"),
        ('{"run": ' + "1" * 5000 + "}", "line 2: this is not JSON"),
        ('{"click": [1e308, 1e308]}', "too far from what is shown"),
        ('{"drag": [[0, 0], [1e300, 0]]}', "too far from what is shown"),
        ('{"input": "click", "pixel": [1e308, -1e308]}', "too far from what is shown"),
        ('{"resize": [1e308, 1e308, 1]}', "give sides from 1 to 65536"),
        ('{"resize": [0.5, 0.5, 1]}', "give sides from 1 to 65536"),
        ('{"window": [1e9, 1e9]}', "give sides from 1 to 65536"),
        ('{"' + "x" * 9999 + '": 1}', "there is no key 'xxx"),
    ],
    ids=lambda given: given[:20],
)
def test_hostile_lines_of_scripts_are_named(
    line: str, sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    script = tmp_path / "script.jsonl"
    header = json.dumps({"format": "pinjoint session", "version": 1, "model": "isostatic"})
    script.write_text(f"{header}\n{line}\n", encoding="utf-8")
    assert main(["play", str(script)]) == 2
    said = capsys.readouterr().err
    assert sentence in said
    assert len(said) < 600


@pytest.mark.parametrize(
    "record", [b"0," + b"1" * 140_000, b"0,1\n1\xff,2\n", b"0,1\n1,2\n\0,3\n"], ids=["long", "no UTF-8", "NUL"]
)
def test_records_that_are_no_csv_are_named(
    record: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "record.csv").write_bytes(record)
    assert main(["shake", "isostatic", str(tmp_path / "record.csv"), "--output", str(tmp_path / "x.json")]) == 2
    said = capsys.readouterr().err
    assert "record.csv, " in said
    assert said.count("\n") == 1
