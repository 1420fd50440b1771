"""A model dict read into plain objects: every default filled in, every name resolved.

Shared by the oracles of this folder, so that they differ in mechanics only. Units: m, kg, s, kN, kN·s/m.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

Vector = tuple[float, float]
Document = dict[str, Any]
Model = Document
DEFAULTS = {"ramp": {"start": 0.0, "duration": 1.0}, "pulse": {"start": 0.0, "duration": 1.0}}
DEFAULTS["sine"] = {"frequency": 1.0, "phase": 0.0}
VALUES = {"table": "factors", "record": "accelerations"}  # of histories that are linear between points


@dataclass(frozen=True)
class Particle:
    """A lumped mass; `displacement` is measured from `position`, the original position."""

    name: str
    position: Vector  # m
    displacement: Vector  # m
    velocity: Vector  # m/s
    fixed: tuple[bool, bool]
    force: Vector  # kN
    acceleration: Vector  # m/s²
    mass: float  # kg
    radius: float  # m


@dataclass(frozen=True)
class Rod:
    """An axial member between the particles number `start` and `end`."""

    name: str
    start: int
    end: int
    span: Vector  # m, from the original position of `start` to that of `end`
    stiffness: float  # EA, kN
    rest_length: float  # m
    free_length: float  # m, at its temperature
    tensile_strength: float  # kN, infinite when unlimited
    compressive_strength: float  # kN, positive, infinite when unlimited
    damping: float  # kN·s/m
    density: float  # kg/m
    plastic_strain: float
    tension_only: bool


@dataclass(frozen=True)
class Load:
    """A force on the particle number `particle`, times the factor of its history."""

    particle: int
    force: Vector  # kN
    history: Document

    def factor(self, time: float) -> float:
        """Return what the force is multiplied by at a time; infinite: in the end, 0 of a vibration."""
        h = self.history
        if h["kind"] == "constant":
            return 1.0
        if h["kind"] == "sine":
            return math.sin(2 * math.pi * h["frequency"] * time + h["phase"]) if time < math.inf else 0.0
        if h["kind"] in VALUES:
            last = 0.0 if h["kind"] == "record" and time == math.inf else h[VALUES[h["kind"]]][-1]
            return float(np.interp(time, h["times"], h[VALUES[h["kind"]]], right=last))
        start, end = self.kinks()
        if h["kind"] == "pulse":
            return 1.0 if start <= time < end else 0.0
        if time < start:
            return 0.0
        return 1.0 if time >= end else (time - start) / h["duration"]

    def kinks(self) -> list[float]:
        """Return the times of jumps and kinks."""
        h = self.history
        if h["kind"] in ("ramp", "pulse"):
            return [h["start"], h["start"] + h["duration"]]
        return list(h["times"]) if h["kind"] in VALUES else []

    def breaks(self) -> list[float]:
        """Return the times of jumps and kinks, and those just before, where a step ends early."""
        return [side for kink in self.kinks() for side in (math.nextafter(kink, -math.inf), kink)]


@dataclass(frozen=True)
class Wall:
    """A straight line on which discs bounce; its restitution None: that of the model."""

    start: Vector  # m
    end: Vector  # m
    restitution: float | None


@dataclass(frozen=True)
class Elements:
    """All elements of one model, in the model's order."""

    particles: list[Particle]
    rods: list[Rod]
    loads: list[Load]
    walls: list[Wall]
    environment_force: Vector  # kN on every particle
    environment_acceleration: Vector  # m/s²
    drag: float  # 1/s
    restitution: float
    collisions: bool
    time: float  # s


def read(model: Model) -> Elements:
    """Read a model dict (format "pinjoint model", version 1) with the defaults of the format."""
    settings = model.get("settings", {})
    environment = model.get("environment", {})
    documents = model.get("particles", [])
    number = {document["name"]: index for index, document in enumerate(documents)}
    yielding = settings.get("plasticity", True)
    rods = [_read_rod(document, documents, number, yielding) for document in model.get("rods", [])]
    return Elements(
        particles=[_read_particle(document, index, rods) for index, document in enumerate(documents)],
        rods=rods,
        loads=[_read_load(document, number) for document in model.get("loads", [])],
        walls=[
            Wall(_vector(wall, "start"), _vector(wall, "end"), wall.get("restitution"))
            for wall in model.get("components", {}).get("walls.Wall", [])
        ],
        environment_force=_vector(environment, "force"),
        environment_acceleration=_vector(environment, "acceleration"),
        drag=float(environment.get("drag", 0.0)),
        restitution=float(settings.get("restitution", 1.0)),
        collisions=settings.get("collisions", True),
        time=float(model.get("state", {}).get("time", 0.0)),
    )


def _read_particle(document: Document, index: int, rods: list[Rod]) -> Particle:
    fixed_x, fixed_y = document.get("fixed", (False, False))
    velocity_x, velocity_y = _vector(document, "velocity")
    mass = document.get("mass")
    if mass is None:
        attached = [rod for rod in rods if index in (rod.start, rod.end)]
        mass = sum(rod.density * rod.rest_length / 2 for rod in attached) if attached else 1.0
    if mass <= 0 and not (fixed_x and fixed_y):
        raise ValueError(
            f"Particle {document['name']} is free but has the mass {mass} kg; give it a mass above 0."
        )
    return Particle(
        name=document["name"],
        position=_vector(document, "position"),
        displacement=_vector(document, "displacement"),
        velocity=(0.0 if fixed_x else velocity_x, 0.0 if fixed_y else velocity_y),
        fixed=(bool(fixed_x), bool(fixed_y)),
        force=_vector(document, "force"),
        acceleration=_vector(document, "acceleration"),
        mass=float(mass),
        radius=float(document.get("radius", 0.05)),
    )


def _read_rod(document: Document, particles: list[Document], number: dict[str, int], yielding: bool) -> Rod:
    start, end = (number[name] for name in document["between"])
    (x1, y1), (x2, y2) = (_vector(particles[index], "position") for index in (start, end))
    span = (x2 - x1, y2 - y1)
    prescribed = document.get("rest_length")
    rest_length = math.hypot(*span) if prescribed is None else float(prescribed)
    thermal_strain = document.get("thermal_expansion", 1.2e-5) * document.get("temperature_change", 0.0)
    return Rod(
        name=document["name"],
        start=start,
        end=end,
        span=span,
        stiffness=float(document.get("stiffness", 164640.0)),
        rest_length=rest_length,
        free_length=rest_length * (1 + thermal_strain),
        tensile_strength=_strength(document.get("tensile_strength"), yielding),
        compressive_strength=_strength(document.get("compressive_strength"), yielding),
        damping=float(document.get("damping", 100.0)),
        density=float(document.get("density", 6.15)),
        plastic_strain=float(document.get("plastic_strain", 0.0)),
        tension_only=bool(document.get("tension_only", False)),
    )


def _read_load(document: Document, number: dict[str, int]) -> Load:
    history = document.get("history", {"kind": "constant"})
    full = DEFAULTS.get(history["kind"], {}) | history
    return Load(particle=number[document["on"]], force=_vector(document, "force"), history=full)


def _strength(value: float | None, yielding: bool) -> float:
    """Return the strength in kN; null, 0 and plasticity switched off mean unlimited."""
    return float(value) if value and yielding else math.inf


def _vector(document: Document, key: str) -> Vector:
    x, y = document.get(key, (0.0, 0.0))
    return float(x), float(y)
