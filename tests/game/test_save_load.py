"""Save and load: names, files, what is asked and what is said, and that no work is lost."""

import itertools
import json
import os
import re
import sys
import unicodedata
from collections.abc import Callable
from pathlib import Path

import pytest

from pinjoint import Session
from pinjoint.components.camera import Viewport
from pinjoint.components.field import same
from pinjoint.components.form import Tile
from pinjoint.documents import library, models
from pinjoint.editor.scenes import files
from pinjoint.editor.scenes.files import FileScene
from pinjoint.editor.scenes.load import Load
from pinjoint.scripts.script import TO_DO, Script, lessons
from pinjoint.systems.render.marks import Text
from pinjoint.systems.render.picture import compose, compose_all
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.render.typography import text_width
from tests.reference.models import triangle
from tests.systems.render.pictures import marks_of

pytestmark = pytest.mark.usefixtures("data")


@pytest.fixture
def session() -> Session:
    return Session.open(triangle())


def scene_of(session: Session) -> FileScene:
    scene = session.scenes.active
    assert isinstance(scene, FileScene)
    return scene


def message_of(session: Session) -> str:
    return scene_of(session).form.message


def saved_as(session: Session, name: str) -> None:
    """Save under a name as a person does."""
    session.press("s")
    session.press("ctrl+a")
    session.type(name)
    session.press("return")


def stiffness_in(source: str | Path) -> float:
    """The stiffness of rod AB in a file."""
    model = models.load(source)
    return model.rods["AB"].stiffness


def unfold(session: Session) -> None:
    """Choose the tiles that stand for those for which one row has no room."""
    scene = scene_of(session)
    assert isinstance(scene, Load)
    for tile in [tile for tile in scene.form.tiles if tile.rest]:
        scene.choose(session, tile)


def shown_tiles(session: Session) -> list[str]:
    return [tile.title for tile in scene_of(session).form.tiles if not tile.hidden]


# --- saving ------------------------------------------------------------------------------------------


def test_a_model_is_saved_under_the_name_that_was_typed(session: Session, data: Path) -> None:
    saved_as(session, "file 1")
    assert session.scene == "pause"
    assert [path.name for path in (data / "models").iterdir()] == ["file 1.json"]
    assert models.load(data / "models" / "file 1.json").rods.names == ["AB", "BC", "CA"]
    assert "file 1" in session.notice


def test_a_name_takes_letters_digits_spaces_and_a_minus(session: Session) -> None:
    session.press("s")
    assert session.scene == "save"
    session.type("My/Bridge*2 ?\\:|\n")
    assert session.boxes["name"] == "My-Bridge2 "
    session.press("backspace")
    assert session.boxes["name"] == "My-Bridge2"


def test_escape_restores_the_name_and_then_leaves_without_saving(session: Session, data: Path) -> None:
    session.press("s")
    session.type("x")
    session.press("escape")
    assert session.boxes["name"] == ""
    assert session.scene == "save"
    session.press("escape")
    assert session.scene == "pause"
    assert not (data / "models").exists()


def test_overwriting_is_asked_and_confirmed_by_a_second_return(session: Session, data: Path) -> None:
    saved_as(session, "a")
    session.rods["AB"].stiffness = 5.0
    path = data / "models" / "a.json"
    before = path.read_bytes()
    saved_as(session, "a")
    assert session.scene == "save"
    assert "already" in message_of(session)
    assert path.read_bytes() == before
    session.type("b")
    assert message_of(session) == "", "another name is not confirmed"
    session.press("backspace")
    session.press("return")
    assert path.read_bytes() == before
    session.press("return")
    assert session.scene == "pause"
    assert stiffness_in(path) == 5.0


@pytest.mark.parametrize(
    "name",
    ["", "   ", ".", "..", ".hidden", "end.", "con", "con .a", "NUL.x", "COM¹", "lpt³.b", "a" * 101, "क" * 99],
)
def test_a_name_that_no_file_can_have_is_refused(session: Session, data: Path, name: str) -> None:
    saved_as(session, name)
    assert session.scene == "save"
    assert message_of(session)
    assert not list(data.rglob("*.json"))


@pytest.mark.parametrize("name", ["../up", "a/b", "a\\b", "a\0b", "a:b", "a\nb"])
def test_no_name_leads_out_of_the_folder(name: str) -> None:
    with pytest.raises(library.NameRefused):
        library.path_of(name)


@pytest.mark.parametrize("name", ["पुल", "Brücke", "Bru\u0308cke", "pont très léger", "γέφυρα", "橋", "สะพาน"])
def test_names_may_be_of_any_script(session: Session, data: Path, name: str) -> None:
    """Many write vowels and accents as characters that combine with the one before."""
    saved_as(session, name)
    (path,) = (data / "models").glob("*.json")
    assert path.stem == unicodedata.normalize("NFC", name)
    assert library.find(name) == path


@pytest.mark.skipif(sys.platform in ("win32", "darwin"), reason="file names are texts there")
def test_a_file_whose_name_is_no_text_is_shown_and_saved(data: Path, tmp_path: Path) -> None:
    path = tmp_path / os.fsdecode(b"\xff-\n.json")
    models.save(models.parse(triangle()), path)
    session = Session.open(path)
    assert session.document.file.name.encode().decode() == "\ufffd-\n"
    session.rods["AB"].stiffness = 5.0
    session.press("ctrl+s")
    assert stiffness_in(path) == 5.0
    (data / "models").mkdir(parents=True)
    models.save(session.model, data / "models" / path.name)
    session.press("d")
    assert "\ufffd-\n" in shown_tiles(session)


def test_a_file_in_place_of_the_folder_is_explained(session: Session, data: Path) -> None:
    data.mkdir()
    (data / "models").write_text("no folder")
    saved_as(session, "a")
    assert session.scene == "save"
    assert "models cannot be made: File exists. Write another one" in message_of(session)


def test_ctrl_s_saves_again_without_asking(session: Session, data: Path) -> None:
    session.press("ctrl+s")
    assert session.scene == "save", "a model without a name is given one"
    session.type("a")
    session.press("return")
    session.rods["AB"].stiffness = 5.0
    assert session.document.unsaved
    session.press("ctrl+s")
    assert session.scene == "pause"
    assert not session.document.unsaved
    assert stiffness_in(data / "models" / "a.json") == 5.0


def test_what_another_window_saved_is_only_replaced_when_asked_twice(tmp_path: Path) -> None:
    path = tmp_path / "ours.json"
    models.save(models.parse(triangle()), path)
    here, there = Session.open(path), Session.open(path)
    here.rods["AB"].stiffness = 5.0
    there.rods["AB"].stiffness = 7.0
    there.press("ctrl+s")
    here.press("ctrl+s")
    assert "Another window or program has changed 'ours'" in here.notice
    assert here.document.unsaved
    assert stiffness_in(path) == 7.0
    here.press("ctrl+s")
    assert here.notice == "Saved as 'ours'."
    assert stiffness_in(path) == 5.0
    path.unlink()
    here.press("ctrl+s")
    assert stiffness_in(path) == 5.0, "what is gone is not in the way"


def test_an_example_is_not_overwritten(data: Path) -> None:
    session = Session.open("isostatic")
    session.rods["AB"].stiffness = 5.0
    session.press("ctrl+s")
    assert session.scene == "save"
    assert session.boxes["name"] == "isostatic"
    session.press("return")
    assert stiffness_in(data / "models" / "isostatic.json") == 5.0
    assert stiffness_in("isostatic") == 164640.0


def test_the_state_of_a_run_is_saved_and_continues_with_the_same_bits(session: Session) -> None:
    session.run(steps=30)
    saved_as(session, "run")
    session.run(steps=30)
    expected = session.particles.displacement.copy()
    session.press("d")
    session.type("run")
    session.press("return")
    assert session.model.clock.steps == 30
    session.run(steps=30)
    assert same(session.particles.displacement, expected)


# --- loading -----------------------------------------------------------------------------------------


def test_a_saved_model_is_loaded_by_its_name(session: Session) -> None:
    session.rods["AB"].stiffness = 5.0
    saved_as(session, "file 1")
    session.press("ctrl+n")
    assert session.particles.count == 0
    session.press("d")
    assert session.scene == "load"
    session.type("file 1")
    session.press("return")
    assert session.scene == "pause"
    assert session.rods["AB"].stiffness == 5.0
    assert session.document.file.name == "file 1"
    session.run(steps=10)
    assert session.time > 0.0


def test_a_name_that_is_not_there_is_said_and_nothing_is_lost(session: Session) -> None:
    session.rods["AB"].stiffness = 5.0
    model = session.model
    session.press("d")
    session.type("isostatik")
    session.press("return")
    assert session.scene == "load"
    assert message_of(session).startswith("File not found")
    assert "isostatic" in message_of(session), "the nearest name"
    session.press("escape")
    session.press("escape")
    assert session.scene == "pause"
    assert session.model is model
    assert session.undo()


@pytest.mark.parametrize("content", [b"", b"{", b"[]", b'{"format": "pinjoint model"}', b"\xff\xfe"])
def test_a_file_that_is_no_model_is_explained(session: Session, data: Path, content: bytes) -> None:
    (data / "models").mkdir(parents=True)
    (data / "models" / "bad.json").write_bytes(content)
    model = session.model
    session.press("d")
    scene = scene_of(session)
    while scene.busy(session):
        session.frame(0.0)
    assert "cannot be read" in [tile.caption for tile in scene.form.tiles]
    session.type("bad")
    session.press("return")
    assert session.scene == "load"
    assert "bad.json" in message_of(session)
    assert session.model is model


def test_typing_filters_by_title_and_name(session: Session) -> None:
    saved_as(session, "my tower")
    session.press("ctrl+o")
    everything = shown_tiles(session)
    # Tiles that stand for those for which one row has no room.
    folded = [tile.title for tile in scene_of(session).form.tiles if tile.rest]
    assert {"All 1", "All lessons"} < {*folded}
    assert len(everything) == len(models.bundled()) + len(lessons()) + len(lessons(TO_DO)) + 2 + len(folded)
    assert {*folded} <= {*everything}
    session.type("TOWER")
    assert shown_tiles(session) == ["my tower", "Lattice tower in the wind"]
    session.type(" wind")
    assert shown_tiles(session) == ["Lattice tower in the wind"]
    for _ in "TOWER wind":
        session.press("backspace")
    assert shown_tiles(session) == everything


def test_return_opens_the_first_model_that_is_left_to_choose(session: Session) -> None:
    saved_as(session, "my tower")
    session.press("ctrl+o")
    session.type("tow")
    session.press("return")
    assert session.scene == "pause"
    assert session.document.file.name == "my tower"
    session.press("ctrl+o")
    session.type("tower wind")
    session.press("return")
    assert session.model.title == "Lattice tower in the wind"


def test_arrows_choose_and_return_opens(session: Session) -> None:
    session.press("d")
    session.type("hyperstatic")
    for key in ("down", "right", "left", "right"):
        session.press(key)
    chosen = scene_of(session).form.chosen
    assert chosen is not None
    title = shown_tiles(session)[1]
    assert chosen.title == title
    session.press("return")
    assert session.scene == "pause"
    assert session.model.title == title


def test_a_click_on_a_picture_opens_it(session: Session) -> None:
    session.view.camera.viewport = Viewport(0, 0, 1000, 720)
    session.press("d")
    place = next(
        p for p in scene_of(session).layout(session).places if getattr(p.item, "title", "") == "Pendulum"
    )
    session.press("click", (place.left + 9, place.top + 9))
    assert (session.scene, session.model.title) == ("pause", "Pendulum")


def test_a_click_begins_an_empty_model_in_statics(session: Session) -> None:
    session.resize(1000, 720)
    session.press("d")
    session.press("click", middle_of(scene_of(session), "New, empty model", session))
    assert (session.scene, session.model.particles.count) == ("statics", 0)
    assert session.settings.opens_in == "statics"
    assert not session.document.unsaved


def test_a_click_on_a_saved_picture_offers_its_name(session: Session) -> None:
    saved_as(session, "a")
    session.press("ctrl+n")
    session.press("s")
    tile = scene_of(session).form.tiles[0]
    place = scene_of(session).layout(session).place_of(tile)
    assert place is not None
    session.press("click", (place.left + 9, place.top + 9))
    assert session.boxes["name"] == "a"
    session.press("return")
    assert "already" in message_of(session)


def test_unsaved_work_is_there_again_after_undo(session: Session) -> None:
    session.rods["AB"].stiffness = 5.0
    session.run(steps=100)
    model, time = session.model, session.time
    session.documents.open("isostatic")
    session.rods["AB"].stiffness = 7.0
    assert session.undo()
    assert session.undo()
    assert session.model is model
    assert session.time == time
    assert session.undo()
    assert session.undo()
    assert (session.time, session.rods["AB"].stiffness) == (0.0, 164640.0)
    assert not session.undo()
    for _ in range(4):
        assert session.redo()
    assert (session.model.title, session.rods["AB"].stiffness) == ("Isostatic triangle", 7.0)
    assert not session.redo()


def test_opening_another_model_forgets_what_could_be_done_again_here(session: Session) -> None:
    session.rods["AB"].stiffness = 5.0
    session.rods["BC"].stiffness = 6.0
    session.undo()
    session.documents.open("tower")
    session.undo()
    assert session.rods["AB"].stiffness == 5.0
    session.redo()  # leads to the tower, not to what was undone before it was opened
    assert session.model.title != "Isostatic triangle"
    assert not session.redo()


def test_work_that_was_gone_back_from_is_kept_when_another_model_is_opened(session: Session) -> None:
    session.rods["AB"].stiffness = 5.0
    session.documents.open("hyperstatic")
    session.rods["AC"].stiffness = 6.0
    for _ in range(2):
        session.undo()
    session.documents.open("tower")
    seen = [document.model for document in session.documents]
    assert [len(document.model.rods) for document in session.documents][:2] == [6, 3]
    assert seen[0].rods["AC"].stiffness == 6.0
    assert seen[1].rods["AB"].stiffness == 5.0


def test_saved_work_is_not_kept_twice(session: Session) -> None:
    saved_as(session, "a")
    session.documents.open("isostatic")
    session.documents.open("tower")
    assert len(session.documents) == 1


def test_a_typed_velocity_is_unsaved_work() -> None:
    session = Session.open("collision_iii")
    session.particles[0].velocity = (1.0, 2.0)
    assert session.document.unsaved
    session.documents.open("tower")
    session.undo()
    assert session.particles[0].velocity == (1.0, 2.0)


def test_examples_that_were_only_run_are_not_kept(session: Session) -> None:
    for name in ("isostatic", "tower", "pendulum"):
        session.documents.open(name)
        session.run(steps=5)
    assert len(session.documents) == 1
    assert session.undo()
    assert not session.undo()
    assert session.time == 0.0


def test_loading_in_the_middle_of_a_run_works(session: Session) -> None:
    session.press("space")
    session.frame(0.01)
    session.press("ctrl+o")
    assert session.scene == "load"
    session.type("tower")
    session.press("return")
    assert session.scene == "pause"
    session.press("space")
    session.press("ctrl+n")
    assert (session.scene, session.particles.count) == ("statics", 0)  # new structures are drawn there


# --- the folder --------------------------------------------------------------------------------------


def test_the_newest_comes_first(session: Session, data: Path) -> None:
    for age, name in enumerate(("b", "c", "a")):
        saved_as(session, name)
        os.utime(data / "models" / f"{name}.json", (1e9 - age, 1e9 - age))
    assert [path.stem for path in library.saved()] == ["b", "c", "a"]


def test_the_data_folder_is_the_systems_own_unless_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(library.DATA_VARIABLE)
    assert "pinjoint" in library.data_folder().parts


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(5, "just now"), (65, "1 minute ago"), (7300, "2 hours ago"), (90000, "1 day ago"), (1e7, "20..-..-..")],
)
def test_ages_are_written_in_words(tmp_path: Path, seconds: float, text: str) -> None:
    path = tmp_path / "x"
    path.touch()
    then = path.stat().st_mtime - seconds
    os.utime(path, (then, then))
    assert re.fullmatch(text, library.written_age(path))
    assert library.written_age(tmp_path / "gone") == ""


def test_pictures_are_read_few_a_frame_and_only_where_they_are_seen(
    session: Session, data: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(files, "READING", 0.0)  # which is time enough for one
    (data / "models").mkdir(parents=True)
    content = json.dumps(triangle()).encode()
    for number in range(60):
        (data / "models" / f"m{number}.json").write_bytes(content)
    session.view.camera.viewport = Viewport(0, 0, 640, 480)
    session.press("d")
    unfold(session)
    read: Callable[[], int] = lambda: sum(  # noqa: E731
        isinstance(tile.source, Path) and tile.picture is not None for tile in scene_of(session).form.tiles
    )
    assert session.busy
    counts = []
    while session.busy:
        session.frame(0.01)
        counts.append(read())
    assert counts == list(range(1, len(counts) + 1))
    assert len(counts) < 30


# --- where it is -------------------------------------------------------------------------------------


@pytest.mark.parametrize("size", [(320, 240), (1920, 1080)])
def test_arrows_reach_every_picture_and_show_it(session: Session, size: tuple[int, int]) -> None:
    session.view.camera.viewport = Viewport(0, 0, *size)
    session.press("d")
    form = scene_of(session).form
    form.tiles = [tile for tile in form.tiles if not tile.rest]  # nothing is folded
    for tile in form.tiles:
        session.press("right")
        assert form.chosen is tile
        assert scene_of(session).layout(session).place_of(tile) is not None
    for _ in form.tiles:
        session.press("up")
    assert scene_of(session).layout(session).paper.scrolled[0] <= 1


def test_examples_are_pictured_and_said_what_they_are(session: Session) -> None:
    session.view.camera.viewport = Viewport(0, 0, 1000, 900)
    session.press("d")
    examples = [tile for tile in scene_of(session).form.tiles if isinstance(tile.source, str) and not tile.rest]
    assert sorted(tile.source for tile in examples) == models.bundled()
    assert all(tile.explanation for tile in examples)
    while session.busy:
        session.frame(0.01)
    seen = [place.item for place in scene_of(session).layout(session).places]
    assert all(tile.picture is not None for tile in examples if tile in seen)
    assert any(tile in seen for tile in examples)
    assert len({tile.title for tile in examples}) == len(examples)
    first = [tile.source for tile in itertools.islice(examples, 2)]
    assert first == ["swing", "catapult"]  # the playground


@pytest.mark.parametrize("size", [(640, 480), (1920, 1080)])
@pytest.mark.parametrize("own", [0, 1, 30])
def test_the_first_screen_has_own_models_a_new_one_lessons_and_examples(
    session: Session, size: tuple[int, int], own: int
) -> None:
    for number in range(own):
        saved_as(session, f"my model {number}")
    session.resize(*size)
    session.press("d")
    scene = scene_of(session)
    seen = [place.item for place in scene.layout(session).places if isinstance(place.item, Tile)]
    titles = [tile.title for tile in seen]
    assert sum(isinstance(tile.source, Path) for tile in seen) >= min(own, 2)
    assert "New, empty model" in titles
    assert any(isinstance(tile.source, Script) for tile in seen)
    assert sum(isinstance(tile.source, str) and not tile.rest for tile in seen) >= 2
    assert any(tile.rest for tile in seen), "there are more examples"
    if own > 10:
        session.press("click", middle_of(scene, "All 30", session))
        seen = [place.item for place in scene.layout(session).places if isinstance(place.item, Tile)]
        assert sum(isinstance(tile.source, Path) for tile in seen) > 3
        assert "All 30" not in shown_tiles(session)
        session.type("model 17")
        assert shown_tiles(session) == ["my model 17"], "search finds what was folded"


def middle_of(scene: FileScene, title: str, session: Session) -> tuple[float, float]:
    """The pixel in the middle of a tile."""
    place = next(p for p in scene.layout(session).places if isinstance(p.item, Tile) and p.item.title == title)
    return place.left + place.width / 2, place.top + place.height / 2


def test_arrows_begin_where_one_has_scrolled_to(session: Session) -> None:
    session.resize(640, 480)
    session.press("d")
    for _ in range(3):
        session.press("wheel down")
    scene = scene_of(session)
    seen = [place.item for place in scene.layout(session).places if isinstance(place.item, Tile)]
    assert seen[0] is not scene.form.tiles[0]
    session.press("down")
    assert scene.form.chosen is seen[0]


def test_what_is_asked_is_read_in_full_in_a_small_window(session: Session) -> None:
    saved_as(session, "bridge")
    session.resize(320, 240)
    saved_as(session, "bridge")
    session.update_view()
    form, view = session.stages[0]
    said = " ".join(mark.text for mark in compose(form, view, load_theme()).marks if isinstance(mark, Text))
    assert message_of(session) in said
    assert "Press Return again to replace it, or Esc to keep it." in said


@pytest.mark.parametrize("width", [640, 1024, 1920])
def test_lessons_stand_in_full_rows_with_their_titles_inside(session: Session, width: int) -> None:
    session.resize(width, 1080)
    session.press("d")
    unfold(session)
    picture = compose_all(session.stages, load_theme("light"))[0]
    cards = [hit for hit in picture.hits if isinstance(hit.item, Tile) and isinstance(hit.item.source, Script)]
    rows = [len(list(row)) for _, row in itertools.groupby(cards, lambda card: card.top)]
    assert len(set(rows[1:-1])) == 1
    titles = [
        (mark, card) for mark in marks_of(picture, Text) for card in cards if card.contains((mark.x, mark.y))
    ]
    for mark, card in titles:
        assert mark.x + text_width(mark.text, mark.size, mark.weight) <= card.left + card.width - 6.0


# --- where files go --------------------------------------------------------------------------------------


def in_folder(session: Session, key: str, folder: str) -> None:
    """Type a folder into the form that a key opens."""
    session.press(key)
    session.click_box("folder")
    session.press("ctrl+a")
    session.type(folder)


def test_models_go_to_the_folder_that_was_typed_which_is_remembered(data: Path, tmp_path: Path) -> None:
    session, folder = Session.open("isostatic"), tmp_path / "course" / "week 3"
    in_folder(session, "s", str(folder))
    session.press("shift+tab")
    session.press("ctrl+a")
    session.type("truss")
    session.press("return")
    assert (folder / "truss.json").is_file()
    assert str(folder) in session.notice or "truss" in session.notice
    again = Session.open("isostatic")
    again.press("ctrl+o")
    assert scene_of(again).boxes["folder"] == str(folder)
    again.type("truss")
    again.press("return")
    assert again.document.file.path == folder / "truss.json"
    in_folder(again, "ctrl+o", str(data / "models"))
    again.press("return")
    assert message_of(again) == ""
    assert library.models_folder() == library.own_folder()


@pytest.mark.parametrize(
    ("key", "folder", "said"),
    [
        ("s", "models", "only a part of a path"),
        ("ctrl+o", "/no/such/folder", "There is no folder"),
        ("s", "/dev/null/models", "cannot be used"),
        ("s", "~nobody knows/models", "cannot be used"),
    ],
)
def test_a_folder_that_cannot_be_used_is_refused_and_the_former_one_stays(
    data: Path, key: str, folder: str, said: str
) -> None:
    session = Session.open("isostatic")
    in_folder(session, key, folder)
    session.press("return")
    assert said in message_of(session)
    assert library.models_folder() == data / "models"


def test_the_form_says_where_everything_goes(data: Path) -> None:
    session = Session.open("isostatic")
    session.press("s")
    told = scene_of(session).form.boxes[1].explanation
    assert str(data / "models") in told
    assert str(data / "autosave") in told
