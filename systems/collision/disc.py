"""Columns of the array `discs`, shape (n, WIDTH): one row per disc, its path since its last impact.

From its epoch t₀ on a disc moves along u(t) = u₀ + v₀ (t − t₀) + a (t − t₀)²/2, u being the displacement from
its original position o; a is constant until the next impact.
"""

UX, UY = 0, 1  # displacement at the epoch, m
VX, VY = 2, 3  # velocity at the epoch, m/s
AX, AY = 4, 5  # acceleration of the path, m/s²
EPOCH = 6  # s
RADIUS = 7  # m
OX, OY = 8, 9  # original position, m
WX, WY = 10, 11  # inverse mass in each direction, 1/kg; 0 where the disc is held
GX, GY = 12, 13  # acceleration without contact forces, m/s²
STEP = 14  # s; when the forces in its lasting contacts are due again
WIDTH = 15

EPSILON = 2.220446049250313e-16
SPEED_NOISE = 16.0 * EPSILON  # of both speeds: a slower approach is round-off
PLACE_NOISE = 64.0 * EPSILON  # of both positions and paths: discs this near touch
