"""Work without an end: it says how far it is, Ctrl+C ends it at once, and what was found until then is written."""

import json
import signal
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from pinjoint.commands import progress
from pinjoint.commands.command_line import main
from tests.properties.limits import interrupted_after
from tests.reference.models import model, particle, rod

pytestmark = pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="nothing would interrupt it")
FIXED = {"fixed": [True, True], "radius": 0.1}
BILLION_IMPACTS = model(
    [
        particle("A", 0, 0, velocity=[1e9, 0], radius=0.1),
        *(particle(name, x, 0, **FIXED) for name, x in (("L", -1), ("R", 1))),
    ],
    [],
)
STIFF_DAMPER = model(
    [particle("A", 0, 0, fixed=[True, True]), particle("B", 1, 0, force=[1, 0])],
    [rod("A", "B", damping=1e9)],
    settings={"integrator": "velocity_verlet"},
)
ENDLESS = {"impacts": BILLION_IMPACTS, "a stiff damper": STIFF_DAMPER}


@pytest.mark.parametrize("model", ENDLESS.values(), ids=ENDLESS.keys())
def test_a_run_that_is_interrupted_reports_what_it_had(model: dict[str, Any], answer: Any) -> None:
    answer("run", model, "--at", "1e-9")  # compiles
    with interrupted_after(1.0):
        run = answer("run", model, "--at", "1e-9,1e6", status=130)
    assert run["status"] == "interrupted"
    assert run["message"].startswith("Interrupted at t = ")
    assert run["states"][0]["time"] == 1e-9
    last = run["states"][-1]
    assert len(run["states"]) == 2
    energy = last["energy"]
    assert abs(energy["imbalance"]) <= 1e-6 * max(abs(energy["work"]), energy["kinetic"])


@pytest.mark.parametrize(
    "words",
    [
        "plot MODEL --of energy.kinetic --until 1e6 --output OUT.csv",
        "render MODEL --at 1e6 --output OUT.png",
        "render MODEL --at 1e6 --output OUT.gif",
        "sweep MODEL --vary settings.restitution=1,1 --measure energy.kinetic --at 1e6 --workers 1 --output OUT.csv",
    ],
    ids=lambda words: words[:6],
)
def test_other_commands_end_with_a_sentence(
    words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "endless.json"
    path.write_text(json.dumps(BILLION_IMPACTS), encoding="utf-8")
    main(["run", str(path), "--at", "1e-9"])  # compiles
    given = words.replace("MODEL", str(path)).replace("OUT", str(tmp_path / "out"))
    with interrupted_after(1.0):
        assert main(given.split()) == 130
    assert "pinjoint: Interrupted" in capsys.readouterr().err


def test_what_lasts_says_how_far_it_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(progress, "SILENT", 0.2)
    monkeypatch.setattr(progress, "FURTHER", 0.2)
    path = tmp_path / "endless.json"
    path.write_text(json.dumps(BILLION_IMPACTS), encoding="utf-8")
    main(["run", str(path), "--at", "1e-9"])  # compiles
    capsys.readouterr()
    with interrupted_after(1.0), progress.told():
        assert main(["run", str(path), "--at", "1e6"]) == 130
    said = [line for line in capsys.readouterr().err.splitlines() if "impacts. Ctrl+C stops it." in line]
    impacts = [int(line.rpartition(" steps, ")[2].partition(" ")[0]) for line in said]
    fallen = [later < sooner for sooner, later in pairwise(impacts)]
    assert len(impacts) > 1
    assert sum(fallen) <= 1  # Ctrl+C goes back to what is kept, and the voice may tell of that, too
    assert max(impacts) > 1000


@pytest.mark.parametrize(
    "given",
    [
        model([BILLION_IMPACTS["particles"][0], particle("B", 0.5, 1, velocity=[1e16, 1e19])], []),
        model(
            [particle("A", 0, 0, velocity=[1, 0]), particle("B", 1, 0.05)],
            [],
            components={"walls.Wall": [{"start": [-1e11, -1], "end": [1e11, -1]}]},
        ),
        model(  # a rod of 1.4e9 m leaves its branch between two times that are next to each other
            [
                particle("P0", 0, 0, displacement=[0.016, 1e9], mass=2, **FIXED),
                particle(
                    *("P1", -1e9, 0.3),
                    velocity=[1.3211215257974307, -1.1614779683649394],
                    acceleration=[1, -9.81],
                    mass=2,
                    radius=0.2,
                ),
                particle("P2", 2, 0, displacement=[0.016, -0.01]),
                particle("P3", 0, 1.3, velocity=[0.28764957300111266, 1.3866213842230934]),
            ],
            [
                rod("P1", "P0", temperature_change=30, tension_only=True),
                rod("P2", "P0", rest_length=1, temperature_change=30, tension_only=True),
                rod("P3", "P0", tensile_strength=100, plastic_strain=0.001),
                rod("P3", "P1", temperature_change=30),
            ],
        ),
    ],
    ids=["speeds", "a wall", "cables"],
)
def test_numbers_of_very_different_sizes_do_not_make_work(given: dict[str, Any], tmp_path: Path) -> None:
    path = tmp_path / "sizes.json"
    path.write_text(json.dumps(given), encoding="utf-8")
    main(["run", str(path), "--at", "1e-9"])  # compiles
    with interrupted_after(5.0):
        assert main(["run", str(path), "--at", "0.01", "--output", str(tmp_path / "out")]) == 0
