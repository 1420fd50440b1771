"""The thesis' support functions for plane vectors in polar coordinates (chapter 7; appendix A.6).

A vector is a list [angle, length]; a dictionary of vectors holds a list of angles and one of lengths
(section 2.1). Angles lie in [−π, π]. Section numbers are those of the thesis.
"""

import math

Polar = list[float]
Vectors = dict[str, list[float]]

QUARTER = math.pi / 2


def identify_quadrant(angle: float) -> int:
    """Return 1 to 4, counted counter-clockwise (A.6.7)."""
    if angle >= 0:
        if angle >= 2 * math.pi:
            angle = angle % (2 * math.pi)
        return int(angle // QUARTER) + 1
    if angle <= -2 * math.pi:
        angle = angle % (-2 * math.pi)
    return 4 - int(angle // -QUARTER)


def normalize_angle(angle: float) -> float:
    """Return the equivalent angle in [−π, π] (A.6.1)."""
    quadrant = identify_quadrant(angle)
    if angle == 0:
        return 0.0
    if angle > 0:
        remainder = angle % QUARTER
        if quadrant == 1:
            return remainder
        if quadrant == 2:
            return remainder + QUARTER
        if quadrant == 3:
            return -math.pi + remainder
        return -QUARTER + remainder
    remainder = angle % -QUARTER
    if quadrant == 1:
        return remainder + QUARTER
    if quadrant == 2:
        return remainder + math.pi
    if quadrant == 3:
        return remainder - QUARTER
    return remainder


def add_vectors(vector1: Polar, vector2: Polar, scale1: float = 1, scale2: float = 1) -> Polar:
    """Return the sum of two vectors, each times its scale (A.6.2)."""
    x = scale1 * vector1[1] * math.cos(vector1[0]) + scale2 * vector2[1] * math.cos(vector2[0])
    y = scale1 * vector1[1] * math.sin(vector1[0]) + scale2 * vector2[1] * math.sin(vector2[0])
    angle = normalize_angle(math.atan2(y, x))
    length = math.hypot(x, y)
    return [angle, length]


def cartesian_to_polar(vector: list[float]) -> Polar:
    """Return the polar coordinates of [x, y] (A.6.3)."""
    length = math.hypot(vector[0], vector[1])
    angle = normalize_angle(math.atan2(vector[1], vector[0]))
    return [angle, length]


def polar_to_cartesian(vector: Polar) -> list[float]:
    """Return [x, y] (A.6.4)."""
    x = vector[1] * math.cos(vector[0])
    y = vector[1] * math.sin(vector[0])
    return [x, y]


def project_vector(vector: Polar, axis_angle: float) -> Polar:
    """Return the projection of a vector on an axis (A.6.8)."""
    delta_angle = vector[0] - axis_angle
    projected_length = abs(vector[1] * math.cos(delta_angle))
    quadrant = identify_quadrant(delta_angle)
    if quadrant in (1, 4):
        return [normalize_angle(axis_angle), projected_length]
    return [normalize_angle(axis_angle + math.pi), projected_length]


def decompose_vector(vector: Polar, angle_x: float = 0.0, angle_y: float | None = None) -> tuple[Polar, Polar]:
    """Return the projections on two axes, by default perpendicular ones (A.6.9)."""
    if angle_y is None:
        angle_y = angle_x + math.pi / 2
    vector_x = project_vector(vector, angle_x)
    vector_y = project_vector(vector, angle_y)
    return vector_x, vector_y


def sum_vectors_dict(vectors: Vectors, others: Vectors | None = None) -> Vectors:
    """Return the sum of all vectors in one or two dictionaries, as a dictionary of one vector (A.6.10)."""
    total = [0.0, 0.0]
    for index in range(len(vectors["angle"])):
        total = add_vectors(total, [vectors["angle"][index], vectors["scalar"][index]])
    if others is not None:
        for index in range(len(others["angle"])):
            total = add_vectors(total, [others["angle"][index], others["scalar"][index]])
    return {"angle": [total[0]], "scalar": [total[1]]}
