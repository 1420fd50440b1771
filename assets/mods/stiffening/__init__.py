"""Stiffening: rods whose axial force is N = EA (ε + β ε³), β being a fact of each rod."""

from __future__ import annotations

from pinjoint.api import App, Component, Field, Law, Model, Rod, compiled


class Material(Component):
    of = Rod
    cubic: Field[float] = Field(title="cubic stiffness", minimum=0.0, doc="β in N = EA (ε + β ε³).")


@compiled
def cubic(elongation, rods_rest_length, rods_stiffness, rods_stiffening_cubic):
    """What comes on top of EA ε (kN)."""
    strain = elongation / rods_rest_length
    return rods_stiffness * rods_stiffening_cubic * strain * strain * strain


class Cubic(Law):
    name = "stiffening.cubic"
    kernel = cubic
    reads = ("rods.rest_length", "rods.stiffness", "rods.stiffening_cubic")
    adds = ("rods.axial_force",)

    def needs(self, model: Model) -> bool:
        return bool(model.rods.stiffening_cubic.any())


def plugin(app: App) -> None:
    app.component(Material)
    app.system(Cubic)
