"""The arrays of a group: discs ("members" 0, 1, …) and the contacts between them, dealt with together.

links: shape (c, 2), the two members of each contact.
contacts: shape (c, WIDTH), the columns below.
mobility: shape (m, 2), inverse mass of each member in each direction, 1/kg, 0 where it is held, so that
    N_cᵀ M⁻¹ N_d is the compliance of the contacts under the members' supports.
motions: shape (NOTES, m, 2): MOTION is what impulses change, the others are notes of other motion. Velocities,
    m/s, with impulses in N·s; or accelerations, m/s², with forces in N.
marks: shape (3, c), work space. matrix: shape (DIRECT + 1, DIRECT), work space.
"""

NX, NY = 0, 1  # unit vector from the first member to the second
DISTANCE = 2  # of their centres, m
OPENING = 3  # compliance of the contact itself, 1/kg
BIAS = 4  # added to the rate at which the contact opens
GIVEN = 5  # impulse of the present projection
IMPULSE = 6  # of the whole impact
FORCE = 7  # that has kept the discs apart since the group's last change, N; 0: none
WIDTH = 8

MOTION, INITIAL, START, ELASTIC, VELOCITY = 0, 1, 2, 3, 4
NOTES = 5

ACTIVE, STATE, CHOSEN = 0, 1, 2  # rows of marks: contacts of a projection; how they fare; those fitted now

DIRECT = 48  # contacts up to which a projection is solved directly; more: by sweeps
