"""The audit of the paper: what it claims, what is true of it, and the exact evidence.

[Yang2020] states its main result as a conjecture and says so; most of what it claims is true. A row
holds one claim against the book: a true one is proved there, for the others there is a cloud of
rational points on which the claim fails, re-checked in fractions.
"""

from __future__ import annotations

import enum
from collections.abc import Mapping
from dataclasses import dataclass

from certreg.results import Ruling, Verdict

from . import counterexamples, spring_counterexamples
from .counterexamples import Counterexample


class Finding(enum.Enum):
    """What is found of a claim; the value is the word shown."""

    TRUE = "true"
    TRUE_UNDER_A_CONDITION = "true under a condition"
    FALSE_AS_STATED = "false as stated"
    NOT_PROVED_HERE = "not proved here"


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One claim of the paper.

    claim: in our words. place: where the paper makes it. holds: what is true, the condition
    included; of a true claim, what it rests on. because: the claims of the book that prove that.
    counterexample: exact, to the claim as it is stated; None if it is true, or if neither it nor
    its contrary is proved here.
    """

    number: str
    claim: str
    place: str
    finding: Finding
    holds: str
    because: tuple[str, ...]
    counterexample: Counterexample | None = None

    def __post_init__(self) -> None:
        none = self.finding in {Finding.TRUE, Finding.NOT_PROVED_HERE}
        if (self.counterexample is None) is not none:
            raise ValueError(f"row {self.number}: a counterexample, unless the claim is true")

    def recheck(self) -> Verdict:
        """Whether the counterexample refutes the claim as stated, computed anew.

        PROVED: it does. REFUTED: it does not. INCONCLUSIVE: it has none; what holds is proved by
        the book's claims.
        """
        if self.counterexample is None:
            proofs = f"what holds is proved by {', '.join(self.because)}"
            words = f"{self.finding.value}, no counterexample: {proofs}"
            return Verdict(ruling=Ruling.INCONCLUSIVE, words=words)
        return self.counterexample.recheck()

    def stands(self, book: Mapping[str, Verdict]) -> Verdict:
        """Whether the finding stands, given the verdicts on the book's claims by name."""
        for name in self.because:
            if name not in book or not book[name].proved:
                words = f"row {self.number} rests on {name}, which is not proved"
                return Verdict(ruling=Ruling.INCONCLUSIVE, words=words)
        if self.counterexample is None:
            return Verdict(ruling=Ruling.PROVED, words=f"proved by {', '.join(self.because)}")
        return self.recheck()


def rows() -> tuple[Row, ...]:
    """All rows, in the order of the paper."""
    return ROWS


def carried_over() -> tuple[Row, ...]:
    """Rows on what the paper conjectures, of springs that are matrices; it does not speak of these.

    They do not count among the paper's claims.
    """
    return CARRIED_OVER


def table(*, linked: bool = False) -> str:
    """The audit as a Markdown table; linked: the claims' names as links to their pages."""
    head = ("", "The paper's claim", "Where", "Finding", "What holds", "Counterexample", "Proof")
    lines = [_line(head), _line(["---"] * len(head))]
    for row in rows():
        names = [f"[{n}](proofs/{n}.md)" if linked else n for n in row.because]
        words = row.counterexample.words if row.counterexample else ""
        finding = row.finding.value
        cells = (row.number, row.claim, row.place, finding, row.holds, words, ", ".join(names))
        lines.append(_line(cells))
    return "\n".join(lines) + "\n"


def _line(cells: tuple[str, ...] | list[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


TRUE, CONDITION, FALSE, OPEN = Finding

ROWS = (
    Row(
        number="1",
        claim="The potential energy of the springs is the maximum-likelihood objective.",
        place="Proposition 4 (i)",
        finding=TRUE,
        holds="For t = ȳ + c − R x̄, exactly.",
        because=("potential_energy", "maximum_likelihood"),
    ),
    Row(
        number="2",
        claim="The stated equations of motion are those of the rigid body on springs.",
        place="Proposition 1, with the total force and torque",
        finding=TRUE,
        holds="Newton–Euler, Euler–Poincaré, d'Alembert and an independent chart agree.",
        because=("total_force", "total_torque", "euler_poincare", "dalembert", "cayley_chart"),
    ),
    Row(
        number="3",
        claim="The total energy has the rate −μM|v|² − μ ωᵀJω ≤ 0 over the entire state space.",
        place="proof of Proposition 4, for the invariant set theorem on 18 numbers",
        finding=CONDITION,
        holds="On the rotations, where the motion is. For other matrices R the rate has the "
        "further term 2 tr(RᵀR[ω]S₂), of either sign.",
        because=("kinetic_energy", "dissipation"),
        counterexample=counterexamples.OFF_THE_ROTATIONS,
    ),
    Row(
        number="4a",
        claim="With three noncollinear points V → ∞ as the state, R any matrix, goes to infinity.",
        place="proof of Proposition 4, footnote",
        finding=FALSE,
        holds="In all matrices it takes four points that are not coplanar. On the rotations, which "
        "are compact, V is proper with three noncollinear points, and that is all that is needed.",
        because=("properness",),
        counterexample=counterexamples.FLAT,
    ),
    Row(
        number="4b",
        claim="All trajectories converge to the set of equilibria.",
        place="Proposition 4 (ii)",
        finding=TRUE,
        holds="On rotations and R⁹ by LaSalle's theorem, J ≻ 0 as the paper supposes.",
        because=("properness", "dissipation", "convergence"),
    ),
    Row(
        number="5",
        claim="At rest the centres coincide and Σ k [x̃]ₓ Rᵀ y = 0; these are all equilibria.",
        place="end of the proof of Proposition 4",
        finding=TRUE,
        holds="Exactly. (That the centres coincide follows from the first of the equations; the "
        "paper says the second.)",
        because=("equilibrium_equations", "torque"),
    ),
    Row(
        number="6a",
        claim="Three noncollinear source points make the global minimiser unique.",
        place="Corollary 5",
        finding=FALSE,
        holds="It is unique if and only if d₂ + d₃ > 0, a condition on both clouds.",
        because=("spectrum", "classification"),
        counterexample=counterexamples.TWO_OPTIMA,
    ),
    Row(
        number="6b",
        claim="A global minimiser, at rest, is an equilibrium.",
        place="Corollary 5",
        finding=TRUE,
        holds="Whether it is unique or not: it is an eigenvector of the largest eigenvalue.",
        because=("equilibrium_equations", "eigenvectors"),
    ),
    Row(
        number="6c",
        claim="For if it moved, the next state would have no more energy, against uniqueness.",
        place="proof of Corollary 5",
        finding=CONDITION,
        holds="With a unique minimiser, and said of the flow, which has no next time step. "
        "Without uniqueness another state may have as little energy, and nothing is contradicted.",
        because=("dissipation", "equilibrium_equations"),
        counterexample=counterexamples.TWO_OPTIMA,
    ),
    Row(
        number="7",
        claim="Besides the optimum there are three or infinitely many equilibria.",
        place="Conjecture 6",
        finding=CONDITION,
        holds="Where the optimum is unique. Where it is not, there are none, one, two or "
        "infinitely many, as the table of the eight cases says.",
        because=("eigenvectors", "classification"),
        counterexample=counterexamples.FEWER_THAN_THREE,
    ),
    Row(
        number="8a",
        claim="For generic points there are three spurious equilibria.",
        place="Conjecture 6 (i)",
        finding=TRUE,
        holds="With probability one, for three points or more drawn from a density.",
        because=("discriminant", "generic", "classification"),
    ),
    Row(
        number="8b",
        claim="Each of them is exactly 180° from the optimum.",
        place="Conjecture 6 (i), section 4.1",
        finding=TRUE,
        holds="Eigenvectors of different eigenvalues are orthogonal: 180° between any two.",
        because=("half_turns", "eigenvectors"),
    ),
    Row(
        number="9a",
        claim="When the cloud is symmetric, there are infinitely many spurious equilibria.",
        place="Conjecture 6 (ii)",
        finding=FALSE,
        holds="If Y = RX + t with a rotation R and the weights are invariant, a rotation axis of "
        "order three or more is enough. A half turn, other targets or a mirror image are not.",
        because=("symmetry", "classification"),
        counterexample=counterexamples.SYMMETRIC_BUT_FINITE,
    ),
    Row(
        number="9b",
        claim="The equilateral triangle and the square have infinitely many.",
        place="the graphical proof of Conjecture 6 (ii)",
        finding=TRUE,
        holds="A circle of them, of index 1; and one more, of index 3.",
        because=("symmetry", "classification", "morse_bott"),
    ),
    Row(
        number="9c",
        claim="Infinitely many spurious equilibria happen when the cloud exhibits symmetry.",
        place="abstract and introduction, in our reading: only then",
        finding=FALSE,
        holds="It takes two equal |dᵢ|: equal second moments, which clouds without any symmetry "
        "have, too.",
        because=("classification",),
        counterexample=counterexamples.INFINITE_WITHOUT_SYMMETRY,
    ),
    Row(
        number="9d",
        claim="Any perturbation of these that drives a corner out of the plane leaves at once.",
        place="the graphical proof of Conjecture 6 (ii)",
        finding=FALSE,
        holds="They are unstable: turned about the axis of the flip, the body leaves. About the "
        "other axis in the plane the energy rises, and the body turns back.",
        because=("hessian", "morse_bott", "instability"),
        counterexample=counterexamples.PULLED_BACK,
    ),
    Row(
        number="10",
        claim="All spurious equilibria are locally unstable.",
        place="Conjecture 6 (iii)",
        finding=TRUE,
        holds="Isolated or not, J ≻ 0 as the paper supposes.",
        because=("unstable_count", "instability"),
    ),
    Row(
        number="11",
        claim="The four equilibria have 0, 1, 2 and 3 eigenvalues with positive real part.",
        place="section 4.1, of random clouds",
        finding=TRUE,
        holds="For every cloud with J ≻ 0 and four equilibria, with any damping μ > 0.",
        because=("unstable_count", "classification"),
    ),
    Row(
        number="12",
        claim="At the optimum all eigenvalues of the Jacobian are in the left half-plane.",
        place="caption of the figure of eigenvalues",
        finding=CONDITION,
        holds="Of the closed half-plane, which has the imaginary axis for its edge: none is to the "
        "right of it. Six are zero at every equilibrium, as 18 numbers describe 12 dimensions; "
        "where the optimum is unique the other 12 are in the open half-plane.",
        because=("ambient_jacobian", "characteristic_polynomial", "pushforward"),
        counterexample=counterexamples.SIX_ZEROS,
    ),
    Row(
        number="13a",
        claim="The total energy never increases along the motion.",
        place="proof of Proposition 4",
        finding=TRUE,
        holds="For the flow.",
        because=("dissipation",),
    ),
    Row(
        number="13b",
        claim="In the simulation the total energy is always non-increasing.",
        place="section 4.2, seen in a typical example; here as a general statement",
        finding=FALSE,
        holds="Explicit Euler raises V in the first step from rest, always: by "
        "h²/2 (M|a|² + αᵀJα). The implicit midpoint rule never raises it.",
        because=("euler_energy", "midpoint"),
        counterexample=counterexamples.FIRST_STEP,
    ),
    Row(
        number="14",
        claim="J is positive definite with at least three noncollinear points.",
        place="after Proposition 1",
        finding=TRUE,
        holds="If and only if.",
        because=("inertia",),
    ),
    Row(
        number="15a",
        claim="Without perturbation, too, the system always converges to the global optimum.",
        place="introduction, section 4.2, seen in 100 runs; here as a general statement",
        finding=CONDITION,
        holds="It tends to the set of equilibria, if J ≻ 0, and the spurious ones are unstable. It "
        "converges to the optimum from every state with less energy than all of these. The paper's "
        "starts, at rest with R = I, need not have less: some clouds start at a saddle.",
        because=("convergence", "instability", "certified_basin"),
        counterexample=counterexamples.STARTED_AT_A_SADDLE,
    ),
    Row(
        number="15b",
        claim="Explicit Euler with the step 0.01 simulates it, μ > 0 being any constant.",
        place="section 4.2; section 2 allows every μ > 0",
        finding=CONDITION,
        holds="With a step that is small against μ and the springs; for the translation, where "
        "μ² < 8, it takes h < μ/2.",
        because=("euler_energy",),
        counterexample=counterexamples.DIVERGING,
    ),
    Row(
        number="15c",
        claim="Stopped where the rates have a norm below 1e-4, it has escaped the saddles.",
        place="section 4.2, in our reading; section 3 gives the remedy",
        finding=CONDITION,
        holds="With the remedy that the paper gives: look at the Jacobian where it stopped, and "
        "perturb. The rule alone stops on an open set around every saddle, and changes with the "
        "unit of length. The certified basin is a rule that needs no second look.",
        because=("certified_basin", "half_turns"),
        counterexample=counterexamples.STOPPED_AT_ONCE,
    ),
    Row(
        number="15d",
        claim="If all spurious equilibria are unstable, simulating converges to the optimum with "
        "high probability.",
        place="section 3, after Conjecture 6",
        finding=OPEN,
        holds="Every motion tends to the equilibria, and next to each spurious one there are "
        "states from which it leaves for good. That the states that stay have measure zero would "
        "take a theorem on centre-stable manifolds; the paper does not say of which starts it "
        "speaks.",
        because=("convergence", "instability"),
    ),
    Row(
        number="15e",
        claim="Where it did converge to an unstable equilibrium, the Jacobian there informs of it, "
        "and a small perturbation helps it escape.",
        place="section 3, after Conjecture 6",
        finding=TRUE,
        holds="At the optimum no eigenvalue has a positive real part, at every spurious "
        "equilibrium one has, if J ≻ 0. Arbitrarily near are states with less energy, from which "
        "the body never comes back.",
        because=("pushforward", "characteristic_polynomial", "unstable_count", "instability"),
    ),
)

CARRIED_OVER = (
    Row(
        number="S1",
        claim="Springs that are planes: there are three spurious equilibria, or infinitely many.",
        place="Conjecture 6, carried over",
        finding=FALSE,
        holds="At least four equilibria in all. Complex ones counted there are 40, or infinitely "
        "many. From 4 to 40 are real; where none is degenerate their number is even.",
        because=("forty_lines", "forty_real", "real_lines"),
        counterexample=spring_counterexamples.FORTY,
    ),
    Row(
        number="S2",
        claim="Springs that are planes: all spurious equilibria are locally unstable.",
        place="Conjecture 6 (iii), carried over",
        finding=FALSE,
        holds="A spurious equilibrium can be stable, and a motion can end there. What tells the "
        "optimum from it is a certificate.",
        because=("stable_spurious",),
        counterexample=spring_counterexamples.STABLE,
    ),
    Row(
        number="S3",
        claim="Springs that are planes: all trajectories converge to the set of equilibria.",
        place="Proposition 4 (ii), carried over",
        finding=TRUE,
        holds="If J ≻ 0. Where the springs leave a shift free, the equilibria form lines or "
        "planes, and the body coasts along them until it is at rest.",
        because=("spring_translation", "spring_rest"),
    ),
    Row(
        number="S4",
        claim="Springs that are planes: as many unstable eigenvalues as the Hessian has negative "
        "ones.",
        place="section 4.1, carried over",
        finding=TRUE,
        holds="Where no shift is free, J ≻ 0 and the Hessian is not singular: of the reduced "
        "energy on the rotations, too, and with any damping.",
        because=("spring_index",),
    ),
)
