"""The toolbar: what it offers, where, and that a click does what the key does."""

import pytest

from pinjoint import Session
from pinjoint.components.camera import Viewport
from pinjoint.components.extensions import EXTENSIONS
from pinjoint.components.language import begun, spoken
from pinjoint.components.settings import DIAGRAMS
from pinjoint.components.tags import DiagramShown
from pinjoint.components.toolbar import Tool
from pinjoint.components.view import Hit, drawn_positions
from pinjoint.editor.toolbar import TOOLBAR, WORDS, of_mods
from pinjoint.systems.input.actions import ACTIONS
from pinjoint.systems.render.marks import Panel, Stamps, Text
from pinjoint.systems.render.picture import compose, compose_all
from pinjoint.systems.render.symbols import icon, icons
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.render.typography import capital_height, text_width
from tests.reference.boxes import overlap, text_box
from tests.reference.hits import hits_in, push
from tests.systems.render.pictures import marks_of

SIZES = [(1000, 720), (640, 480), (3840, 2160)]


def opened(source: object = "isostatic", size: tuple[int, int] = (1000, 720), ratio: float = 1.0) -> Session:
    session = Session.open(source)  # type: ignore[arg-type]
    session.view.camera.viewport = Viewport(0, 0, *size)
    session.view.pixel_ratio = ratio
    session.view.fit(session.model)
    return session


EMPTY = {"format": "pinjoint model", "version": 1}


def buttons(session: Session) -> dict[str, Hit]:
    """Those of the toolbar, by their actions."""
    on_strip = (hit for hit in hits_in(session) if isinstance(hit.item, Tool) and hit.at is None)
    return {hit.item.action: hit for hit in on_strip}


def tool(session: Session, action: str) -> Tool:
    found = buttons(session)[action].item
    assert isinstance(found, Tool)
    return found


def test_every_tool_is_an_action_with_a_key_and_an_icon() -> None:
    offered = [*(action for group in TOOLBAR.values() for action in group), *of_mods(draw=True)]
    assert len(offered) == len(set(offered))
    assert {*offered} <= {*WORDS}
    for action in offered:
        assert icon(action)
        assert any(binding.key and binding.title for binding in ACTIONS[action].bindings)
    assert {*icons(), *EXTENSIONS.icons} == {
        *offered,
        *of_mods(draw=False),
        "pause",
        *(f"diagram {quantity}" for quantity in DIAGRAMS),
    }


@pytest.mark.parametrize("spoken_now", ["en", "pt"])
@pytest.mark.parametrize(
    ("size", "worded", "named"),
    [
        ((1280, 800), True, True),
        ((1000, 720), False, True),
        ((1280, 640), False, False),
        ((640, 480), False, False),
    ],
)
def test_buttons_have_words_and_groups_names_where_there_is_room(
    size: tuple[int, int], worded: bool, named: bool, spoken_now: str
) -> None:
    with spoken(spoken_now):
        session = opened(size=size)
        session.update_view()
        strip, found = session.view.strip, buttons(session).values()
        picture = compose(session.view.toolbar, session.view, load_theme("light"))
        texts = [mark for mark in picture.marks if isinstance(mark, Text)]
        said = {mark.text for mark in texts}
        assert not any(text.endswith("…") for text in said)
        assert all(mark.x + text_width(mark.text, mark.size, mark.weight) <= strip.right for mark in texts)
        assert ({begun(tool.item.word) for tool in found} <= said) is worded
        assert ({*session.view.toolbar.names} <= said) is named
        assert all(hit.top + hit.height <= strip.bottom for hit in found)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("ratio", [1.0, 2.0])
def test_buttons_lie_in_the_strip_without_overlapping(size: tuple[int, int], ratio: float) -> None:
    pixels = round(size[0] * ratio), round(size[1] * ratio)
    session = opened(size=pixels, ratio=ratio)
    view, found = session.view, list(buttons(session).values())
    assert len(found) == sum(map(len, view.toolbar.groups)) > 20
    for button in found:
        corner = button.left + button.width - 1, button.top + button.height - 1
        assert view.strip.contains((button.left, button.top))
        assert view.strip.contains(corner)
        assert [other for other in found if other.contains(corner)] == [button]


@pytest.mark.parametrize("size", SIZES)
def test_a_fitted_structure_is_not_covered(size: tuple[int, int]) -> None:
    session = opened("hyperstatic", size)
    view = session.view
    pixels = view.camera.to_pixels(drawn_positions(session.model))
    left, right = pixels[:, 0].min() - view.canvas.left, size[0] - pixels[:, 0].max()
    assert view.strip.width > 0
    assert left > 40
    assert left == pytest.approx(right)


def test_tab_and_small_windows_hide_it() -> None:
    session = opened()
    session.press("tab")
    assert session.view.strip.width == 0
    session.press("click", (19.0, 19.0))  # where the first button was
    assert session.scene == "pause"
    session.press("tab")
    assert session.view.strip.width > 0
    assert opened(size=(320, 240)).view.strip.width == 0
    assert opened(size=(1000, 100)).view.strip.width == 0


@pytest.mark.parametrize("size", [(640, 360), (512, 384), (1000, 300), (640, 240)])
def test_where_height_is_short_it_has_more_columns(size: tuple[int, int]) -> None:
    session = opened(size=size)
    view, found = session.view, buttons(session)
    assert {*found} == {tool.action for group in view.toolbar.groups for tool in group}
    assert all(button.top + button.height <= size[1] for button in found.values())
    corners = [(button.left + 1.0, button.top + 1.0) for button in found.values()]
    assert len({*corners}) == len(found)
    push(session, "save")
    assert session.scene == "save"


@pytest.mark.parametrize("key", ["click", "ctrl+click", "drag"])
def test_a_click_on_a_button_acts_and_selects_nothing(key: str) -> None:
    session = opened()
    session.select(session.particles["A"])
    push(session, "toggle run", key)
    assert session.scene == "simulation"
    assert session.selected == [session.particles["A"]]
    assert (tool(session, "toggle run").icon, tool(session, "toggle run").pressed) == ("pause", True)
    push(session, "toggle run", key)
    assert session.scene == "pause"


def test_what_lies_under_the_strip_cannot_be_hit() -> None:
    session = opened()
    x, y = session.view.camera.to_pixels(session.particles["A"].position)
    session.view.camera.pan((19.0 - x, 350.0 - y))
    session.press("click", (19.0, 350.0))
    assert session.selected == []


def test_undo_and_redo_are_offered_only_where_there_is_something() -> None:
    session = opened(EMPTY)
    assert not tool(session, "undo").enabled
    session.press("p", (500.0, 300.0))
    assert tool(session, "undo").enabled
    push(session, "redo")
    assert session.model.particles.count == 1
    push(session, "undo")
    assert session.model.particles.count == 0
    assert tool(session, "redo").enabled
    push(session, "redo")
    assert session.model.particles.count == 1


def test_keys_over_the_toolbar_take_a_tool_up_instead_of_drawing_below_it() -> None:
    session = opened(EMPTY)
    session.press("p", (19.0, 350.0))
    assert session.model.particles.count == 0
    assert session.view.tool == "place"


def test_steps_by_the_toolbar_ignore_the_selection() -> None:
    session = opened()
    session.select(session.particles["B"])
    push(session, "step")
    assert session.model.clock.steps == 1
    push(session, "step back")
    assert session.model.clock.steps == 0
    assert session.particles["B"].position == (1.0, 1.0)


def test_the_force_method_has_its_own_tools_and_sheets_none() -> None:
    session = opened("hyperstatic")
    push(session, "force method")
    assert session.scene == "force method"
    assert "next part" in buttons(session)
    assert "undo" not in buttons(session)
    push(session, "back")
    assert session.scene == "pause"
    push(session, "load")
    assert session.scene == "load"
    assert not any(shown is session.view.toolbar for shown, _ in session.stages)


def test_tools_beside_properties_leave_them_and_act() -> None:
    session = opened("isostatic")
    push(session, "properties")
    assert session.scene == "properties"
    session.click_box("drag")
    session.type("3")
    push(session, "toggle run")
    assert session.scene == "simulation"
    assert session.environment.drag == 3.0, "what was typed counts"
    push(session, "properties")
    assert session.scene == "properties"
    push(session, "properties")
    assert session.scene == "simulation", "the same button closes them"


def test_the_tip_names_the_action_and_its_key() -> None:
    session = opened()
    session.update_view()
    button = buttons(session)["undo"]
    session.view.pointer = button.left + 5.0, button.top + 5.0
    toolbar, view = session.stages[-1]
    assert compose(toolbar, view, load_theme()).texts == [*view.toolbar.names, "Undo", "Ctrl+Z"]


def test_pressed_and_unavailable_tools_look_different() -> None:
    session = opened()
    session.press("i")
    toolbar, view = session.stages[-1]
    theme = load_theme()
    inks = {mark.symbol: mark.ink for mark in compose(toolbar, view, theme).marks if isinstance(mark, Stamps)}
    assert inks["toggle diagrams"] == theme.focus
    assert inks["place"] == theme.text
    assert inks["redo"][3] < 128


@pytest.mark.parametrize("size", [(640, 480), (1280, 800)])
@pytest.mark.parametrize("scene", ["pause", "force method", "refused", "properties"])
def test_no_tip_covers_what_is_said(scene: str, size: tuple[int, int]) -> None:
    """The heading, notices, the legend, the slider and values among it, whichever button the pointer rests on."""
    session = Session.open("hyperstatic")
    session.resize(*size)
    session.press("i")
    for key in {"force method": ("k", "i"), "refused": ("k", "k"), "properties": ("return",)}.get(scene, ()):
        session.press(key)
    if scene == "refused":
        session.press("y")
    session.update_view()
    for button in buttons(session).values():
        session.view.pointer = button.left + 5.0, button.top + 5.0
        session.update_view()
        *below, toolbar = compose_all(session.stages, load_theme())
        tips = [
            mark for mark in toolbar.marks if isinstance(mark, Panel) and mark.fill == load_theme().background
        ]
        assert len(tips) == 1
        tip = tips[0].left, tips[0].top, tips[0].left + tips[0].width, tips[0].top + tips[0].height
        assert tip[0] >= session.view.strip.right
        assert tip[2] <= size[0]
        texts = [mark for picture in below for mark in picture.marks if isinstance(mark, Text)]
        covered = [text.text for text in texts if overlap(text_box(text, capital_height(text.size)), tip)]
        assert not covered, button.action


def test_the_tip_goes_after_a_press_and_comes_back_with_the_pointer() -> None:
    session = opened()
    session.update_view()
    button = buttons(session)["force"]
    there = button.left + 5.0, button.top + 5.0
    session.view.pointer = there
    for pointer, press, tips in (
        (there, False, 1),
        (there, True, 0),
        ((400.0, 300.0), False, 0),
        (there, False, 1),
    ):
        session.view.pointer = pointer
        if press:
            session.press("click", pointer)
        session.update_view()
        toolbar, view = session.stages[-1]
        assert len(compose(toolbar, view, load_theme()).texts) == len(view.toolbar.names) + 2 * tips


@pytest.mark.parametrize("key", ["i", "a", "b"])
def test_what_free_bodies_do_not_show_is_not_lit_and_puts_them_together(key: str) -> None:
    session = opened("hyperstatic_yield")
    shown = {"i": "all_diagrams", "a": "utilisation", "b": "shape"}[key]
    for keys in ((key, "x", key), ("x", key)):
        for press in keys:
            session.press(press)
        assert not session.view.free_bodies
        assert getattr(session.view, shown)
        session.press("x")
        lit = {button.action for button in buttons(session).values() if button.item.pressed}
        assert lit == {"toggle free bodies"}
        session.press("x")
        while getattr(session.view, shown):
            session.press(key)


def test_the_button_of_diagrams_is_lit_and_puts_them_out_whatever_is_selected() -> None:
    session = opened("hyperstatic")
    push(session, "toggle diagrams")
    session.select(session.rods["AC"])
    session.update_view()
    assert tool(session, "toggle diagrams").pressed
    push(session, "toggle diagrams")
    assert not session.view.all_diagrams
    push(session, "toggle diagrams")
    assert session.model.any_tagged(DiagramShown)
    assert not session.view.all_diagrams


@pytest.mark.parametrize("width", [420, 1000])
def test_a_menu_opens_at_the_pointer_and_says_if_there_is_more_of_it(width: int) -> None:
    session = opened(size=(width, 480))
    session.press("right click", session.view.camera.middle)
    picture = compose_all(session.stages, load_theme("light"))[-1]
    menu, entries = session.view.menu, {hit.item for hit in picture.hits if isinstance(hit.item, int)}
    assert menu is not None
    assert any(panel.left <= menu.at[0] + 1.0 < panel.left + panel.width for panel in marks_of(picture, Panel))
    assert ("Wheel shows more" in picture.texts) == (len(entries) < len(menu.entries)) == (width == 420)
