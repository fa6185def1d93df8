"""The file of a certificate: an envelope that names the points, and a body that proves of them.

Format `certreg-certificate/1`: JSON, UTF-8, sorted keys; every number that carries proof is an
integer or a dyadic pair [mantissa, exponent]. What a body proves is said by its kind.
"""

from __future__ import annotations

import base64
import hashlib
import json
import os
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

from certreg._loading import found_late
from certreg.certificate.file_parts import FilePart, MisreadError
from certreg.errors import InvalidFileError
from certreg.io.atomic import write_atomically
from certreg.io.streams import require_ending
from certreg.results import Brief
from certreg.verify import FILE_MAX, JSON, NODES_MAX, RefusalError, shown

if TYPE_CHECKING:
    from certreg.problem.problem import RegistrationProblem


FORMAT = "certreg-certificate/1"
FILE = json.JSONEncoder(sort_keys=True, allow_nan=False, indent=1)
CERTIFICATE = "certificate.json"  # of a folder that certify --out wrote
LINE = json.JSONEncoder(sort_keys=True, allow_nan=False, separators=(",", ":"))
PIECE = 3 << 18  # bytes of data encoded at a time: a multiple of three


class CertificateBody(FilePart):
    """What a kind of certificate adds to the envelope: its proof and its claims.

    COMPACT: thousands of small integers, without a line for each.
    INLINE: the contract: of more points the file carries the digest only.
    """

    __slots__ = ()
    KIND: ClassVar[str]
    COMPACT: ClassVar[bool] = False
    INLINE: ClassVar[int] = 1_000_000


BODIES = {  # by their kind: module of this wing, and class
    "isotropic": ("isotropic", "IsotropicBody"),
    "similarity": ("isotropic", "SimilarityBody"),
    "count": ("count", "CountBody"),
    "springs-sos": ("squares", "SpringsSosBody"),
    "springs-cones": ("cones", "SpringsConesBody"),
    "springs-list": ("listing", "SpringsListBody"),
    "consensus": ("consensus", "ConsensusBody"),
    "truncated-rotation": ("truncated", "TruncatedRotationBody"),
    "consensus-similarity": ("consensus", "ConsensusSimilarityBody"),
}
KINDS = {  # each is loaded where a certificate is of it
    kind: found_late(f"certreg.certificate.{module}", body)
    for kind, (module, body) in BODIES.items()
}
AnyBody_co = TypeVar("AnyBody_co", bound=CertificateBody, covariant=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class Envelope(FilePart):
    """What the files of all kinds say; data: in base64, the bytes that are hashed."""

    PLACES: ClassVar = {"data": "problem.data", "digest": "problem.digest", "n": "problem.n"}

    kind: str
    about: dict[str, Any]
    n: int
    digest: str
    data: str | None = None
    format: str = FORMAT


ENVELOPE = {"about", "format", "kind", "problem"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Certificate(Brief, Generic[AnyBody_co]):
    """A proof object for one problem.

    Attributes
    ----------
    n, digest
        Number of points, and SHA-256 of `RegistrationProblem.data_bytes`.
    inline
        What has the bytes that are hashed into the digest: these, or the problem, which is not
        copied before they are asked for; None where it is too large to inline.
    body
        What is claimed and what proves it, of one of `KINDS`.
    about
        Names and settings; nothing in it is proved.
    """

    n: int
    digest: str
    inline: bytes | RegistrationProblem | None = field(compare=False)  # the digest is compared
    body: AnyBody_co
    about: dict[str, Any] = field(default_factory=dict[str, Any])

    def __repr__(self) -> str:
        return f"<Certificate of kind {self.body.KIND}: n={self.n}, digest={self.digest[:12]}...>"

    @property
    def data(self) -> bytes | None:
        """The bytes that are hashed into the digest; None where the file is not to hold them."""
        inline = self.inline
        return inline if inline is None or isinstance(inline, bytes) else inline.data_bytes()

    @classmethod
    def load(cls, certificate: str | os.PathLike[str] | bytes) -> Certificate[CertificateBody]:
        """The certificate in a file. Proves nothing: ask `certreg.verify`.

        As strict as the checker: it must have all keys of its kind, of the right types and sizes,
        and no others. Stricter in one thing: a state in `basin` is there or null, not null in part.

        Parameters
        ----------
        certificate
            A path, or the bytes of the file.

        Returns
        -------
        Certificate[CertificateBody]
            As it was before it was saved.

        Raises
        ------
        InvalidFileError
            Where the file cannot be read or is not well-formed.
        """
        content = certificate_bytes(certificate)
        name = "the certificate" if isinstance(certificate, bytes) else shown(certificate)
        try:
            document = _decoded(content)
            head = Envelope.from_fields({key: document[key] for key in ENVELOPE & document.keys()})
            body, text = body_of(document), head.data
            data = None if text is None else base64.b64decode(text, validate=True)
        except (RefusalError, ValueError, MemoryError) as error:
            reason = str(error) or "not enough memory"
            raise InvalidFileError(
                f"{name}: is no certificate ({reason}): give a file that certreg wrote",
                path=None if isinstance(certificate, bytes) else Path(certificate),
            ) from error
        return Certificate(
            n=head.n,
            digest=head.digest,
            inline=data,
            body=body,
            about=head.about,
        )

    def pieces(self) -> Iterator[bytes]:
        """The file's content, piece by piece."""
        form = LINE if self.body.COMPACT else FILE
        yield from file_pieces(self._document(), self.data, form=form)

    def _document(self) -> dict[str, Any]:
        head = Envelope(kind=self.body.KIND, about=self.about, n=self.n, digest=self.digest)
        return {**head.to_fields(), **self.body.to_fields()}

    def to_json(self) -> bytes:
        """The file's content."""
        return b"".join(self.pieces())

    def line(self) -> bytes:
        """The same on one line, for a file of many."""
        return b"".join(file_pieces(self._document(), self.data, form=LINE))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the file; under a temporary name first, so that it is never half there.

        Parameters
        ----------
        path
            Of the file.

        Raises
        ------
        InvalidFileError
            Where it cannot be written.
        """
        write_atomically(path, self.pieces())


def enclosed(
    problem: RegistrationProblem, body: AnyBody_co, about: dict[str, Any] | None = None
) -> Certificate[AnyBody_co]:
    """The body in its envelope, with the points unless they are too many."""
    inline = None
    if problem.n <= body.INLINE:
        inline = problem.data_bytes() if problem.mapped else problem  # a file may change meanwhile
    return Certificate(
        n=problem.n,
        digest=hashlib.sha256(inline).hexdigest()
        if isinstance(inline, bytes)
        else problem.digest(),
        inline=inline,
        body=body,
        about=about or {},
    )


def body_of(document: dict[str, Any]) -> CertificateBody:
    """What the file of a certificate says that is of its kind alone. Raises MisreadError."""
    kind = KINDS.get(document["kind"])
    if kind is None or document["format"] != FORMAT:
        raise MisreadError(f"is not a {FORMAT} of a known kind")
    own = {key: value for key, value in document.items() if key not in ENVELOPE}
    return kind().from_fields(own)


def _decoded(content: bytes) -> dict[str, Any]:
    """The object in a file that is no larger than the checker reads. Raises MisreadError."""
    nodes = sum(map(content.count, (b",", b"[", b"{")))
    if len(content) > FILE_MAX or nodes > NODES_MAX:
        raise MisreadError("is too large")
    try:
        document = JSON.decode(content.decode())
    except (ValueError, RecursionError) as error:
        raise MisreadError("is not JSON in UTF-8 of a sane depth") from error
    if document.__class__ is not dict:
        raise MisreadError("is not an object")
    return document


def file_pieces(
    document: dict[str, Any], data: bytes | None, *, form: json.JSONEncoder = FILE
) -> Iterator[bytes]:
    """A certificate's file, with the data in place of the null: large, so never twice in memory."""
    text = form.encode(document) + "\n"
    if data is None:
        yield text.encode()
        return
    # Within a string the quotes would be escaped, and of the parts `problem` is the last with data.
    before, name, after = text.rpartition(f'"data"{form.key_separator}')
    yield (before + name + '"').encode()
    for start in range(0, len(data), PIECE):
        yield base64.b64encode(data[start : start + PIECE])
    yield ('"' + after.removeprefix("null")).encode()


def certificate_bytes(
    certificate: str | os.PathLike[str] | bytes | Certificate[CertificateBody],
) -> bytes:
    """The bytes of the file, one more than allowed at most. Raises InvalidFileError."""
    if isinstance(certificate, Certificate):
        return certificate.to_json()
    if isinstance(certificate, bytes):
        return certificate
    if Path(certificate).is_dir():
        certificate = Path(certificate) / CERTIFICATE
    if os.fspath(certificate).endswith(".jsonl"):
        raise InvalidFileError(
            f"{shown(certificate)}: holds a certificate a line: let `certreg verify` check them "
            "all, or give the bytes of one line",
            path=Path(certificate),
        )
    try:
        require_ending(certificate)
        with Path(certificate).open("rb") as stream:
            return stream.read(FILE_MAX + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "not a file name"
        raise InvalidFileError(
            f"{shown(certificate)}: cannot be read ({reason}): give a readable file",
            path=Path(certificate),
        ) from error
