"""What step programs call things: columns, the state, and arguments of their functions."""

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
    *("particles_masses", "per_arm", "lever"),
    *("rods_turning_shares", "rods_bowing", "rods_end_stiffness"),
)
ENTRIES = (Account, Control, Mark, Measure, Search, Side, StopReason)
KEPT = ("kept_force", "kept_resisting", "kept_power", "own_acceleration", "own_support", "every")
DRIVEN_ENTRIES = (Order, Real, Whole)
PUSHED = ("support", "unpushed")  # arrays of programs whose particles may meet


STATE = ("displacement", "velocity", "force", "resisting", "direction")
EVERY = "displacement.shape[0]"  # particles
IN_BLOCK = "{0}[block], {0}[block + 1]"

# What functions take before the columns.
TRIAL_STATE = "time, dt, *state"
PREDICTED = "time, dt, displacement, predicted, *forces"
RESISTED = "time, dt, displacement, velocity, resisting, direction"
NOW = "control[Control.TIME], control[Control.STEP_SIZE]"

SHIFT = {f"s{d}": f"displacement[b, {i}] - displacement[a, {i}]" for i, d in enumerate("xy")}
TURNED = {f"turn_{end}": f"displacement[{end}, 2] * per_arm[0]" for end in "ab"}
SPUN = {f"spin_{end}": f"velocity[{end}, 2] * per_arm[0]" for end in "ab"}
DRIFT = {f"drift_{d}": f"velocity[b, {i}] - velocity[a, {i}]" for i, d in enumerate("xy")}

OF_PAIR = {  # what kernels of pairs are provided with
    "apart": "(x, y)",
    "drift": "(velocity[j, 0] - velocity[i, 0], velocity[j, 1] - velocity[i, 1])",
}

NO_POWER = tuple(f"power_{name} = 0.0" for name in ACCOUNTS)
POWER_RETURNED = tuple(f"power[Account.{name.upper()}] = power_{name}" for name in ACCOUNTS)
