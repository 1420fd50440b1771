"""Small structures whose rods without force become straight while others yield: settling went back and forth there.

Each is a table of particles (x, y; fixed x, y; force x, y in kN; acceleration x, y) and one of rods (ends; stiffness in kN;
tensile and compressive strength in kN, 0 for none; whether it is a cable).
"""

from typing import Any

from tests.reference.elements import Model
from tests.reference.models import model, particle, rod

A_YIELDING_TRUSS: tuple[list[Any], list[Any]] = (
    [
        ((1.528158, 0.732327), (False, False), (8.688872231655182, -3.6168437799254876), (0, 0)),
        ((0.349518, 1.504593), (False, False), (-10.737867572745794, 11.224926101650965), (0, 0)),
        (
            (1.680943, 3.227198),
            (False, False),
            (5.284414211219769, 3.4063401049367426),
            (1.7873942556869995, -1.0812871967323814),
        ),
        ((2.816392, 1.401092), (False, False), (0, 0), (0, 0)),
        ((1.499907, 0.015484), (True, True), (2.775206190268787, -2.6575628613578703), (0, 0)),
        ((1.228075, 2.093794), (False, False), (0, 0), (0, 0)),
        ((1.028277, 1.021601), (False, False), (0, 0), (0, 0)),
        ((4.392691, 3.049632), (False, True), (0, 0), (-0.6329971471493196, 0.24407262725446333)),
    ],
    [
        (0, 1, 4898.317557424649, 37.983964708900686, 45.76403675981867, False),
        (3, 0, 2440.622453139175, 22.86781874505493, 26.57396798598575, False),
        (4, 0, 5065.548460153028, 38.36852603347882, 56.20595690527769, False),
        (0, 5, 3875.857510362355, 14.194000324574269, 49.022168196688064, False),
        (0, 6, 6604.669735506588, 0, 55.469957241759616, False),
        (0, 7, 3927.2960517210595, 33.61740531243542, 39.15745654833175, False),
        (4, 1, 2143.365420932177, 61.466802293048055, 14.383372115222581, False),
        (5, 1, 1080.6871590099422, 46.94917139143794, 29.629297359858153, False),
        (6, 1, 1726.612419683919, 18.374033158867768, 53.54691783638772, False),
        (3, 2, 2526.4988452481884, 24.000545805562734, 47.23736218526907, False),
        (5, 2, 1483.8423072527394, 18.399279608534297, 19.409556172743038, False),
        (3, 5, 4858.921299869259, 16.100802951144903, 51.98156284275859, False),
        (4, 7, 1126.1760937347085, 8.450556279880871, 22.19976253812918, False),
    ],
)

A_CABLE_TRUSS: tuple[list[Any], list[Any]] = (
    [
        ((4.706757, 2.711069), (False, False), (0, 0), (0, 0)),
        ((2.119111, 0.551151), (False, True), (0, 0), (0, 0)),
        ((1.382315, 1.765688), (True, True), (0, 0), (0, 0)),
        ((1.926663, 1.684308), (False, False), (0, 0), (0, 0)),
        ((2.124654, 4.023512), (True, False), (-3.5266526963873925, 1.9546014603524209), (0, 0)),
        ((3.37167, 3.802552), (False, False), (0, 0), (0, 0)),
        ((0.720123, 3.458235), (False, False), (0, 0), (0, 0)),
    ],
    [
        (0, 1, 220.64784130045982, 0, 0, False),
        (0, 3, 933.7927322715123, 0, 0, False),
        (5, 0, 270.8838986854068, 0, 0, False),
        (1, 2, 1248.8332926749842, 0, 0, True),
        (3, 1, 216.3236302152596, 0, 0, False),
        (3, 2, 821.8050715308394, 0, 0, False),
        (4, 2, 403.70074198720437, 0, 0, False),
        (6, 2, 192.77524896870145, 0, 0, False),
        (3, 4, 285.92128667636973, 0, 0, True),
        (3, 5, 296.3027950016451, 0, 0, True),
        (4, 5, 645.5625833415611, 0, 0, False),
        (4, 6, 139.49499672388205, 0, 0, True),
    ],
)


def straightening(tables: tuple[list[Any], list[Any]]) -> Model:
    """Return one of the structures as a model."""
    nodes, rods = tables
    return model(
        [
            particle(
                f"n{row}", *position, fixed=list(fixed), force=list(force), acceleration=list(acceleration)
            )
            for row, (position, fixed, force, acceleration) in enumerate(nodes)
        ],
        [
            rod(
                f"n{first}",
                f"n{second}",
                stiffness=stiffness,
                tensile_strength=tension,
                compressive_strength=compression,
                tension_only=cable,
            )
            for first, second, stiffness, tension, compression, cable in rods
        ],
        settings={"collisions": False},
    )
