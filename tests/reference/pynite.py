"""Linear trusses by PyNite, an independent open-source solver of space frames."""

import warnings

from tests.reference.elements import Document, Model, read

NU, UNIT = 0.3, 1.0


def linear_truss(model: Model) -> Document:
    """Return displacement [m] and reaction [kN] by particle, axial_force [kN] by rod, first-order theory.

    Pinned members in a plane; loads with their final value, no lack of fit. Tension positive.
    """
    from Pynite import FEModel3D

    elements = read(model)
    frame = FEModel3D()
    for particle in elements.particles:
        frame.add_node(particle.name, *particle.position, 0.0)
        fixed_x, fixed_y = particle.fixed
        frame.def_support(particle.name, fixed_x, fixed_y, True, True, True, True)
        for direction, axis in (("FX", 0), ("FY", 1)):
            force = particle.force[axis] + elements.environment_force[axis]
            acceleration = particle.acceleration[axis] + elements.environment_acceleration[axis]
            frame.add_node_load(particle.name, direction, force + particle.mass * acceleration / 1000)
    frame.add_material("unit", UNIT, UNIT / (2 * (1 + NU)), NU, 0.0)
    for rod in elements.rods:
        frame.add_section(rod.name, rod.stiffness, UNIT, UNIT, UNIT)
        ends = elements.particles[rod.start].name, elements.particles[rod.end].name
        frame.add_member(rod.name, *ends, "unit", rod.name)
        frame.def_releases(rod.name, Ryi=True, Rzi=True, Ryj=True, Rzj=True)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        frame.analyze_linear(check_stability=False, sparse=False)
    case = "Combo 1"
    nodes = frame.nodes
    return {
        "displacement": {name: [node.DX[case], node.DY[case]] for name, node in nodes.items()},
        "reaction": {name: [node.RxnFX[case], node.RxnFY[case]] for name, node in nodes.items()},
        "axial_force": {name: -member.axial(0.0, case) for name, member in frame.members.items()},
    }
