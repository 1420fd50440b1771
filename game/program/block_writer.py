"""The source of step programs of very large models: in blocks, which cores share among themselves.

See game/program/layout.py for what a block is.
"""

from __future__ import annotations

from collections.abc import Iterable

from game.program.binding import Bound
from game.program.loops import RodLoop, indented
from game.program.writer import Writer
from systems.base import ACCOUNTS

_RODS = "block_rods[block], block_rods[block + 1]"
_PARTICLES = "first, last"
_LIMITS = ("first = block_particles[block]", "last = block_particles[block + 1]")


class BlockWriter(Writer):
    """Writes forces and resistance as functions of one block, called for all blocks at once.

    What blocks add to accounts is added up in their order, so that no bit depends on the number of cores.
    """

    BLOCK = ("block_particles", "block_rods", "block_cores")

    def _add_columns(self, bound: Iterable[Bound]) -> None:
        super()._add_columns(bound)
        self.columns += [*self.BLOCK, *(f"block_{b.prefix}" for b in self.loads)]

    def _constants(self) -> str:
        return super()._constants() + (
            "from numba import prange\n"
            'parallel = njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, parallel=True)\n'
        )

    def _rod_loop(self, loop: RodLoop) -> list[str]:
        return loop.in_stages(self._is_float, _RODS)

    def _short_rod_loop(self, loop: RodLoop) -> list[str]:
        return loop.one_by_one(_RODS)

    def _forces(self, name: str, *, accepted: bool) -> str:
        commits = self.commits if accepted else []
        slots = sorted({b.slot for b in commits})
        body = [
            *self._particle_forces(span=_PARTICLES),
            *(f"lost_{slot} = 0.0" for slot in slots),
            *self._rod_loop(self._rod_forces(commits)),
            *(f"partial[block, {slot}] = lost_{slot}" for slot in slots),
        ]
        given = "time, dt, displacement, velocity, force, resisting, direction"
        return self._in_blocks(
            name,
            f"{given}, account" if accepted else given,
            given,
            body,
            [line for slot in slots for line in (_total(slot), f"account[{slot}] += 1000.0 * total")],
        )

    def _resist(self) -> str:
        every = range(len(ACCOUNTS))
        body = [
            *self._resistance(span=_PARTICLES),
            *(f"partial[block, {slot}] = power_{slot}" for slot in every),
        ]
        given = "time, dt, displacement, velocity, resisting, direction"
        after = [line for slot in every for line in (_total(slot), f"power[{slot}] = total")]
        return self._in_blocks("resist", f"{given}, power", given, body, after)

    def _in_blocks(self, name: str, parameters: str, given: str, body: list[str], after: list[str]) -> str:
        """A function that does something in every block, on one core or several, then with what is between."""
        columns = self._columns_text()
        call = f"{name}_block(block, {given}, partial, {columns})"
        one = [*_LIMITS, *body]
        several = ["for block in prange(block_rods.shape[0] - 2):", f"    {call}"]
        whole = [
            "blocks = block_rods.shape[0] - 2",
            f"partial = np.zeros((blocks + 1, {len(ACCOUNTS)}))",
            "if block_cores[0] > 1:",
            f"    {name}_each({given}, partial, {columns})",
            "else:",
            *indented(["for block in range(blocks):", f"    {call}"]),
            call.replace("(block,", "(blocks,"),
            *after,
        ]
        return "\n".join(
            [
                "@compiled",
                f"def {name}_block(block, {given}, partial, {columns}):",
                *indented(one),
                "",
                "@parallel",
                f"def {name}_each({given}, partial, {columns}):",
                *indented(several),
                "",
                "@compiled",
                f"def {name}({parameters}, {columns}):",
                *indented(whole),
            ]
        )


def _total(slot: int) -> str:
    return f"total = partial[:, {slot}].sum()"
