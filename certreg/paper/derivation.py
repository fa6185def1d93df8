"""The derivations, found and run: claims proved anew, on this machine, about the code installed.

They stand beside the package in a checkout (`derivations/`) and inside it in a wheel
(`certreg/_derivations`); either way they are imported as `certreg._derivations`, when asked for and
not before. Nothing in the package imports them otherwise. Here they are also made lines for a
terminal.
"""

from __future__ import annotations

import difflib
import importlib
import importlib.util
import re
import sys
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from certreg._loading import late, library
from certreg.campaign.workers import LocalWorkers
from certreg.errors import CertregError
from certreg.io.atomic import write_atomically, write_files

if TYPE_CHECKING:
    from concurrent.futures import Future

    from certreg.native.codegen import emit as native_emit
    from certreg.results import Verdict
else:
    native_emit = late("certreg.native.codegen.emit")


PACKAGE = Path(__file__).resolve().parent.parent
CHECKOUT = PACKAGE.parent / "derivations"
NAME = "certreg._derivations"
LATEX_FILE, CODE_FOLDER = "claims.tex", "generated"
WIDTH = 24  # of a claim's name
_PLAIN = (
    (r"\\(?:mathrm|operatorname|mathsf|text)\{([^}]*)\}", r"\1"),
    (r"\\dot\{?(\w)\}?", r"\1'"),
    (r"\\(?:l|r)?Vert|\\\|", "|"),
    (r"\\le\b", "<="),
    (r"\\ge\b", ">="),
    (r"\\to\b", "->"),
    (r"\\times\b", "x"),
    (r"\\circ\b", "°"),
    (r"\\[,;! ]", " "),
    (r"[$`*{}]", ""),
    (r"\\(\w+)", r"\1"),
)


class UnknownClaimError(CertregError):
    """The book of claims has no claim of that name."""


def chapters() -> tuple[Any, ...]:
    """The chapters of the book: each a title and the names of its claims."""
    return _module("book").CHAPTERS


def outcomes(names: Sequence[str] = ()) -> Iterator[Any]:
    """What became of each claim (kernel.ClaimOutcome), all if no names are given, as it is run.

    Raises UnknownClaimError before anything is run.
    """
    book, prove = _module("book"), _module("kernel").prove
    for name in names:
        if name not in book.names():
            every: tuple[str, ...] = book.names()
            meant = difflib.get_close_matches(name, every, n=1)
            near = f"did you mean {meant[0]!r}? " if meant else ""
            raise UnknownClaimError(
                f"there is no claim {name!r}: {near}`certreg derive --list` prints the names"
            )
    return (prove(book.claim(name)) for name in (names or book.names()))


def verdict(name: str) -> Verdict:
    """The verdict on one claim of the book, proved anew; for a process of its own."""
    (outcome,) = outcomes([name])
    return outcome.verdict


@contextmanager
def proving(names: Sequence[str]) -> Generator[Mapping[str, Future[Verdict]]]:
    """The verdicts on claims by name, proved in processes of their own while the caller goes on.

    On leaving the context, proofs that have not started are cancelled.
    """
    with LocalWorkers() as workers:
        yield {name: workers.executor.submit(verdict, name) for name in names}


def paper_claims() -> tuple[Any, ...]:
    """The claims of the paper (audit.Row), in its order."""
    return _module("audit").rows()


def audit(proved: Sequence[Any]) -> list[tuple[Any, Verdict]]:
    """The paper's claims (audit.Row), each with whether its finding stands.

    proved: the outcomes of all claims of the book, on which the findings rest.
    """
    verdicts = {outcome.claim.name: outcome.verdict for outcome in proved}
    return [(row, row.stands(verdicts)) for row in paper_claims()]


def all_hold(proved: Sequence[Any], audited: Sequence[tuple[Any, Verdict]]) -> bool:
    """Whether every claim was proved, and every finding of the audit stands."""
    verdicts = [*(outcome.verdict for outcome in proved), *(verdict for _, verdict in audited)]
    return all(verdict.proved for verdict in verdicts)


def write_latex(proved: Sequence[Any], folder: Path) -> None:
    """Write the executed claims as a LaTeX document."""
    folder.mkdir(parents=True, exist_ok=True)
    write_atomically(folder / LATEX_FILE, _module("latex").document(proved).encode())


def write_code(folder: Path) -> None:
    """Write the C that the derived expressions become, generated anew."""
    library("casadi", "the generated C")
    emit = _module("emit")
    files = native_emit.generated_files(emit.definitions(), emit.records())
    write_files(folder / CODE_FOLDER, files)


def _module(name: str) -> Any:
    """A module of the derivations, from the checkout if the package stands in one."""
    library("sympy", "a derivation")
    if NAME not in sys.modules and (CHECKOUT / "book.py").is_file():
        spec = importlib.util.spec_from_file_location(
            NAME, CHECKOUT / "__init__.py", submodule_search_locations=[str(CHECKOUT)]
        )
        if spec is not None and spec.loader is not None:
            package = importlib.util.module_from_spec(spec)
            sys.modules[NAME] = package
            spec.loader.exec_module(package)
    return importlib.import_module(f"{NAME}.{name}")


def claim_line(outcome: Any) -> str:
    """One line about a claim (kernel.Outcome): name, verdict, what it rests on, time."""
    used = len(outcome.claim.standard)
    rests = f", {used} standard fact{'s' * (used != 1)} used" if used else ""
    ruling = outcome.verdict.ruling.value.upper() + outcome.modulo
    name, title = outcome.claim.name, plain(outcome.claim.title)
    line = f"{name:{WIDTH}} {ruling:9} {outcome.seconds:6.2f} s  {title}"
    return f"{line}\n{'':{WIDTH}} {outcome.verdict.words}{rests}"


def chapters_text(chapters: Iterable[Any]) -> str:
    """The names of the claims, by chapter (book.Chapter)."""
    return "\n\n".join(
        "\n".join((chapter.title, *(f"  {name}" for name in chapter.names))) for chapter in chapters
    )


def audit_lines(audited: Iterable[tuple[Any, Verdict]]) -> Iterator[str]:
    """The claims of the paper (audit.Row), each with its finding and whether that stands."""
    for position, (row, verdict) in enumerate(audited):
        if position == 0:
            yield "\nThe claims of the paper [Yang2020]:"
        doubt = "" if verdict.proved else f"  finding NOT CONFIRMED: {verdict.words}"
        yield f"{row.number:>4}  {row.finding.value:23} {plain(row.claim)}{doubt}"


def closing_line(outcomes: Sequence[Any], audited: Sequence[Any]) -> str:
    """How many claims were proved, what had to fail and did, how long it took."""
    proved = sum(outcome.verdict.proved for outcome in outcomes)
    quoting = sum(bool(outcome.modulo) for outcome in outcomes)
    modulo = f" ({quoting} modulo a theorem that is quoted)" if quoting else ""
    controls = [control for outcome in outcomes for control in outcome.controls]
    refuted = sum(control.refuted for control in controls)
    dropped = [drop for outcome in outcomes for drop in outcome.dropped]
    needed = sum(drop.needed for drop in dropped)
    seconds = sum(outcome.seconds for outcome in outcomes)
    paper = f", {len(audited)} claims of the paper audited" if audited else ""
    return (
        f"\n{proved} of {len(outcomes)} claims proved{modulo}, "
        f"{refuted} of {len(controls)} mutated statements refuted, "
        f"{needed} of {len(dropped)} hypotheses needed{paper}, in {seconds:.1f} s"
    )


def plain(words: str) -> str:
    """Markdown with LaTeX made readable in a terminal."""
    for pattern, text in _PLAIN:
        words = re.sub(pattern, text, words)
    return words
