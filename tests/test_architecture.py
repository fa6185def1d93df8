"""The map is what the imports say: data flows one way."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import certreg

PACKAGE = Path(certreg.__file__).parent

# A module imports only from lines above its own, or from its left on the same line.
MAP = """
results errors settings registration.exit_codes
io.atomic exact.dyadic problem.memory_mapped
verify
geometry.so3 exact.elimination
native.codegen.translate native.codegen.emit
native.batch native.clouds native.resting native.cache native.compiler native.library
native.evaluator native.engine problem.floating_sums
problem.problem
problem.exact_sums problem.moments objective.energy geometry.pose
objective.classification equilibrium.critical_set exact.eigenbasis equilibrium.stability
equilibrium.spectral registration.closed_form registration.alignment
equilibrium.polynomials equilibrium.exports exact.balls equilibrium.tracking
equilibrium.reference equilibrium.groebner equilibrium.homotopy equilibrium.krawczyk equilibrium.counting
equilibrium.methods
relaxation.qcqp relaxation.conic relaxation.shor
dynamics.body dynamics.integrators dynamics.simulation equilibrium.batch dynamics.batch registration.covariance
certificate.envelope certificate.bounds
certificate.multiplier certificate.producing certificate.count
certificate.coq certificate.coqc certificate.blockwise certificate.checking
registration.agreement
registration.certification registration.enumeration registration.assessment
problem.random_instances
io.streams io.labels io.xyz io.text io.lzf
io.npy io.npz io.ply_rows io.ply io.pcd io.pairs io.clouds io.poses dynamics.trajectories registration.examples
registration.c_sources paper.derivation
report.markup report.roads report.document report.summary report.claims
report.captions report.panel report.runs report.scene report.stage report.page
report.folder report.revisiting
campaign.manifest campaign.folder campaign.shards campaign.workers campaign.calls campaign.running
campaign.table campaign.listing campaign.pairs paper.monte_carlo
paper.particles paper.scheme paper.comparisons
paper.equilibria paper.simulations paper.polygons
paper.construction paper.poses
paper.families paper.maps
paper.observations
paper.evidence paper.exhibits
paper.statics paper.motions paper.proofs paper.verdicts
paper.style paper.figures paper.pictures paper.drawings paper.charts
paper.map_tables paper.reproduction paper.exhibition
cli.options cli.progress
cli.registering cli.judging cli.dynamics cli.derivations cli.campaigns
cli.reproducing
cli.main __main__
"""
PROVERS = ("certificate", "verify")  # the only places that speak of proof
ORDER = [f"certreg.{name}" for line in MAP.split("\n") for name in line.split()]


def module_name(path: Path) -> str:
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imported(source: str, modules: set[str], *, runtime_only: bool = True) -> set[str]:
    """The certreg modules that a source imports, `from certreg import x` resolved to certreg.x."""
    found: set[str] = set()
    tree = ast.parse(source)
    typing_only = {
        id(node)
        for block in ast.walk(tree)
        if isinstance(block, ast.If) and "TYPE_CHECKING" in ast.dump(block.test)
        for node in ast.walk(block)
    }
    for node in ast.walk(tree):
        if runtime_only and id(node) in typing_only:
            continue
        names: list[str] = []
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, "imports are absolute"
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            names = [n if n in modules else str(node.module) for n in names]
        found |= {name for name in names if name.split(".")[0] == "certreg"}
    return found


def upward_imports(sources: dict[str, str]) -> list[str]:
    """Every import that goes against the map, as 'module imports module'."""
    modules = set(sources)
    faults: list[str] = []
    for module, source in sources.items():
        if module not in ORDER:
            continue
        for other in imported(source, modules):
            if other == "certreg":
                continue  # the face: `__version__`
            if other not in ORDER or ORDER.index(other) >= ORDER.index(module):
                faults.append(f"{module} imports {other}")
    return faults


def sources() -> dict[str, str]:
    return {module_name(path): path.read_text() for path in sorted(PACKAGE.rglob("*.py"))}


def test_every_module_stands_on_the_map():
    folders = {
        "certreg",
        "certreg.cli",
        "certreg.paper",
        "certreg.registration",
        "certreg.dynamics",
        "certreg.equilibrium",
        "certreg.objective",
        "certreg.problem",
        "certreg.exact",
        "certreg.geometry",
        "certreg.campaign",
        "certreg.certificate",
        "certreg.native.codegen",
        "certreg.native.generated",
        "certreg.io",
        "certreg.native",
        "certreg.relaxation",
        "certreg.report",
    }

    assert set(sources()) - folders == set(ORDER)


def test_imports_only_go_down_the_map():
    assert upward_imports(sources()) == []


def test_a_planted_upward_import_is_seen():
    planted = sources()
    planted["certreg.problem.moments"] += "\nfrom certreg.registration import certification\n"
    planted["certreg.geometry.so3"] += "\ndef f():\n    import certreg.problem.moments\n"

    assert upward_imports(planted) == [
        "certreg.geometry.so3 imports certreg.problem.moments",
        "certreg.problem.moments imports certreg.registration.certification",
    ]


def test_the_checker_stays_short():
    text = (PACKAGE / "verify.py").read_text()
    further = re.findall(r"# --- kind: .*?\n# --- end of kind: [^\n]*\n", text, re.DOTALL)
    isotropic = re.sub(
        r"\n\n# --- kind: .*?\n# --- end of kind: [^\n]*\n", "", text, flags=re.DOTALL
    )

    assert len(isotropic.splitlines()) <= 400
    assert [kind for kind in further if len(kind.splitlines()) > 200] == []
    assert len(further) == len(re.findall("^# --- kind: ", text, re.MULTILINE)) == 1


def test_finding_does_not_know_proving():
    for module, source in sources().items():
        if module.startswith("certreg.equilibrium"):
            others = imported(source, set(sources()))
            assert not {o for o in others if o.split(".")[1] in PROVERS}, module


def test_functions_and_modules_keep_to_the_sizes_of_the_house():
    for module, source in sources().items():
        assert module == "certreg.verify" or len(source.splitlines()) <= 400, module
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.FunctionDef):
                lines = (node.end_lineno or 0) - node.lineno + 1
                assert lines <= 60, f"{module}.{node.name}"
