"""The source of step programs of very large models, which are computed in blocks by several cores.

See systems/program/blocks.py for what a block is.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pinjoint.systems.program.binding import Bound, StepRole
from pinjoint.systems.program.entries import ACCOUNTS
from pinjoint.systems.program.pasting import indented
from pinjoint.systems.program.writer import PREDICTED, RESISTED, TRIAL_STATE, Writer, accounts_of

_PARTICLES = "first, last"
_LIMITS = ("first = np.uint64(block_particles[block])", "last = np.uint64(block_particles[block + 1])")
_COMPLETED = f"{TRIAL_STATE}, predicted"


class BlockWriter(Writer):
    """Writes a version of each function for one block, and one that calls it for all blocks.

    In the steps themselves cores share the blocks. The accounts' shares of the blocks are summed in the order of the
    blocks, so that no bit depends on the number of cores.
    """

    BLOCK = ("block_particles", "block_rods", "block_cores")
    rows = "block_rods[block], block_rods[block + 1]"

    def _add_columns(self, bound: Iterable[Bound]) -> None:
        super()._add_columns(bound)
        self.columns += [*self.BLOCK, *(f"block_{b.prefix}" for b in self.of[StepRole.LOAD])]

    def _head(self) -> str:
        return super()._head() + "from pinjoint.systems.program.kernel import prange, shared\n"

    def _forces(self, name: str, commits: Sequence[Bound]) -> str:
        accounts = accounts_of(commits)
        body = [
            *self._particle_forces(span=_PARTICLES),
            *(f"lost_{name} = 0.0" for name in accounts),
            *self._rod_loop(self._rod_forces(commits)),
            *(f"partial[block, {_entry(name)}] = lost_{name}" for name in accounts),
        ]
        account = ", account" if name == "accept" else ""
        after = [*_losses(accounts), *self._pushes()]
        return _of_block(name, TRIAL_STATE, body) + _of_all(name, TRIAL_STATE, account, after)

    def _resist(self) -> str:
        body = [
            *self._resistance(span=_PARTICLES),
            *(f"partial[block, {_entry(name)}] = power_{name}" for name in ACCOUNTS),
        ]
        return _of_block("resist", RESISTED, body) + _of_all("resist", RESISTED, ", power", _gains())

    def _of_steps(self) -> list[str]:
        """What begins steps, and what ends them if anything is left to do then, in parts that cores share."""
        ends, begins = (
            self._particles(where, _PARTICLES) for where in (self.integrator.ends, self.integrator.begins)
        )
        losses = [*_losses(accounts_of(self.commits)), *self._pushes()]
        accept, resist = _call("accept", "block", PREDICTED), _call("resist", "block", RESISTED)
        parts = [_shared("move", _COMPLETED, [*begins, accept], ", account", losses)]
        if self.powers:
            parts.append(_shared("complete", _COMPLETED, [*ends, resist], ", power", _gains()))
        elif ends:
            parts.append(_shared("complete", _COMPLETED, ends, "", []))
        return [*super()._of_steps(), *parts]

    def _move(self) -> list[str]:
        return [f"move({_COMPLETED}, account, *columns)"]

    def _accelerate(self) -> list[str]:
        ends = [f"complete({_COMPLETED}, *columns)"] if self.integrator.ends else []
        return self._gains("complete", _COMPLETED) or ends


def _call(name: str, block: str, given: str) -> str:
    return f"{name}_block({block}, {given}, partial, *columns)"


def _of_block(name: str, given: str, body: list[str]) -> str:
    """A function for one block."""
    return _function("compiled", f"def {name}_block(block, {given}, partial, *columns):", [*_LIMITS, *body])


def _of_all(name: str, given: str, results: str, after: list[str], loop: Sequence[str] = ()) -> str:
    """A function that calls that of one block for every block and for the rods between them, and sums up."""
    body = [
        "blocks = block_rods.shape[0] - 2",
        f"partial = np.zeros((blocks + 1, {len(ACCOUNTS)}))",
        *(loop or _one_by_one(name, given)),
        _call(name, "blocks", given),
        *after,
    ]
    return _function("compiled", f"def {name}({given}{results}, *columns):", body)


def _one_by_one(name: str, given: str) -> list[str]:
    return ["for block in range(blocks):", f"    {_call(name, 'block', given)}"]


def _shared(name: str, given: str, body: list[str], results: str, after: list[str]) -> str:
    """A function for one block, and one that calls it for all blocks, shared among cores."""
    each = f"{name}_each(blocks, {given}, partial, *columns)"
    several = ["for block in prange(blocks):", f"    {_call(name, 'block', given)}"]
    loop = ["if block_cores[0] > 1:", f"    {each}", "else:", *indented(_one_by_one(name, given))]
    return (
        _of_block(name, given, body)
        + _function("shared", f"def {each}:", several)
        + _of_all(name, given, results, after, loop)
    )


def _function(decorator: str, head: str, body: list[str]) -> str:
    return "\n".join([f"@{decorator}", head, *indented(body)]) + "\n\n\n"


def _losses(accounts: Iterable[str]) -> list[str]:
    """Lines that add the losses of all blocks to the accounts."""
    return [f"account[{_entry(name)}] += 1000.0 * {_total(name)}" for name in accounts]


def _gains() -> list[str]:
    """Lines that sum what each account gains per second."""
    return [f"power[{_entry(name)}] = {_total(name)}" for name in ACCOUNTS]


def _total(account: str) -> str:
    return f"partial[:, {_entry(account)}].sum()"


def _entry(account: str) -> str:
    return f"Account.{account.upper()}"
