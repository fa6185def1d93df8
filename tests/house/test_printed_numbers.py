"""A number that is printed as a bound goes through `at_most` or `at_least`, never to the nearest.

Of the checker: through its own `rounded`. Every other format of a number stands on a list below,
with what its last digit is worth.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
from syntax import nodes

import certreg

PACKAGE = Path(certreg.__file__).parent
COVERED = ("verify.py", "results.py", "problem", "registration", "report", "campaign", "cli", "io")
SPEC = re.compile(r"([gefn%]|\.\d+)$", re.IGNORECASE)
TEMPLATE = re.compile(r"\{[^{}:]*:[-+ ,#\d.]*[gefn%]\}", re.IGNORECASE)
PERCENT = re.compile(r"%[-+ #0]*[\d.*]*[gef]", re.IGNORECASE)
ROUNDERS = {"round", "around", "quantize", "format_float_positional", "format_float_scientific"}
ALLOWED = {  # what the last digit of a number to the nearest is worth, and where there is one
    "of the certified rotation to twelve decimals, said to be rounded; not a bound": """
        verify.py {(c << 64) / length:.12f}
    """,
    "a Decimal that `rounded` made, of no more digits than are printed": """
        verify.py {degrees:.1e}
        verify.py {ends[0]:g}
        verify.py {ends[1]:g}
    """,
    "tried: told only if its weight is the certified one, exactly": """
        verify.py {w ** (-0.5):.6g}
    """,
    "of a result in the `repr`": """
        results.py {float(value):.6g}
        registration/result.py {self.rmse:.6g}
        registration/assessed.py {away:.6g}
    """,
    "a constant, rounded down: 1 and 3.14159, below pi": """
        results.py {whole:.6g}
    """,
    "measured or computed, and told as that: no inequality is printed": """
        problem/gicp.py {angle:.6g}
        registration/agreement.py {math.degrees(angle):.3g}
        registration/ambiguity.py {100 * equilibria.margin.relative:.3g}
        registration/ambiguity.py {away:.4g}
        registration/ambiguity.py {best.rmse:.3g}
        registration/ambiguity.py {following.rmse:.3g}
        registration/assessment_words.py {apart:.2g}
        registration/assessment_words.py {apart:.6g}
        registration/assessment_words.py {away:.4g}
        registration/assessment_words.py {defect:.1e}
        registration/assessment_words.py {degrees:.4g}
        registration/assessment_words.py {away:.6g}
        registration/assessment_words.py {math.degrees(rest.angle):.2g}
        registration/closed_form.py {gap:.3g}
        registration/pair_words.py {percent:.2g}
        registration/pair_words.py {width:.2g}
        registration/examples.py round(c.rmse or 0.0, RMSE_DIGITS)
        registration/rounding.py {times:.3g}
        registration/convention_errors.py {degrees:.2g}
        registration/convention_errors.py {scale:.6g}
        registration/convention_errors.py {shift:.3g}
        registration/valley.py {degrees:.{digits}g}
        registration/valley.py {self.excess:.2g}
        registration/labelled.py {self.cost:.6g}
        report/judged_pose.py {math.degrees(angle):.4g}
        report/overview.py {ratio:.3g}
        report/viewer.py {away:.3g}
        report/viewer.py {away:.4g}
        report/viewer.py {most:.3g}
        report/scene_words.py {here / best:.3g}
        report/scene_words.py {math.degrees(worst.angle_to_optimum):.4g}
        report/words.py {ran[name]:.3g}
        io/poses.py {norm:.6g}
        io/pairing.py {here:.16g}
        io/pairing.py {there:.16g}
        io/text.py {column[0]:.0f}
        io/text.py {column[1]:.0f}
        io/trajectories.py {least:.6g}
        io/trajectories.py {math.hypot(*row[4:]):.6g}
    """,
    "a whole number, or the way to one": """
        registration/ambiguity.py round(degrees)
        registration/misfits.py round(1 / CHANCE)
        registration/convention_errors.py turn.round(LEAST_DECIMALS)
        registration/convention_errors.py turn.round(d)
        registration/label_assessment.py round(entry * 2.0 ** BITS)
        report/uncertainty.py round(value, decimals)
    """,
    "a figure of statistics, which proves nothing": """
        registration/assessment_words.py {distance.value:.3g}
        registration/misfits.py {1000000.0 * off:.3g}
        registration/misfits.py {chi2.value:.6g}
        registration/misfits.py {off:.3g}
        registration/misfits.py {percent:.3g}
        registration/misfits.py {times:.3g}
        registration/misfits.py {times:.6g}
        registration/misfits.py {times:.{1 - math.floor(math.log10(times - 1.0))}f}
        registration/misfits.py {times:.{digits}g}
        registration/misfits.py {unit[0]:.6g}
        registration/pair_warnings.py {100.0 * share:.3g}
        report/judged_pose.py {distance.p:.2g}
        report/judged_pose.py {distance.value:.4g}
        report/uncertainty.py {chi2.p:.2g}
        report/uncertainty.py {chi2.value:.4g}
        report/uncertainty.py {round(value, decimals) + 0.0:.{decimals}f}
        report/uncertainty.py {value:.1e}
        report/uncertainty.py {value:.1g}
        report/uncertainty.py {value:.6g}
        report/uncertainty.py {value:.{max(0, 1 - math.floor(math.log10(value)))}f}
        report/uncertainty.py {value:.{max(0, digits - 1)}e}
    """,
    "never rounded to the limit that it is held against": """
        registration/exit_codes.py {value:.{digits}g}
        registration/gap_parts.py {percent:.3g}
        report/lines.py {percent:.{digits}f}
        report/thinning.py {100.0 * left:.3g}
    """,
    "numbers of a pose in words; all digits stand beside them": """
        registration/loose_turns.py axis.round(3)
        registration/loose_turns.py {entry + 0.0:.3g}
        report/pose_facts.py {:.6f}
        report/pose_facts.py {:.6g}
        report/pose_facts.py {entry:.4f}
        report/pose_facts.py {value:.5e}
        report/pose_facts.py {value:.9g}
        report/pose_words.py {degrees:.4g}
        report/pose_words.py {entry:.3f}
        report/pose_words.py {entry:.6g}
        report/pose_words.py {pose.scale:.6g}
        report/pose_facts.py {scale:.9g}
        cli/judging.py {pose.scale:.15g}
    """,
    "a value to try, or beside which the user's is held": """
        registration/units.py {unit[0]:.6g}
    """,
    "seconds, steps and rates of a run": """
        report/any_report.py {EMBEDDED_BYTES / 2 ** 20:.0f}
        report/breaking.py {stage.time:.4g}
        report/methods.py {1000.0 * each.seconds:.2f}
        report/reload.py {damping:.6g}
        report/reload.py {problem.damping:g}
        report/rest_sections.py {run.times[-1]:.6g}
        report/simulation.py {run.speed:.3g}
        report/simulation.py {run.time:.6g}
        report/words.py {damping:.6g}
        cli/progress.py {self.made / self.seconds:,.0f}
        cli/reproducing.py {progress.seconds:.1f}
        cli/reproducing.py {rate:,.0f}
        cli/reproducing.py {solving * workers.count:,.0f}
    """,
    "numbers of a table or a card, computed; proved bounds stand apart from them": """
        report/breaking.py {stage.energy:.6g}
        report/breaking.py {stage.width:.4g}
        report/equilibria.py {math.degrees(each.component.angle_to_optimum):.6g}
        report/simulation.py {run.best_scale:.6g}
        report/simulation.py {first:.6g}
        report/simulation.py {last:.6g}
        report/cards.py {math.degrees(away or 0.0):.4g}
        report/cards.py {value:.6g}
        report/pair_page.py {share[row]:.3g}
        report/methods.py {e:.10g}
        report/equilibria.py {math.degrees(part.angle_to_first):.6g}
        report/equilibria.py {part.above:.1e}
        report/springs.py {100.0 * of_it:.3g}
        report/springs.py {100.0 * share:.3g}
        report/springs.py {math.degrees(away):.1g}
        report/lines.py {100 * margin.relative:.3g}
        report/lines.py {context.divide(Decimal(value.numerator), Decimal(value.denominator)):.9e}
        report/lines.py {degrees:.{digits}g}
        report/equilibria.py {math.degrees(component.angle_to_optimum):.6g}
        report/lines.py {trajectory.scales[-1]:.6g}
        report/lines.py {value:.4g}
        report/lines.py {value:.6f}
        report/lines.py {value:.9e}
        report/pair_page.py {angles[row]:.3g}
        report/pairs.py {least.cost:.9g}
    """,
    "a place, a size or a mark in a picture": """
        report/breaking.py {top + PANEL * (1.0 - height):.1f}
        report/breaking.py {total:.4g}
        report/breaking.py {widest:.3g}
        report/breaking.py {x:.1f}
        report/breaking.py {y:.1f}
        report/pair_picture.py round(SCALE * 160)
        report/pair_picture.py round(SCALE * 240)
        report/pair_picture.py {10.0 ** k:g}
        report/pair_picture.py {float(_down(np.array([10.0 ** k]), low, high)[0]):.1f}
        report/picture.py {value:.1f}
    """,
}


def formats(source: str) -> list[str]:
    """What a module formats or rounds to the nearest: the value and how, as it is written."""
    return sorted({text for node in nodes(source) if (text := formatted(node)) is not None})


def formatted(node: ast.AST) -> str | None:
    """How a piece of syntax rounds; None where it does not."""
    if isinstance(node, ast.FormattedValue) and node.format_spec is not None:
        spec = ast.unparse(node.format_spec)[2:-1]
        loses = SPEC.search(spec) and not decimal_of_the_checker(node.value, spec)
        return f"{{{ast.unparse(node.value)}:{spec}}}" if loses else None
    if isinstance(node, ast.Call):
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        spec = name == "format" and isinstance(node.func, ast.Name) and len(node.args) > 1
        return ast.unparse(node) if name in ROUNDERS or spec else None
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mod):
        text = getattr(node.left, "value", None)
        return ast.unparse(node) if isinstance(text, str) and PERCENT.search(text) else None
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return next(iter(TEMPLATE.findall(node.value)), None)
    return None


def decimal_of_the_checker(value: ast.expr, spec: str) -> bool:
    """Whether `rounded` of `verify.py` made the number, of no more digits than are printed."""
    if not (isinstance(value, ast.Call) and getattr(value.func, "id", "") == "rounded"):
        return False
    digits = getattr(value.args[1], "value", 0)
    return spec in {"g", f".{digits - 1}e"}


def found() -> set[str]:
    """All of the modules that print first lines, theorems, limits, warnings, pages and tables."""
    sources = (path for part in COVERED for path in sorted(PACKAGE.glob(f"{part}/**/*.py")))
    return {
        f"{path.relative_to(PACKAGE).as_posix()} {text}"
        for path in (*(PACKAGE / part for part in COVERED if part.endswith(".py")), *sources)
        for text in formats(path.read_text("utf-8"))
    }


def listed() -> list[str]:
    return [line.strip() for lines in ALLOWED.values() for line in lines.strip().splitlines()]


@pytest.mark.slow
def test_a_number_to_the_nearest_is_on_the_list_with_its_reason():
    """A bound goes through `at_most` or `at_least`, a number of the user through `as_given`."""
    there, known = found(), {*listed()}

    assert (sorted(there - known), sorted(known - there)) == ([], [])
    assert len(listed()) == len(known)


@pytest.mark.parametrize(
    "planted",
    [
        'f"no motion brings more than 5 within {bound:g}"',
        'f"within {x:.3g} degrees"',
        'f"{x:.{digits}e}"',
        'f"{x:,.0f}"',
        'f"{x:.1%}"',
        'f"{x:.4}"',
        'f"{rounded(x, 3):.1e}"',
        'f"{rounded(x, 3):.3g}"',
        'f"{float(rounded(x, 3)):g}"',
        'f"{round(x, 3)}"',
        "np.round(x, 3)",
        "x.round(3)",
        "Decimal(x).quantize(y)",
        'format(x, ".3g")',
        '"%.3g" % x',
        '"at most %s, %5.2f" % (a, b)',
        '"at most {:.3g}".format(x)',
        'WORDS = "at most {gap:.3e}"',
    ],
)
def test_a_planted_number_to_the_nearest_is_seen(planted: str):
    assert len(formats(planted)) == 1


@pytest.mark.parametrize(
    "safe",
    [
        'f"within {at_most(x)} degrees, {x!r}, {x}, {n:,}, {n:>5}, {name:16}"',
        'f"{rounded(x, 3):.2e} {rounded(x, 12):g} {rounded(x, 9, ROUND_FLOOR):g}"',
        '"at most {gap}".format(gap=at_most(x))',
        '"%s of %d" % (a, b)',
        "n % 3",
        '"%s" % x',
    ],
)
def test_numbers_that_keep_their_side_are_let_through(safe: str):
    assert formats(safe) == []
