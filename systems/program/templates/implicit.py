"""Implicit stages, for the loop of runge_kutta.py.

Each stage solves  M a = f(x̂ + (γh)² a, v̂ + γh a)  for its acceleration by Newton's method. The matrix
M + γh C + (γh)² K is never formed: a product with it is one pass over the rods, and conjugate gradients,
preconditioned by the 2 × 2 blocks of the particles and their rotations, solve with it. Sums have a fixed order and
iterations fixed tolerances: the same input gives the same bits.
"""

# ruff: noqa: F821, F841
# mypy: ignore-errors


def implicit_stages(time, dt, allowed, state, scratch, *columns):
    """Accelerations of the stages after the first; False if Newton's method does not converge."""
    trial, speed = work[STAGES], work[STAGES + 1]
    known_x, known_v = work[STAGES + 2], work[STAGES + 3]
    correction = work[STAGES + 4]
    by_v = GAMMA * dt
    by_x = by_v * by_v
    for s in range(1, STAGES):
        acceleration = work[s]
        extrapolate(s, dt, displacement, velocity, work, known_x, known_v)
        for i in range(displacement.shape[0]):
            for d in range(D):
                acceleration[i, d] = work[s - 1, i, d]
        before = math.inf
        for iteration in range(MOST_CORRECTIONS + 1):
            for i in range(displacement.shape[0]):
                for d in range(D):
                    speed[i, d] = known_v[i, d] + by_v * acceleration[i, d]
                    trial[i, d] = known_x[i, d] + by_x * acceleration[i, d]
            evaluate(time + NODES[s] * dt, dt, trial, speed, *forces, stage_power, *columns)
            if not correct(
                time + NODES[s] * dt,
                dt,
                by_x,
                by_v,
                trial,
                speed,
                *forces,
                acceleration,
                correction,
                work,
                rod_work,
                *columns,
            ):
                return False
            change = 0.0
            for i in range(displacement.shape[0]):
                for d in range(D):
                    acceleration[i, d] += correction[i, d]
                    change += correction[i, d] * correction[i, d]
            change = by_v * math.sqrt(change)
            if not change < math.inf or (iteration > 1 and change > 2.0 * before):
                return False
            if change <= NEWTON_SHARE * allowed or change <= NEWTON_FLOOR * size_of(by_v, acceleration):
                break
            if iteration == MOST_CORRECTIONS:
                return False
            before = change
        if POWERS or LOADS:
            for k in range(gained.shape[0]):
                gained[k] += RESULT_V[0, s] * stage_power[k]
    return True


def size_of(by_v, acceleration):
    """Change of velocity that an acceleration makes (m/s), Euclidean norm."""
    size = 0.0
    for i in range(acceleration.shape[0]):
        own = 0.0
        for d in range(D):
            own += acceleration[i, d] * acceleration[i, d]
        size += own
    return by_v * math.sqrt(size)


def tangent(time, dt, by_x, by_v, displacement, velocity, direction, rod_work, diagonal, beside, *columns):
    """How forces follow an acceleration that adds by_x × itself to displacements, by_v × itself to velocities.

    direction ← unit vectors of the rods; rod_work ← stiffness of each rod along and across its axis (kN per
    m/s²); diagonal, beside ← the particles' own blocks: mass, and the laws that resist their motion.
    Derivatives of the laws are central differences, wide enough for round-off and exact where a law is linear.
    """
    for i in range(displacement.shape[0]):
        for d in range(D):
            diagonal[i, d] = 0.001 * insert(mass)
            if SPRUNG:
                diagonal[i, d] += by_x * particles_support_springs[i, d]
        beside[i, 0] = 0.0
        insert(particles)
    insert(rods)


def particle_tangent():
    """Of one law that resists the motion of particle `i`."""
    vx = velocity[i, 0]
    vy = velocity[i, 1]
    small = 1e-6 * (abs(vx) + abs(vy)) + 1e-9
    share = 0.5 * by_v / small
    velocity[i, 0] = vx + small
    fx, fy = insert(force)
    velocity[i, 0] = vx - small
    gx, gy = insert(force)
    velocity[i, 0] = vx
    diagonal[i, 0] -= share * (fx - gx)
    beside[i, 0] -= 0.5 * share * (fy - gy)
    velocity[i, 1] = vy + small
    fx, fy = insert(force)
    velocity[i, 1] = vy - small
    gx, gy = insert(force)
    velocity[i, 1] = vy
    diagonal[i, 1] -= share * (fy - gy)
    beside[i, 0] -= 0.5 * share * (fx - gx)


def turning_tangent():
    """Of one law that resists the turning of particle `i`."""
    spin = velocity[i, 2]
    small = 1e-6 * abs(spin) + 1e-9
    velocity[i, 2] = spin + small
    more = insert(moment)
    velocity[i, 2] = spin - small
    diagonal[i, 2] -= 0.5 * by_v / small * (more - insert(moment)) * per_arm[0]
    velocity[i, 2] = spin


def rod_tangent():
    """Of the laws of rod `r`, dampers included."""
    direction[r, 0] = nx
    direction[r, 1] = ny
    insert(rate)
    insert(axial_force)
    total = axial_force
    here = elongation
    small = 1e-7 * (length + original)
    elongation = here + small
    insert(axial_force)
    more = axial_force
    elongation = here - small
    insert(axial_force)
    stiffness = by_x * (more - axial_force) / (2.0 * small)
    elongation = here
    axial_force = total
    if BENDS:
        drawn = stiffness
    if DAMPED:
        insert(damping_force)
        total += damping_force
        present = rate
        small = small / by_v
        rate = present + small
        insert(damping_force)
        more = damping_force
        rate = present - small
        insert(damping_force)
        stiffness += by_v * (more - damping_force) / (2.0 * small)
    rod_work[0, r] = stiffness
    rod_work[1, r] = by_x * total * inverse
    if BENDS:
        insert(bending)


def correct(time, dt, by_x, by_v, trial, speed, forces, acceleration, correction, work, rod_work, *columns):
    """correction ← Newton's, of the acceleration, by conjugate gradients; False if the matrix is not positive."""
    residual, search = work[STAGES + 5], work[STAGES + 6]
    product, solved = work[STAGES + 7], work[STAGES + 8]
    diagonal, beside = work[STAGES + 9], work[STAGES + 10]
    straight, skew = work[STAGES + 11], work[STAGES + 12]
    tangent(time, dt, by_x, by_v, trial, speed, direction, rod_work, diagonal, beside, *columns)
    precondition(direction, rod_work, diagonal, beside, straight, skew, *columns)
    for i in range(trial.shape[0]):
        for d in range(D):
            correction[i, d] = 0.0
            residual[i, d] = 0.0
            if particles_mobility[i, d] > 0.0:
                total = force[i, d] - acceleration[i, d] * (0.001 * insert(mass))
                if RATES:
                    total += resisting[i, d]
                residual[i, d] = total
    size = relax(residual, solved, straight, skew)
    enough = SOLVER_SHARE * SOLVER_SHARE * size
    for i in range(trial.shape[0]):
        for d in range(D):
            search[i, d] = solved[i, d]
    for _ in range(8 * trial.shape[0] + 64):
        if not size > enough:
            break
        multiply(search, product, direction, rod_work, diagonal, beside, *columns)
        curvature = 0.0
        for i in range(trial.shape[0]):
            own = 0.0
            for d in range(D):
                own += search[i, d] * product[i, d]
            curvature += own
        if not curvature > 0.0:
            return False
        share = size / curvature
        for i in range(trial.shape[0]):
            for d in range(D):
                correction[i, d] += share * search[i, d]
                residual[i, d] -= share * product[i, d]
        before = size
        size = relax(residual, solved, straight, skew)
        ratio = size / before
        for i in range(trial.shape[0]):
            for d in range(D):
                search[i, d] = solved[i, d] + ratio * search[i, d]
    return size < math.inf


def multiply(vector, product, direction, rod_work, diagonal, beside, *columns):
    """product ← (M + γh C + (γh)² K) vector; constrained directions are left out. Shear turns with the chord of a rod."""
    for i in range(vector.shape[0]):
        product[i, 0] = diagonal[i, 0] * vector[i, 0] + beside[i, 0] * vector[i, 1]
        product[i, 1] = diagonal[i, 1] * vector[i, 1] + beside[i, 0] * vector[i, 0]
        for d in range(2, D):
            product[i, d] = diagonal[i, d] * vector[i, d]
    for r in range(rods_between.shape[0]):
        a = rods_between[r, 0]
        b = rods_between[r, 1]
        nx = direction[r, 0]
        ny = direction[r, 1]
        sx = vector[b, 0] - vector[a, 0]
        sy = vector[b, 1] - vector[a, 1]
        along, across = rod_work[0, r], rod_work[1, r]
        pull = (along - across) * (nx * sx + ny * sy)
        px = pull * nx + across * sx
        py = pull * ny + across * sy
        if BENDS:
            inverse = direction[r, 2]
            stretched = nx * sx + ny * sy
            aside = nx * sy - ny * sx
            leaning = aside * inverse
            slope_a = vector[a, 2] * per_arm[0] - leaning
            slope_b = vector[b, 2] * per_arm[0] - leaning
            turned_a = rod_work[2, r] * stretched + rod_work[4, r] * slope_a + rod_work[5, r] * slope_b
            turned_b = rod_work[3, r] * stretched + rod_work[5, r] * slope_a + rod_work[6, r] * slope_b
            pulled = rod_work[2, r] * slope_a + rod_work[3, r] * slope_b + rod_work[7, r] * aside
            pushed = rod_work[7, r] * stretched - (turned_a + turned_b) * inverse
            px += pulled * nx - pushed * ny
            py += pulled * ny + pushed * nx
            product[a, 2] += turned_a * per_arm[0]
            product[b, 2] += turned_b * per_arm[0]
        product[a, 0] -= px
        product[a, 1] -= py
        product[b, 0] += px
        product[b, 1] += py
    for i in range(vector.shape[0]):
        for d in range(D):
            if particles_mobility[i, d] == 0.0:
                product[i, d] = 0.0


def precondition(direction, rod_work, diagonal, beside, straight, skew, *columns):
    """straight, skew ← the inverses of the particles' blocks on the diagonal of the matrix."""
    for i in range(diagonal.shape[0]):
        for d in range(D):
            straight[i, d] = diagonal[i, d]
        skew[i, 0] = beside[i, 0]
    for r in range(rods_between.shape[0]):
        nx = direction[r, 0]
        ny = direction[r, 1]
        sideways = max(rod_work[1, r], 0.0)
        stiffer = max(rod_work[0, r], 0.0) - sideways
        if BENDS:
            inverse = direction[r, 2]
            leaning = (rod_work[4, r] + 2.0 * rod_work[5, r] + rod_work[6, r]) * inverse * inverse
            sideways += max(leaning, 0.0)
            stiffer -= max(leaning, 0.0)
            straight[rods_between[r, 0], 2] += max(rod_work[4, r], 0.0) * per_arm[0] * per_arm[0]
            straight[rods_between[r, 1], 2] += max(rod_work[6, r], 0.0) * per_arm[0] * per_arm[0]
        for end in range(2):
            i = rods_between[r, end]
            straight[i, 0] += stiffer * nx * nx + sideways
            straight[i, 1] += stiffer * ny * ny + sideways
            skew[i, 0] += stiffer * nx * ny
    for i in range(diagonal.shape[0]):
        xx = straight[i, 0]
        yy = straight[i, 1]
        xy = skew[i, 0]
        if particles_mobility[i, 0] == 0.0 or particles_mobility[i, 1] == 0.0:
            xy = 0.0
        determinant = xx * yy - xy * xy
        straight[i, 0] = yy / determinant if particles_mobility[i, 0] > 0.0 else 0.0
        straight[i, 1] = xx / determinant if particles_mobility[i, 1] > 0.0 else 0.0
        skew[i, 0] = -xy / determinant
        for d in range(2, D):
            straight[i, d] = 1.0 / straight[i, d] if particles_mobility[i, d] > 0.0 else 0.0


def relax(residual, solved, straight, skew):
    """solved ← preconditioned residual; returns their product, the squared norm of the residual."""
    size = 0.0
    for i in range(residual.shape[0]):
        solved[i, 0] = straight[i, 0] * residual[i, 0] + skew[i, 0] * residual[i, 1]
        solved[i, 1] = straight[i, 1] * residual[i, 1] + skew[i, 0] * residual[i, 0]
        for d in range(2, D):
            solved[i, d] = straight[i, d] * residual[i, d]
        own = 0.0
        for d in range(D):
            own += solved[i, d] * residual[i, d]
        size += own
    return size
