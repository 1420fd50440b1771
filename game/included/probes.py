"""Probes: quantities sampled while time passes, drawn live as plots and written as CSV and PNG."""

from __future__ import annotations

import weakref
from array import array
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pinjoint.components import Model, Particle, Plot, Readout, Rod, Vector, written
from pinjoint.components.field import ENDS, Role
from pinjoint.components.language import english, joined, listed, marked, tr
from pinjoint.components.theory import EXACT
from pinjoint.documents.models import replace
from pinjoint.mods import App
from pinjoint.paths import FACTOR, TIME, Quantity, quantity
from pinjoint.systems.base import Phase, System
from pinjoint.systems.edit import Refusal, saving

if TYPE_CHECKING:  # a command needs no editor
    from pinjoint.editor.context import Context

MOST = 20_000  # samples; beyond, every second one is dropped
FEW = 3  # plots at a time
_PAST = 300  # samples of the run before a plot was opened
FARTHER = 2.0  # times the largest load step: where a plotted curve ends
MOST_RODS = 300  # of a structure of which a curve is plotted at once
PARTS = 24  # of each load step of statics, at which a plot has points
ENERGIES = {  # by path, as legends name them
    "energy.kinetic": marked("kinetic"),
    "energy.elastic": marked("elastic"),
    "energy.dissipated_damping": marked("damping"),
    "energy.dissipated_plastic": marked("yielding"),
}
_OF_ROD = (("axial_force", TIME), ("axial_force", "strain"))
_OF_BENDING_ROD = (*((f"bending_moment.{end}", TIME) for end in ENDS), ("shear.start", TIME))
_OF_PARTICLE = (
    ("displacement.x", TIME),
    ("displacement.y", TIME),
    ("velocity.x", "displacement.x"),
    ("velocity.y", "displacement.y"),
)

ICON = (
    ("line", (-8, -8.5, -8, 8, 8.5, 8)),
    ("line", (-7, 5, -4.5, -1, -2, -5, 0.5, -4, 2.5, 0, 4.5, 2.5, 8, 1)),
)


@dataclass
class Probe:
    """Quantities sampled against another one; samples: the time, `against` and all of `read`, one after the other."""

    against: Quantity
    read: tuple[Quantity, ...]
    samples: array[float] = field(default_factory=lambda: array("d"))
    revision: int = 0
    solved: int = -1  # the revision of statics of which the samples are

    @property
    def of_statics(self) -> bool:
        """True if it is sampled on the way to the solution of statics, not in time."""
        return self.against.path == FACTOR

    @property
    def key(self) -> tuple[str, ...]:
        """The paths that the probe samples; probes with the same key are the same."""
        return (self.against.path, *(quantity.path for quantity in self.read))

    @property
    def table(self) -> np.ndarray[Any, np.dtype[np.float64]]:
        """The samples, shape (k, 2 + quantities): time (s), `against`, and each of `read`."""
        return np.array(self.samples).reshape(-1, 2 + len(self.read))

    @property
    def time(self) -> float | None:
        """The time of the last sample (s)."""
        return self.samples[-2 - len(self.read)] if self.samples else None

    def sample(self, session: Context, time: float) -> None:
        """Take one sample; samples at this time or later are dropped first (time was taken back)."""
        width = 2 + len(self.read)
        while self.samples and self.samples[-width] >= time:
            del self.samples[-width:]
        self.samples.extend([time, self.against.read(session), *(q.read(session) for q in self.read)])
        if len(self.samples) > MOST * width:
            self.samples = array("d", self.table[::2].ravel())
        self.revision += 1

    def plot(self, span: float) -> Plot:
        """A plot of the last part of the samples; span: its share of the whole time."""
        table = self.table
        if len(table):
            begin = table[-1, 0] - span * (table[-1, 0] - table[0, 0])
            table = table[table[:, 0] >= begin]
        curves = tuple((_short(q), table[:, 1], table[:, 2 + index]) for index, q in enumerate(self.read))
        units = ", ".join(dict.fromkeys(q.unit for q in self.read))
        title = tr(self.read[0].title) if len(self.read) == 1 else units
        return Plot(tr(self.against.title), title, curves, hash((self.revision, span)))


def _short(read: Quantity) -> str:
    """A name for the legend of a plot."""
    return tr(ENERGIES.get(read.path, read.name))


@dataclass(eq=False)
class Probes:
    """The probes of one session, newest last; span: the share of the time that plots show."""

    all: list[Probe] = field(default_factory=list)
    curve: tuple[int, Plot] | None = None  # the newest edit that it knows, and load against displacement
    span: float = 1.0
    model: weakref.ref[Model] | None = None

    def add(self, session: Context, paths: Iterable[str], against: str = TIME) -> Probe:
        """Sample these quantities of the run so far, and from now on. Raises PathError.

        The oldest of more than FEW probes is dropped.
        """
        model = session.model
        probe = Probe(quantity(model, against), tuple(quantity(model, path) for path in paths))
        self.model = weakref.ref(model)
        self.all = [*self.all, probe][-FEW:]
        for _ in session.document.timeline.revisited(_PAST) if model.solution is None else ():
            session.simulation.observe()
            probe.sample(session, session.time)
        return probe

    def of(self, session: Context) -> list[Probe]:
        """Those of what is shown: of statics, or in time."""
        solved = session.model.solution is not None
        return [probe for probe in self.all if probe.of_statics == solved]

    def sample(self, session: Context) -> None:
        """Take a sample of every probe for which time has passed; in statics, of the way to a new solution."""
        if session.model.solution is not None:
            self._sample_statics(session)
            return
        behind = [probe for probe in self.of(session) if probe.time != session.time]
        if behind and session.simulation.programs.ready:
            session.simulation.observe()
            for probe in behind:
                probe.sample(session, session.time)

    def _sample_statics(self, session: Context) -> None:
        statics = session.document.statics
        if statics.settlement is None or statics.is_late or session.gesture is not None:  # a drag goes on
            return
        behind = [probe for probe in self.of(session) if probe.solved != statics.revision]
        way = statics.on_the_way(PARTS) if behind else None
        if way is None:
            return
        for number, _ in enumerate(way):
            for probe in behind:
                probe.sample(session, float(number))
        for probe in behind:
            probe.solved = statics.revision


_probes: weakref.WeakKeyDictionary[Context, Probes] = weakref.WeakKeyDictionary()


def probes_of(session: Context) -> Probes:
    """The probes of a session, all of them of the model that is open."""
    probes = _probes.setdefault(session, Probes())
    if probes.model is None or probes.model() is not session.model:
        probes.all, probes.curve = [], None
    return probes


class Sampling(System):
    """Samples the probes once a frame."""

    name = "probes.sampling"
    phase = Phase.EVENTS
    reads = ("document", "state")
    writes = ("probes",)
    headless = False
    scenes = ("simulation", "pause", "statics")

    def process(self, frame: Any) -> None:
        probes_of(frame.session).sample(frame.session)


def choices(session: Context) -> list[tuple[tuple[str, ...], str]]:
    """(paths, path against which) of the plots that suit the selection; the energies if nothing is selected.

    In statics those against the load factor, none if nothing is selected.
    """
    found: list[tuple[tuple[str, ...], str]] = []
    for handle in session.selected[-1:]:
        pairs = _OF_ROD if isinstance(handle, Rod) else _OF_PARTICLE if isinstance(handle, Particle) else ()
        if isinstance(handle, Rod) and handle.bending_stiffness:
            pairs = (*_OF_BENDING_ROD, *pairs)
        if isinstance(handle, Particle) and handle.inertia:
            pairs = (*pairs, ("rotation", TIME))
        start = f"{handle.table}.{getattr(handle, 'name', '')}."
        found = [((start + y,), x if x == TIME else start + x) for y, x in pairs]
    if session.model.solution is None:
        return found or [(tuple(ENERGIES), TIME)]
    return [(paths, FACTOR) for paths, against in found if against == TIME]


def _plot_next(session: Context, pixel: Vector) -> None:
    """Plot the first quantity of the selection, then the next; after the last one, none."""
    probes = probes_of(session)
    offered = choices(session)
    if not offered:
        raise Refusal("Select a particle or a rod first; then O plots it against the load factor.")
    keys = [(against, *paths) for paths, against in offered]
    shown = [keys.index(probe.key) for probe in probes.all if probe.key in keys]
    probes.all = [probe for probe in probes.all if probe.key not in keys]
    following = shown[-1] + 1 if shown else 0
    if following == len(offered):
        session.notice = tr("The plots of the selection are closed.")
        return
    paths, against = offered[following]
    probe = probes.add(session, paths, against)
    probes.sample(session)
    title = tr(probe.read[0].title) if len(paths) == 1 else tr("energies")
    session.notice = tr(
        "Plot: {quantity} against {other}. O shows the next.", quantity=title, other=tr(probe.against.title)
    )


def _plot_curve(session: Context, pixel: Vector) -> None:
    """Plot load against displacement, through limit points, of the selected particle, else of what moves most; or close."""
    from pinjoint.curves import plot  # they import scipy
    from pinjoint.systems.statics.path import Curve, Goal

    probes, model = probes_of(session), session.model
    names = [f"{one.name}.{axis}" for one in session.selected for axis in "xy" if isinstance(one, Particle)]
    if model.rods.count > MOST_RODS:
        raise Refusal(
            "This takes long for more than {count} rods; use the command: pinjoint curve", count=MOST_RODS
        )
    held = {f"{one.name}.{axis}" for one in model.particles for at, axis in enumerate("xy") if one.fixed[at]}
    try:
        goal = Goal.of(model, FARTHER * (max(model.settings.load_steps, key=abs) or 1.0))
        curve = Curve.of(model, goal, theory=EXACT if model.solution is None else model.settings.theory)
    except ValueError as error:  # such as a model without loads
        session.notice = str(error)
        return
    drawn = plot(model, curve, [name for name in names if name not in held])
    shown = probes.curve is not None and probes.curve[1].x_title == drawn.x_title
    probes.model = weakref.ref(model)
    probes.curve = None if shown else (model.newest(Role.DOCUMENT), drawn)


def zoom(factor: float, session: Context) -> None:
    """Show a shorter or longer part of the time."""
    probes = probes_of(session)
    probes.span = min(max(probes.span * factor, 1.0 / 1024.0), 1.0)
    session.notice = tr("Plots show the last {share} of the time.", share=written.share(probes.span))


def save(session: Context, pixel: Vector) -> None:
    """Write every plot as CSV and PNG into the working folder."""
    shown = probes_of(session).of(session)
    paths = [Path.cwd() / f"pinjoint-plot-{number}.csv" for number, _ in enumerate(shown, 1)]
    with saving():
        for probe, path in zip(shown, paths, strict=True):
            _write_csv(probe, path)
            _write_png(probe, path.with_suffix(".png"), session.view.theme)
    names = listed([path.stem for path in paths])
    session.notice = (
        tr("Saved as CSV and PNG: {names}", names=names)
        if paths
        else tr("There is no plot to save; O makes one.")
    )


def _write_csv(probe: Probe, path: Path) -> None:
    """Write one sample a line: the time and the quantities, in the units of the headings."""
    against = [] if probe.against.path == TIME else [1]
    titles = [*([probe.against.title] if against else []), *(read.title for read in probe.read)]
    timed = [] if probe.of_statics else [0]
    heads = [*["time (s)" for _ in timed], *map(english, titles)]
    samples = probe.table[:, [*timed, *against, *range(2, 2 + len(probe.read))]].tolist()
    replace(path, written.as_csv([heads, *samples]).encode())


def _write_png(probe: Probe, path: Path, theme: str = "light") -> None:
    """Write the whole plot as a picture."""
    from pinjoint.pictures import plot_picture  # pygame is there when it is needed

    plot_picture(probe.plot(1.0), path, theme)


def panels(session: Context) -> Sequence[Readout]:
    """Each probe as a panel with its plot."""
    probes = probes_of(session)
    shown = [
        Readout(_heading(probe), (), probe.plot(1.0 if probe.of_statics else probes.span), "probes.close")
        for probe in probes.of(session)
    ]
    if probes.curve is not None and probes.curve[0] == session.model.newest(Role.DOCUMENT):
        shown.append(Readout(tr("Load–displacement curve"), (), probes.curve[1], "probes.close"))
    return shown


def close(session: Context, pixel: Vector) -> None:
    """Take away the plot whose panel was pressed."""
    probes, pressed = probes_of(session), session.view.pressed
    closed = _names(pressed.item) if pressed is not None else ()
    if probes.curve is not None and closed[1:2] == (probes.curve[1].x_title,):
        probes.curve = None
    shown = zip(probes.of(session), panels(session), strict=False)
    gone = [probe for probe, readout in shown if _names(readout) == closed]
    probes.all = [probe for probe in probes.all if probe not in gone]


def _names(readout: Readout) -> tuple[str, ...]:
    """What tells the plots of a session apart."""
    return (readout.title, readout.plot.x_title, readout.plot.y_title) if readout.plot is not None else ()


def _heading(probe: Probe) -> str:
    energies = all(read.path.startswith("energy.") for read in probe.read)
    if energies:
        return tr("Energies")
    return tr("Plot of {quantities}", quantities=joined(map(_short, probe.read), ", "))


def run(words: list[str]) -> int:
    """`pinjoint plot MODEL --of QUANTITY --until T --output FILE`."""
    from pinjoint.commands.arguments import Parser, UsageError, count, option, positive
    from pinjoint.commands.options import add_model, add_steps, headless_of
    from pinjoint.commands.output import writable, writing

    parser = Parser("plot", "Run a model and write quantities against time or another quantity.")
    add_model(parser)
    add_steps(parser)
    option(parser, "--of PATH", "such as rods.AB.axial_force", action="append", required=True)
    option(parser, "--against PATH", "default: time", default=TIME)
    option(parser, "--until T", "simulated time (s)", positive, required=True)
    option(parser, "--samples N", "at least; default 500", count, default=500)
    option(parser, "--output FILE", ".csv or .png", writable, required=True)
    options = parser.parse_args(words)
    session = headless_of(options)
    probe = probes_of(session).add(session, options.of, options.against)
    output = Path(options.output)
    if output.suffix not in (".csv", ".png"):
        raise UsageError(
            "{file}: choose a file that ends with one of {endings}.",
            file=f"--output {output}",
            endings=".csv, .png",
        )
    record(session, probe, options.until, options.samples)
    with writing(output):
        (_write_png if output.suffix == ".png" else _write_csv)(probe, output)
    return 0


def record(session: Context, probe: Probe, until: float, samples: int) -> None:
    """Run to a time (s), reading at evenly spaced times. Ends early at rest."""
    simulation = session.simulation
    simulation.advance(0)
    for number in range(samples):
        simulation.run_to(until * number / (samples - 1))
        simulation.observe()
        probe.sample(session, session.time)
        if simulation.halted:
            return


def plugin(app: App) -> None:
    """Register the system, its keys, the panels and the command."""
    app.system(Sampling)
    app.panel(panels)
    app.command("plot", run, marked("write or draw what a run does, against time or other"))
    live = ("simulation", "pause", "statics")
    app.action("probes.plot", key="o", scenes=live, title=marked("plot the selection"), icon=ICON)(_plot_next)
    app.action("probes.curve", key="ctrl+u", scenes=live[1:], title=marked("plot load against displacement"))(
        _plot_curve
    )
    app.action("probes.save", key="ctrl+e", scenes=live, title=marked("save plots as CSV and PNG"))(save)
    app.action("probes.close", while_drawing=True)(close)
    for name, key, factor, title in (
        ("longer", "[", 2.0, marked("show a longer time in plots")),
        ("shorter", "]", 0.5, marked("show a shorter time in plots")),
    ):
        app.action(f"probes.{name}", key=key, scenes=live[:2], title=title, while_drawing=True)(
            lambda session, pixel, factor=factor: zoom(factor, session)  # type: ignore[misc]
        )
