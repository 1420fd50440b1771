"""`pinjoint curve`: a load–displacement curve."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from pinjoint.commands.arguments import Parser, UsageError, count, finite, option
from pinjoint.commands.options import ANSWERED, NOT_ANSWERED, add_model, add_theory, model_of
from pinjoint.commands.output import Row, add_output, write_result, writing
from pinjoint.components.language import joined, marked, plural, tr
from pinjoint.components.model import Model
from pinjoint.components.rod import bends
from pinjoint.curves import UNITS, called, chosen, columns, plot
from pinjoint.streams import tell
from pinjoint.systems.catalogue import left_out_of_statics
from pinjoint.systems.statics.explain import describe_motion
from pinjoint.systems.statics.path import Curve, Goal
from pinjoint.systems.statics.theory import mechanisms


def command(words: Sequence[str]) -> int:
    """Do what the words after the command ask for; returns the exit status."""
    parser = Parser(
        "curve",
        "Load–displacement curve: equilibria while the load grows, and while it falls again past limit points.",
    )
    add_model(parser)
    goal = parser.add_mutually_exclusive_group()
    option(goal, "--factor", "end where the load factor first reaches this; default 1", finite, default=1.0)
    option(
        goal,
        "--until B.y=-2.5",
        "end where a particle first has this displacement (m), or rotation, as B.rotation=1 (rad)",
    )
    option(
        parser,
        "--branch N",
        "at the Nth bifurcation, take the branch that buckles along its mode, or against it if N is negative;"
        " default: stay on the main branch",
        int,
        default=0,
    )
    option(parser, "--points N", "compute at most N equilibria; default 500", count, default=500)
    option(
        parser,
        "--of B.y",
        "only this displacement, rotation (B.rotation), axial force (AB) or moment (AB.start); may be given several times",
        action="append",
    )
    add_theory(parser)
    add_output(parser, default="csv")
    options = parser.parse_args(words)
    model = model_of(options)
    try:
        end = Goal.of(model, options.factor, options.until)
        wanted = {name: getattr(options, name) for name in ("points", "branch", "theory")}
        found = Curve.of(model, end, **wanted)
        is_picture = str(options.output).lower().endswith((".png", ".svg", ".pdf"))
        drawn = plot(model, found, options.of or ()) if is_picture else None
        chosen(model, found, options.of or ())
    except (ValueError, LookupError) as error:
        raise UsageError(str(error)) from None
    laws = left_out_of_statics(model)
    message = "" if found.complete else _why_it_ends(model, found, options.points)
    message = joined([_what_is_missing(found, options.branch), message])
    said = {"complete": found.complete, "message": message, "left_out": laws}
    if drawn is not None:
        from pinjoint.pictures import plot_picture

        with writing(options.output):
            plot_picture(drawn, Path(options.output))
    else:
        write_result(options, said | _data(model, found, options.of), _rows)
    if laws:
        tell(tr("The curve leaves out the laws of mods: {laws}.", laws=", ".join(laws)))
    for event in found.events:
        tell(event.message)
    tell(message)
    return ANSWERED if found.complete and not laws and not message else NOT_ANSWERED


def _what_is_missing(curve: Curve, branch: int) -> str:
    """A sentence if there is no bifurcation of this number, else ""."""
    there = sum(event.kind == "bifurcation" for event in curve.events)
    if abs(branch) <= there:
        return ""
    if there == 0:
        return tr(
            "The curve has no bifurcations, so there is no branch {branch}; leave out --branch.", branch=branch
        )
    return plural(
        "The curve has one bifurcation, so there is no branch {branch}; choose 1 or -1.",
        "The curve has {count} bifurcations, so there is no branch {branch}; choose from 1 to {count}, or -1 to -{count}.",
        there,
        branch=branch,
    )


def _why_it_ends(model: Model, curve: Curve, most: int) -> str:
    """Where and why a curve ends before its goal."""
    count = len(curve.load_factor)
    factor = float(curve.load_factor[-1])
    if count == most:
        return tr(
            "The curve stops at the load factor {factor:.6g}, after {count} points; allow more: --points {more}.",
            factor=factor,
            count=count,
            more=10 * count,
        )
    if count > 1:
        return tr(
            "The curve ends at the load factor {factor:.6g}: no further equilibrium was found.", factor=factor
        )
    why = ""
    if len(moving := mechanisms(model)):
        why = tr(
            "The structure is a mechanism: {moving} can move. Add rods or supports there.",
            moving=describe_motion(model, moving),
        )
    return joined([tr("The curve ends where it begins, at the load factor {factor:.6g}.", factor=factor), why])


def _data(model: Model, curve: Curve, names: Sequence[str] | None) -> dict[str, Any]:
    """A curve as plain data: columns, each list with one entry for every equilibrium, and the same as points; and events.

    displacement (m): by free direction, such as "B.y"; axial_force (kN): by rod. Where members bend: rotation (rad), by
    particle that turns; bending_moment (kN·m), by rigid end, such as "AB.start".
    """
    return {
        "load_factor": curve.load_factor,
        "stable": curve.stable,
        **{
            quantity: {
                name: values for name, values in of.items() if names is None or called(quantity, name) in names
            }
            for quantity, of in columns(model, curve).items()
        },
        "points": [_point(model, curve, number) for number in range(len(curve.load_factor))],
        "events": [event.record(model) for event in curve.events],
    }


def _point(model: Model, curve: Curve, number: int) -> dict[str, Any]:
    """One equilibrium of a curve as plain data, by particle and by rod, with what bending adds."""
    bent = bends(model)
    particles = zip(model.particles.names, curve.displacement[number], curve.rotation[number], strict=True)
    rods = zip(model.rods.names, curve.axial_force[number], curve.bending_moment[number], strict=True)
    return {
        "load_factor": curve.load_factor[number],
        "stable": curve.stable[number],
        "particles": {
            name: {"displacement": moved} | ({"rotation": turned} if bent else {})
            for name, moved, turned in particles
        },
        "rods": {
            name: {"axial_force": force} | ({"bending_moment": moments} if bent else {})
            for name, force, moments in rods
        },
    }


def _rows(found: Mapping[str, Any]) -> Iterator[Row]:
    """The data of a curve as rows, one for every equilibrium, headings first; the last tells of plastic hinges and collapse.

    That is there only if one forms, and of other events none, which lie between equilibria.
    """
    factors = [float(factor) for factor in found["load_factor"]]
    told = dict.fromkeys(factors, "")
    for event in found["events"]:
        if event["load_factor"] in told and event["kind"] in ("hinge", "collapse"):
            said = " ".join([event["kind"], *filter(None, [event.get("particle")])])
            told[event["load_factor"]] = ", ".join(filter(None, [told[event["load_factor"]], said]))
    columns = {
        f"{name} ({unit})": values
        for quantity, unit in UNITS.items()
        for name, values in found.get(quantity, {}).items()
    }
    if any(told.values()):
        columns[marked("event")] = [told[factor] for factor in factors]
    yield marked("load factor"), marked("stable"), *columns
    yield from zip(found["load_factor"], found["stable"], *columns.values(), strict=True)
