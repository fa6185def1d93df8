"""The tables of a run in Markdown, made from its document alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from benchmarks.measuring import Quantity, power_of_ten

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

MARK = {True: "kept", False: "**missed**", None: ""}
NO_ANSWER = "none"  # a peer that refuses or overflows


def ratios(series: dict[str, Any]) -> str:
    """The seconds of the first line, and how many times those every other line takes."""
    lines = {line["name"]: _times(line) for line in series["lines"]}
    (first, ours), *others = lines.items()
    sizes = sorted({size for times in lines.values() for size in times})
    rows = [[f"**{first}**", *(_seconds(ours.get(size)) for size in sizes)]]
    for name, times in others:
        shared = times.keys() & ours.keys()
        rows.append([name, *(_ratio(times[s] / ours[s]) if s in shared else "" for s in sizes)])
    return _table([series["size"], *(power_of_ten(size) for size in sizes)], rows)


def bounds(run: dict[str, Any]) -> str:
    """Every claim: its figure, its bound, whether it was kept."""
    rows = [
        [name, figure["what"], _quantity(figure), _bound(figure), MARK[figure["passed"]]]
        for name, row in run["figures"].items()
        for figure in row
        if figure["passed"] is not None
    ]
    return _table(["by", "what", "figure", "bound", ""], rows, left=2)


def figures(run: dict[str, Any], name: str, *, containing: str) -> str:
    """The figures of one measurement whose names contain some words, and what stands beside."""
    found = [figure for figure in run["figures"][name] if containing in figure["what"]]
    rows = [[each["what"], _quantity(each), _beside(each)] for each in found]
    return _table(["what", "figure", "beside it"], rows, left=3)


def peers(run: dict[str, Any]) -> str:
    """What certreg was measured beside, and why a peer is missing."""
    rows = [
        [peer["name"], peer["version"] or f"absent: {peer['absent']}", f"`{peer['call']}`"]
        for peer in run["peers"]
    ]
    return _table(["peer", "version", "what is called"], rows, left=3)


def accuracy(run: dict[str, Any], cases: dict[str, str]) -> str:
    """A row for each tool, a column for each case of `cases`: figure to heading."""
    found = {figure["what"]: figure["beside"] for figure in run["figures"]["accuracy"]}
    tools = list(dict.fromkeys(tool for case in cases for tool in found[case]))
    rows = [[tool, *(_angle(found[case].get(tool)) for case in cases)] for tool in tools]
    return _table(["radians", *cases.values()], rows)


def origin(run: dict[str, Any]) -> str:
    """Where, when and of what the run was made: a list, since its entries are long."""
    machine, load, commit = run["machine"], run["load"], run["commit"]
    caches = ", ".join(f"{name} {_bytes(size)}" for name, size in machine["caches"].items())
    memory = _bytes(machine["memory"]) if machine["memory"] else "unknown"
    rows = {
        "date": f"{run['date'].replace('T', ' ').removesuffix('+00:00')} UTC, "
        f"{run['seconds']:.0f} seconds",
        "commit": _commit(commit),
        "processor": f"{machine['cpu']}, {machine['cores']} cores ({caches})",
        "memory": memory,
        "system": machine["system"],
        "load": f"{_loads(load['start'])} at the start, {_loads(load['end'])} at the end",
        "versions": ", ".join(f"{name} {found}" for name, found in run["versions"].items()),
    }
    return "\n".join(f"- **{key}**: {value}" for key, value in rows.items())


def _table(head: Sequence[str], rows: Iterable[Sequence[str]], *, left: int = 1) -> str:
    """The first `left` columns are words, the others numbers."""
    rule = [":--" if k < left else "--:" for k in range(len(head))]
    return "\n".join("| " + " | ".join(row) + " |" for row in (head, rule, *rows))


def _times(line: dict[str, Any]) -> dict[int, float]:
    return dict(zip(line["sizes"], line["seconds"], strict=True))


def _seconds(seconds: float | None) -> str:
    return "" if seconds is None else str(Quantity(seconds, "s"))


def _ratio(ratio: float) -> str:
    return f"{ratio:.2g}×" if ratio < 100 else f"{ratio:.0f}×"


def _quantity(figure: dict[str, Any]) -> str:
    value = figure["value"]
    return NO_ANSWER if value is None else str(Quantity(value, figure["unit"]))


def _beside(figure: dict[str, Any]) -> str:
    return ", ".join(f"{name.rstrip(':')} {_quantity(q)}" for name, q in figure["beside"].items())


def _bound(figure: dict[str, Any]) -> str:
    unit = figure["unit"]
    sides = (("≥", figure["least"]), ("≤", figure["bound"]))
    return ", ".join(f"{sign} {Quantity(side, unit)}" for sign, side in sides if side is not None)


def _angle(quantity: dict[str, Any] | None) -> str:
    if quantity is None:
        return ""
    return NO_ANSWER if quantity["value"] is None else f"{quantity['value']:.1e}"


def _bytes(size: int) -> str:
    step = next(k for k in (3, 2, 1, 0) if size >= 1024**k)
    return f"{size / 1024**step:.3g} {('B', 'KiB', 'MiB', 'GiB')[step]}"


def _commit(commit: dict[str, Any] | None) -> str:
    if commit is None:
        return "unknown"
    return f"`{commit['id'][:12]}`" + (" with changes" if commit["changed"] else "")


def _loads(load: Sequence[float] | None) -> str:
    return "unknown" if load is None else " ".join(f"{each:.1f}" for each in load)
