"""Poses in JSON: results and pose files of certreg, bare lists, and certificates."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from certreg.geometry.given import GivenPose
from certreg.geometry.orthogonality import ROTATION_TOLERANCE
from certreg.io.pose_values import finite_array, of_matrix, of_quaternion
from certreg.verify import FORMAT, RefusalError, parse, shown

if TYPE_CHECKING:
    from certreg.io.pose_values import PoseSource

QUATERNION = 4  # entries
BOUNDED = "consensus", "truncated"  # what only results of pairs with bounds hold
SCALE = 64  # bits: the root of the norm is then right beyond a double


def pose_of_json(source: PoseSource, content: bytes, text: str) -> GivenPose:
    """The pose in a document; content: the bytes of the text, of which certificates are parsed."""
    try:
        document: Any = json.loads(text)
    except (ValueError, RecursionError) as error:
        message = f"is not JSON ({shown(error)}): give a pose file or a certreg result"
        raise source.refusal(message) from error
    if isinstance(document, list):
        return of_matrix(source, document)
    fields = cast("dict[str, Any]", document)
    if fields.get("format") == FORMAT:
        return pose_of_certificate(source, content)
    some = any(isinstance(fields.get(name), dict) for name in BOUNDED)
    if isinstance(fields.get("pose"), dict):
        fields = fields["pose"]
    if "T_target_source" in fields:
        return replace(of_matrix(source, fields["T_target_source"]), of_some=some)
    if not {"rotation", "quaternion_wxyz"} & set(fields) or "translation" not in fields:
        raise source.refusal("holds no pose (T_target_source, or rotation and translation)")
    return replace(_pose_of_fields(source, fields), of_some=some)


def pose_of_certificate(source: PoseSource, content: bytes) -> GivenPose:
    """The rotation that a certificate is about, rounded to doubles; nothing in it is believed.

    The file holds no translation: it is the best one for the points that it is about.
    """
    try:
        statement = parse(content)
    except RefusalError as error:
        message = f"is neither a pose file nor a well-formed certificate ({shown(error)})"
        raise source.refusal(message) from error
    q = getattr(statement, "pose", None) or _pose_of_fit(getattr(statement, "fit", None))
    if not any(q):  # that of a count holds none
        raise source.refusal("is a certificate that holds no pose: give a pose or a result")
    norm = math.isqrt(sum(entry * entry for entry in q) << 2 * SCALE)
    turn = np.array([(entry << SCALE) / norm for entry in q])
    some = statement.model.endswith(("--max-residual", "--objective truncated"))
    return GivenPose(turn=turn, translation=None, of_some=some)


def _pose_of_fit(fit: Any) -> tuple[int, ...]:
    """Of the least squares that a certificate of wrong pairs holds, as nobody has checked it."""
    fields = cast("dict[str, Any]", fit) if isinstance(fit, dict) else {}
    proof = fields.get("proof", fields)
    pose = cast("dict[str, Any]", proof).get("pose") if isinstance(proof, dict) else None
    entries = cast("list[Any]", pose) if isinstance(pose, list) else []
    right = len(entries) == QUATERNION and all(type(entry) is int for entry in entries)
    return tuple(entries) if right else (0,)


def _pose_of_fields(source: PoseSource, fields: dict[str, Any]) -> GivenPose:
    """Rotation, quaternion or both, which must agree, and a translation."""
    translation = finite_array(source, fields["translation"], (3,), "translation")
    matrix = None
    if "rotation" in fields:
        matrix = finite_array(source, fields["rotation"], (3, 3), "rotation")
    scale = _scale(source, fields.get("scale"))
    if "quaternion_wxyz" not in fields:
        return GivenPose(turn=cast("Any", matrix), translation=translation, scale=scale)
    quaternion = finite_array(source, fields["quaternion_wxyz"], (4,), "quaternion_wxyz")
    pose = of_quaternion(source, quaternion, translation)
    apart = 0.0 if matrix is None else float(np.abs(matrix - pose.rotation).max())
    if apart > ROTATION_TOLERANCE:
        message = "rotation and quaternion_wxyz are two different rotations: keep one"
        raise source.refusal(
            message, column="quaternion_wxyz", value=apart, limit=ROTATION_TOLERANCE
        )
    return replace(pose, scale=scale)


def _scale(source: PoseSource, value: Any) -> float | None:
    """Of y = s R x + t; None where there is none, as in the result of a rigid problem."""
    if value is None:
        return None
    scale = float(finite_array(source, value, (), "scale"))
    if scale <= 0.0:
        message = f"scale is {scale!r}: that of a similarity is > 0"
        raise source.refusal(message, column="scale", value=scale, limit=0.0)
    return scale
