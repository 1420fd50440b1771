"""The command line as a person meets it: exit status, one clear line for what is wrong, nothing lost."""

import csv
import io
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from pinjoint import mods
from pinjoint.commands.command_line import main
from pinjoint.commands.output import FORMATS
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import spoken
from pinjoint.systems.program.compiler import Choice, Compile
from tests.reference.models import model, particle, rod

ROOT = Path(__file__).parents[3]


def pinjoint(*words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """A process of its own, on no display but what `environment` says."""
    unset = ("DISPLAY", "WAYLAND_DISPLAY", "SDL_VIDEODRIVER")
    inherited = {name: value for name, value in os.environ.items() if name not in unset}
    return subprocess.run(
        [sys.executable, "-m", "pinjoint", *words],
        cwd=ROOT,
        env=inherited | environment,
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=300,
    )


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="elsewhere there always is a display")
@pytest.mark.parametrize("environment", [{}, {"DISPLAY": ":98765"}], ids=["none", "out of reach"])
def test_without_a_display_one_line_says_so(environment: dict[str, str]) -> None:
    found = pinjoint("isostatic", **environment)
    assert found.returncode == 3
    (line,) = [line for line in found.stderr.splitlines() if line.startswith("pinjoint: ")]
    assert "pinjoint run" in line
    assert found.stdout == ""


MODEL = model(
    [particle("A", 0, 0, fixed=[True, True]), particle("B", 1, 0, fixed=[False, True], force=[10, 0])],
    [rod("A", "B")],
)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ("run isostatic --static --load-factors ,", "write numbers separated by commas"),
        ("run isostatic --output /no/such/folder/x.json", "there is no folder /no/such/folder"),
        ("run isostatic --events /", "it is a folder"),
        ("run isostatic --set particles.B.position=1e200,1", "1e+200 m; it must be at most 1e+30 m"),
        ("curve von_mises --factor nan", "nan is not a finite number"),
        ("curve von_mises --points 1", "1 is not a whole number of at least 2"),
        ("plot isostatic", "required: --of, --until, --output. See: pinjoint plot --help"),
        ("plot missing --of time --until 1 --output x.csv", "no bundled model 'missing'"),
        ("plot isostatic --of rods.AX.strain --until 1 --output x.csv", "no 'AX' among the rods"),
        ("plot isostatic --of time --until 1 --output x.pdf", "ends with one of .csv, .png"),
        ("shake isostatic missing.csv --output x.json", "missing.csv cannot be read: No such file"),
        ("play missing.jsonl", "There is no file and no lesson 'missing.jsonl'; choose one of 01_first"),
        ("play 1_draw_truss", "did you mean '1_draw_a_truss'?"),
        ("render isostatic --output x.tiff", "choose a file that ends with one of .png, .svg"),
        (
            "plot isostatic --of time --until 1e-4 --samples 2 --output /proc/x.csv",
            "/proc/x.csv cannot be written",
        ),
        ("verfy isostatic", "There is no command 'verfy'; did you mean 'verify'?"),
        ("run isostatic --mods", "Argument --mods: expected one argument"),
    ],
)
def test_what_cannot_be_done_is_said_in_one_line(
    words: str, sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(words.split()) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.startswith("pinjoint: ")
    assert said.err.count("\n") == 1
    assert sentence in said.err


def test_lists_of_numbers_may_begin_with_a_minus(answer: Any) -> None:
    states = answer("run", "isostatic", "--static", "--load-factors", "-0.5,0.5")["states"]
    assert [state["load_factor"] for state in states] == [-0.5, 0.5]


def test_times_before_that_of_a_saved_run_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "later.json"
    path.write_text(json.dumps(MODEL | {"state": {"time": 3.5, "steps": 10}}), encoding="utf-8")
    assert main(["run", str(path), "--at", "1"]) == 2
    assert "The model is at t = 3.5 s already" in capsys.readouterr().err


def test_a_file_whose_name_is_no_utf_8(tmp_path: Path, answer: Any) -> None:
    path = os.fsdecode(os.fsencode(tmp_path) + b"/b\xff.json")
    try:
        Path(path).write_text(json.dumps(MODEL), encoding="utf-8")
    except OSError:
        pytest.skip("such names are not possible here")
    assert answer("run", path, "--static")["model"].endswith("/b?.json")


def test_a_reader_that_has_seen_enough_is_no_error() -> None:
    line = f"'{sys.executable}' -m pinjoint mods list | head -c 1; exit ${{PIPESTATUS[0]}}"
    found = subprocess.run(["/bin/bash", "-c", line], cwd=ROOT, capture_output=True, text=True)
    assert found.returncode in (0, 1)
    assert found.stderr == ""


def test_help_says_what_each_command_does(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    with pytest.raises(SystemExit):
        main(["--help"])
    lines = capsys.readouterr().out.splitlines()
    for name in EXTENSIONS.commands:
        assert any(re.fullmatch(rf"  {name} +\w.+", line) for line in lines), name
    assert max(map(len, lines)) <= 80


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (
            "run load_cases --static --case heat --combination sun",
            "--case and --combination exclude each other",
        ),
        ("verify isostatic --path AB", "--path works only together with --influence"),
        ("verify isostatic --theory-only --limit 3", "--limit and --theory-only exclude each other"),
        ("run isostatic --load-factors 1", "--load-factors works only together with --static; add it."),
        ("run isostatic --theory exact", "--theory works only together with --static"),
        ("run isostatic --path AB", "--path works only together with --static"),
        (
            "run isostatic --static --limit 3",
            "--limit and --static exclude each other; leave out one of the two.",
        ),
        ("run isostatic --at 1 --limit 3", "--limit and --at exclude each other"),
        ("run isostatic --static --time-step 0.01", "--time-step and --static exclude each other"),
        ("run isostatic --static --integrator rk4", "--integrator and --static exclude each other"),
        ("run isostatic --static --measure-error", "--measure-error and --static exclude each other"),
        ("run isostatic --static --events e.csv", "--events and --static exclude each other"),
        ("curve isostatic --time-step 0.01", "Unrecognized arguments: --time-step 0.01"),
        ("render isostatic --output a.png --deformed", "--deformed works only together with --static"),
        ("render isostatic --output a.png --at 1 --until-rest", "--at and --until-rest exclude each other"),
        ("render isostatic --output a.png --static --at 1", "--at and --static exclude each other"),
        ("render isostatic --output a.gif --static", "--static and .gif exclude each other"),
    ],
)
def test_no_option_is_dropped_in_silence(capsys: pytest.CaptureFixture[str], command: str, said: str) -> None:
    assert main(command.split()) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize("variable", ["PINJOINT_DATA", "PINJOINT_CONFIG"])
def test_a_variable_that_names_no_folder_is_refused(variable: str) -> None:
    found = pinjoint("run", "isostatic", **{variable: __file__})
    assert found.returncode == 2
    assert found.stderr == f"pinjoint: {variable} is '{__file__}'; set it to a folder, or leave it out.\n"


def test_a_model_without_rods_has_nothing_to_displace(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    (tmp_path / "empty.json").write_text(json.dumps(model([], [])))
    assert main(["displacement-method", str(tmp_path / "empty.json")]) == 0
    assert json.loads(capsys.readouterr().out)["unknowns"] == []


@pytest.mark.parametrize("command", sorted(EXTENSIONS.commands))
@pytest.mark.parametrize("language", ["en", "pt"])
def test_each_command_has_help(capsys: pytest.CaptureFixture[str], command: str, language: str) -> None:
    with spoken(language), pytest.raises(SystemExit) as ended:
        main([command, "--help"])
    assert ended.value.code == 0
    assert "--help" in capsys.readouterr().out


@pytest.mark.parametrize("command", ["run isostatic --static", "mods list"])
def test_a_full_disk_is_said_in_one_line(command: str) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("there is no /dev/full here")
    words = [sys.executable, "-m", "pinjoint", *command.split()]
    with open("/dev/full", "w") as full:
        found = subprocess.run(words, cwd=ROOT, stdout=full, stderr=subprocess.PIPE, text=True)
    assert found.returncode == 2
    assert re.fullmatch(r"pinjoint: Standard output cannot be \w+: No space left on device\..*\n", found.stderr)


@pytest.mark.parametrize(
    "command",
    [
        "run isostatic --static --output {}.csv",
        "render isostatic --output {}.png",
        "plot isostatic --of time --until 0.001 --output {}.csv",
        "plot isostatic --of time --until 0.001 --output {}.png",
    ],
)
def test_a_result_that_cannot_be_written_leaves_the_old_one(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def fail(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    words = command.format(tmp_path / "result").split()
    path = Path(words[-1])
    path.write_text("old", encoding="utf-8")
    monkeypatch.setattr(os, "fsync", fail)
    assert main(words) == 2
    assert re.fullmatch(
        r"pinjoint: .* cannot be written: No space left on device\. Choose .*\n", capfd.readouterr().err
    )
    assert path.read_text(encoding="utf-8") == "old"
    assert list(tmp_path.iterdir()) == [path]


# --- formats -------------------------------------------------------------------------------------------

PRINTING = {  # commands that print a result, and their format if none is asked for
    "run isostatic --static": "table",
    "verify isostatic --theory-only": "table",
    "verify isostatic --influence AB A.y": "table",
    "curve von_mises --until B.y=-0.1": "csv",
    "force-method hyperstatic --release AC": "json",
    "force-method hyperstatic --all": "json",
    "plan isostatic": "table",
    "mods list --no-mods": "table",
    "mods check assets/mods/wind": "table",
    "play 1_draw_a_truss": "table",
}


@pytest.fixture
def unloaded() -> Iterator[None]:
    """What a command loads is unloaded after the test."""
    before = len(mods.MODS)
    yield
    mods.unload(mods.MODS[before:])


@pytest.mark.usefixtures("unloaded")
@pytest.mark.parametrize("command", PRINTING)
def test_every_command_that_prints_knows_three_formats(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(Choice, "compile", Compile.NEVER)
    printed = {}
    for chosen in FORMATS:
        path = tmp_path / f"result.{chosen}"
        assert main([*command.split(), "--format", chosen]) == 0
        printed[chosen] = capsys.readouterr().out
        assert main([*command.split(), "--format", chosen, "--output", str(path)]) == 0
        assert capsys.readouterr().out == ""
        assert without_times(path.read_text(encoding="utf-8")) == without_times(printed[chosen])
    json.loads(printed["json"], parse_constant=pytest.fail)
    rows = list(csv.reader(io.StringIO(printed["csv"])))
    assert len({len(row) for row in rows}) == 1
    assert all(rows[0])
    assert len(set(printed.values())) == 3
    assert main(command.split()) == 0
    assert without_times(capsys.readouterr().out) == without_times(printed[PRINTING[command]])


def without_times(text: str) -> str:
    """What two runs of a command have in common: all but the seconds that they took."""
    text = re.sub(r'"(wall|compile)_seconds": [^,]*', "", text)
    return re.sub(r"computed in .* s, ready after .* s", "", text)


@pytest.mark.parametrize("command", PRINTING)
def test_no_command_writes_where_it_cannot(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*command.split(), "--output", "/no/such/folder/x"]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert "/no/such/folder/x cannot be written, there is no folder /no/such/folder" in said.err
    assert main([*command.split(), "--format", "yaml"]) == 2
    assert "choose from" in capsys.readouterr().err


@pytest.mark.parametrize("same", ["itself", "a link", "another name", "a path"])
@pytest.mark.parametrize(
    "command",
    [
        "run {model} --static --output {file}",
        "run {model} --events {file}",
        "verify {model} --theory-only --output {file}",
        "render {model} --output {file}",
        "shake {model} {record} --output {file}",
        "sweep {model} --vary settings.restitution=0:1:2 --measure rods.AB.strain --output {file}",
        "plot {model} --of time --until 0.001 --output {file}",
        "{model} --record {file}",
        "shake isostatic {model} --output {file}",
        "play {script} --output {file}",
    ],
)
def test_no_command_replaces_what_it_reads(
    command: str, same: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model, record = tmp_path / "model.csv", tmp_path / "record.csv"  # plot and sweep look at the ending
    content = (ROOT / "assets" / "models" / "isostatic.json").read_bytes()
    model.write_bytes(content)
    record.write_text("0,0\n1,1\n", encoding="utf-8")
    script = tmp_path / "script.jsonl"
    script.write_text('{"format": "pinjoint session", "version": 1, "model": "model.csv"}\n', encoding="utf-8")
    file = tmp_path / "other.csv"
    if same == "a link":
        file.symlink_to(model)
    elif same == "another name":
        file.hardlink_to(model)
    else:
        file = model if same == "itself" else Path(f"{tmp_path}/../{tmp_path.name}/model.csv")
    assert main(command.format(model=model, record=record, script=script, file=file).split()) == 2
    assert "which would be lost; choose another file" in capsys.readouterr().err
    assert model.read_bytes() == content


def test_two_results_do_not_go_into_one_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    both = str(tmp_path / "result.csv")
    assert main(["run", "isostatic", "--output", both, "--events", both]) == 2
    assert "choose another file" in capsys.readouterr().err


def test_there_is_no_report_of_what_is_determinate(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    report = tmp_path / "report.pdf"
    assert main(["force-method", "isostatic", "--all", "--report", str(report)]) == 2
    assert "isostatic is statically determinate" in capsys.readouterr().err
    assert not report.exists()


@pytest.mark.parametrize("language", ["en", "pt"])
def test_random_variants_in_every_language(language: str, tmp_path: Path) -> None:
    words = "sweep hyperstatic --static --samples 2 --measure rods.CD.strain --vary rods.CD.stiffness~normal(1e5,1e3)"
    found = pinjoint(*words.split(), "--output", str(tmp_path / "r.csv"), PINJOINT_LANGUAGE=language)
    assert found.returncode == 0, found.stderr
    assert len((tmp_path / "r.csv").read_text(encoding="utf-8").splitlines()) == 3


def printed_by(command: str, capsys: pytest.CaptureFixture[str]) -> str:
    assert main(command.split()) == 0
    return capsys.readouterr().out


def test_every_format_of_the_force_method_has_the_same_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    command = "force-method hyperstatic --release AC"
    found = json.loads(printed_by(command, capsys))
    (row,) = csv.DictReader(io.StringIO(printed_by(f"{command} --format csv", capsys)))
    assert row == {
        "released": "AC",
        "delta_real (m)": repr(found["delta_real"]),
        "delta_base (m)": repr(found["delta_base"]),
        "delta_unit AC (m/kN)": repr(found["delta_unit"]),
        "force (kN)": repr(found["force"]),
        "exact_force (kN)": repr(found["exact_force"]),
    }
    assert f"{found['force']:.7g}" in printed_by(f"{command} --format table", capsys)


def test_a_curve_that_ends_early_says_why(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["curve", "von_mises", "--points", "3", "--format", "json"]) == 1
    said = capsys.readouterr()
    message = json.loads(said.out)["message"]
    assert message.endswith(", after 3 points; allow more: --points 30.")
    assert message in said.err


def test_every_format_of_a_curve_has_the_same_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    command = "curve von_mises --until B.y=-0.1"
    rows = list(csv.DictReader(io.StringIO(printed_by(command, capsys))))
    found = json.loads(printed_by(f"{command} --format json", capsys))
    assert found["complete"] is True
    assert [float(row["load factor"]) for row in rows] == found["load_factor"]
    assert [row["stable"] == "1" for row in rows] == found["stable"]
    assert [float(row["B.y (m)"]) for row in rows] == found["displacement"]["B.y"]
    rod, forces = next(iter(found["axial_force"].items()))
    assert [float(row[f"{rod} (kN)"]) for row in rows] == forces


def test_every_format_of_verify_has_the_same_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    command = "verify isostatic --theory-only"
    found = json.loads(printed_by(f"{command} --format json", capsys))
    rows = list(csv.DictReader(io.StringIO(printed_by(f"{command} --format csv", capsys))))
    values = {(row["name"], row["quantity"], row["component"]): row for row in rows}
    assert values["AB", "axial_force", ""]["unit"] == "kN"
    assert float(values["AB", "axial_force", ""]["exact"]) == found["rods"]["AB"]["axial_force"]["exact"]
    displaced = values["B", "displacement", "y"]
    assert displaced["element"] == "particle"
    assert displaced["simulation"] == ""
    assert float(displaced["linear"]) == found["particles"]["B"]["displacement"]["y"]["linear"]
