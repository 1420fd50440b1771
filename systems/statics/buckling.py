"""Buckling: at which factors of the load a structure gives way, and in which shapes.

Linear, K₀ φ = −λ K_G φ: K₀ is the stiffness with the forces that act in full (weight, lack of fit, warmth, moved supports),
K_G that of the first-order axial forces of the forces and loads at the factor 1. Nothing moves before it gives way.

About an exact equilibrium at the factor λ₀, λ = λ₀ − φᵀ K_T φ / φᵀ K_T′ φ: K_T is the tangent stiffness there, K_T′ its
derivative along the path of equilibria, and φ are the modes of K_T φ = −μ K_G φ, K_G by the rates of the axial forces on the
moved rods. (The eigenvectors of K_T and K_T′ will not do: rods that turn are so stiff along their axes that half of
the change, without its square, has no meaning.) φᵀ K_T φ falls like a line towards a bifurcation, and like a root towards
a limit load λ_c, so that λ comes out as far beyond λ_c as λ₀ is before it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from pinjoint.components.arrays import Array, Rows
from pinjoint.components.derived import on_axis
from pinjoint.components.language import plural, tr
from pinjoint.components.mistake import WrongValue
from pinjoint.components.model import Model
from pinjoint.components.particle import supported
from pinjoint.components.rod import bears_between, extensible_elsewhere
from pinjoint.components.wording import brief
from pinjoint.systems.islands import lowest_joined
from pinjoint.systems.statics.assembly import Matrix
from pinjoint.systems.statics.bending import needed_parts
from pinjoint.systems.statics.equations import SOFT, Structure, upright
from pinjoint.systems.statics.events import NoEquilibrium
from pinjoint.systems.statics.explain import describe_motion, divide_named, rod_names
from pinjoint.systems.statics.external import External
from pinjoint.systems.statics.factor import Factor, pseudo_random, regular, shifted, unresisted
from pinjoint.systems.statics.response import Response
from pinjoint.systems.statics.state import Start, StaticState
from pinjoint.systems.statics.theory import FULL, linear

_RESTARTS = 100
_LANCZOS = 40  # vectors that the lowest of larger structures are found from, at least
_MODES = 5
# Of the work of compression on the member that does most: those that do less take no part in a mode.
IDLE = 1e-6
_IN_LINE = 1e-6  # sine of the angle between rods, and share of their bending stiffness
NOTHING = 1e-10  # of the largest axial force, or of the largest eigenvalue: round-off
# Of the rods' stiffness: by what tension is to hold a mechanism before it gives way.
_STIFFENED = 1e-6, 1e-8, 1e-10
STEP = 1e-5  # change of the rods, as a share, over which a derivative along the path of equilibria is taken
STRAINED = 0.1  # strain at a critical factor above which no material is still elastic


@dataclass(frozen=True, repr=False)
class Buckling:
    """factors: critical load factors λ > 0, ascending, (k,). modes: (k, n, 2), where members bend with rotations (n, 3),
    the largest motion of each 1.

    dead, live: first-order axial forces (kN) of what acts in full, and of forces and loads at the factor 1, (rods,); about
    an equilibrium, by the line that touches their path there.
    effective_length: π √(EI/−N) of compressed rods with a bending stiffness at the lowest factor (m), (rods,); NaN of others
    and where compression does no work in the lowest mode. member_length: of rods that continue each other in a line, all
    together (m), (rods,).
    leading: rows of the rods whose compression does most of the work in each mode, (k,), and leading_length, their effective
    lengths at its factor (m), NaN without bending stiffness, (k,).
    notes: sentences about what the factors leave out. message: why there is none; "" if there are some. coarse: rods are so
    compressed at the lowest factor that one cubic is too coarse for them: the factors are no answers but upper bounds.
    """

    __repr__ = brief

    factors: Array
    modes: Array
    dead: Array
    live: Array
    effective_length: Array
    member_length: Array
    leading: Rows
    leading_length: Array
    notes: tuple[str, ...] = ()
    message: str = ""
    coarse: bool = False

    @classmethod
    def of(cls, model: Model, count: int = _MODES, about: StaticState | Start | None = None) -> Buckling:
        """The lowest critical load factors of a model, its rods elastic, and the modes in which it gives way.

        about: an exact equilibrium under its load factor, from where the next critical ones are told; None: linear
        buckling. Raises NoEquilibrium where that has no answer, where what acts in full is too much already, where nothing
        but its stiffness under no load resists a motion, or where the equilibrium is not stable.
        """
        if count < 1:
            raise WrongValue("modes is {modes}; ask for at least 1.", modes=count)
        structure, stiffens = Structure.of(model), False
        if about is None:
            rods = structure.unmoved
            dead, whole = (linear(model, None, factor).axial_force for factor in (0.0, 1.0))
            live = _told(whole - dead, whole)
            steady, softening = _geometric(structure, dead, 0.0), _geometric(structure, live, 1.0)
            held = _resisting(model, structure, structure.initial_tangent + steady, softening)
        else:
            rods, live, held, change = _ahead(structure, about, External.of(model))
            dead = rods.axial_force - about.load_factor * live
            softening = _geometric(structure, live, 1.0, rods)
        softens = bool((live < 0.0).any() or bears_between(model))
        vectors = _modes(structure, held, softening, count if softens else 0)
        if about is None:
            factors = _factors(structure, vectors, steady, softening)
        else:
            resisted, changed = (np.einsum("ik,ik->k", vectors, matrix @ vectors) for matrix in (held, change))
            nearer = np.divide(resisted, -changed, out=np.full(len(changed), np.inf), where=changed < 0.0)
            order = np.argsort(nearer)[: int(np.isfinite(nearer).sum())]
            stiffens, factors = len(order) < len(nearer), about.load_factor + nearer[order]
            vectors = vectors[:, order]
        motions = structure.motions(vectors)
        modes = np.array([upright(motion) for motion in motions]).reshape(motions.shape)
        works = [_work(structure, rods, field, -live) for field in structure.fields(vectors)]
        leading = np.array([int(work.argmax()) for work in works], dtype=np.intp)
        member = members(model)
        taking = np.zeros(len(live), dtype=bool)
        if works:
            work = np.bincount(member, works[0])
            taking = (work > IDLE * work.max())[member]
        lengths = [_effective_length(model, dead + factor * live) for factor in factors]
        lowest = dead + factors[0] * live if len(factors) else np.zeros(len(dead))
        return cls(
            factors,
            modes,
            dead,
            live,
            np.where(taking, _effective_length(model, lowest), np.nan),
            np.bincount(member, model.rods.rest_length)[member].astype(np.float64),
            leading,
            np.array([length[row] for length, row in zip(lengths, leading, strict=True)]),
            tuple(_notes(model, factors, lowest, about)),
            "" if len(factors) else _why_none(model, live, stiffens=stiffens),
            bool((needed_parts(model, lowest) > 1).any()),
        )


def _told(part: Array, whole: Array) -> Array:
    """Axial forces without those that are round-off beside others."""
    return np.where(np.abs(part) <= NOTHING * np.abs(whole).max(initial=0.0), 0.0, part)


def _ahead(
    structure: Structure, about: StaticState | Start, external: External
) -> tuple[Response, Array, Matrix, Matrix]:
    """The rods in an exact equilibrium, the rate of their axial forces along the path of equilibria (kN for each 1 of the
    load factor), the tangent stiffness there, and its rate."""
    structure = structure.unyielding
    place = structure.field(about.displacement, about.rotation)

    def rods(by: float, motion: Array | float = 0.0) -> Response:
        return structure.respond(place + by * motion, about.permanent, about.load_factor + by)

    here = rods(0.0)
    stiffness = structure.tangent(here, here.slack)
    if not regular(stiffness, structure.weight, -SOFT).definite:
        message = tr("The equilibrium is not stable: no load factor can be told at which it would give way.")
        raise NoEquilibrium("collapse", message)
    pushed, pulled = (external.at(by) - structure.internal(rods(by)) for by in (0.5, -0.5))
    motion = Factor(stiffness).solve(structure.gather(pushed - pulled))
    step = min(STEP / max(structure.move(motion, here), STEP), 1.0)
    after, before = (rods(by, structure.spread(motion)) for by in (step, -step))
    change = structure.tangent(after, here.slack) - structure.tangent(before, here.slack)
    rate = (after.axial_force - before.axial_force) / (2.0 * step)
    return here, _told(rate, here.axial_force), stiffness, change / (2.0 * step)


def _geometric(structure: Structure, axial_force: Array, share: float, rods: Response | None = None) -> Matrix:
    """The stiffness of straight rods by these axial forces alone, and by what a share of the forces between ends turns.

    rods: where they are, if moved.
    """
    rods = structure.unmoved if rods is None else rods
    bending, bent = structure.bending, rods.bent
    if bending is not None and bent is not None:
        still = {name: np.zeros_like(values) for name, values in vars(bent).items()}
        along = on_axis(share * bending.span_load, rods.axis)[0]
        bent = replace(bent, **still | {"along": along})
        bending = replace(bending, end_stiffness=np.zeros_like(bending.end_stiffness))
    rods = replace(rods, axial_force=axial_force, bent=bent)
    unsupported = replace(structure, bending=bending, springs=np.zeros_like(structure.springs))
    return unsupported.tangent(rods, np.ones(len(axial_force), dtype=bool))


def _resisting(model: Model, structure: Structure, stiffness: Matrix, softening: Matrix) -> Matrix:
    """The stiffness at a load so small that every motion is resisted: none, but where tension holds mechanisms."""
    weight = structure.weight
    if regular(stiffness, weight, -SOFT).definite:
        return stiffness
    if not regular(stiffness, weight).definite:
        message = tr(
            "The structure already buckles under what the load factor does not multiply: weight, lack of fit, temperature,"
            " moved supports. Stiffen it, or let the weight act as forces on particles, which the factor multiplies."
        )
        raise NoEquilibrium("collapse", message)
    modes = unresisted(structure, structure.unmoved, stiffness)
    if not modes.shape[1]:
        return stiffness
    size = float(abs(softening.diagonal()).max(initial=0.0))
    for share in _STIFFENED if size > 0.0 else ():
        held = stiffness + share * float(weight.max()) / size * softening
        if regular(held, weight, -SOFT * share).definite:
            return held
    message = tr(
        "The structure is a mechanism, which has no buckling load: nothing resists moving {motion}, and compression makes"
        " it move at once. Add rods or supports there, or join rods rigidly.",
        motion=describe_motion(model, structure.fields(modes)),
    )
    raise NoEquilibrium("mechanism", message)


def _modes(structure: Structure, stiffness: Matrix, softening: Matrix, count: int) -> Array:
    """The φ (N, k) of the lowest positive λ of (K + λ K_G) φ = 0, by the largest 1/λ."""
    size = structure.size
    if size == 0 or count == 0:
        return np.zeros((size, 0))
    count = min(count, size // 3) if size > FULL else min(count, size)
    find = _largest if size > FULL else _every
    weight = structure.weight
    if not Factor(stiffness).definite:  # by round-off: factors are computed without what is added
        stiffness = shifted(stiffness, weight)
    try:
        values, vectors = find(weight, -softening, stiffness, count)
    except (ValueError, RuntimeError):  # the ends of very short rods are far stiffer than their weight
        try:
            values, vectors = find(np.maximum(weight, stiffness.diagonal()), -softening, stiffness, count)
        except (ValueError, RuntimeError):
            message = tr(
                "The buckling loads cannot be computed: the stiffnesses or lengths of the rods differ too much. Make the"
                " stiffest softer or the shortest longer."
            )
            raise NoEquilibrium("collapse", message) from None
    order = np.argsort(-values)[:count]
    return vectors[:, order[values[order] > NOTHING * np.abs(values).max(initial=0.0)]]


def _every(weight: Array, one: Matrix, other: Matrix, count: int) -> tuple[Array, Array]:
    """All eigenvalues of A φ = μ B φ and their φ. Raises LinAlgError where B is not definite."""
    from scipy.linalg import eigh

    root = np.sqrt(weight)
    both = [m if isinstance(m, np.ndarray) else m.toarray() for m in (one, other)]
    soft, stiff = (m / root[:, None] / root for m in both)
    values, vectors = eigh(soft, stiff)
    return values, vectors / root[:, None]


def _largest(weight: Array, one: Matrix, other: Matrix, count: int) -> tuple[Array, Array]:
    """The largest eigenvalues of A φ = μ B φ and their φ, sparse; those that are found of few, beside many that are 0."""
    from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

    inverse = LinearOperator(other.shape, matvec=Factor(other).solve, dtype=np.float64)
    first, basis = pseudo_random(len(weight), 1)[:, 0], max(_LANCZOS, 3 * count)
    try:
        found: tuple[Array, Array] = eigsh(
            one, count, M=other, Minv=inverse, which="LA", v0=first, ncv=basis, maxiter=_RESTARTS
        )
    except ArpackNoConvergence as end:
        found = end.eigenvalues, end.eigenvectors
    return found


def _factors(structure: Structure, vectors: Array, steady: Matrix, softening: Matrix) -> Array:
    """λ of each mode by Rayleigh's quotient, with the energy of its deformations.

    In these nothing cancels, unlike in matrices of many short rods, so that the quotient has the more digits.
    """
    found = []
    for vector in vectors.T:
        stretched = structure.elongation_rate(vector, structure.unmoved)
        energy = float((structure.stiffness / structure.rest_length) @ stretched**2)
        if structure.bending is not None:
            slopes = structure.slope_rates(structure.spread(vector), structure.unmoved)
            energy += float((slopes * structure.bending.moments(slopes)).sum())
        energy += float(vector @ (structure.unknown_springs * vector))
        energy += float(vector @ (steady @ vector))
        found.append(-energy / float(vector @ (softening @ vector)))
    return np.array(found)


def _work(structure: Structure, rods: Response, mode: Array, compression: Array) -> Array:
    """The work of compression (rods,) on what each rod's ends approach each other in a mode, to second order."""
    change = structure.relative(mode)
    aside = rods.axis[:, 0] * change[:, 1] - rods.axis[:, 1] * change[:, 0]
    nearer = 0.5 * aside**2 / np.where(rods.length > 0.0, rods.length, np.inf)
    if structure.bending is not None:
        nearer += structure.bending.bow(structure.slope_rates(mode, rods))[1]
    return compression * nearer


def members(model: Model) -> Rows:
    """The number of the member of each rod, (rods,): rods in a line, alike and rigidly joined where nothing else is."""
    rods, particles = model.rods, model.particles
    ends, rigid = rods.between.astype(np.intp), rods.fixity == 1.0
    axis = rods.difference / np.maximum(rods.original_length, 1e-300)[:, None]
    joined = np.bincount(ends.ravel(), minlength=particles.count) == 2
    free = joined & ~supported(model).any(axis=1)
    order = np.argsort(ends.ravel(), kind="stable")
    one, other = order[free[ends.ravel()[order]]].reshape(-1, 2).T  # both ends of rods at such joints
    cross = axis[one // 2, 0] * axis[other // 2, 1] - axis[one // 2, 1] * axis[other // 2, 0]
    stiffness = rods.bending_stiffness
    same = (np.abs(cross) < _IN_LINE) & rigid.ravel()[one] & rigid.ravel()[other]
    same &= np.isclose(stiffness[one // 2], stiffness[other // 2], rtol=_IN_LINE)
    pairs = np.stack([one[same] // 2, other[same] // 2], axis=1)
    return lowest_joined(rods.count, pairs)


def _effective_length(model: Model, axial_force: Array) -> Array:
    """π √(EI/−N) of rods that are compressed and have a bending stiffness; else NaN."""
    pressed = (axial_force < 0.0) & (model.rods.bending_stiffness > 0.0)
    ratio = np.divide(
        model.rods.bending_stiffness, -axial_force, out=np.full(len(axial_force), np.nan), where=pressed
    )
    return np.pi * np.sqrt(ratio)


def _why_none(model: Model, live: Array, *, stiffens: bool) -> str:
    """Why no factor makes a structure give way; stiffens: about an equilibrium, in all modes."""
    if stiffens:
        return tr(
            "From this equilibrium on, the load makes the structure stiffer: no load factor is told at which it gives way."
        )
    if not live.any():
        return tr("No force or load acts on the rods; apply one, which the load factor multiplies.")
    pressed = np.flatnonzero(live < 0.0)
    if not len(pressed):
        return tr("The forces and loads compress no rod, so the structure buckles at no load factor.")
    return tr(
        "The structure buckles at no load factor: the ends of the compressed {rods} cannot move sideways. Divide a rod that"
        " bends to see it buckle between its ends.",
        rods=rod_names(model, pressed),
    )


def _notes(model: Model, factors: Array, lowest: Array, about: StaticState | Start | None = None) -> list[str]:
    """From where it is told, and what the lowest factor leaves out: strains that are not elastic, struts, and rods that one
    cubic is too coarse for."""
    if not len(factors):
        return []
    rods, notes = model.rods, []
    if elsewhere := extensible_elsewhere(model):
        notes.append(elsewhere)
    if about is not None:
        notes.append(
            tr(
                "Told from the exact equilibrium at the load factor {factor:.4g}, as its stiffness changes there: the nearer"
                " the load comes, the closer.",
                factor=about.load_factor,
            )
        )
    strain = -lowest / rods.stiffness
    if len(strain) and strain.max() > STRAINED:
        row = int(strain.argmax())
        notes.append(
            tr(
                "At the load factor {factor:.4g}, {rod} is shortened by {strain:.0%} of its length: a real material fails"
                " long before.",
                factor=factors[0],
                rod=model.describe(rods[row]),
                strain=strain[row],
            )
        )
    pinned = (rods.bending_stiffness > 0.0) & ~(rods.turning_shares > 0.0).any(axis=1)
    struts = pinned & (-lowest * rods.rest_length**2 > np.pi**2 * rods.bending_stiffness)
    if struts.any():
        rows = np.flatnonzero(struts)
        notes.append(
            plural(
                "At a lower load, {rods} would buckle between its hinges, at π² EI/L². Let it buckle as a strut,"
                " or divide it, to see that.",
                "At a lower load, {rods} would buckle between their hinges, at π² EI/L². Let them buckle as"
                " struts, or divide them, to see that.",
                len(rows),
                rods=rod_names(model, rows),
            )
        )
    parts = needed_parts(model, lowest)
    if (parts > 1).any():
        notes.append(divide_named(model, np.flatnonzero(parts > 1), parts))
    return notes
