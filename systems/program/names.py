"""What step programs call things: columns, the state, arguments of their functions, and coordinates of both blocks."""

from __future__ import annotations

from pinjoint.systems.base import StopReason
from pinjoint.systems.collision.driven.columns import Order, Real, Whole
from pinjoint.systems.entries import ACCOUNTS, Account, Control, Mark, Measure, Search, Side

ALWAYS = (
    "particles_mobility",
    "particles_mass",
    "particles_constant_force",
    "rods_between",
    "rods_difference",
    "rods_original_length",
    "rods_rest_length",
    "rods_stiffness",
)
OBSERVED = (
    *("rods_axial_force", "rods_length", "rods_strain", "yielding"),  # written
    *("fixed", "tension", "compression", "yields"),  # read
)
OF_BENDING = (  # columns of models that bend
    *("particles_turning", "particles_inertia", "particles_constant_moment", "lever"),
    *("rods_turning_shares", "rods_bowing", "rods_end_stiffness"),
)
TURNING_OBSERVED = ("reaction_moment", "rods_end_moment", "clamped")
ENTRIES = (Account, Control, Mark, Measure, Search, Side, StopReason)
KEPT = ("kept_force", "kept_resisting", "kept_power", "own_acceleration", "own_support", "every")
DRIVEN_ENTRIES = (Order, Real, Whole)
PUSHED = ("support", "unpushed")  # arrays of programs whose particles may meet


STATE = ("displacement", "velocity", "force", "resisting", "direction")
BENT_STATE = (
    *("displacement", "rotation", "velocity", "angular_velocity"),
    *("force", "moment", "resisting", "twisting", "direction"),
)
SECOND_BLOCK = {  # what coordinates are called there, by what they are called in the first
    "displacement": "rotation",
    "velocity": "angular_velocity",
    "force": "moment",
    "resisting": "twisting",
    "predicted": "predicted_spin",
    "particles_mobility": "particles_turning",
}
TURNED_STATE = (*SECOND_BLOCK.values(),)[:4]
SECOND_PARTS = ("push", "extrapolate", "accelerate", "combine")  # functions that are written for both blocks
# Groups of arguments that have one more entry for every one where there are rotations.
FIRST_BLOCK = {
    "placed": ("displacement",),
    "moving": ("velocity",),
    "pulled": ("force",),
    "resisted": ("resisting",),
    "unpressed": ("unpushed",),
    "acting": ("applied",),
    "foreseen": ("predicted",),
    "tried": ("trial", "speed"),
    "reached": ("work[STAGES]", "work[STAGES + 1]"),
    "accelerating": ("acceleration",),
    "correcting": ("correction", "work"),
    "sizing": ("acceleration",),
    "strung": ("along", "across"),
    "diagonals": ("diagonal", "beside"),
    "inverses": ("straight", "skew"),
    "mobilities": ("particles_mobility",),
    "residuals": ("residual", "solved"),
    "vectors": ("vector", "product"),
    "multiplied": ("search", "product"),
}
BOTH_BLOCKS = {
    "placed": ("displacement", "rotation"),
    "moving": ("velocity", "angular_velocity"),
    "pulled": ("force", "moment"),
    "resisted": ("resisting", "twisting"),
    "unpressed": ("unpushed", "moment"),
    "acting": ("applied", "applied_moment"),
    "foreseen": ("predicted", "predicted_spin"),
    "tried": ("trial", "trial_rotation", "speed", "trial_spin"),
    "reached": ("work[STAGES]", "turns[STAGES]", "work[STAGES + 1]", "turns[STAGES + 1]"),
    "accelerating": ("acceleration", "turning_acceleration"),
    "correcting": ("correction", "turning_correction", "work", "turns"),
    "sizing": ("acceleration", "turning_acceleration", "reach"),
    "strung": ("along", "across", "tangents"),
    "diagonals": ("diagonal", "beside", "turning_diagonal"),
    "inverses": ("straight", "skew", "turning_straight"),
    "mobilities": ("particles_mobility", "particles_turning"),
    "residuals": ("residual", "solved", "turning_residual", "turning_solved"),
    "vectors": ("vector", "product", "turning_vector", "turning_product"),
    "multiplied": ("search", "product", "turning_search", "turning_product"),
}
LEAST_TURN = (
    1e-3  # share of what displacements amount to by the longest rod, below which no error of rotations counts
)
EVERY = "displacement.shape[0]"  # particles
IN_BLOCK = "{0}[block], {0}[block + 1]"

# What functions take before the columns.
TRIAL_STATE = "time, dt, *state"
PREDICTED = "time, dt, *placed, *foreseen, *forces"
RESISTED = "time, dt, *placed, *moving, *resisted, direction"
NOW = "control[Control.TIME], control[Control.STEP_SIZE]"

SHIFT = {f"s{d}": f"displacement[b, {i}] - displacement[a, {i}]" for i, d in enumerate("xy")}
TURNED = {f"turn_{end}": f"rotation[{end}, 0]" for end in "ab"}
SPUN = {f"spin_{end}": f"angular_velocity[{end}, 0]" for end in "ab"}
DRIFT = {f"drift_{d}": f"velocity[b, {i}] - velocity[a, {i}]" for i, d in enumerate("xy")}

OF_PAIR = {  # what kernels of pairs are provided with
    "apart": "(x, y)",
    "drift": "(velocity[j, 0] - velocity[i, 0], velocity[j, 1] - velocity[i, 1])",
}

NO_POWER = tuple(f"power_{name} = 0.0" for name in ACCOUNTS)
POWER_RETURNED = tuple(f"power[Account.{name.upper()}] = power_{name}" for name in ACCOUNTS)

# In `combine` for rotations: their own scales, at least a small share of those of displacements.
NORMS = {f"norm_{d}": f"math.sqrt(size_{d})" for d in "xv"}
LEAST = {
    f"norm_{d}": f"math.sqrt(size_{d}), LEAST_TURN * FIRST_{scale} / search[Search.REACH]"
    for d, scale in {"x": "DISPLACEMENT", "v": "SPEED"}.items()
}
LARGEST = {
    "LARGEST_DISPLACEMENT": "LARGEST_ROTATION",
    "LARGEST_SPEED": "LARGEST_SPIN",
    "FIRST_DISPLACEMENT": "search[Search.LARGEST_DISPLACEMENT]",
    "FIRST_SPEED": "search[Search.LARGEST_SPEED]",
}
