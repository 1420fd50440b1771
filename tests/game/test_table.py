"""The table of results, through keys and clicks: it says what is computed, orders, selects, scrolls, is copied and saved."""

import csv
import io
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pinjoint import Session
from pinjoint.components.language import spoken
from pinjoint.components.view import TABLE_SHARE, drawn_positions
from pinjoint.documents import models
from pinjoint.results import Results
from pinjoint.scripts.playing import Recorder
from pinjoint.systems.render.marks import Text
from pinjoint.systems.render.picture import compose
from pinjoint.systems.render.theme import load_theme
from tests.reference.hits import hits_in, push
from tests.scripted.test_scripted import replayed_from
from tests.systems.render.frame_models import PINNED, ROLLER, frame

SIZES = [(640, 480), (1280, 800), (1920, 1080)]
BEAM = frame(
    {"A": (0.0, 0.0, PINNED), "B": (6.0, 0.0, ROLLER)},
    {"A B": {"distributed_force": [0.0, -10.0], "bending_stiffness": 3e4}},
)


def opened(source: Any, size: tuple[int, int] = (1280, 800), *keys: str) -> Session:
    """In statics, with the table."""
    session = Session.open(source)
    session.resize(*size)
    for key in ("q", "n", *keys):
        session.press(key)
    return session


def click(session: Session, *item: object) -> None:
    """Click what the table has for something."""
    session.press("click", next(hit.middle for hit in hits_in(session) if hit.item == item))


def rows(session: Session) -> dict[str, tuple[str, ...]]:
    """The texts in sight, by names."""
    return {texts[0]: texts[1:] for _, _, texts in session.lister.listing.rows}


def column(session: Session, title: str) -> dict[str, str]:
    at = next(n for n, head in enumerate(session.lister.listing.heads[1:]) if head[0] == title)
    return {name: texts[at] for name, texts in rows(session).items()}


def test_a_simple_beam_as_it_is_read() -> None:
    session = opened(BEAM)
    wanted = {"V start": "30.00", "V end": "−30.00", "M end": "0", "M max": "45.00", "at x": "300.0"}
    deflection = 100.0 * 5.0 * 10.0 * 6.0**4 / (384.0 * 3e4)
    for title, text in (wanted | {"deflection": f"{deflection:.4f}"[:6]}).items():
        assert column(session, title)["AB"] == text
    click(session, "title", 1)
    assert column(session, "reaction y") == {"A": "30.00", "B": "30.00"}
    assert column(session, "reaction x") == {"A": "0", "B": ""}
    click(session, "title", 2)
    assert rows(session)["Σ"] == ("0", "0", "0")
    picture = compose(session.lister.listing, session.view, load_theme("light"))
    assert {"Sums", "−60.00", "60.00", "Σ"} <= {mark.text for mark in picture.marks if isinstance(mark, Text)}


@pytest.mark.parametrize("name", [name for name in models.bundled() if models.header_of(name).rods])
def test_it_has_all_rows_of_the_results(name: str) -> None:
    session = opened(name, (1000, 720))
    found, over = Results.of(session.model), session.view.table_place.middle
    for table in (found.rods, found.particles, found.sums):
        session.press("home", over)
        seen = rows(session)
        for _ in range(len(table)):
            session.press("page down", over)
            seen |= rows(session)
        assert list(seen.items()) == [(row[0], row[1:]) for row in table[1:]]
        session.press("right", over)
    if session.lister.shown == "steps":  # of what is beyond the elastic range
        session.press("right", over)
    assert session.lister.shown == "rods"


def test_it_follows_every_edit() -> None:
    session = opened(BEAM)
    session.rods["AB"].distributed_force = (0.0, -20.0)
    assert column(session, "M max")["AB"] == "90.00"
    session.press("ctrl+z")
    assert column(session, "M max")["AB"] == "45.00"
    session.rods["AB"].tensile_strength = 100.0
    assert "utilisation" in session.lister.listing.heads[-1][0]


def test_a_head_orders_the_rows_and_the_next_click_turns_them_around() -> None:
    session = opened("gerber_beam")
    keys = [column.key for column in session.lister.table.columns]
    click(session, "head", 1 + keys.index("largest_moment_at"))
    values = list(column(session, "at x").values())
    assert values == ["200.0", "200.0", "400.0", "", ""]
    click(session, "head", 1 + keys.index("largest_moment_at"))
    assert [*column(session, "at x").values()] == ["400.0", "200.0", "200.0", "", ""]
    click(session, "head", 0)
    assert list(rows(session)) == session.model.rods.names
    click(session, "head", 0)
    assert list(rows(session)) == session.model.rods.names[::-1]


def test_rows_select_elements_and_elements_their_rows() -> None:
    session = opened("tower")
    click(session, "row", 3)
    assert session.selected == [session.model.rods[3]]
    over = session.view.table_place.middle
    session.press("down", over)
    assert session.selected == [session.model.rods[4]]
    session.press("up", over)
    session.press("up", over)
    assert session.selected == [session.model.rods[2]]
    last = session.model.rods[session.model.rods.count - 1]
    session.click(*drawn_positions(session.model)[[end.row for end in last.ends]].mean(axis=0).tolist())
    assert session.selected == [last]
    assert [row for row, chosen, _ in session.lister.listing.rows if chosen] == [last.row]
    particle = session.model.particles[session.model.particles.count - 1]
    session.click(*drawn_positions(session.model)[particle.row].tolist())
    assert session.lister.listing.title == "Joints"
    assert [row for row, chosen, _ in session.lister.listing.rows if chosen] == [particle.row]


def test_arrows_over_the_model_still_move_what_is_selected() -> None:
    session = opened("tower")
    click(session, "title", 1)
    click(session, "row", 5)
    before = session.model.particles[5].position
    session.press("up", session.view.canvas.middle)
    assert session.selected == [session.model.particles[5]]
    assert session.model.particles[5].position != before


def test_a_row_turns_boxes_to_its_element() -> None:
    session = opened("portal")
    session.select(session.rods["AB"])
    session.press("return")
    click(session, "row", session.rods["CD"].row)
    assert session.scene == "properties"
    assert session.scenes.active.form.heading == "rod CD"  # type: ignore[attr-defined]


def test_the_wheel_scrolls_it_and_the_model_stays() -> None:
    session = opened("tower")
    before, over = session.view.camera.scale, session.view.table_place.middle
    session.press("wheel down", over)
    assert (session.lister.listing.first, session.view.camera.scale) == (3, before)
    for _ in range(40):
        session.press("wheel down", over)
    listing = session.lister.listing
    assert listing.first + len(listing.rows) == listing.count
    session.press("home", over)
    assert session.lister.listing.first == 0


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", ["two_storey_frame", "warren_bridge", "tower"])
def test_it_covers_no_structure_and_gives_its_room_back(name: str, size: tuple[int, int]) -> None:
    session = Session.open(name)
    session.resize(*size)
    session.press("home")
    before = session.view.camera.scale, session.view.camera.centre
    session.press("n")
    place, canvas = session.view.table_place, session.view.canvas
    x, y = session.view.camera.to_pixels(drawn_positions(session.model)).T
    assert ((x > canvas.left) & (x < canvas.right) & (y > canvas.top) & (y < canvas.bottom)).all()
    assert (
        place.width * place.height + canvas.width * canvas.height
        == (size[0] - session.view.strip.width) * size[1]
    )
    assert len(session.lister.listing.rows) >= 5
    push(session, "toggle table")
    assert session.view.table_place.width == 0
    assert (session.view.camera.scale, session.view.camera.centre) == before


def test_it_takes_no_more_height_than_its_rows_need() -> None:
    session = opened("portal", (800, 600))
    before = session.view.table_place.height
    assert before < TABLE_SHARE * 600
    assert len(rows(session)) == session.lister.listing.count == 3
    session.press("right", session.view.table_place.middle)
    assert len(rows(session)) == 4
    for rod, parts in (("BC", 2), ("CD", 20)):
        session.divide(rod, parts)
        session.press("left", session.view.table_place.middle)
        assert session.view.table_place.height > before
        before = session.view.table_place.height
    assert session.view.table_place.height == round(TABLE_SHARE * 600)


def test_where_it_leaves_little_the_structure_goes_before_sliders() -> None:
    session = opened("two_storey_frame", SIZES[0])
    assert session.view.slider_places == []
    y = session.view.camera.to_pixels(session.model.particles.position)[:, 1]
    assert np.ptp(y) > 0.45 * session.view.canvas.height
    session.press("n")
    assert session.view.slider_places != []


@pytest.mark.parametrize("code", ["en", "pt"])
def test_what_is_copied_and_saved_is_read_again(
    code: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)

    class Window:
        def copy(self, text: str) -> None:
            self.text = text

        def copied(self) -> str:
            return self.text

        def save(self, name: str, contents: bytes) -> str:
            Path(name).write_bytes(contents)
            return name

    with spoken(code):
        session = opened("portal")
        session.window = Window()
        click(session, "head", 5)
        push(session, "save table")
        session.press("ctrl+c", session.view.table_place.middle)
        saved, copied = Path("pinjoint-rods.csv").read_text("utf-8-sig"), session.clipboard
        found, order = session.lister.table, [row for row, _, _ in session.lister.listing.rows]
    comma, between = (",", ";") if code == "pt" else (".", ",")
    for text, separator in ((saved, between), (copied, "\t")):
        head, *read = csv.reader(io.StringIO(text), delimiter=separator)
        assert head == [*next(found.rows())]
        assert len(set(head)) == len(head)
        assert [row[0] for row in read] == [found.names[row] for row in order]
        for at, one in enumerate(found.columns, start=1):
            numbers = [float(row[at].replace(comma, ".")) if row[at] else math.nan for row in read]
            assert numbers == pytest.approx(one.values[order].tolist(), rel=0.0, abs=0.0, nan_ok=True)
    assert comma in read[0][1]


def test_a_recording_presses_the_same_rows(tmp_path: Path) -> None:
    session, path = Session.open("tower"), tmp_path / "recorded.jsonl"
    with path.open("w", encoding="utf-8") as file:
        Recorder(session, file, "tower")
        session.resize(1000, 720)
        session.press("q")
        session.press("n")
        session.press("end", session.view.table_place.middle)
        click(session, "row", session.model.rods.count - 2)
    replayed = replayed_from(path)
    assert replayed.selected == [replayed.model.rods[session.model.rods.count - 2]]
    assert replayed.view.camera == session.view.camera
