"""Sliders of a session: what they show, and new ones for any number of an element."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from pinjoint.components import written
from pinjoint.components.cases import choices, said
from pinjoint.components.field import Field
from pinjoint.components.handle import Handle
from pinjoint.components.language import begun, decimals, joined, marked, tr
from pinjoint.components.load import Load, factor_now
from pinjoint.components.model import Model
from pinjoint.components.numeric_range import incomputable
from pinjoint.components.rod import Rod
from pinjoint.components.round_numbers import round_up
from pinjoint.components.settings import Settings
from pinjoint.components.slider import Aim, Control, SetSliders, Slider, SliderStack
from pinjoint.components.toolbar import Tool
from pinjoint.documents.sliders import unmovable
from pinjoint.editor.context import Context
from pinjoint.systems.edit import Refusal
from pinjoint.systems.edit.arrows import extent, usual
from pinjoint.systems.input.actions import LIVE

# The keys of the controls of the displacement scale and, in statics, of the last load step.
SCALE, LOAD = -1, -2
HIGH = 400.0  # points of a canvas that has room for that of the load
LOADS = Slider((), 0.0, 2.0)  # the range of that, unless the model needs more
SCALES = Slider((), 1.0, 1000.0, logarithmic=True)  # of displacements, unless the model needs more
ABOVE = 28.0  # points, of the status bar
DECADES = 10.0  # a new slider of a stiffness goes from the value / 10 to the value × 10
# By unit: how far a new slider of a 0 goes.
NOTHING = {"K": 50.0, "kN": 10.0, "kN/m": 10.0, "kN·m": 10.0, "m/s²": 10.0, "m/s": 1.0}


# --- what is shown -------------------------------------------------------------------------------------------


def slider_stack(context: Context) -> SliderStack:
    """The sliders on the canvas of the active scene."""
    return sliders_of(context) if context.view.legend and context.mode in LIVE else SliderStack()


def sliders_of(context: Context) -> SliderStack:
    """The sliders of the open document: displacement scale at the bottom, load factor of statics, those of the model."""
    model = context.model
    scale = [scale_control(model.settings)] if model.rods.count else []
    high = context.view.canvas.height >= HIGH * context.view.pixel_ratio
    if scale and high and model.solution is not None:
        factor = model.settings.load_steps[-1]
        share = loads(model.settings).share_of(factor)
        value = f"× {written.given(factor, 4)}"
        scale.append(Control(LOAD, tr("load factor"), value, share, "× 1", pressed=factor == 1.0))
    own = (control_of(model, key, slider) for key, slider in enumerate(model.sliders))
    controls = *scale, *(control for control in own if control is not None)
    return SliderStack(controls, ABOVE, _choices(context) if model.solution is not None else ())


def _choices(context: Context) -> tuple[Tool, ...]:
    """What can be chosen to act in statics, then the envelope of combinations, and the boxes of their factors."""
    model, enveloped = context.model, context.view.envelope
    names = choices(model)
    if not names:
        return ()
    chosen = None if enveloped else model.settings.combination
    titles = [name if name in model.settings.combinations else begun(said(model, name)) for name in names]
    named = zip(names, titles, strict=True)
    tools = [Tool("show combination", title, pressed=name == chosen) for name, title in named]
    return (
        *tools,
        Tool("toggle envelope", begun(tr("envelope")), pressed=enveloped),
        Tool("edit combinations", "…"),
    )


def scale_control(settings: Settings) -> Control:
    """The control of the displacement scale."""
    scale, automatic = settings.displacement_scale, settings.prescribed_displacement_scale is None
    share = scales(settings).share_of(max(scale, 1.0))
    value = f"× {written.given(scale, 4)}"
    return Control(SCALE, tr("displacements"), value, share, tr("auto"), pressed=automatic)


def scales(settings: Settings) -> Slider:
    """The range of displacement scales: from 1 to 1000, or to as much as the model needs."""
    most = max(SCALES.last, 10.0 * settings.automatic_displacement_scale, settings.displacement_scale)
    return Slider((), SCALES.first, 10.0 ** math.ceil(math.log10(most) - 1e-9), logarithmic=True)


def loads(settings: Settings) -> Slider:
    """The range of load factors: from 0 to 2, or as far as the last load step goes."""
    last = settings.load_steps[-1]
    return replace(LOADS, first=min(LOADS.first, last), last=max(LOADS.last, last))


def control_of(model: Model, key: int, slider: Slider) -> Control | None:
    """What a slider of a model shows; None if nothing that it moves exists (any more)."""
    found = [(aim, handle) for aim in slider.aims for handle in aim.handles(model.tables)[:1]]
    if not found:
        return None
    aim, handle = found[0]
    field, value = model.tables[aim.table].fields[aim.field], _value(aim, handle)
    unit, factor = field.on_screen
    text = tr(field.absent) if value is None else _written(value * factor, unit)
    text = joined([text, _now(model, handle, aim.field)], ", ")
    share = None if value is None else slider.share_of(value)
    return Control(key, slider.title or _title(model, aim, handle, field), text, share, "×")


def _now(model: Model, handle: Handle, field: str) -> str:
    """How much of a load acts now, where that is not all of it."""
    if not isinstance(handle, Load) or field not in (Load.force.name, Load.moment.name):
        return ""
    factor = factor_now(model, handle)
    if not math.isfinite(factor) or f"{factor:.0%}" == "100%":
        return ""
    return tr("now {share} %", share=f"{100.0 * factor:.0f}".replace("-", "−"))


def _written(value: float, unit: str) -> str:
    """A number to four digits with its unit."""
    return decimals(f"{float(f'{value:.4g}'):.10g} {unit}".strip().replace("-", "−"))


def _title(model: Model, aim: Aim, handle: Handle, field: Field[Any]) -> str:
    """Whose number a slider moves, and which."""
    whose = (
        tr("all {elements}", elements=tr(aim.table))
        if aim.element is None
        else getattr(handle, "name", model.describe(handle))
    )
    number = joined([tr(field.title), aim.axis])
    return tr("{element}: {value}", element=whose, value=number)


def _value(aim: Aim, handle: Handle) -> float | None:
    """The number that a slider shows: the one in use, where its own is automatic."""
    value = getattr(handle, aim.field)
    overrides = getattr(type(handle), aim.field).overrides
    if value is None and overrides is not None:
        value = getattr(handle, overrides)
    if value is None:
        return None
    return float(value["xy".index(aim.axis)] if aim.axis else value)


# --- making ----------------------------------------------------------------------------------------------


def add_slider(context: Context, elements: Sequence[Handle], field: str, axis: str = "") -> Slider:
    """Put a slider for a Field of elements, or its component "x" or "y", on the canvas. Raises Refusal.

    It moves all of them together. One that there is already is not made again.
    """
    model, first = context.model, elements[0]
    known = model.tables[first.table].fields
    found = known[known[field].overridden_by or field]
    if problem := unmovable(found, axis):
        raise Refusal(problem)
    aims = tuple(Aim(element.table, element, found.name, axis) for element in elements)
    there = next((slider for slider in model.sliders if slider.aims == aims), None)
    if there is not None:
        raise Refusal("There is already a slider for {title}.", title=_title(model, aims[0], first, found))
    value = _value(aims[0], first)
    if value is None:
        raise Refusal(
            "{quantity} is {absent}; give it a number first.",
            quantity=begun(tr(found.title)),
            absent=tr(found.absent),
        )
    slider = _around(model, found, value, aims)
    low = -math.inf if found.minimum is None else found.minimum
    high = math.inf if found.maximum is None else found.maximum
    first_end, last_end = (min(max(end, low), high) for end in (slider.first, slider.last))
    slider = replace(slider, first=first_end, last=last_end)
    with model.transaction(marked("new slider")):
        model.execute(SetSliders((*model.sliders, slider)))
    context.view.legend = True  # it is hidden with the toolbar and the legend
    context.view.sliders = sliders_of(context)
    if context.view.fitted:
        context.view.fit(model)
    context.notice = tr("New slider at the lower left: {title}", title=_title(model, aims[0], first, found))
    return slider


def _around(model: Model, field: Field[Any], value: float, aims: tuple[Aim, ...]) -> Slider:
    """A slider with a range that suits a Field with that value."""
    if field.name in ("position", "displacement") and not incomputable(model):
        reach = round_up(0.25 * extent(model)) or 1.0
        return Slider(aims, value - reach, value + reach)
    if (field.above is not None and field.unit.startswith("kN")) or (
        field is Rod.prescribed_bending_stiffness and value > 0.0
    ):
        return Slider(aims, value / DECADES, value * DECADES, logarithmic=True)
    if field.above is not None:
        return Slider(aims, 0.5 * value, 1.5 * value)
    if value != 0.0:
        return Slider(aims, 0.0, math.copysign(round_up(2.0 * abs(value)), value))
    reach = round_up(usual(model, "force")) if field.name == "force" else NOTHING.get(field.unit, 1.0)
    return Slider(aims, -reach, reach)
