"""Readouts beside the model: theory of the selected elements and the worst of all, and the energy account."""

import pytest

from pinjoint import Session
from tests.benchmarks.models import lattice


def shown(session: Session) -> dict[str, dict[str, str]]:
    session.update_view()
    return {readout.title: dict(readout.rows) for readout in session.view.readouts}


def test_theory_stands_beside_the_selected_rod() -> None:
    session = Session.open("hyperstatic_yield")
    session.run(until="rest")
    session.select(session.rods["AB"])
    assert shown(session) == {}
    session.press("m")
    rows = shown(session)["Axial force of rod AB"]
    assert rows["exact theory"] == "45.22 kN"
    (run,) = [value for title, value in rows.items() if title.startswith("the run, error")]
    (linear,) = [value for title, value in rows.items() if title.startswith("linear theory, error 8.5")]
    assert (run, linear) == ("45.22 kN", "26.92 kN")
    session.press("m")
    assert shown(session) == {}


def test_displacements_and_reactions_of_a_particle_and_the_worst_of_all() -> None:
    session = Session.open("isostatic")
    session.run(until="rest")
    session.select(session.particles["A"])
    session.press("m")
    readouts = shown(session)
    assert readouts["Displacement x of particle A"]["exact theory"] == "−0.02438 cm"
    assert readouts["Reaction y of particle A"]["exact theory"] == "20.01 kN"
    assert (
        readouts["Theory beside the run"]["largest error of linear theory"]
        == "0.13 % (displacement y of particle B)"
    )


@pytest.mark.parametrize(
    ("name", "title", "said"),
    [
        ("isostatic_collapse", "exact theory", "collapse at 86.9 % of the load"),
        ("pendulum", "linear theory", "no solution: this is a mechanism"),
        ("braced_portal", "linear theory", "cannot be used: there are cables"),
        ("snap_through", "snap-through", "at 2.54 % of the load"),
    ],
)
def test_what_theory_cannot_answer_is_said(name: str, title: str, said: str) -> None:
    session = Session.open(name)
    session.press("m")
    assert shown(session)["Theory beside the run"][title] == said


@pytest.mark.parametrize(
    ("name", "numbers", "rank"),
    [
        ("isostatic", "3 + 3 − 2·3 = 0", None),
        ("hyperstatic", "6 + 3 − 2·4 = 1", None),
        ("pendulum", "1 + 2 − 2·2 = −1", "no state of self-stress, one mechanism"),
    ],
)
def test_the_degree_is_told_with_its_formula_and_the_rank_where_it_differs(
    name: str, numbers: str, rank: str | None
) -> None:
    session = Session.open(name)
    session.press("m")
    rows = shown(session)["Theory beside the run"]
    assert rows["g = m + r − 2n"] == numbers
    assert rows.get("by matrix rank") == rank


@pytest.mark.parametrize(
    ("name", "title", "said"),
    [
        ("isostatic", "at rest", "as static theory predicts"),
        ("overshoot_yield", "differs from static theory", "yielded in the overshoot"),
    ],
)
def test_at_rest_the_verdict_comes_before_the_errors(name: str, title: str, said: str) -> None:
    session = Session.open(name)
    session.press("m")
    assert title not in shown(session)["Theory beside the run"]
    session.run(until="rest")
    assert next(iter(shown(session)["Theory beside the run"].items())) == (title, said)


def test_theory_follows_edits_and_says_when_it_does_not_know_the_history() -> None:
    session = Session.open("isostatic")
    session.press("m")
    session.select(session.rods["CA"])
    before = shown(session)["Axial force of rod CA"]["exact theory"]
    session.particles["B"].force = (0, -160)
    assert shown(session)["Axial force of rod CA"]["exact theory"] != before
    session.run(steps=10)
    session.particles["B"].force = (0, -100)
    assert shown(session)["Theory beside the run"]["edited during the run"] == "theory leaves this out"
    assert [session.undo() for _ in range(2)] == ["load of particle B", "run"]
    assert [session.redo() for _ in range(2)] == ["run", "load of particle B"]
    assert shown(session)["Theory beside the run"]["edited during the run"] == "theory leaves this out"


def test_a_run_taken_back_and_repeated_is_not_called_edited() -> None:
    session = Session.open("isostatic")
    session.press("m")
    session.particles["B"].force = (0, -160)
    assert "edited during the run" not in shown(session)["Theory beside the run"]
    session.run(steps=10)
    session.undo()
    assert "edited during the run" not in shown(session)["Theory beside the run"]
    session.redo()
    assert session.model.clock.steps == 10
    assert "edited during the run" not in shown(session)["Theory beside the run"]


def test_what_was_settled_is_not_called_edited() -> None:
    session = Session.open("hyperstatic_yield")
    session.press("m")
    session.run(time=0.2)
    session.press("e")
    assert shown(session)["Theory beside the run"]["settled during the run"] == "theory leaves this out"
    session.press("r")
    session.press("e")
    assert not any("during the run" in title for title in shown(session)["Theory beside the run"])


def test_without_rods_or_with_very_many_it_says_so() -> None:
    session = Session.open("collision_i")
    session.press("m")
    assert shown(session)["Theory beside the run"] == {"There are no rods to compare.": ""}
    large = Session(lattice(3000))
    large.press("m")
    assert shown(large)["Theory beside the run"] == {"more than 2000 rods: use": "pinjoint verify"}


def test_numbers_that_cannot_be_computed_with_do_not_stop_the_picture() -> None:
    session = Session.open("isostatic")
    session.particles["B"].displacement = (1e300, 0.0)
    session.press("m")
    assert shown(session)["Theory beside the run"] == {"numbers too large or too small": ""}


def test_the_energy_account_on_demand() -> None:
    session = Session.open("overshoot_yield")
    session.run(until="rest")
    session.press("j")
    rows = shown(session)["Energy account"]
    assert rows["work of the loads"] == "264.6 J"
    assert session.energy.kinetic != 0.0
    assert rows["kinetic"] == "0 J", "less than anybody sees beside the rest"
    assert float(rows["dissipated by yielding"].removesuffix(" J")) > 0.0
    assert "numerical imbalance" in rows
