"""Variations: what a sweep changes from variant to variant, and the values that it takes."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence, Sized
from dataclasses import dataclass
from typing import Any

import numpy as np

from pinjoint.components.language import joined, marked, tr
from pinjoint.components.mistake import Mistake
from pinjoint.components.model import Model
from pinjoint.components.wording import cut
from pinjoint.paths import EVERY, PathError, Target, locate, read_value, settable

Value = float | bool | str | None

FORMS = marked(
    "write PATH=START:STOP:COUNT (evenly spaced), PATH=START:STOP:COUNT:log (by equal ratios),"
    " PATH=VALUE,VALUE,… or PATH~normal(MEAN,DEVIATION)"
)
INSTALL = 'pip install "pinjoint[sweep]"'
MOST_VARIANTS = 10_000_000


class SweepError(Mistake, ValueError):
    """A sweep that cannot be done; the message says why and what to write or do."""


@dataclass(frozen=True)
class Variation:
    """What gets other values in each variant: one fact, these `values` in turn, or facts, each drawn anew for every sample.

    path: of all of them. columns: of each. label: for the axis of a diagram. distribution: "" if nothing is drawn.
    """

    path: str
    columns: tuple[str, ...]
    label: str
    values: tuple[Value, ...] = ()
    distribution: str = ""
    parameters: tuple[float, float] = (0.0, 0.0)

    def draw(self, generator: np.random.Generator) -> tuple[float, ...]:
        """One value per column."""
        drawn = DISTRIBUTIONS[self.distribution](generator, *self.parameters, len(self.columns))
        return tuple(drawn.tolist())


def _lognormal(generator: np.random.Generator, mean: float, deviation: float, count: int) -> Any:
    """Of this mean and standard deviation themselves, not of the logarithm's."""
    variance = math.log1p((deviation / mean) ** 2)
    return mean * np.exp(math.sqrt(variance) * generator.standard_normal(count) - 0.5 * variance)


DISTRIBUTIONS: Mapping[str, Callable[..., Any]] = {
    # Of the mean and the standard deviation, which may be given as 5% of the mean.
    "normal": lambda generator, mean, deviation, count: mean + deviation * generator.standard_normal(count),
    "lognormal": _lognormal,
    "uniform": lambda generator, low, high, count: low + (high - low) * generator.random(count),
}


# --- reading -------------------------------------------------------------------------------------------


def read_variations(model: Model, vary: Iterable[str] | Mapping[str, Sequence[Value]]) -> tuple[Variation, ...]:
    """The variations of a model that texts such as "rods.CD.tensile_strength=150:300:31" describe.

    vary: the texts, or the values by path. Raises SweepError.
    """
    texts = (
        [f"{path}={_listed(path, values)}" for path, values in vary.items()]
        if isinstance(vary, Mapping)
        else vary
    )
    variations = tuple(_read(model, text) for text in texts)
    paths = [path for variation in variations for path in variation.columns]
    for path, times in Counter(paths).items():
        if times > 1:
            raise SweepError("{path} is varied twice; leave out one of the two.", path=path)
    for place, path in enumerate(paths):
        for before in paths[:place] if EVERY in path else ():
            if _covers(path, before):
                raise SweepError(
                    "Varying {path} would overwrite {before}, which is varied before it; swap the two.",
                    path=path,
                    before=before,
                )
    return variations


def _covers(path: str, one: str) -> bool:
    """Whether a path with every element has this one among its own."""
    table, star, field = path.partition(f".{EVERY}.")
    return bool(star) and one.startswith(f"{table}.") and one.endswith(f".{field}")


def _listed(path: str, values: Sequence[Value]) -> str:
    if isinstance(values, str) or not isinstance(values, Sized) or len(values) == 0:
        raise SweepError("{path}: give it a list of at least one value.", path=path)
    return ",".join(as_text(np.asarray(value).item()) for value in values)


def _read(model: Model, text: str) -> Variation:
    try:
        target, rest = locate(model, text, settable)
        if not target.handles:
            raise PathError("the model has no {table}; vary something else.", table=tr(target.table.name))
        if target.field.shape and not target.axis:
            raise PathError("vary one component, {key}.x or {key}.y.", key=target.field.key)
        if rest.startswith("="):
            path = target.path(target.element)
            return Variation(path, (path,), _label(target, target.element), _values(target, rest[1:]))
        if rest.startswith("~"):
            return _random(target, rest[1:])
        raise PathError("it has no values; {form}.", form=tr(FORMS))
    except PathError as error:
        raise SweepError(joined([f"{cut(text)}:", str(error)])) from None


def _label(target: Target, element: str) -> str:
    title = joined([tr(target.field.title), target.axis])
    if element == EVERY:
        title = tr("{quantity} of all {elements}", quantity=title, elements=tr(target.table.name))
    elif element:
        title = tr("{quantity} of {element}", quantity=title, element=element)
    return joined([title, target.field.unit], ", ")


def _values(target: Target, text: str) -> tuple[Value, ...]:
    parts = [part.strip() for part in text.split(":")]
    if len(parts) > 1 and target.field.dtype is float:
        return _range(parts)
    values = tuple(read_value(target, part) for part in text.split(","))
    for value in values:
        if isinstance(value, str) and (target.field.dtype is not str or not value):
            raise PathError(
                "'{value}' is not a value of {field}; {form}.",
                value=cut(str(value)),
                field=target.field.title,
                form=tr(FORMS),
            )
    return values


def _range(parts: Sequence[str]) -> tuple[float, ...]:
    spaced = np.geomspace if parts[3:] == ["log"] else np.linspace
    if len(parts) not in (3, 4) or (len(parts) == 4 and parts[3] != "log"):
        raise PathError("a range has a start, a stop and a count; {form}.", form=tr(FORMS))
    start, stop = _finite(parts[0]), _finite(parts[1])
    if not (re.fullmatch("[0-9]{1,9}", parts[2]) and 1 <= int(parts[2]) <= MOST_VARIANTS):
        raise PathError(
            "'{text}' is not a count; write a whole number of at least 1, at most {most}.",
            text=cut(parts[2]),
            most=MOST_VARIANTS,
        )
    if spaced is np.geomspace and not start * stop > 0.0:
        raise PathError("a :log range cannot reach or cross 0; leave out :log, or change the limits.")
    return tuple(spaced(start, stop, int(parts[2])).tolist())


def _random(target: Target, text: str) -> Variation:
    found = re.fullmatch(r"\s*(\w+)\s*\(([^,()]+),([^,()]+)\)\s*", text)
    kinds = ", ".join(DISTRIBUTIONS)
    if found is None or found[1] not in DISTRIBUTIONS:
        raise PathError(
            "'{text}' is not a distribution; write one of {kinds} with its two parameters, such as"
            " normal(164640,5%) or uniform(100,300).",
            text=text,
            kinds=kinds,
        )
    if target.field.dtype is not float:
        raise PathError("{field} is not a number; list its values after =.", field=target.field.title)
    kind, first, second = found[1], _finite(found[2]), found[3].strip()
    if kind == "uniform":
        parameters = (first, _finite(second))
        if not parameters[0] < parameters[1]:
            raise PathError("write uniform(LOWEST,HIGHEST), the lower value first.")
    else:
        deviation = abs(first) * _finite(second[:-1]) / 100.0 if second.endswith("%") else _finite(second)
        parameters = (first, deviation)
        if not deviation >= 0.0 or (kind == "lognormal" and not first > 0.0):
            raise PathError("the standard deviation must be at least 0, and the mean of a lognormal above 0.")
    # Strengths and stiffnesses of different rods are independent: each has its own draw.
    elements = target.table.names if target.element == EVERY else [target.element]
    columns = tuple(map(target.path, elements))
    label = _label(target, elements[0])
    return Variation(target.path(target.element), columns, label, (), kind, parameters)


def _finite(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise PathError("'{text}' is not a finite number; {form}.", text=text.strip(), form=tr(FORMS))
    return value


def as_text(value: Value) -> str:
    """A value as an override has it; numbers lose no digit."""
    if value is None:
        return "null"
    return str(value).lower() if isinstance(value, bool) else str(value)
