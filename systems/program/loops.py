"""Loops over the rods in the source of step programs: rod by rod, or in stages that processors vectorise.

In stages, the values at the ends of a chunk of rods are gathered, then all rods of the chunk are computed, then their
forces are added to their ends: the same operations and order of sums as rod by rod, hence the same bits. Rod by rod, a
step of Verlet takes 9 to 24 % longer (300 to 10 000 rods). Stages pass their results in one scratch array; the computing
loop also reads a few columns.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from pinjoint.systems.program.pasting import indented

CHUNK = 64  # rods in a chunk: their values stay in the nearest cache
# Columns read directly: LLVM checks at run time that they do not overlap scratch; with more it gives up.
_APART = 7

ALL = "0, rods_between.shape[0]"

_ROW = re.compile(r"\br\b")
_ELEMENT = re.compile(r"\b([A-Za-z_]\w*)\[r((?:, \d+)*)\]")


@dataclass(frozen=True)
class RodLoop:
    """A loop over every rod `r`, from particle `a` to `b`.

    gather: names, and expressions of values at the ends. compute: lines that use these names and entries [r] of
    columns; what they do `if rare:` keeps processors from vectorising them, so that in stages all rods are computed
    without, and those that are rare once more. made: names that compute leaves for scatter. scatter: lines that add to
    the ends, or elsewhere. writes: columns that compute changes.
    """

    gather: Mapping[str, str]
    compute: Sequence[str]
    made: Sequence[str] = ()
    scatter: Sequence[str] = ()
    writes: Sequence[str] = ()

    def __add__(self, other: RodLoop) -> RodLoop:
        """One loop that does both, in each stage one after the other."""
        return RodLoop(
            {**self.gather, **other.gather},
            [*self.compute, *other.compute],
            [*self.made, *other.made],
            [*self.scatter, *other.scatter],
            [*self.writes, *other.writes],
        )

    def one_by_one(self, span: str = ALL) -> list[str]:
        """The loop's lines, rod by rod. span: the first row and the row after the last."""
        return [
            f"for r in range({span}):",
            "    a = rods_between[r, 0]",
            "    b = rods_between[r, 1]",
            *(f"    {name} = {what}" for name, what in self.gather.items()),
            *indented(self.compute),
            *indented(self.scatter),
        ]

    def in_stages(self, floats: Callable[[str], bool], span: str = ALL) -> list[str]:
        """The loop's lines, stage by stage. floats: whether a column holds floating-point numbers."""
        elements = dict.fromkeys(_ELEMENT.findall("\n".join(self.compute)))
        plain = [name for name, part in elements if not part and name not in self.writes][:_APART]
        copied = [(name, part) for name, part in elements if name not in plain and floats(name)]
        usual, made = list(self.compute), [*self.made]
        if all(map(floats, self.writes)):  # else what was written could not be taken back
            usual = _without_rare(self.compute)
        made += ["rare"] * (len(usual) < len(self.compute))
        kept: list[str | tuple[str, str]] = [*self.gather, *copied, *made]
        slots = {name: slot for slot, name in enumerate(kept)}
        scattered = _ELEMENT.findall("\n".join(self.scatter))
        sliced = dict.fromkeys(name for name, _ in (*elements, *scattered))

        def place(name: str | tuple[str, str]) -> str:
            return f"scratch[k + {CHUNK * slots[name]}]"

        def there(match: re.Match[str]) -> str:
            return _entry((match[1], match[2]))

        def here(match: re.Match[str]) -> str:
            element = match[1], match[2]
            return place(element) if element in slots else _entry(element)

        def computed(lines: Sequence[str]) -> list[str]:
            return [
                *(f"{name} = {place(name)}" for name in self.gather),
                *(_ROW.sub("start + k", _ELEMENT.sub(here, line)) for line in lines),
                *(f"{place(name)} = {name}" for name in made),
            ]

        begin, end = span.split(", ")
        back = [(name, part) for name, part in copied if name in self.writes]
        again = [*(f"{place(e)} = {_entry(e)}" for e in back), *computed(self.compute)]
        ends = ["a = ends[k, 0]", "b = ends[k, 1]"]
        stages: list[list[str]] = [
            [*ends, *(f"{place(name)} = {what}" for name, what in self.gather.items())],
            [f"{place(e)} = {_entry(e)}" for e in copied],
            computed(usual),
            [f"if {place('rare')} != 0.0:", *indented(again)] if "rare" in made else [],
            [
                *ends,
                *(f"{name} = {place(name)}" for name in self.made),
                *(_ELEMENT.sub(there, line) for line in self.scatter),
                *(f"{_entry(e)} = {place(e)}" for e in back),
            ],
        ]
        body = [
            f"count = min({CHUNK}, {end} - start)",
            "ends = rods_between[start : start + count]",
            *(f"{name}_ = {name}[start : start + count]" for name in sliced),
        ]
        for lines in stages:
            if lines:
                body += ["for k in range(count):", *indented(lines)]
        return [
            f"scratch = np.empty({CHUNK * max(len(slots), 1)})",
            f"for start in range({begin}, {end}, {CHUNK}):",
            *indented(body),
        ]


def _without_rare(lines: Sequence[str]) -> list[str]:
    """Lines but for what they do `if rare:`."""
    kept, inside = [], False
    for line in lines:
        inside = line == "if rare:" or (inside and line.startswith(" "))
        kept += [] if inside else [line]
    return kept


def _entry(element: tuple[str, str]) -> str:
    name, part = element
    return f"{name}_[k{part}]"
