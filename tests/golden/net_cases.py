"""The cases of the light net, in words of the command line; chosen by what they reach.

Each headline, each warning of a fit, each slip, each refusal, each format that is written. `file`
keeps what a step wrote, `python` what a function of `net_python.py` prints. To add a case, write it
here and `make record`.
"""

from __future__ import annotations

from dataclasses import dataclass

TRUNCATED = "--rotation-only --objective truncated --max-residual"
ALONE = "--no-relaxation --no-simulation"


@dataclass(frozen=True)
class NetCase:
    name: str
    steps: tuple[str, ...]


def _certified(name: str, clouds: str, *more: str) -> NetCase:
    return NetCase(f"certify-{name}", (f"certify {clouds} {ALONE}", *more))


def _judged(name: str, clouds: str, *poses: str) -> NetCase:
    return NetCase(f"assess-{name}", tuple(f"assess {clouds} --pose {pose}" for pose in poses))


GOOD = "cloud.csv noisy.csv"

CASES = (
    NetCase(
        "wrong-pairs",
        (
            "certify cloud.csv noisy.csv --max-residual 0.08 --out o",
            "file o o/fit.csv",
            "verify o/certificate.json",
            "certify cloud.csv noisy.csv --max-residual weights.txt",
            "certify cloud.csv noisy.csv --max-residual 0.08 --effort 0",
            "certify cloud.csv noisy.csv --max-residual nothing.txt",
            "certify cloud.csv noisy.csv --effort 2",
            "certify cloud.csv noisy.csv --max-residual 0.08 --scale asymmetric",
            "certify cloud.csv planes.csv --springs plane --max-residual 0.08",
            "certify cloud.csv wall.csv --springs plane --max-residual 0.08",
            "certify cloud.csv noisy.csv --sigma 0.02 --max-residual 0.08 --json",
            "certify cloud.csv noisy.csv --max-residual 0.08 --rotation-only",
            "certify short.csv narrow.csv --max-residual weights.txt",
            "certify cloud.csv inches.csv --max-residual 0.01 --json",
            "certify axes.csv half.csv --max-residual 2 --require-fit",
        ),
    ),
    NetCase(
        "truncated",
        (
            f"certify ways.csv bothways.csv {TRUNCATED} 0.25 --out o",
            "file o/fit.csv",
            "page o/report.html",
            "python bared o/certificate.json bared.json",
            "report bared.json",
            f"report bared.json ways.csv bothways.csv {TRUNCATED} 0.25",
            "apply bared.json ways.csv --out a.csv",
            f"certify short.csv narrow.csv {TRUNCATED} 0.0001 --max-gap 1e-30 --out p",
            "page p/report.html",
            f"certify short.csv narrow.csv {TRUNCATED} 0.5 --json",
            f"certify hair.csv hair.csv {TRUNCATED} 0.5",
            f"certify axes.csv half.csv {TRUNCATED} 2",
            f"certify cloud.csv noisy.csv {TRUNCATED} 0.01",
        ),
    ),
    NetCase(
        "assess-labels",
        (
            "assess cloud.csv noisy.csv --labels some.txt --max-residual 0.08",
            *(
                f"assess short.csv narrow.csv --labels {labels} --max-residual 0.5 --rotation-only "
                "--objective truncated"
                for labels in ("kept.txt", "swapped.txt")
            ),
        ),
    ),
    NetCase(
        "certify-all",
        (
            "certify axes.csv turned.csv --damping 3",
            "certify axes.csv half.csv --integrator euler",
            f"certify axes.csv turned.csv {ALONE}",
        ),
    ),
    NetCase(
        "certify-out",
        (
            "certify cloud.csv noisy.csv --sigma 0.02 --damping 2 --integrator midpoint --out o",
            "file o o/certificate.json o/result.json o/pose.txt o/pose.json o/fit.csv",
            "file o/trajectory.npz o/report.html",
            "verify o/certificate.json",
            "verify o/certificate.json cloud.csv noisy.csv",
            "verify o/certificate.json cloud.csv noisy.csv --any-weight",
            "verify o/certificate.json cloud.csv noisy.csv --sigma 0.02 --max-gap 1e-9",
            "verify o/certificate.json cloud.csv noisy.csv --sigma 0.02 --ignore-weights",
            "verify o/certificate.json noisy.csv cloud.csv --sigma 0.02",
            "verify o/certificate.json cloud.npy noisy.csv --sigma 0.02",
            "verify o/certificate.json cloud.npy noisy.csv",
            "verify o/certificate.json cloud.npy noisy.csv --any-weight",
            "verify o/certificate.json labelled.csv sigmas.csv",
            "verify o/certificate.json labelled.csv sigmas.csv --any-weight",
            "verify o/certificate.json cloud.csv noisy.csv --sigma 0.02 --weights weights.txt",
            "verify o/certificate.json --sigma 0.02",
            "verify o/certificate.json --max-angle 1e-99",
            "report o/certificate.json --out o/again.html",
            "assess cloud.csv noisy.csv --pose o --sigma 0.02",
            "apply o cloud.csv --out o/m.csv",
            "apply o labelled.csv --out o/m.txt",
            "apply o cloud.csv --out o/m.ply",
            "apply o cloud.csv --out o/m.npy",
            "file o/m.csv o/m.txt o/m.ply o/m.npy",
            f"certify cloud.csv noisy.csv {ALONE} --out o",
            "file o",
        ),
    ),
    _certified(
        "noisy",
        GOOD,
        f"certify {GOOD} --sigma 0.02 {ALONE}",
        f"certify {GOOD} --sigma 1 {ALONE}",
        f"certify {GOOD} --weights weights.txt {ALONE}",
    ),
    _certified(
        "noisier", "cloud.csv noisier.csv", f"certify cloud.csv noisier.csv --sigma 0.02 {ALONE}"
    ),
    _certified(
        "narrow",
        "short.csv narrow.csv",
        f"certify short.csv narrow.csv --sigma 0.01 {ALONE} --out o",
        "page o/report.html",
        f"certify needle.csv needled.csv {ALONE} --out o",
        "page o/report.html",
    ),
    _certified(
        "scaled",
        "cloud.csv scaled.csv",
        f"certify cloud.csv scaled.csv {ALONE} --require-fit --max-rmse 0.01",
        f"certify cloud.csv scaled.csv {ALONE} --out o",
        "page o/report.html",
    ),
    _certified(
        "units",
        "cloud.csv inches.csv",
        f"certify cloud.csv twice.csv {ALONE}",
        f"certify axes.csv large.csv {ALONE}",
        f"certify cloud.csv ppm.csv {ALONE}",
        "certify axes.csv wide.csv",
        f"certify axes.csv huger.csv {ALONE}",
    ),
    _certified(
        "outliers",
        "cloud.csv outlier.csv",
        f"certify labelled.csv labelledwrong.csv {ALONE}",
        f"certify cloud.csv exchanged.csv {ALONE}",
    ),
    _certified(
        "pairing",
        "cloud.csv shuffled.csv",
        f"certify cloud.csv rolled.csv {ALONE}",
        f"certify cloud.csv reflected.csv {ALONE}",
        f"certify cloud.csv unlike.csv {ALONE}",
    ),
    _certified(
        "far",
        "cloud.csv far.csv",
        f"certify cloud.csv farther.csv {ALONE}",
        f"certify cloud.csv farther.csv {ALONE} --out o",
        "page o/report.html",
        f"certify cloud.csv farther.csv {ALONE} --damping 2 --json",
    ),
    _certified(
        "limits",
        f"{GOOD} --max-gap 1e-30",
        f"certify {GOOD} {ALONE} --max-angle 1e-30 --max-gap 0.5",
        f"certify line.csv bent.csv --max-gap 1e-40 {ALONE}",
    ),
    _certified(
        "one",
        "one.csv other.csv",
        f"certify one.csv other.csv {ALONE} --max-gap 0 --out o",
        "page o/report.html",
    ),
    *(
        NetCase(
            f"row-{name}",
            (
                f"certify {name}-source.csv {name}-target.csv --damping 2",
                f"equilibria {name}-source.csv {name}-target.csv",
                f"assess {name}-source.csv {name}-target.csv --pose identity.txt",
            ),
        )
        for name in (
            "1111-mirrored",
            "121",
            "112",
            "13",
            "211",
            "31",
            "22",
            "22-two-points",
            "4",
            "4-cancelling",
        )
    ),
    NetCase(
        "circle",
        (
            "certify 22-source.csv 22-target.csv --out o",
            "file o/pose.json",
            "certify 31-source.csv 31-target.csv --out o --json",
        ),
    ),
    NetCase(
        "equilibria",
        (
            "equilibria axes.csv turned.csv --method all",
            "equilibria axes.csv turned.csv --method all --json",
            "equilibria axes.csv turned.csv --method homotopy",
            "equilibria axes.csv turned.csv --method groebner --out count.json",
            "verify count.json",
            "report count.json",
            "file count.json",
            "equilibria 13-source.csv 13-target.csv --out count.json",
            "equilibria 13-source.csv 13-target.csv --method all",
            "equilibria short.csv narrow.csv",
            "equilibria needle.csv needled.csv",
            "equilibria axes.csv turned.csv --method homotopy --json",
            "equilibria 4-source.csv 4-target.csv --method all",
        ),
    ),
    NetCase(
        "simulate",
        (
            "simulate axes.csv turned.csv --out t.npz",
            "file t.npz",
            "simulate axes.csv turned.csv --json --integrator splitting --damping optimal",
            "simulate axes.csv turned.csv --integrator midpoint --step 0.05",
            "simulate axes.csv half.csv",
            "simulate 22-source.csv 22-target.csv",
            "simulate one.csv other.csv",
        ),
    ),
    _judged(
        "good",
        GOOD,
        "right.txt",
        "near.txt",
        "rotation.json",
        "'tum.txt' --line 2",
        "inexact.txt",
        "kitti.txt",
        "list.json",
        "rows.json",
        "matrix.json",
        "pose.npy",
        "right.txt --json --sigma 0.02",
    ),
    _judged(
        "bad", GOOD, "off.txt", "shiftedoff.txt", "reflection.txt", "off.txt --sigma 0.02 --json"
    ),
    _judged(
        "spurious",
        "axes.csv turned.csv",
        "axesright.txt",
        "halfturn.txt",
        "halfx.txt",
        "halfx.txt --json",
    ),
    _judged(
        "slips",
        "cloud.csv moved.csv",
        *(
            f"{slip}.txt"
            for slip in (
                "inverse",
                "transposed",
                "transposedbest",
                "scalarlast",
                "scalarfirst",
                "centred",
                "centredsource",
                "centredtarget",
                "millimetres",
                "similar",
                "off",
                "shiftedoff",
                "near",
            )
        ),
    ),
    NetCase(
        "assess-refused",
        tuple(
            f"apply {pose} cloud.csv --out a.csv"
            for pose in (
                "rotationalone.json",
                "twopose.json",
                "short.json",
                "words.json",
                "stack.npy",
                "three.npy",
                "three-by-three.txt",
                "projective.txt",
                "norm.txt",
                "five.txt",
                "word.txt",
                "'tum.txt' --line 3",
                "accept-count.json",
                "accept-pattern-1111.json",
                "similar.txt",
            )
        ),
    ),
    _judged("narrow", "short.csv narrow.csv", "identity.txt"),
    _judged("needle", "needle.csv needled.csv", "scalarlast.txt", "axesturn.txt"),
    NetCase("assess-slip", ("assess cloud.csv moved.csv --pose inverse.txt --json",)),
    _judged("poor", "cloud.csv outlier.csv", "right.txt"),
    NetCase(
        "read",
        (
            f"certify labelled.csv labels.csv {ALONE}",
            f"certify labelled.csv fewer.csv {ALONE} --match common",
            f"certify labelled.csv fewer.csv {ALONE}",
            f"certify cloud.csv noisy.csv --pairs pairs.txt {ALONE}",
            f"certify cloud.csv noisy.csv --pairs again.txt --one-to-one {ALONE}",
            f"certify labelled.csv sigmas.csv {ALONE}",
            f"certify cloud.xyz noisy.csv {ALONE}",
            f"certify cloud.ply noisy.csv {ALONE}",
            f"certify cloud.npy noisy.csv {ALONE}",
            f"certify cloud.csv noisy.csv --weights some.txt {ALONE}",
            f"certify cloud.csv noisy.csv --pairs again.txt {ALONE}",
            f"certify plain.csv semicolons.csv {ALONE}",
            *(
                f"certify cloud.csv noisy.csv --pairs {name}.txt"
                for name in ("outside", "three", "whole", "nopairs")
            ),
            *(
                f"certify {clouds}"
                for clouds in (
                    "labelled.csv others.csv --match common",
                    "labelled.csv double.csv",
                    "ids.csv ids2.csv",
                )
            ),
            "certify cloud.csv noisy.csv --pairs nowhere.txt",
            "certify cloud.csv noisy.csv --pairs cloud.ply",
        ),
    ),
    NetCase(
        "refused",
        (
            "certify nowhere.csv axes.csv",
            "certify word.csv axes.csv",
            "certify ragged.csv axes.csv",
            "certify nan.csv axes.csv",
            "certify cloud.csv axes.csv",
            "certify axes.csv turned.csv --sigma 0",
            "certify cloud.csv noisy.csv --weights zero.txt",
            "certify axes.csv turned.csv --sigma 1 --weights weights.txt",
            "certify axes.csv turned.csv --max-gap 2",
            "certify axes.csv turned.csv --max-rmse nan",
            "certify axes.csv turned.csv --damping 0",
            "certify axes.csv huger.csv",
            "certify axes.csv turned.csv --one-to-one",
            "certify axes.csv turned.csv --pairs pairs.txt --match common",
            "verify junk.json",
            "verify nowhere.json",
            "verify junk.json axes.csv",
            "verify junk.json --any-weight",
            "verify junk.json --out a.v",
            "verify junk.json --coq --max-gap 1",
            "report junk.json",
            "report junk.json --out junk.json",
            "assess axes.csv turned.csv --pose junk.json",
            "assess axes.csv turned.csv --pose tum.txt",
            "apply reflection.txt axes.csv --out a.csv",
            "apply right.txt axes.csv --out a.stl",
            "simulate axes.csv turned.csv --step 0",
            "simulate axes.csv turned.csv --out a.csv",
            "simulate one.csv other.csv --damping optimal",
            "batch misspelt-list.csv",
            "batch header-list.csv",
            "batch nothing-list.csv",
            "batch junk.json",
            "batch empty-list.csv",
            "batch list.csv --parquet",
            "nonsense",
            "codegen --out junk.json",
        ),
    ),
    NetCase(
        "vectors",
        tuple(
            f"verify {name}.json"
            for name in (
                "accept-count",
                "accept-pattern-1111",
                "accept-pattern-22-collinear",
                "accept-pattern-4",
                "refuse-gap-one-unit-too-small",
                "refuse-unique-where-it-is-not",
            )
        ),
    ),
    NetCase(
        "batch",
        (
            "batch short-list.csv",
            "batch list.csv --out o --max-rmse 0.5",
            "file o o/summary.csv o/columns.csv o/certificates",
            "batch list.csv --out o --max-rmse 0.5",
            "batch list.csv --out o",
            "batch wrong-list.csv --out w --max-gap 1e-30",
            "file w/summary.csv",
            "batch list.csv --out p --require-fit --parquet",
            "file p",
        ),
    ),
    NetCase(
        "weak",
        (
            f"certify {GOOD} --out o",
            "python weaken o/certificate.json weak.json",
            "report weak.json",
            "page report.html",
            "verify weak.json",
            "python weaken o/certificate.json weaker.json none",
            "verify weaker.json",
            "report weaker.json --out weaker.html",
            "page weaker.html",
            "python renamed o/certificate.json other.json",
            "report other.json",
            "report o/certificate.json cloud.csv noisy.csv",
            "report o/certificate.json cloud.csv moved.csv",
            "python bared o/certificate.json bared.json",
            "verify bared.json",
            "report bared.json",
            "report bared.json cloud.csv noisy.csv",
            "report bared.json cloud.csv noisy.csv --any-weight",
            f"certify {GOOD} {ALONE} --out p",
            "report p/certificate.json --out p/again.html",
            "page p/again.html",
        ),
    ),
    *(
        NetCase(f"python-{name}", (f"python {name}",))
        for name in (
            *("cards", "texts", "missing", "pages", "doubts", "poses", "calls", "stories"),
            *("bad_files", "formats", "fits", "runs"),
        )
    ),
    *(
        NetCase(f"shown-{name.split(' ', 1)[0]}", (f"python shown {name}",))
        for name in (
            "rows 'twelve rows' 'on two poses' mirrored",
            "scales 'with sigma' beyond",
            "noise 'each its own'",
            "ties 'needle, scaled' 'rod, sure' 'narrow, a row'",
            "sizes 'a line far' 'at rest'",
            "patterns plain 121 13 211 22 31 4 'half a turn' small euler",
        )
    ),
    NetCase(
        "judged",
        (
            "python judged 0 0",
            "python judged 0 0.01 right quaternion inverse doubled turned 'three decimals'",
            "python judged 0 0.01 'turned a little' 'shifted a little' 'scalar last'",
            "python judged 5e6 0.01 'six decimals' right",
            "python judged 5e6 0 right shifted 'three decimals' 'centred source' doubled inverse",
        ),
    ),
    NetCase(
        "springs-planes",
        (
            "certify cloud.csv planes.csv --springs plane --out o",
            "file o o/pose.json o/fit.csv",
            "page o/report.html",
            "verify o/certificate.json",
            "verify o/certificate.json cloud.csv planes.csv --springs plane",
            "verify o/certificate.json cloud.csv planes.csv",
            "report o/certificate.json --out o/again.html",
            *(
                f"assess cloud.csv planes.csv --springs plane --pose {pose}"
                for pose in ("o/pose.json", "right.txt", "near.txt", "off.txt", "identity.txt")
            ),
            "certify cloud.csv planes.csv --springs plane --sigma 0.02",
            "certify cloud.csv planes.csv --springs plane --sigma 0.001 --out s",
            "page s/report.html",
            "certify cloud.csv planes.csv --springs plane --sigma 0.02 --max-angle 1e-30 --json",
            "simulate cloud.csv planes.csv --springs plane",
            "equilibria cloud.csv planes.csv --springs plane",
            "certify cloud.csv planes.csv --springs plane --damping optimal",
            "certify cloud.csv pointless.csv --springs plane",
        ),
    ),
    NetCase(
        "springs-kinds",
        (
            "certify cloud.csv lines.csv --springs line",
            "certify cloud.csv full.csv --springs full --out f",
            "page f/report.html",
            "assess cloud.csv full.csv --springs full --pose right.txt",
            "certify cloud.csv noisy.csv --normals some.csv --directions rest.csv --json",
            "certify cloud.csv noisy.csv --normals some.csv --directions rest.csv",
        ),
    ),
    NetCase(
        "springs-free",
        (
            *(
                step
                for walls in ("wall", "walls")
                for step in (
                    f"certify cloud.csv {walls}.csv --springs plane --out {walls}",
                    f"page {walls}/report.html",
                    f"assess cloud.csv {walls}.csv --springs plane --pose {walls}/pose.json",
                )
            ),
            "verify wall/certificate.json",
            "assess cloud.csv wall.csv --springs plane --pose right.txt",
            "certify ball.csv sphere.csv --springs plane",
            "assess ball.csv sphere.csv --springs plane --pose identity.txt",
            "certify five.csv fiveplanes.csv --springs plane",
            "certify six.csv sixplanes.csv --springs plane",
            "certify choi_lam_source.csv choi_lam_target.csv --factors choi_lam_target.csv --out c",
            "page c/report.html",
        ),
    ),
    NetCase("equilibria-of-rows", ("python listed patterns", "python spurious")),
    NetCase("altered", ("python altered", "python unsaid")),
    NetCase(
        "about",
        (
            "info",
            "codegen --out c",
            "file c/example.c c/survey.txt",
            "--help",
            "--version",
            "certify --help",
            "demo --out d",
        ),
    ),
)
