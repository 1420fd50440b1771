"""Listing: which table of results a person has open, in which order its rows stand, and from which on they are shown."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.collapse_steps import collapse_steps
from pinjoint.components import written
from pinjoint.components.bent import is_frame
from pinjoint.components.field import Vector
from pinjoint.components.handle import Handle
from pinjoint.components.language import language, tr
from pinjoint.components.model import Model
from pinjoint.components.rod import bearing
from pinjoint.components.units import units_on_screen
from pinjoint.components.view import Listing
from pinjoint.documents.statics import PLASTIC
from pinjoint.results import Results, envelope_of_reactions, envelope_of_rods
from pinjoint.systems.input.actions import LIVE, PROPERTIES, TABLE
from pinjoint.systems.render.ui.listing import height_of, rows_in
from pinjoint.tables import Table

_WIDE, _NARROW = 860.0, 400.0  # points across tables of rods that bend or bear loads, and of others


class Lister:
    """What is listed of the model that is open.

    shown: "rods", "particles" or "sums"; of envelopes "envelope" or "reactions". orders: by table, the key of the column by
    which its rows are ordered, "" as in the model, and whether the largest come first. first: the row at the top.
    """

    def __init__(self, context: Any) -> None:  # pinjoint.editor.context.Context, which holds it
        self._context = context
        self.shown = "rods"
        self.orders: dict[str, tuple[str, bool]] = {}
        self.first = 0
        self._tables: dict[str, Table] = {}
        self._chosen: list[Handle] = []
        self._of: object = None
        self._made: tuple[object, Listing] | None = None

    @property
    def wanted(self) -> Vector:
        """Points across and high that the tables want beside the model; 0, 0: none is open, or not in this scene."""
        context, rods = self._context, self._context.model.rods
        if TABLE not in context.view.wanted or context.mode not in (*LIVE, PROPERTIES):
            return 0.0, 0.0
        wide = is_frame(context.model) or bearing(context.model).any()
        most = max(rods.count, context.model.particles.count)
        return (_WIDE if wide else _NARROW), height_of(most + 1)

    @property
    def tables(self) -> dict[str, Table]:
        """All tables by name, up to date; empty while forces are not known."""
        model = self._context.model
        known = self._context.view.forces_known or model.solution is not None  # rows of a mechanism, too
        envelope = self._context.view.enveloped
        if self._of != (model.context, model.revision, known, language(), units_on_screen(), id(envelope)):
            found = Results.of(model if known else Model())
            self._tables = {"rods": found.rods, "particles": found.particles, "sums": found.sums}
            if envelope is not None:
                of_reactions = envelope_of_reactions(model, envelope)
                self._tables = {"envelope": envelope_of_rods(model, envelope), "reactions": of_reactions}
            elif model.solution is not None and model.first_order and (steps := self._steps()) is not None:
                self._tables["steps"] = steps
            said = language(), units_on_screen(), id(envelope)
            self._of = (model.context, model.revision, known, *said)  # finding them may compute forces
        return self._tables

    def _steps(self) -> Table | None:
        """The way to collapse of what is shown, if that is beyond the elastic range."""
        settlement = self._context.document.statics.settlement
        if settlement is None or PLASTIC.isdisjoint(event.kind for event in settlement.events):
            return None
        with self._context.model.own_state():
            return collapse_steps(self._context.model)

    @property
    def table(self) -> Table:
        """The table that is shown."""
        if self.shown not in self.tables:  # that of envelopes, or no longer
            self.turn_to(next(iter(self.tables)))
        return self.tables[self.shown]

    @property
    def _by(self) -> tuple[int, bool]:
        """The column by which rows are ordered, 0 for the names, and whether the largest come first."""
        key, falls = self.orders.get(self.shown, ("", False))
        keys = [column.key for column in self.table.columns]
        return (keys.index(key) + 1 if key in keys else 0), falls

    @property
    def _order(self) -> list[int]:
        """The rows in the order in which they stand, those without a number last, then the sum."""
        table, (by, falls) = self.table, self._by
        count = len(table.names)
        values = table.columns[by - 1].values if by else np.arange(float(count))
        order: NDArray[np.intp] = np.argsort(-values if falls else values, kind="stable")
        return [*order.tolist(), *[count] * table.summed]

    # --- what is seen ------------------------------------------------------------------------------------

    @property
    def listing(self) -> Listing:
        """What is in sight."""
        view, model, table = self._context.view, self._context.model, self.table
        place = view.table_place, view.pixel_ratio
        now = (self._of, self.shown, self._by, self.first, model.tags_revision, place)
        if self._made is None or self._made[0] != now:
            order, titles = self._order, [self._title(name) for name in self.tables]
            first = min(max(self.first, 0), max(len(order) - rows_in(*place), 0))
            chosen = self._selected_rows
            shown = order[first : first + rows_in(*place)]
            heads = [(table.corner, ""), *((column.title, column.unit) for column in table.columns)]
            made = Listing(
                titles=tuple(titles),
                title=titles[list(self.tables).index(self.shown)],
                heads=tuple(heads),
                by=self._by[0],
                falls=self._by[1],
                rows=tuple((row, row in chosen, table[1 + row]) for row in shown),
                longest=max(table.names, key=len, default=""),
                first=first,
                count=len(order),
            )
            self._made = now, made
        return self._made[1]

    @staticmethod
    def _title(name: str) -> str:
        titles = {
            "rods": tr("Forces in rods"),
            "particles": tr("Joints"),
            "sums": tr("Sums"),
            "envelope": tr("Envelope"),
            "reactions": tr("Reactions"),
            "steps": tr("Hinge by hinge"),
        }
        return titles[name]

    @property
    def _elements(self) -> str:
        """The table of the model whose elements the rows are; "" if they are none's."""
        return {"sums": "", "steps": "", "envelope": "rods", "reactions": "particles"}.get(
            self.shown, self.shown
        )

    def follow(self) -> None:
        """Show the rows of elements that were selected elsewhere."""
        chosen = [handle for handle in self._context.selected if handle.table in ("rods", "particles")]
        if chosen != self._chosen and chosen:
            names = {"rods": "envelope", "particles": "reactions"} if "envelope" in self.tables else {}
            if not any(handle.table == self._elements for handle in chosen):
                self.turn_to(names.get(chosen[0].table, chosen[0].table))
            row = next(handle.row for handle in chosen if handle.table == self._elements)
            if row < len(self.table.names):
                at, shown = self._order.index(row), self.listing
                self.first = min(max(shown.first, at - len(shown.rows) + 1), at)
        self._chosen = chosen

    # --- what a person does with it ------------------------------------------------------------------------

    def turn_to(self, shown: str) -> None:
        """Show another table."""
        if shown != self.shown:
            self.shown, self.first = shown, 0

    def turn(self, by: int) -> None:
        """Show the next table, or the one before."""
        names = list(self.tables)
        self.turn_to(names[(names.index(self.shown) + by) % len(names)])

    def press(self, item: Any) -> None:
        """A title shows its table, a head orders the rows by its column or turns them around, a row selects its element."""
        match item:
            case "title", int(number):
                self.turn_to(list(self.tables)[number])
            case "head", int(number):
                by, falls = self._by
                key = self.table.columns[number - 1].key if number else ""
                self.orders[self.shown] = key, not falls if number == by else False
                self.first = 0
            case "row", int(row):
                self._select(row)

    def _select(self, row: int) -> None:
        handles = self._context.model.tables[self._elements].handles if self._elements else []
        if row < len(handles):
            self._context.scenes.active.turn_to(self._context, handles[row])

    def scroll(self, rows: int) -> None:
        """Scroll by so many rows."""
        self.first = self.listing.first + rows
        self.first = self.listing.first

    def page(self, by: int) -> None:
        """Scroll by all rows in sight but one."""
        self.scroll(by * max(len(self.listing.rows) - 1, 1))

    def choose(self, by: int) -> None:
        """Select the element of the next row, or of the one before."""
        order, chosen = self._order, self._selected_rows
        here = [at for at, row in enumerate(order) if row in chosen]
        at = here[0] + by if here else 0 if by > 0 else len(self.table.names) - 1
        if 0 <= at < len(self.table.names):
            self._select(order[at])

    @property
    def _selected_rows(self) -> set[int]:
        return {handle.row for handle in self._context.selected if handle.table == self._elements}

    def text(self, between: str = "") -> str:
        """The table in full, in the order in which it is shown, for spreadsheets of the present language."""
        heads, *rows = self.table.rows()
        rows = [rows[row] for row in self._order if row < len(rows)]
        return written.as_csv([heads, *rows], local=True, between=between)
