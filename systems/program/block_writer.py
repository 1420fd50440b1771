"""The source of step programs of very large models: in blocks, which cores share among themselves.

See systems/program/blocks.py for what a block is.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from systems.base import ACCOUNTS
from systems.program.binding import Bound
from systems.program.loops import RodLoop, indented
from systems.program.writer import FORCED, PREDICTED, RESISTED, Writer

_RODS = "block_rods[block], block_rods[block + 1]"
_PARTICLES = "first, last"
_COMPLETED = FORCED.replace("velocity", "velocity, predicted")
_MOVED = f"{_COMPLETED}, ending"
_LIMITS = ("first = np.uint64(block_particles[block])", "last = np.uint64(block_particles[block + 1])")


class BlockWriter(Writer):
    """Writes each function as one of a block, called for all blocks; cores share those that make up a step.

    What blocks add to accounts is added up in their order, so that no bit depends on the number of cores.
    """

    BLOCK = ("block_particles", "block_rods", "block_cores")

    def _add_columns(self, bound: Iterable[Bound]) -> None:
        super()._add_columns(bound)
        self.columns += [*self.BLOCK, *(f"block_{b.prefix}" for b in self.loads)]

    def _constants(self) -> str:
        return super()._constants() + (
            "from numba import njit, prange\n"
            'parallel = njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, parallel=True)\n'
        )

    def _rod_loop(self, loop: RodLoop) -> list[str]:
        return loop.in_stages(self._is_float, _RODS)

    def _short_rod_loop(self, loop: RodLoop) -> list[str]:
        return loop.one_by_one(_RODS)

    def _forces(self, name: str, *, accepted: bool) -> str:
        commits = self.commits if accepted else []
        slots = _slots(commits)
        body = [
            *self._particle_forces(span=_PARTICLES),
            *(f"lost_{slot} = 0.0" for slot in slots),
            *self._rod_loop(self._rod_forces(commits)),
            *(f"partial[block, {slot}] = lost_{slot}" for slot in slots),
        ]
        results = ", account" if accepted else ""
        return self._of_block(name, FORCED, body) + self._of_all(name, FORCED, results, _losses(slots))

    def _resist(self) -> str:
        body = [
            *self._resistance(span=_PARTICLES),
            *(f"partial[block, {slot}] = power_{slot}" for slot in range(len(ACCOUNTS))),
        ]
        return self._of_block("resist", RESISTED, body) + self._of_all("resist", RESISTED, ", power", _gains())

    def _integrate(self) -> str:
        """Each step has one part that cores share, or two; where it has one, it ends as the next one begins."""
        if self.driver.kernel:
            return super()._integrate()
        ends, begins = (self._particles(where, _PARTICLES) for where in (self.driver.ends, self.driver.begins))
        between = ["if ending:", *indented(ends)] if ends and not self.powers else []
        accept = self._call("accept", "block", PREDICTED)
        losses = _losses(_slots(self.commits))
        parts = [self._shared("move", _MOVED, [*between, *begins, accept], ", account", losses)]
        if self.powers:
            resist = self._call("resist", "block", RESISTED)
            parts.append(self._shared("complete", _COMPLETED, [*ends, resist], ", power", _gains()))
        return "".join([*parts, super()._integrate()])

    def _move(self) -> list[str]:
        return [f"move({_MOVED.replace('ending', 'step > 1')}, account, {self._columns_text()})"]

    def _complete(self) -> list[str]:
        return self._enter_powers("complete", _COMPLETED) if self.powers else []

    def _finish(self) -> list[str]:
        return [] if self.powers else self._particles(self.driver.ends)

    def _call(self, name: str, block: str, given: str) -> str:
        return f"{name}_block({block}, {given}, partial, {self._columns_text()})"

    def _of_block(self, name: str, given: str, body: list[str]) -> str:
        head = f"def {name}_block(block, {given}, partial, {self._columns_text()}):"
        return _function("compiled", head, [*_LIMITS, *body])

    def _of_all(self, name: str, given: str, results: str, after: list[str], loop: Sequence[str] = ()) -> str:
        """A function that does something in every block, then with what is between, and adds up."""
        body = [
            "blocks = block_rods.shape[0] - 2",
            f"partial = np.zeros((blocks + 1, {len(ACCOUNTS)}))",
            *(loop or self._one_by_one(name, given)),
            self._call(name, "blocks", given),
            *after,
        ]
        return _function("compiled", f"def {name}({given}{results}, {self._columns_text()}):", body)

    def _one_by_one(self, name: str, given: str) -> list[str]:
        return ["for block in range(blocks):", f"    {self._call(name, 'block', given)}"]

    def _shared(self, name: str, given: str, body: list[str], results: str, after: list[str]) -> str:
        """A function like that, of which cores share the blocks."""
        each = f"{name}_each(blocks, {given}, partial, {self._columns_text()})"
        several = ["for block in prange(blocks):", f"    {self._call(name, 'block', given)}"]
        loop = [
            "if block_cores[0] > 1:",
            f"    {each}",
            "else:",
            *indented(self._one_by_one(name, given)),
        ]
        return (
            self._of_block(name, given, body)
            + _function("parallel", f"def {each}:", several)
            + self._of_all(name, given, results, after, loop)
        )


def _function(decorator: str, head: str, body: list[str]) -> str:
    return "\n".join([f"@{decorator}", head, *indented(body)]) + "\n\n"


def _slots(commits: Iterable[Bound]) -> list[int]:
    return sorted({b.slot for b in commits})


def _losses(slots: Iterable[int]) -> list[str]:
    """Lines that add what is lost to the accounts."""
    return [line for slot in slots for line in (_total(slot), f"account[{slot}] += 1000.0 * total")]


def _gains() -> list[str]:
    """Lines that tell what each account gains per second."""
    return [line for slot in range(len(ACCOUNTS)) for line in (_total(slot), f"power[{slot}] = total")]


def _total(slot: int) -> str:
    return f"total = partial[:, {slot}].sum()"
