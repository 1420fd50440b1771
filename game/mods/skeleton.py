"""The skeleton of a mod: a folder that works, with a test that passes, to begin with."""

from __future__ import annotations

from pathlib import Path

from pinjoint.components.mistake import reason_of
from pinjoint.mods.loading import origin_of_module
from pinjoint.mods.mod import MANIFEST, ModError, check_name

_FILES = {
    MANIFEST: """\
name = "{name}"
version = "0.1"
description = "A steady wind on all particles"
requires = ["pinjoint>={version}"]
""",
    "__init__.py": '''\
"""A steady wind on all particles: a law, the fact that it needs, and what a person sees of it."""

from pinjoint.api import Component, Environment, Field, Law, Readout, compiled


class Air(Component):
    of = Environment
    speed: Field[float] = Field("m/s", title="wind speed", doc="To the right; 0: no wind.")


@compiled
def push(particles_mass, particles_velocity, environment_{name}_speed):
    """Force (x, y) in kN on one particle."""
    return 0.001 * particles_mass * (environment_{name}_speed - particles_velocity[0]), 0.0


class Wind(Law):
    name = "{name}.wind"
    each = "particles"
    kernel = push
    reads = ("particles.mass", "particles.velocity", "environment.{name}_speed")

    def needs(self, model):
        return model.environment.{name}_speed != 0.0


def plugin(app):
    app.component(Air)
    app.system(Wind)
    app.panel(lambda s: Readout("{name}", (("speed", f"{{s.environment.{name}_speed:g}} m/s"),)))
''',
    "test_{name}.py": '''\
"""Run by: pytest {name}"""

from pathlib import Path

from pinjoint.api import Session

HERE = Path(__file__).parent


def test_the_wind_blows_to_the_right():
    document = {{"format": "pinjoint model", "version": 1, "particles": [{{"name": "A", "position": [0, 0]}}]}}
    session = Session.open(document, mods=[HERE])
    session.environment.{name}_speed = 10.0
    session.run(time=0.1)
    # 1 kg with the force m (u − v): v = u (1 − exp(−t))
    assert abs(session.particles["A"].velocity[0] - 0.95162582) < 1e-6
''',
}


def write_skeleton(name: str, parent: Path, version: str) -> list[Path]:
    """Write a new mod into a folder of its name; returns its files. Raises ModError."""
    check_name(name)
    folder = parent / name
    if not folder.exists() and origin_of_module(name) is not None:
        raise ModError("There is a Python module '{name}' already; give the mod another name.", name=name)
    try:
        folder.mkdir(parents=True)
        paths = []
        for pattern, text in _FILES.items():
            paths.append(folder / pattern.format(name=name))
            paths[-1].write_text(text.format(name=name, version=version), encoding="utf-8")
    except FileExistsError:
        raise ModError("{folder} exists already; choose another name.", folder=folder) from None
    except OSError as error:
        raise ModError(
            "{folder} cannot be written: {reason}. Choose another folder with --into.",
            folder=folder,
            reason=reason_of(error),
        ) from None
    return paths
