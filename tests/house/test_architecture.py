"""The map is what the imports say: data flows one way, and a name is imported from its module."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from functools import cache
from graphlib import CycleError, TopologicalSorter
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from syntax import nodes, tree

import certreg

if TYPE_CHECKING:
    from collections.abc import Iterator


PACKAGE = Path(certreg.__file__).parent
verify = import_module("certreg.verify")

# A wing, or a module beside the wings, imports only from those above its own line.
WINGS = (
    "results",
    "errors",
    "_loading",
    "verify",
    "geometry",
    "exact",
    "native",
    "problem",
    "io",
    "objective",
    "equilibrium",
    "relaxation",
    "dynamics",
    "certificate",
    "registration",
    "report",
    "campaign",
    "paper",
    "cli",
    "__main__",
)
FOLDERS_OF_DATA = {"data"}
FINDING = ("objective", "equilibrium", "relaxation")
PROVING = ("certificate", "verify")  # the only places that speak of proof
INNER_IMPORTS = 4  # within functions, each with its reason beside it


@dataclass(frozen=True, kw_only=True)
class Import:
    """One imported name: by which module, from which module, and whether within a function."""

    by: str
    source: str
    name: str
    line: int
    inner: bool

    def __str__(self) -> str:
        return f"{self.by} imports {self.source}.{self.name}"


def module_name(path: Path) -> str:
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def sources() -> dict[str, str]:
    return {module_name(path): path.read_text("utf-8") for path in sorted(PACKAGE.rglob("*.py"))}


def wing(module: str) -> str:
    return module.split(".")[1]


def statements(node: ast.AST, *, inner: bool = False) -> Iterator[tuple[ast.AST, bool]]:
    """Every statement below a node, and whether it stands within a function."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, (ast.stmt, ast.ExceptHandler, ast.match_case)):
            yield child, inner
            yield from statements(child, inner=inner or isinstance(child, ast.FunctionDef))


@cache
def imports_of(module: str, source: str) -> tuple[Import, ...]:
    """Everything that a module imports from certreg, for types alone, too."""
    found: list[Import] = []
    for node, inner in statements(tree(source)):
        if isinstance(node, ast.Import):
            pairs = [alias.name.rpartition(".")[::2] for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module}: imports are absolute"
            pairs = [(str(node.module), alias.name) for alias in node.names]
        else:
            continue
        found += [
            Import(by=module, source=origin, name=name, line=node.lineno, inner=inner)
            for origin, name in pairs
            if (origin or name).split(".")[0] == "certreg"
        ]
    return tuple(found)


def all_imports(texts: dict[str, str]) -> list[Import]:
    return [one for module, text in texts.items() for one in imports_of(module, text)]


def upward(texts: dict[str, str]) -> list[str]:
    """Every import of a wing from its own line or from below, other than within the wing."""
    faults: list[str] = []
    for one in all_imports(texts):
        if one.by == "certreg" or one.name == "__version__":
            continue
        origin = wing(one.source) if "." in one.source else one.name
        here = wing(one.by)
        if origin != here and WINGS.index(origin) >= WINGS.index(here):
            faults.append(str(one))
    return faults


def trespassing(texts: dict[str, str]) -> list[str]:
    """Every import of a name that is private to another module, or of one from no module."""
    folders = {name.rpartition(".")[0] for name in texts} - {"certreg", ""}
    return [
        str(one)
        for one in all_imports(texts)
        if f"{one.source}.{one.name}" not in texts
        and (one.source in folders or one.name.startswith("_"))
        and one.name != "__version__"
    ]


def within(text: str) -> list[ast.stmt]:
    """What a module holds beside its docstring."""
    return tree(text).body[bool(ast.get_docstring(tree(text))) :]


def homes(source: str) -> dict[str, str]:
    """What the call of `lazy_face` says: the module of each name, relative to the package."""
    calls = [n for n in nodes(source) if isinstance(n, ast.Call)]
    (call,) = [c for c in calls if isinstance(c.func, ast.Name) and c.func.id == "lazy_face"]
    shown: dict[str, tuple[str, ...]] = ast.literal_eval(call.args[1])
    return {name: module for module, names in shown.items() for name in names}


def test_every_wing_stands_on_the_map():
    names = {path.stem for path in PACKAGE.iterdir() if path.suffix in {"", ".py"}}

    assert names - FOLDERS_OF_DATA - {"__init__", "__pycache__"} == set(WINGS)


def test_the_hall_is_small():
    entries = {path.name for path in PACKAGE.iterdir()}

    assert len(entries - {"__init__.py", "__main__.py", "py.typed", "__pycache__"}) <= 20


@pytest.mark.slow
def test_imports_only_go_down_the_map():
    assert upward(sources()) == []


@pytest.mark.slow
def test_a_name_is_imported_from_its_module_and_is_not_private_to_it():
    assert trespassing(sources()) == []


def test_a_package_within_holds_nothing_but_its_modules():
    """Its `__init__` is a docstring: names that users import are those of `certreg`."""
    packages = [path for path in PACKAGE.rglob("__init__.py") if path.parent != PACKAGE]

    assert len(packages) > 15
    assert [path for path in packages if within(path.read_text("utf-8"))] == []
    assert within('"""A face."""\nfrom certreg.problem.moments import trace\n')


def circle(texts: dict[str, str]) -> list[str]:
    """A circle of modules, each of which imports the one before it, for types alone, too."""
    imported: dict[str, set[str]] = {module: set() for module in texts if module != "certreg"}
    for one in all_imports(texts):
        if one.by in imported and one.name != "__version__":
            full = f"{one.source}.{one.name}"
            imported[one.by].add(full if full in texts else one.source)
    try:
        TopologicalSorter(imported).prepare()
    except CycleError as error:
        return error.args[1]
    return []


@pytest.mark.slow
def test_no_modules_import_one_another_in_a_circle():
    planted = sources()
    planted["certreg.geometry.so3"] += "\nfrom certreg.geometry.pose import Pose\n"

    assert circle(sources()) == []
    assert {"certreg.geometry.so3", "certreg.geometry.pose"} <= set(circle(planted))


@pytest.mark.slow
def test_a_planted_upward_import_is_seen():
    planted = sources()
    planted["certreg.problem.moments"] += (
        "\nfrom certreg.registration.certification import certify\n"
    )
    planted["certreg.geometry.so3"] += "\ndef f():\n    import certreg.problem.moments\n"
    planted["certreg.exact.balls"] += (
        "\nif TYPE_CHECKING:\n    from certreg.problem.moments import Moments\n"
    )

    assert upward(planted) == [
        "certreg.exact.balls imports certreg.problem.moments.Moments",
        "certreg.geometry.so3 imports certreg.problem.moments",
        "certreg.problem.moments imports certreg.registration.certification.certify",
    ]


@pytest.mark.slow
def test_a_planted_import_of_a_private_name_or_from_a_package_is_seen():
    planted = sources()
    planted["certreg.dynamics.body"] += "\nfrom certreg.problem.moments import _sums\n"
    planted["certreg.objective.isotropic"] += "\nfrom certreg.problem import moments, Moments\n"
    planted["certreg.io.text"] += "\ndef f():\n    from certreg.native.codegen import C_FILE\n"

    assert trespassing(planted) == [
        "certreg.dynamics.body imports certreg.problem.moments._sums",
        "certreg.io.text imports certreg.native.codegen.C_FILE",
        "certreg.objective.isotropic imports certreg.problem.Moments",
    ]


@pytest.mark.slow
def test_the_public_face_shows_what_its_types_say_and_no_name_of_a_module():
    """But `verify`, which is the function in whatever order both are imported."""
    text = sources()["certreg"]
    names = {name for name in sources() if name.count(".") == 1}
    typed = {
        one.name: one.source.removeprefix("certreg.")
        for one in imports_of("certreg", text)
        if one.source not in {"certreg", "certreg._loading"} and one.name != "verify"
    }

    assert homes(text) == typed
    assert not {f"certreg.{name}" for name in typed} & names


def late_modules(source: str) -> dict[str, str]:
    """By the name that stands for it: each module that `late` loads when it is asked for one."""
    return {
        ast.unparse(node.targets[0]): ast.literal_eval(node.value.args[0])
        for node in nodes(source)
        if isinstance(node, ast.Assign)
        and isinstance(node.value, ast.Call)
        and ast.unparse(node.value.func) == "late"
    }


def mistyped(texts: dict[str, str]) -> list[str]:
    """What `late` loads and the types do not say."""
    faults: list[str] = []
    for module, text in texts.items():
        typed = {
            alias.asname or alias.name: f"{node.module}.{alias.name}"
            for node in nodes(text)
            if isinstance(node, ast.ImportFrom)
            for alias in node.names
        }
        for name, loaded in late_modules(text).items():
            if typed.get(name) != loaded:
                faults.append(f"{module} loads {loaded} as {name}")
    return faults


@pytest.mark.slow
def test_a_module_that_is_loaded_late_is_the_one_that_types_say():
    planted = sources()
    planted["certreg.io.text"] += '\npcd = late("certreg.io.pcd")\n'
    planted["certreg.io.columns"] += (
        '\nfrom certreg.problem import springs\nsprings = late("certreg.problem.attributes")\n'
    )

    assert mistyped(sources()) == []
    assert mistyped(planted) == [
        "certreg.io.columns loads certreg.problem.attributes as springs",
        "certreg.io.text loads certreg.io.pcd as pcd",
    ]
    assert sum(len(late_modules(text)) for text in sources().values()) > 20


def test_few_imports_stand_within_functions():
    inner = {(one.by, one.line) for one in all_imports(sources()) if one.inner}

    assert len(inner) <= INNER_IMPORTS, sorted(inner)


def test_the_checker_is_a_common_part_and_a_section_for_each_kind():
    """And for a few parts that kinds share."""
    text = (PACKAGE / "verify.py").read_text("utf-8")
    sections = re.findall(
        r"^# --- ((?:kind|part): [\w-]+) -+\n(.*?)^# --- end of \1 -+\n",
        text,
        re.DOTALL | re.MULTILINE,
    )
    own = sum(len(section.splitlines()) + 2 for _, section in sections)

    kinds = [name.removeprefix("kind: ") for name, _ in sections if name.startswith("kind: ")]
    assert kinds == list(verify.KINDS)
    assert [name for name, section in sections if len(section.splitlines()) + 2 > 200] == []
    assert len(text.splitlines()) - own <= 350
    assert text.count("# --- ") == 2 * len(sections)


@pytest.mark.slow
def test_a_section_of_the_checker_is_read_beside_the_common_part_alone():
    """No kind uses a name of another's section, and the common part only those of the kinds.

    What kinds share stands in parts; these use none of a kind.
    """
    text = (PACKAGE / "verify.py").read_text("utf-8")
    outside = re.split(r"^# --- (?:end of )?(?:kind|part): .*\n", text, flags=re.MULTILINE)
    parts = re.findall(
        r"^# --- (kind|part): [^\n]*\n(.*?)^# --- end of", text, re.DOTALL | re.MULTILINE
    )
    common, sections = "".join(outside[::2]), [section for _, section in parts]
    shared = [kind == "part" for kind, _ in parts]
    own = [
        {
            ast.unparse(node.targets[0]) if isinstance(node, ast.Assign) else node.name
            for node in tree(part).body
            if isinstance(node, (ast.Assign, ast.ClassDef, ast.FunctionDef))
        }
        for part in sections
    ]
    used = [{n.id for n in nodes(part) if isinstance(n, ast.Name)} for part in sections]

    for k, names in enumerate(used):
        others = [own[j] for j in range(len(own)) if j != k and not shared[j]]
        assert not names & set().union(*others)
        if shared[k]:
            assert not names & set().union(*own[k + 1 :])
    among = {node.id for node in nodes(common) if isinstance(node, ast.Name)}
    forms = {form.__name__ for form in verify.KINDS.values()}
    assert among & set().union(*own) == {"main", *forms}  # it is run at the end of the file


def test_finding_does_not_know_proving():
    for one in all_imports(sources()):
        if wing(one.by + ".") in FINDING:
            assert wing(one.source + ".") not in PROVING, str(one)


@pytest.mark.slow
def test_functions_and_modules_keep_to_the_sizes_of_the_house():
    for module, source in sources().items():
        assert module == "certreg.verify" or len(source.splitlines()) <= 450, module
        for node, _ in statements(tree(source)):
            if isinstance(node, ast.FunctionDef):
                lines = (node.end_lineno or 0) - node.lineno + 1
                told = ast.get_docstring(node, clean=False) or ""  # whose sections are long
                assert lines - len(told.splitlines()) <= 55, f"{module}.{node.name}"


NOT_ABSTRACT = re.compile(r"^ +raise NotImplementedError", re.MULTILINE)


def test_what_a_subclass_must_have_is_abstract_so_that_the_type_checker_asks_for_it():
    assert [name for name, text in sources().items() if NOT_ABSTRACT.search(text)] == []
    assert NOT_ABSTRACT.search("def f():\n    raise NotImplementedError\n")


def test_no_two_test_files_have_the_same_name():
    """Pytest would refuse the second, and with it all tests; a folder that is a package may."""
    files = Path(__file__).parents[1].rglob("test_*.py")
    names = [path.name for path in files if not path.with_name("__init__.py").exists()]

    assert len(names) > 100
    assert sorted(names) == sorted(set(names))
