"""Fields: what a column may hold, how a person is told otherwise, and how a handle reads and writes it."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pinjoint.included  # noqa: F401 (its mods register further histories)
from pinjoint.components.field import Field, FieldError, Role, same
from pinjoint.components.handle import Handle
from pinjoint.components.language import english, spoken
from pinjoint.components.load import Load
from pinjoint.components.model import KINDS
from pinjoint.components.rod import Rod
from pinjoint.components.settings import Settings
from pinjoint.components.table import fields_of
from pinjoint.components.world import World
from tests.unit.test_world import triangle


def number(**options: Any) -> Field[Any]:
    return Field("kN", title="push", doc="A force.", **options)


def rod_in_row(row: int) -> str:
    return f"rod {row}"


ALL_FIELDS = [pytest.param(f, id=f"{k.__name__}.{f.name}") for k in KINDS for f in fields_of(k)]
PURE_RATIOS = {
    "tolerance",
    "step_error",
    "plastic_strain",
    "bowing",
    "turning_shares",
    "fixity",
    "strain",
    "restitution",
    "displacement_scale",
    "automatic_displacement_scale",
    "prescribed_displacement_scale",
}


# --- one value ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("field", "value", "expected"),
    [
        (number(), 3, 3.0),
        (number(), np.float32(0.5), 0.5),
        (number(), np.int64(7), 7.0),
        (number(shape=(2,)), [1, 2], (1.0, 2.0)),
        (number(shape=(2,)), np.array([1, 2]), (1.0, 2.0)),
        (number(dtype=int), 2.0, 2),
        (number(dtype=int), np.uint8(2), 2),
        (number(dtype=int), 2**63 - 1, 2**63 - 1),
        (number(dtype=bool), np.bool_(True), True),
        (number(dtype=bool, shape=(2,)), (True, False), (True, False)),
        (number(dtype=str), np.str_("AB"), "AB"),
        (number(nullable=True), None, None),
        (number(minimum=0.0, maximum=1.0), 0.0, 0.0),
        (number(minimum=0.0, maximum=1.0), 1, 1.0),
        (number(dtype="reference", shape=(2,)), (0, 2**32 - 1), (0, 2**32 - 1)),
    ],
)
def test_a_value_is_normalised(field: Field[Any], value: Any, expected: Any) -> None:
    checked = field.check(value, "rod AB")
    assert checked == expected
    assert type(checked) is type(expected)
    if isinstance(expected, tuple):
        assert [type(v) for v in checked] == [type(v) for v in expected]


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        (number(), "3", "rod AB: push is '3'; it must be a number."),
        (number(), True, "rod AB: push is True; it must be a number."),
        (number(), None, "rod AB: push is None; it must be a number."),
        (number(), 1j, "rod AB: push is 1j; it must be a number."),
        (number(), np.complex128(1), "it must be a number."),
        (number(), np.array(3.0), "it must be a number."),
        (number(), math.nan, "rod AB: push is nan; it must be a finite number."),
        (number(), -math.inf, "it must be a finite number."),
        (number(), 10**400, "it must be a finite number."),
        (number(dtype=int), 2.5, "rod AB: push is 2.5; it must be a whole number below 2^63."),
        (number(dtype=int), math.nan, "it must be a finite number."),
        (number(dtype=int), math.inf, "it must be a finite number."),
        (number(dtype=int), 2**63, "it must be a whole number below 2^63."),
        (number(above=0.0), 0.0, "rod AB: push is 0 kN; it must be greater than 0 kN."),
        (number(minimum=0.0), -1.5, "rod AB: push is -1.5 kN; it must be at least 0 kN."),
        (number(maximum=1.0), 1.0000001, "rod AB: push is 1.0000001 kN; it must be at most 1 kN."),
        (number(shape=(2,)), 3.0, "rod AB: push is 3.0; it must be a pair of numbers, [x, y]."),
        (number(shape=(2,)), np.array(3.0), "it must be a pair of numbers, [x, y]."),
        (number(shape=(2,)), "12", "rod AB: push is '12'; it must be a pair of numbers, [x, y]."),
        (number(shape=(2,)), {1.0, 2.0}, "it must be a pair of numbers, [x, y]."),
        (number(shape=(2,)), {"x": 1, "y": 2}, "it must be a pair of numbers, [x, y]."),
        (number(shape=(2,)), [1, 2, 3], "rod AB: push needs two entries, [x, y]; it has 3."),
        (number(shape=(2,)), [1, math.nan], "rod AB: push y is nan; it must be a finite number."),
        (number(shape=(2,)), np.ones((2, 2)), "it must be a number."),
        (number(dtype=bool), 1, "rod AB: push is 1; it must be true or false."),
        (number(dtype=bool, shape=(2,)), (True, 0), "rod AB: push is (True, 0); it must be true or false."),
        (number(dtype=str), 3, "rod AB: push is 3; it must be a text."),
        (number(dtype=str, choices=("a", "b")), "c", "rod AB: push is 'c'; choose one of a, b."),
        (number(dtype="reference"), -1, "rod AB: push is -1 kN; it must be at least 0 kN."),
        (number(dtype="reference"), 2**32, "it must be at most 4.29497e+09 kN."),
        (number(dtype="reference"), "A", "rod AB: push is 'A'; it must be an element, its name or its row."),
    ],
)
def test_a_refusal_names_element_value_and_remedy(field: Field[Any], value: Any, message: str) -> None:
    with pytest.raises(FieldError) as refusal:
        field.check(value, "rod AB")
    assert str(refusal.value).startswith("rod AB: push ")
    assert str(refusal.value).endswith(message)


@pytest.mark.parametrize(
    ("owner", "value", "fragment"),
    [
        (Settings.integrator, ["rk4"], "integrator is ['rk4']; choose one of automatic"),
        (Load.history, ["ramp"], "history is ['ramp']; it must be like"),
        (Load.history, {"kind": ["ramp"]}, "it must be like"),
        (
            Load.history,
            {"kind": "wave"},
            "there is no kind of history 'wave'; choose one of constant, pulse, ramp",
        ),
        (
            Load.history,
            {"kind": "ramp", "durration": 1},
            "a history of the kind 'ramp' has no 'durration'; it takes only: kind, start",
        ),
        (
            Load.history,
            {"kind": "ramp", "duration": -1},
            "duration of the history is -1 s; it must be at least 0 s",
        ),
        (
            Load.history,
            {"kind": "ramp", "start": math.inf},
            "start of the history is inf; it must be a number between -1e+30 and 1e+30",
        ),
        (Load.history, {"kind": "ramp", "start": True}, "start of the history is True; it must be a number"),
        (Load.history, {"kind": "ramp", "start": 10**400}, "it must be a number between -1e+30 and 1e+30"),
    ],
)
def test_checkers_refuse_in_sentences(owner: Field[Any], value: Any, fragment: str) -> None:
    with pytest.raises(FieldError) as refusal:
        owner.check(value, "load 1")
    assert "load 1: " in str(refusal.value)
    assert fragment in str(refusal.value)


def test_a_history_is_complete_and_cannot_be_changed() -> None:
    given_history: dict[str, Any] = {"kind": "ramp", "duration": np.int64(2)}
    history = Load.history.check(given_history, "load 1")
    given_history["duration"] = -5
    assert history == {"kind": "ramp", "start": 0.0, "duration": 2.0}
    with pytest.raises(TypeError):
        history["start"] = 1.0


# --- a whole column ------------------------------------------------------------------------------------


@pytest.mark.parametrize("rows", [1, 3, 100])
def test_a_column_takes_one_value_for_each_row_or_one_for_all(rows: int) -> None:
    vector, scalar = number(shape=(2,)), number()
    each = [[i, i + 0.5] for i in range(rows)]
    assert vector.check_column(each, rows, rod_in_row).tolist() == each
    assert vector.check_column(np.array(each), rows, rod_in_row).tolist() == each
    assert vector.check_column((1, 2), rows, rod_in_row).tolist() == [[1.0, 2.0]] * rows
    assert scalar.check_column(5, rows, rod_in_row).tolist() == [5.0] * rows
    assert scalar.check_column(np.arange(rows), rows, rod_in_row).tolist() == list(range(rows))
    assert number(dtype=str).check_column("a", rows, rod_in_row).tolist() == ["a"] * rows
    history = {"kind": "constant"}
    assert Load.history.check_column(history, rows, rod_in_row).tolist() == [history] * rows
    nullable = number(nullable=True)
    assert np.isnan(nullable.check_column(None, rows, rod_in_row)).all()
    assert np.isnan(nullable.check_column(np.full(rows, np.nan), rows, rod_in_row)).all()


@pytest.mark.parametrize("rows", [2, 100])
@pytest.mark.parametrize(
    ("field", "values"),
    [
        (number(), [1.0]),
        (number(), np.zeros((3, 1))),
        (number(shape=(2,)), [[5.0]]),
        (number(shape=(2,)), 5.0),
        (number(dtype=str), ["a"]),
        (number(), np.zeros(0)),
    ],
)
def test_nothing_is_stretched_silently(field: Field[Any], values: Any, rows: int) -> None:
    with pytest.raises(FieldError):
        field.check_column(values, rows, rod_in_row)


@pytest.mark.parametrize("rows", [3, 100])
@pytest.mark.parametrize("container", [list, np.array], ids=["list", "array"])
@pytest.mark.parametrize(
    ("field", "good", "bad"),
    [
        (number(), 1.0, math.nan),
        (number(), 1.0, math.inf),
        (number(), 1.0, "2"),
        (number(nullable=True, above=0.0), 1.0, -1.0),
        (number(nullable=True, above=0.0), 1.0, math.inf),
        (number(above=0.0), 1.0, 0.0),
        (number(minimum=0.0), 1.0, -1.0),
        (number(maximum=1.0), 1.0, 2.0),
        (number(dtype=int), 1, 2.5),
        (number(dtype=bool), True, "no"),
        (number(dtype="reference"), 1, -1),
        (number(dtype="reference"), 1, 2**32),
        (number(shape=(2,)), (1.0, 1.0), (1.0, math.nan)),
    ],
)
def test_the_first_bad_row_is_named(
    field: Field[Any], good: Any, bad: Any, container: Callable[[Any], Any], rows: int
) -> None:
    values = container([good] * (rows - 2) + [bad, bad])
    with pytest.raises(FieldError) as refusal:
        field.check_column(values, rows, rod_in_row)
    # An array of mixed types became texts as a whole, so that its first row is bad already.
    first = rows - 2 if container is list or values.dtype.kind != "U" else 0
    assert str(refusal.value).startswith(f"rod {first}: push ")


def test_what_only_looks_like_a_number_does_not_pass_in_a_column() -> None:
    with pytest.raises(FieldError, match="rod 19: push is nan"):
        number(nullable=True).check_column([None] * 19 + [math.nan], 20, rod_in_row)
    for values in ([1.0, True] * 10, ["1"] * 20, np.ones(20, dtype=bool), [1.0, None] * 10, [[1.0]] * 20):
        with pytest.raises(FieldError):
            number().check_column(values, 20, rod_in_row)


SCALARS = st.one_of(
    st.floats(),
    st.integers(-(2**70), 2**70),
    st.booleans(),
    st.none(),
    st.text(max_size=2),
    st.floats(width=32).map(np.float64),
)
NUMBER_FIELDS = st.builds(
    number,
    dtype=st.sampled_from([float, int, bool, str]),
    minimum=st.one_of(st.none(), st.just(0.0)),
    maximum=st.one_of(st.none(), st.just(1.0)),
    above=st.one_of(st.none(), st.just(-1.0)),
) | st.builds(number, nullable=st.just(True), above=st.one_of(st.none(), st.just(0.0)))


@given(NUMBER_FIELDS, st.lists(SCALARS, min_size=9, max_size=12))
def test_a_column_takes_what_its_values_are_allowed_one_by_one(field: Field[Any], values: list[Any]) -> None:
    expected: list[Any] | None
    try:
        expected = [field.check(value, f"rod {row}") for row, value in enumerate(values)]
        refusal = ""
    except FieldError as error:
        expected, refusal = None, str(error)
    if expected is None:
        with pytest.raises(FieldError) as caught:
            field.check_column(values, len(values), rod_in_row)
        assert str(caught.value) == refusal
    else:
        column = field.check_column(values, len(values), rod_in_row)
        assert [field.loaded(column, row) for row in range(len(column))] == expected
        assert column.dtype == field.storage


# --- storage -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("field", ALL_FIELDS)
def test_a_column_starts_as_the_default(field: Field[Any]) -> None:
    column = field.allocate(3)
    assert column.shape == (3, *field.shape)
    assert column.dtype == field.storage
    default = (
        (field.default,) * field.shape[0] if field.shape and np.ndim(field.default) == 0 else field.default
    )
    assert [field.loaded(column, row) for row in range(len(column))] == [default] * 3
    assert field.allocate(0).shape == (0, *field.shape)


def test_a_column_of_objects_holds_tuples_and_lists_as_they_are() -> None:
    field: Field[Any] = Field(title="curve", doc="Points.", dtype=object, default=(1, 2))
    assert field.allocate(3).tolist() == [(1, 2)] * 3
    assert field.check_column([(1, 2), [3]], 2, rod_in_row).tolist() == [(1, 2), [3]]


def test_none_needs_a_storage_that_can_hold_it() -> None:
    for options in ({"dtype": int}, {"dtype": bool}, {"dtype": "reference"}, {"shape": (2,)}):
        with pytest.raises(ValueError, match="push"):
            number(nullable=True, **options)


def test_columns_are_compared_bit_for_bit() -> None:
    assert same(np.array([math.nan, 1.0]), np.array([math.nan, 1.0]))
    assert not same(np.array([0.0]), np.array([-0.0]))
    assert same(np.array(["a", None], dtype=object), np.array(["a", None], dtype=object))
    assert not same(np.array(["a"], dtype=object), np.array(["b"], dtype=object))


# --- as an attribute -----------------------------------------------------------------------------------


def test_a_field_of_the_class_is_the_field_itself() -> None:
    assert isinstance(Rod.stiffness, Field)
    assert (Rod.stiffness.name, Rod.prescribed_rest_length.key) == ("stiffness", "rest_length")


def test_an_attribute_is_a_plain_value() -> None:
    model = triangle()
    a = model.particles["A"]
    a.force = np.array([1, 2])  # type: ignore[assignment]
    assert a.force == (1.0, 2.0)
    assert [type(part) for part in a.force] == [float, float]
    assert type(a.radius) is float
    assert a.fixed == (False, False)
    assert type(a.fixed[0]) is bool
    assert model.rods["AB"].between == (0, 1)
    assert a.prescribed_mass is None


def test_assigning_to_a_derived_field_overrides_it_and_none_goes_back() -> None:
    model = triangle()
    particle, rod = model.particles["B"], model.rods["AB"]
    lumped, distance = particle.mass, rod.rest_length
    particle.mass, rod.rest_length = 5, 2.0
    assert (particle.prescribed_mass, particle.mass) == (5.0, 5.0)
    assert (rod.prescribed_rest_length, rod.rest_length) == (2.0, 2.0)
    assert model.particles["A"].mass == 0.5 * 6.15 * (2.0 + 2.0)
    particle.mass = rod.rest_length = None
    assert (particle.prescribed_mass, particle.mass) == (None, lumped)
    assert rod.rest_length == distance


def test_an_override_is_checked_and_a_computed_field_cannot_be_set() -> None:
    model = triangle()
    with pytest.raises(FieldError, match=r"^particle A: mass is -1 kg; it must be greater than 0 kg\.$"):
        model.particles["A"].mass = -1.0
    with pytest.raises(FieldError, match=r"^rod AB: axial force is computed and cannot be set\.$"):
        model.rods["AB"].axial_force = 1.0
    assert model.particles["A"].prescribed_mass is None


def test_scripts_read_a_refusal_in_english_whatever_the_language() -> None:
    field: Field[float] = Field("kN", doc="How hard.", minimum=0.5)
    field.__set_name__(object, "push")
    with spoken("pt"), pytest.raises(FieldError) as refusal:
        field.check(-0.25, "rod AB")
    assert english(refusal.value) == "rod AB: push is -0.25 kN; it must be at least 0.5 kN."
    with spoken("pt"):
        assert "-0,25 kN" in str(refusal.value)


def test_a_misspelt_attribute_is_refused() -> None:
    said = "There is no 'froce' among the attributes of particles; did you mean 'force'"
    with pytest.raises(AttributeError, match=said):
        triangle().particles["A"].froce = (1.0, 0.0)  # type: ignore[attr-defined]
    with pytest.raises(AttributeError, match=said):
        _ = triangle().particles["A"].froce  # type: ignore[attr-defined]


def test_it_is_in_kinds_without_slots_too() -> None:
    class Bumper(Handle):
        table, noun = "bumpers", "bumper"
        name: Field[str] = Field(title="name", default="", dtype=str, doc="Its name.")
        size: Field[float] = Field("m", default=0.2, title="size", doc="How large it is.")

    world = World([Bumper])
    (bumper,) = world.create(Bumper, 1)
    with pytest.raises(AttributeError, match="did you mean 'size'"):
        bumper.sise = 0.3  # type: ignore[attr-defined]


# --- every Field of the program --------------------------------------------------------------------------


@pytest.mark.parametrize("field", ALL_FIELDS)
def test_every_field_is_explained(field: Field[Any]) -> None:
    assert field.title
    assert field.doc.endswith((".", "'"))
    measured = field.dtype is float and field.name not in PURE_RATIOS
    assert bool(field.unit) == measured
    assert bool(field.shown[0]) == measured
    if field.dtype is not float:
        assert (field.minimum, field.maximum, field.above) == (None, None, None) or field.references


@pytest.mark.parametrize("kind", KINDS)
def test_overrides_and_references_are_declared_on_both_sides(kind: type[Any]) -> None:
    by_name = {field.name: field for field in fields_of(kind)}
    tables = [kind.table for kind in KINDS]
    for field in by_name.values():
        if field.overrides is not None:
            derived = by_name[field.overrides]
            assert (derived.role, derived.overridden_by) == (Role.DERIVED, field.name)
            assert field.nullable
        if field.overridden_by is not None:
            assert by_name[field.overridden_by].overrides == field.name
        if field.references is not None:
            assert tables.index(field.references) < tables.index(kind.table)
    keys = [field.key for field in by_name.values() if field.role is not Role.DERIVED]
    assert len(keys) == len(set(keys))


@pytest.mark.parametrize("field", ALL_FIELDS)
def test_every_default_is_allowed(field: Field[Any]) -> None:
    if field.role is not Role.DERIVED:
        default = field.loaded(field.allocate(1), 0)
        assert field.check(default, "its default") == default
