"""Reports of runs: the states at the times that were asked for."""

from pinjoint import Session
from pinjoint.commands.reports.report import Analysis
from tests.reference.models import triangle

DAMPED = triangle(damping=100, density=6.15)


def test_states_are_reported_at_exactly_the_times_asked_for() -> None:
    times = (0.0, 1e-4, 3e-4, 0.3, 0.7)
    run = Analysis(times=times).run(Session.open(DAMPED).simulation, "triangle")
    assert run["status"] == "time reached"
    assert [made["time"] for made in run["states"]] == list(times)
    forces = [made["rods"]["AB"]["axial_force"] for made in run["states"]]
    assert forces[0] == 0.0
    assert forces[1] != forces[2] != forces[3]
    assert forces[3] == forces[4]  # at rest before 0.3 s; from then on time passes without steps


def test_a_report_on_the_way_does_not_change_the_run() -> None:
    direct = Analysis(times=(3e-4,)).run(Session.open(DAMPED).simulation, "triangle")
    reported = Analysis(times=(1.2345e-4, 3e-4)).run(Session.open(DAMPED).simulation, "triangle")
    assert reported["states"][-1] == direct["states"][-1]
