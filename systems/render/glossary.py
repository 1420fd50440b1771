"""Glossary: the terms of the program beside those of courses, each explained in plain sentences."""

from __future__ import annotations

import unicodedata

from components.language import marked, tr

# Term, what else it is called, and what it means.
TERMS: tuple[tuple[str, str, str], ...] = (
    (
        marked("particle"),
        marked("node, joint"),
        marked("A point with mass. Rods meet at particles; supports and loads act on them."),
    ),
    (
        marked("rod"),
        marked("bar, member"),
        marked(
            "A straight piece between two particles. In a truss it carries axial force only, in a frame it bends too."
        ),
    ),
    (
        marked("truss"),
        marked("pin-jointed structure"),
        marked("Rods that are joined by hinges, so that they carry axial force only."),
    ),
    (
        marked("frame"),
        "",
        marked("Rods with rigid joints: the angle between them stays the same, and they bend."),
    ),
    (
        marked("support"),
        "",
        marked(
            "Holds a particle: a pin in x and y, a roller in one direction; a clamp also stops it from turning."
        ),
    ),
    (marked("reaction"), marked("support force"), marked("The force with which a support holds a particle.")),
    (marked("hinge"), "", marked("A joint that lets the end of a rod turn. The bending moment there is zero.")),
    (
        marked("axial force"),
        marked("normal force N"),
        marked("The force along a rod: positive in tension, negative in compression."),
    ),
    (marked("tension"), "", marked("A force that pulls a rod and makes it longer. It is drawn in red.")),
    (marked("compression"), "", marked("A force that pushes a rod and makes it shorter. It is drawn in blue.")),
    (
        marked("bending moment"),
        marked("M"),
        marked("The moment inside a rod that bends it. It is drawn on the side that is in tension."),
    ),
    (marked("shear force"), marked("V"), marked("The force inside a rod that acts across its axis.")),
    (
        marked("distributed load"),
        "",
        marked("A load that is spread along a rod, in kN for each metre."),
    ),
    (
        marked("free-body diagram"),
        "",
        marked("A part of the structure that is cut free, with all the forces that act on it."),
    ),
    (
        marked("statically determinate"),
        marked("isostatic"),
        marked("Equilibrium alone gives all forces: there are as many equations as unknown forces."),
    ),
    (
        marked("statically indeterminate"),
        marked("hyperstatic"),
        marked(
            "There are more unknown forces than equations of equilibrium. The stiffness of the rods decides, too."
        ),
    ),
    (
        marked("degree of static indeterminacy"),
        marked("degree of hyperstaticity"),
        marked("How many more unknown forces there are than equations of equilibrium."),
    ),
    (
        marked("force method"),
        marked("flexibility method"),
        marked(
            "Solves a statically indeterminate structure: release the redundants, then find the forces that close the gaps."
        ),
    ),
    (
        marked("redundant"),
        marked("hyperstatic unknown X₁"),
        marked(
            "A force that equilibrium alone does not give. The force method releases it and finds it from compatibility."
        ),
    ),
    (
        marked("released structure"),
        marked("primary structure"),
        marked("The structure without its redundants. It is statically determinate."),
    ),
    (
        marked("compatibility equation"),
        "",
        marked("δ₁₀ + δ₁₁ X₁ = 0: the released parts fit together again."),
    ),
    (
        marked("flexibility coefficient"),
        marked("δ₁₁"),
        marked("The displacement at the release that is caused by X₁ = 1."),
    ),
    (
        marked("mechanism"),
        "",
        marked(
            "A structure that can move without any rod changing its length. It needs another rod or support."
        ),
    ),
    (marked("at rest"), "", marked("Nothing moves: the forces on every particle are in equilibrium.")),
    (
        marked("find equilibrium"),
        marked("settle"),
        marked("Computes the position of rest at once, without the motion that leads there."),
    ),
    (marked("load factor"), marked("λ"), marked("The number by which all loads are multiplied.")),
    (
        marked("linear theory"),
        marked("first-order theory"),
        marked("The statics of courses: forces and displacements are computed on the undeformed structure."),
    ),
    (
        marked("exact theory"),
        marked("nonlinear theory"),
        marked("Equilibrium in the deformed shape, however large the displacements are."),
    ),
    (
        marked("axial stiffness EA"),
        "",
        marked("Young's modulus E times the area A. A force N makes a rod of length L longer by N L / EA."),
    ),
    (
        marked("bending stiffness EI"),
        "",
        marked("Young's modulus E times the second moment of area I. The larger it is, the less a rod bends."),
    ),
    (marked("rest length"), marked("unstressed length"), marked("The length of a rod that carries no force.")),
    (
        marked("lack of fit"),
        "",
        marked(
            "The rest length of a rod differs from the distance that it must span, so that it is forced into place."
        ),
    ),
    (
        marked("mass per length"),
        marked("density in kg/cm"),
        marked("The mass of one centimetre of rod. Each end of the rod gets half of its mass."),
    ),
    (marked("strain"), marked("ε"), marked("The change of length of a rod divided by its rest length.")),
    (
        marked("yield"),
        marked("become plastic"),
        marked("At its strength a rod goes on deforming without carrying more force. It is drawn in violet."),
    ),
    (marked("plastic strain"), marked("permanent strain"), marked("The strain that is left after unloading.")),
    (
        marked("utilisation"),
        "",
        marked("The axial force divided by the strength of the rod. At 100 % the rod yields."),
    ),
    (
        marked("cable"),
        marked("tension only"),
        marked("A rod that carries tension and goes slack instead of carrying compression."),
    ),
    (
        marked("buckling"),
        "",
        marked("Under a large enough compression a straight rod or a structure bends to the side."),
    ),
    (
        marked("snap-through"),
        "",
        marked("A shallow arch or truss jumps to its other side when the load grows beyond a limit."),
    ),
    (
        marked("natural frequency"),
        "",
        marked("How often in a second a structure swings back and forth when nothing drives it."),
    ),
    (
        marked("vibration mode"),
        marked("natural mode"),
        marked("The shape in which a structure swings at one of its natural frequencies."),
    ),
    (marked("damping"), "", marked("Takes energy from a motion, until the structure is at rest.")),
    (
        marked("coefficient of restitution"),
        marked("e"),
        marked(
            "The speed of separation after an impact divided by the speed of approach: 1 is elastic, 0 does not bounce."
        ),
    ),
    (
        marked("time step"),
        marked("Δt"),
        marked("The short time by which the computation advances the motion at once."),
    ),
)


def glossary() -> list[tuple[str, str, str]]:
    """Terms, other names and meanings in the present language, in its alphabetical order."""
    said = [(tr(term), tr(also) if also else "", tr(meaning)) for term, also, meaning in TERMS]
    return sorted(said, key=lambda entry: unicodedata.normalize("NFKD", entry[0].casefold()))
