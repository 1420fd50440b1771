"""Model files: what is read, what is refused and how that is said, how it is written."""

import gc
import json
import math
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pinjoint.commands.command_line import main
from pinjoint.components.field import Column, FieldError, Role, same
from pinjoint.components.load import Load
from pinjoint.components.model import Model
from pinjoint.documents import models
from pinjoint.documents.models import ModelError
from tests.reference.models import model, particle, rod, square, triangle

BASE = {"format": "pinjoint model", "version": 1}


def saved_columns(loaded: Model) -> dict[str, Column]:
    """Every column that a file must keep, by name."""
    return {
        f"{table.name}.{field.name}": table.column(field.name)
        for table in loaded.tables.values()
        if table.name != "boxes"
        for field in table.fields_in(Role.DOCUMENT, Role.STATE)
    }


def assert_same(first: Model, second: Model) -> None:
    before, after = saved_columns(first), saved_columns(second)
    assert before.keys() == after.keys()
    for name, column in before.items():
        assert same(column, after[name]), name
    assert (first.title, first.description) == (second.title, second.description)


# --- reading -----------------------------------------------------------------------------------------


def test_a_document_becomes_a_model() -> None:
    loaded = models.parse(triangle(tensile_strength=215, damping=0) | {"title": "T", "description": "d"})
    assert loaded.title == "T"
    assert loaded.description == "d"
    assert loaded.particles.names == ["A", "B", "C"]
    assert loaded.particles["B"].force == (120.0, -160.0)
    assert loaded.particles["A"].fixed == (False, True)
    assert [end.name for end in loaded.rods["CA"].ends] == ["C", "A"]
    assert loaded.rods["AB"].tensile_strength == 215.0
    assert loaded.rods["AB"].compressive_strength is None
    assert loaded.rods["AB"].stiffness == 164640.0


@pytest.mark.parametrize("collects", [True, False])
def test_reading_leaves_the_garbage_collector_as_it_was(tmp_path: Path, collects: bool) -> None:
    good, bad = tmp_path / "good.json", tmp_path / "bad.json"
    good.write_text(json.dumps(triangle()), encoding="utf-8")
    bad.write_text(json.dumps(BASE | {"particles": 3}), encoding="utf-8")
    before = gc.isenabled()
    try:
        (gc.enable if collects else gc.disable)()
        models.load(good)
        assert gc.isenabled() is collects
        with pytest.raises(ModelError):
            models.load(bad)
        assert gc.isenabled() is collects
    finally:
        (gc.enable if before else gc.disable)()


def test_sections_are_optional_and_have_defaults() -> None:
    loaded = models.parse(BASE)
    assert [len(loaded.tables[name]) for name in ("particles", "rods", "loads", "grids")] == [0, 0, 0, 0]
    assert loaded.settings.restitution == 1.0


def test_loads_and_grids_without_a_name_get_the_smallest_free_one() -> None:
    loads = [{"on": "A"}, {"on": "B", "name": "load 1"}, {"on": "B", "history": {"kind": "ramp"}}]
    loaded = models.parse(triangle() | {"loads": loads, "grids": [{"spacing": [0.25, 1]}]})
    assert loaded.loads.names == ["load 2", "load 1", "load 3"]
    assert loaded.loads["load 3"].history == {"kind": "ramp", "start": 0.0, "duration": 1.0}
    assert loaded.loads["load 1"].particle.name == "B"
    assert loaded.grids["grid 1"].spacing == (0.25, 1.0)


def test_numbers_of_scripts_are_taken_too() -> None:
    loaded = models.parse(
        model(
            [particle("A", np.float64(1.5), np.int64(2), force=np.array([3.0, 4.0]))], [], state={"steps": 2.0}
        )
    )
    assert loaded.particles["A"].position == (1.5, 2.0)
    assert loaded.particles["A"].force == (3.0, 4.0)
    assert loaded.clock.steps == 2


def test_null_is_only_for_what_may_be_absent() -> None:
    loaded = models.parse(model([particle("A", 0, 0, mass=None)], []))
    assert loaded.particles["A"].prescribed_mass is None
    with pytest.raises(ModelError, match=r"\$\.particles\[0\]\.radius \(particle A\): .* a number"):
        models.parse(model([particle("A", 0, 0, radius=None)], []))


REFUSED: dict[str, tuple[Any, str, str]] = {
    "no object": ([1], "$", "must be an object"),
    "no format": ({"version": 1}, "$.format", '"format": "pinjoint model"'),
    "no version": ({"format": "pinjoint model"}, "$.version", "it is None"),
    "newer": (BASE | {"version": 2}, "$.version", "up to 1 only; update Pinjoint"),
    "version never was": (BASE | {"version": -1}, "$.version", "there is no version -1"),
    "version is a flag": (BASE | {"version": True}, "$.version", "it is True"),
    "format": (BASE | {"format": np.array([1.0, 2.0])}, "$.format", "it is array([1., 2.])"),
    "walls as a section": (BASE | {"walls": []}, "$", 'here; write "components": {"walls.Wall": […]}.'),
    "unknown section": (BASE | {"partikles": []}, "$", "'partikles' here; did you mean 'particles'?"),
    "key is no text": (BASE | {5: []}, "$", "no key '5' here; choose one of format, version"),
    "title": (BASE | {"title": 5}, "$.title", "it is 5; it must be a text"),
    "section is null": (BASE | {"settings": None}, "$.settings", "must be an object, not null"),
    "section is no list": (BASE | {"rods": {}}, "$.rods", "must be a list, not an object"),
    "element is no object": (BASE | {"grids": [3]}, "$.grids[0]", "must be an object, not a number"),
    "unknown setting": (BASE | {"settings": {"colisions": True}}, "$.settings", "did you mean 'collisions'?"),
    "setting": (
        BASE | {"settings": {"restitution": 2}},
        "$.settings.restitution",
        "is 2; it must be at most 1",
    ),
    "integrator": (BASE | {"settings": {"integrator": [1]}}, "$.settings.integrator", "is [1]; choose one of"),
    "steps": (BASE | {"state": {"steps": 1.5}}, "$.state.steps", "is 1.5; it must be a whole number"),
    "many steps": (BASE | {"state": {"steps": 2**70}}, "$.state.steps", "must be a whole number below"),
    "very many steps": (BASE | {"state": {"steps": 10**400}}, "$.state.steps", "must be a finite number"),
    "two grids shown": (BASE | {"grids": [{}, {}]}, "$.grids[1].shown", "$.grids[0] is shown already"),
    "spacing": (BASE | {"grids": [{"spacing": [1, 0]}]}, "$.grids[0].spacing", "y is 0 m; it must be greater"),
}


@pytest.mark.parametrize(("document", "path", "reason"), REFUSED.values(), ids=REFUSED.keys())
def test_bad_documents_are_refused_with_path_and_reason(document: Any, path: str, reason: str) -> None:
    with pytest.raises(ModelError) as caught:
        models.parse(document)
    assert str(caught.value).startswith(f"{path}: ")
    assert reason in str(caught.value)


Z = particle("Z", 0, 7)
REFUSED_ELEMENTS: dict[str, tuple[str, dict[Any, Any], str, str]] = {
    "missing position": ("particles", {"name": "Z"}, "", "its 'position' is missing"),
    "missing name": ("particles", {"position": [0, 0]}, "", "its 'name' is missing"),
    "unknown key": ("particles", Z | {"forse": [0, 1]}, "", "'forse' here; did you mean 'force'?"),
    "number as name": ("particles", Z | {"name": 5}, ".name", "it is 5; it must be a text"),
    "empty name": ("particles", Z | {"name": " "}, ".name", "it must be a text that is not empty"),
    "repeated name": ("particles", Z | {"name": "B"}, ".name", "$.particles[1] (particle B) has this name"),
    "one number": ("particles", Z | {"position": 4}, ".position", "is 4; it must be a pair of numbers"),
    "text": ("particles", Z | {"position": [0, "5"]}, ".position", "y is '5'; it must be a number"),
    "flag": ("particles", Z | {"position": [True, 5]}, ".position", "x is True; it must be a number"),
    "three": ("particles", Z | {"force": [1, 2, 3]}, ".force", "needs two entries, [x, y]; it has 3"),
    "nan": ("particles", Z | {"position": [0, math.nan]}, ".position", "y is nan; it must be a finite"),
    "huge": ("particles", Z | {"position": [10**400, 0]}, ".position", "must be a finite number"),
    "number as flag": ("particles", Z | {"fixed": [0, 1]}, ".fixed", "must be true or false"),
    "mass": ("particles", Z | {"mass": 0}, ".mass", "is 0 kg; it must be greater than 0 kg"),
    "moving support": (
        "particles",
        Z | {"fixed": [False, True], "velocity": [0, 3]},
        ".velocity",
        "velocity y is 3 m/s, but a support holds it along y",
    ),
    "missing ends": ("rods", {"name": "r"}, "", "its 'between' is missing"),
    "computed key": ("rods", rod("A", "D", axial_force=1), "", "'axial_force' is computed"),
    "missing end": ("rods", rod("A", "Q"), ".between", "There is no 'Q' among the particles"),
    "ends as text": ("rods", {"name": "r", "between": "AD"}, ".between", "the names of two particles"),
    "three ends": ("rods", {"name": "r", "between": ["A", "B", "D"]}, ".between", "names of two particles"),
    "rows as ends": ("rods", {"name": "r", "between": [0, 3]}, ".between", "the names of two particles"),
    "same end": ("rods", {"name": "r", "between": ["A", "A"]}, ".between", "both ends are A; a rod"),
    "second rod": (
        "rods",
        {"name": "r", "between": ["C", "B"]},
        ".between",
        "$.rods[1] (rod BC) joins C and B already",
    ),
    "no length": ("rods", rod("A", "O"), "", "its ends are at the same place; move one"),
    "far": (
        "particles",
        particle("far", 0, -1.7e308),
        ".position",
        "y is -1.7e+308 m; it must be at least -1e+30 m",
    ),
    "light": ("particles", particle("P", 0, 9, mass=5e-324), ".mass", "e-324 kg; it must be at least 1e-30 kg"),
    "stiffness": ("rods", rod("A", "D", stiffness=0), ".stiffness", "is 0 kN; it must be greater than"),
    "missing particle": ("loads", {}, "", "its 'on' is missing"),
    "load on nothing": ("loads", {"on": "Q"}, ".on", "There is no 'Q' among the particles"),
    "load on a list": ("loads", {"on": ["A"]}, ".on", "it must be the name of a particle"),
    "history": ("loads", {"on": "A", "history": {"kind": []}}, ".history", "it must be like"),
    "foreign list": ("loads", {"on": "A", "components": []}, ".components", "must be an object, not a list"),
    "foreign name": ("loads", {"on": "A", "components": {"x": {}}}, ".components", "'x' must have the form"),
    "foreign nan": (
        "loads",
        {"on": "A", "components": {"m.C": {"a": [math.inf]}}},
        ".components",
        "cannot hold inf",
    ),
}


@pytest.mark.parametrize(
    ("section", "element", "key", "reason"), REFUSED_ELEMENTS.values(), ids=REFUSED_ELEMENTS.keys()
)
def test_bad_elements_are_refused_with_path_and_reason(
    section: str, element: dict[Any, Any], key: str, reason: str
) -> None:
    document = triangle() | {"loads": []}
    far = [particle("D", -1e30, 5), particle("O", 0, 0), particle("F", 1e30, 0)]
    document["particles"] = [*document["particles"], *far]
    row = len(document[section])
    document[section] = [*document[section], element]
    with pytest.raises(ModelError) as caught:
        models.parse(document)
    name = f" ({section[:-1]} {element['name']})" if isinstance(element.get("name"), str) else ""
    assert str(caught.value).startswith(f"$.{section}[{row}]{key}{name}: ")
    assert reason in str(caught.value)


def test_two_numbers_are_not_one_vector_for_all() -> None:
    document = model([particle("A", 0, 0) | {"position": 1}, particle("B", 0, 0) | {"position": 2}], [])
    with pytest.raises(ModelError, match=r"\$\.particles\[0\]\.position"):
        models.parse(document)


def test_deep_nesting_is_refused() -> None:
    nested: Any = {}
    for _ in range(100_000):
        nested = {"deeper": nested}
    with pytest.raises(ModelError, match="nested too deeply"):
        models.parse(model([particle("A", 0, 0, components={"m.C": nested})], []))


def test_what_the_data_layer_refuses_is_a_model_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any) -> None:
        raise FieldError("load 1: not today; come tomorrow.")

    monkeypatch.setattr(Load, "after_change", refuse)
    with pytest.raises(ModelError, match=r"x\.json: \$\.loads: load 1: not today"):
        models.parse(triangle() | {"loads": [{"on": "A"}]}, "x.json")


# --- files ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", models.bundled())
def test_every_bundled_model_loads_and_round_trips(name: str, tmp_path: Path) -> None:
    loaded = models.load(name)
    assert loaded.title
    assert len(loaded.particles)
    models.save(loaded, tmp_path / "again.json")
    assert_same(loaded, models.load(tmp_path / "again.json"))


def test_a_name_a_path_and_a_document_are_sources(tmp_path: Path) -> None:
    path = tmp_path / "isostatic"
    models.save(models.load("isostatic"), path)
    content = json.loads(path.read_text(encoding="utf-8"))
    for source in (path, str(path), content):
        assert_same(models.load("isostatic"), models.load(source))


def test_a_byte_order_mark_is_no_mistake(tmp_path: Path) -> None:
    path = tmp_path / "bom.json"
    path.write_bytes(b"\xef\xbb\xbf" + json.dumps(triangle()).encode())
    assert len(models.load(path).rods) == 3


@pytest.mark.parametrize("source", ["isostatik", "isostatik.json", "nowhere/isostatik.json"])
def test_an_unknown_name_gets_a_suggestion(source: str) -> None:
    with pytest.raises(ModelError, match=rf"'{source}'; did you mean 'isostatic'\? .*--help lists"):
        models.load(source)


def test_an_unreadable_file_is_explained(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match=r"is a folder; name a model file in it"):
        models.load(tmp_path)
    with pytest.raises(ModelError, match="cannot be read: embedded null byte"):
        models.load("a\0b.json")


HEAD = b'{"format": "pinjoint model", "version": 1, '
MALFORMED = {
    "empty": (b" \n", "is empty; save the model again"),
    "UTF-16": ('{"format": "pinjoint model"}'.encode("utf-16"), "written in UTF-16; save it in UTF-8"),
    "cut off": (HEAD + b'"rods": [', "line 1 column"),
    "trailing comma": (HEAD + b'\n"rods": [],}', "line 2 column"),
    "Latin-1": (
        HEAD + b'\n"title": "\xe9"}',
        "line 2 has a character that is not UTF-8; save the file in UTF-8",
    ),
    "nan": (HEAD + b'"environment": {"drag": NaN}}', "contains NaN; every number must be finite"),
    "infinity": (HEAD + b'"environment": {"drag": -Infinity}}', "contains -Infinity"),
    "out of range": (HEAD + b'"environment": {"drag": 1e999}}', "contains 1e999; every number must be finite"),
    "endless integer": (HEAD + b'"environment": {"drag": ' + b"9" * 5000 + b"}}", "contains 999999999…; every"),
    "deep": (b"[" * 100_000, "nested too deeply"),
    "repeated section": (HEAD + b'"rods": [], "rods": []}', "$.rods: this key stands twice"),
    "repeated key": (HEAD + b'"grids": [{"shown": true, "shown": true}]}', "$.grids[0].shown: this key"),
    "repeated with escapes": (HEAD + b'"title": "\\\\\\"", "title": "\\u0022"}', "$.title: this key"),
}


@pytest.mark.parametrize(("content", "reason"), MALFORMED.values(), ids=MALFORMED.keys())
def test_malformed_files_are_explained(content: bytes, reason: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.json"
    path.write_bytes(content)
    with pytest.raises(ModelError) as caught:
        models.load(path)
    assert str(caught.value).startswith(str(path))
    assert reason in str(caught.value)


def test_escapes_are_not_taken_for_repeated_keys(tmp_path: Path) -> None:
    path = tmp_path / "escapes.json"
    path.write_bytes(HEAD + rb'"title": "\u0022 \\\" \u00e9", "description": "a\nb"}')
    assert models.load(path).title == '" \\" é'


# --- writing -------------------------------------------------------------------------------------------


def everything() -> Model:
    """A model in which nothing is as by default, in a state that only time can have made."""
    made = models.parse(
        model(
            [
                particle("A", -0.0, 5e-324, fixed=[True, False], mass=3, radius=0.1),
                particle("B", 1 / 3, 1e22, force=[-0.0, 1], acceleration=[0, -9.81], velocity=[1e-7, -0.0]),
                particle('ü "q"\n.x', 2**53 + 1, 0.1, displacement=[0.1 + 0.2, -0.0]),
                particle("zeros", 0, 0, velocity=[-0.0, 0.0], force=[0.0, -0.0]),
            ],
            [
                rod(
                    "A",
                    "B",
                    tensile_strength=0,
                    compressive_strength=215,
                    rest_length=1.5,
                    plastic_strain=1e-17,
                )
            ],
            title="All",
            description="line\nline",
            environment={"force": [1, 2], "acceleration": [0, -9.81], "drag": 0.5},
            settings={"restitution": 0.5, "time_step": 1e-5, "collisions": False},
            loads=[
                {"on": "B", "name": "gust", "force": [0, -10], "history": {"kind": "ramp", "duration": 0.5}}
            ],
            grids=[{"spacing": [0.5, 0.25]}, {"shown": False}],
            state={"time": 0.30000000000000004, "steps": 2**60, "work": -1.25, "collisions": 7},
        )
    )
    made.writable("particles.velocity")[2] = (-1e300, 4e-320)
    return made


def test_what_is_as_by_default_is_left_out() -> None:
    document = models.document(models.parse(triangle() | {"state": {"time": 0}}))
    assert document["particles"][0] == {"name": "A", "position": [0.0, 0.0], "fixed": [False, True]}
    assert document["rods"][2] == {"name": "CA", "between": ["C", "A"]}
    assert document["settings"]["integrator"] == "automatic"
    assert not {"title", "loads", "grids", "state"} & set(document)


def test_files_have_one_element_a_line(tmp_path: Path) -> None:
    path = tmp_path / "square.json"
    models.save(models.parse(square() | {"title": "Square"}), path)
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines[:4] == ["{", '  "format": "pinjoint model",', '  "version": 1,', '  "title": "Square",']
    first = lines.index('  "rods": [') + 1
    assert lines[first : first + 2] == [
        '    {"name": "AB", "between": ["A", "B"]},',
        '    {"name": "BC", "between": ["B", "C"]},',
    ]
    assert lines[first + 6 :] == ["  ]", "}"]


def test_components_of_absent_mods_survive(tmp_path: Path) -> None:
    foreign = {"wind.Sail": {"area": 2.0, "n": 2, "parts": [1, None, {"on": True}]}, "wind.Flag": {}}
    document = triangle()
    document["rods"][1] |= {"components": foreign}
    document["environment"] = {"components": foreign}
    loaded = models.parse(document)
    foreign["wind.Sail"]["area"] = 3.0  # the model keeps a copy
    models.save(loaded, tmp_path / "foreign.json")
    again = models.load(tmp_path / "foreign.json")
    foreign["wind.Sail"]["area"] = 2.0
    assert again.foreign == {again.rods["BC"].entity: foreign, again.environment.entity: foreign}
    assert '"n": 2,' in (tmp_path / "foreign.json").read_text(encoding="utf-8")


def test_a_command_says_which_data_have_no_effect(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    document = triangle()
    document["rods"][0] |= {"components": {"wind.Sail": {"area": 2.0}}}
    models.save(models.parse(document), tmp_path / "windy.json")
    assert main(["run", str(tmp_path / "windy.json"), "--static"]) == 0
    assert "mods that are not loaded: wind" in capsys.readouterr().err


def test_components_of_deleted_elements_are_not_written() -> None:
    document = triangle()
    document["rods"][1] |= {"components": {"wind.Sail": {}}}
    loaded = models.parse(document)
    loaded.delete([loaded.rods["BC"]])
    assert all("components" not in element for element in models.document(loaded)["rods"])


def test_what_is_not_finite_is_not_written(tmp_path: Path) -> None:
    path = tmp_path / "model.json"
    loaded = models.parse(triangle())
    models.save(loaded, path)
    before = path.read_bytes()
    loaded.writable("particles.velocity")[1, 0] = math.nan
    with pytest.raises(ModelError, match=r"particle B: velocity is \(nan, 0\.0\), which no file can hold"):
        models.save(loaded, path)
    assert path.read_bytes() == before


@pytest.mark.parametrize("step", ["fsync", "replace"])
def test_a_failure_keeps_the_old_file(step: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: Any) -> None:
        raise OSError(28, "No space left on device")

    path = tmp_path / "model.json"
    path.write_text("old", encoding="utf-8")
    monkeypatch.setattr(os, step, fail)
    with pytest.raises(
        ModelError, match=r"model\.json was not saved: No space left on device\. The file is as it was"
    ):
        models.save(models.parse(triangle()), path)
    assert path.read_text(encoding="utf-8") == "old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.skipif(sys.platform == "win32", reason="folders cannot be synchronised there")
def test_the_folder_is_synchronised_after_a_file_was_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Else a power cut could bring the old file back."""
    synchronised: list[int] = []
    monkeypatch.setattr(os, "fsync", lambda handle: synchronised.append(os.fstat(handle).st_ino))
    models.replace(tmp_path / "some.json", b"content")
    assert synchronised == [(tmp_path / "some.json").stat().st_ino, tmp_path.stat().st_ino]


HALF = "half \ud800"


@pytest.mark.parametrize(
    "document",
    [
        BASE | {"title": HALF},
        BASE | {"description": HALF},
        BASE | {"particles": [particle(HALF, 0, 0)]},
        BASE | {"particles": [particle(f"P{n}", n, 0) for n in range(20)] + [particle(HALF, 0, 0)]},
        BASE | {"particles": [particle("A", 0, 0, components={"mod.Kind": {"text": HALF}})]},
        BASE | {"particles": [particle("A", 0, 0, components={"mod.Kind": {HALF: 1}})]},
    ],
)
def test_half_a_character_is_refused(document: dict[str, Any]) -> None:
    """It could not be saved, copied, kept against a crash, or shown."""
    with pytest.raises(ModelError, match=r"one of its characters is damaged|cannot hold"):
        models.parse(document)


def test_a_text_that_no_file_can_hold_keeps_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "model.json"
    path.write_text("old", encoding="utf-8")
    made = models.parse(BASE)
    made.title = "\ud800"
    with pytest.raises(ModelError, match="surrogates not allowed"):
        models.save(made, path)
    assert path.read_text(encoding="utf-8") == "old"


def test_a_missing_folder_is_explained(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="was not saved: No such file or directory"):
        models.save(models.parse(BASE), tmp_path / "nowhere" / "model.json")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes with names here")
def test_what_is_no_plain_file_is_written_into_and_stays_what_it_is(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)  # who waits for nobody
    try:
        models.replace(pipe, b"text")
        assert os.read(reader, 100) == b"text"
    finally:
        os.close(reader)
    assert pipe.is_fifo()


@pytest.mark.skipif(os.name != "posix", reason="permissions and links as on POSIX systems")
def test_saving_keeps_permissions_and_follows_links(tmp_path: Path) -> None:
    path, link = tmp_path / "model.json", tmp_path / "link.json"
    path.write_text("old", encoding="utf-8")
    path.chmod(0o640)
    link.symlink_to(path)
    models.save(models.parse(triangle()), link)
    assert link.is_symlink()
    assert path.stat().st_mode & 0o777 == 0o640
    assert len(models.load(path).rods) == 3


def test_loading_is_no_undoable_command() -> None:
    assert models.parse(triangle()).on_command is None
