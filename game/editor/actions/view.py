"""Actions on the view and the window."""

from __future__ import annotations

from functools import partial
from operator import attrgetter

from pinjoint.components.field import Vector
from pinjoint.components.language import LANGUAGES, language, speak, tr
from pinjoint.components.toolbar import Menu, Tool
from pinjoint.components.units import PRESETS, SINGLE, is_shown, show_in, show_single, units_on_screen
from pinjoint.editor.context import Context
from pinjoint.systems.edit import saving
from pinjoint.systems.input.actions import ACTIONS, EVERY, IN_PICTURES, LIVE, Perform, actions_of
from pinjoint.systems.render.theme import load_theme
from pinjoint.systems.render.ui.help import help_pages
from pinjoint.systems.render.ui.menu import pointed_at

action = actions_of("View", EVERY, while_drawing=True)

_ZOOM_STEP = 1.2
THEMES = ("light", "dark", "colour-blind", "colour-blind-dark")  # in the order in which one follows another


def toggle(what: str, of: str = "view") -> Perform:
    """Show something in the view, or hide it; or switch a setting."""
    return lambda context, pixel: setattr(it := getattr(context, of), what, not getattr(it, what))


action("zoom in", "wheel up", "zoom in at the pointer", IN_PICTURES)(
    lambda context, pixel: context.scenes.active.zoom(context, _ZOOM_STEP, pixel)
)
action("zoom out", "wheel down", "zoom out", IN_PICTURES)(
    lambda context, pixel: context.scenes.active.zoom(context, 1.0 / _ZOOM_STEP, pixel)
)
action("pan", "drag middle", "move the view (right button, too)", IN_PICTURES)(
    lambda context, dragged: context.scenes.active.pan(context, dragged)  # given how far, not where
)
action("fit", "home", "show the whole model", IN_PICTURES)(
    lambda context, pixel: context.scenes.active.fit(context)
)
action("toggle legend", "tab", "show or hide legend and toolbar", IN_PICTURES)(toggle("legend"))


@action("next theme", "t", "change the colours", IN_PICTURES)
def _next_theme(context: Context, pixel: Vector) -> None:
    """The theme after the present one."""
    theme = context.view.theme
    following = THEMES.index(theme) + 1 if theme in THEMES else 0
    context.view.theme = THEMES[following % len(THEMES)]
    context.notice = tr("Theme: {theme}", theme=tr(load_theme(context.view.theme).title))


@action("next language", "f2", "change the language: English, Português")
def _next_language(context: Context, pixel: Vector) -> None:
    """The language after the present one, in which all is said from now on."""
    codes = list(LANGUAGES)
    speak(codes[(codes.index(language()) + 1) % len(codes)])
    context.scenes.active.say_again(context)
    context.notice = tr("Language: {language}", language=LANGUAGES[language()])


@action("next units", "shift+f2", "change the units: cm kN, m kN mm, N mm", LIVE)
def _next_units(context: Context, pixel: Vector) -> None:
    """The preset of units after the present one, in which numbers are shown and typed from now on."""
    names = list(PRESETS)
    last = names.index(units_on_screen()) if units_on_screen() in names else -1
    show_in(names[(last + 1) % len(names)])
    context.notice = tr("Units: {units}", units=units_on_screen())


@action("units", "ctrl+f2", "choose single units and decimals", LIVE, in_menu=True)
def _units(context: Context, pixel: Vector) -> None:
    """The list of presets, and of single units, quantity by quantity."""
    groups = [[(tr("all"), name, name == units_on_screen()) for name in PRESETS]]
    groups += [[(tr(what), one.split()[0], is_shown(one)) for one in some] for what, some in SINGLE.items()]
    tools = (
        (Tool("show units", f"{what}: {one}", pressed=now) for what, one, now in group) for group in groups
    )
    context.view.menu = Menu(tr("Units"), tuple(map(tuple, tools)), pixel, pointed=pixel)


@action("show units", where=LIVE, in_menu=True)
def _show_units(context: Context, pixel: Vector) -> None:
    """Those of the entry that was clicked, or that keys have come to."""
    view, every = context.view, [*PRESETS, *(one for group in SINGLE.values() for one in group)]
    chosen = every[
        pointed_at(view, load_theme(view.theme), view.pixel) if view.pressed is None else int(view.pressed.item)
    ]
    view.menu = None
    (show_in if chosen in PRESETS else show_single)(chosen)
    context.notice = tr("Units: {units}", units=units_on_screen())


def _magnify(by: int, context: Context, pixel: Vector) -> None:
    """Larger or smaller type, symbols and panels, in a window."""
    if context.window is not None:
        context.notice = tr("Size of text and symbols: {size}", size=context.window.magnify(by))


action("larger", "ctrl++", "make text larger or smaller", repeats=True)(partial(_magnify, 1))
action("larger", "ctrl+shift++")(ACTIONS["larger"].perform)
action("smaller", "ctrl+-", "make text larger or smaller", repeats=True)(partial(_magnify, -1))
action("usual size", "ctrl+0", "reset the size of text")(partial(_magnify, 0))


def _count_of_pages(context: Context) -> int:
    """How many pages the keys of the active scene take; where view.help is more, the last one is shown."""
    scene, view = context.scenes.active, context.view
    lines = tuple(ACTIONS.help_lines(scene.name))
    return len(help_pages(lines, scene.helped(context), view.pixel_ratio, load_theme(view.theme)))


@action("toggle help", "f1", "show help: keys and glossary", pressed=attrgetter("view.help"))
def _toggle_help(context: Context, pixel: Vector) -> None:
    """Show the next page of keys; after the last, none."""
    count = _count_of_pages(context)
    context.view.help = (min(context.view.help, count) + 1) % (count + 1)


def _turn(by: int, context: Context, pixel: Vector) -> None:
    """Another page of the keys, if there is one."""
    count = _count_of_pages(context)
    context.view.help = min(max(min(context.view.help, count) + by, 1), count)


action("help on")(partial(_turn, 1))
action("help back")(partial(_turn, -1))
action("close help")(lambda context, pixel: setattr(context.view, "help", 0))
action("toggle sound", "", "sound on or off", pressed=attrgetter("view.sound"), enabled=attrgetter("window"))(
    toggle("sound")
)
action("toggle full screen", "f11", "full screen on or off")(
    lambda context, pixel: context.window and context.window.toggle_full_screen()
)


def _save_picture(suffix: str, context: Context, pixel: Vector) -> None:
    """Save a picture of the model in a format."""
    if context.window is None:
        return
    with saving():
        context.notice = tr("Picture saved: {file}", file=context.window.screenshot(suffix))


action("screenshot", "f12", "save a picture")(partial(_save_picture, ".png"))
action("picture as svg", "shift+f12", "save a picture as SVG")(partial(_save_picture, ".svg"))
action("picture as pdf", "ctrl+f12", "save a picture as PDF")(partial(_save_picture, ".pdf"))
