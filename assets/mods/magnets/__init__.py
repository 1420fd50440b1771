"""Magnets: poles q that repel each other by k q₁ q₂ (1/r² − 1/c²), or attract if their signs differ, up to c = 1 m."""

from pinjoint.api import App, Component, Field, Law, Model, Particle, compiled


class Magnet(Component):
    of = Particle
    pole: Field[float] = Field(doc="Two of 1 would repel each other with 1 N at 1 m if they reached farther.")


@compiled
def force(apart, particles_magnets_pole):
    x, y = apart
    squared = x * x + y * y
    size = 0.001 * particles_magnets_pole[0] * particles_magnets_pole[1] * (1.0 / squared - 1.0) / squared**0.5
    return -size * x, -size * y


@compiled
def energy(apart, particles_magnets_pole):
    distance = (apart[0] * apart[0] + apart[1] * apart[1]) ** 0.5
    return 0.001 * particles_magnets_pole[0] * particles_magnets_pole[1] * (1.0 / distance + distance - 2.0)


class Force(Law):
    name, each = "magnets.force", "pairs"
    kernel, potential = force, energy
    reads = ("particles.magnets_pole",)

    def cutoff(self, model: Model) -> float:
        return 1.0

    def needs(self, model: Model) -> bool:
        return bool(model.particles.magnets_pole.any())


def plugin(app: App) -> None:
    app.component(Magnet)
    app.system(Force)
