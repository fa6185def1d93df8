"""The registration problem: points, weights, motion, damping; and its digest."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from certreg.errors import InvalidProblemError
from certreg.problem.arrays import cloud_array, contiguous, finite_doubles, mapped_file, row_blocks
from certreg.problem.losses import SQUARES, PairLoss
from certreg.problem.motion import DEFAULT_DAMPING, Motion, Scale, checked_damping, checked_motion
from certreg.problem.row_labels import require_same_labels
from certreg.problem.springs import GivenSprings, require_one_noise, stated_pairs
from certreg.problem.support import PREFIXES, Cell, require_supported
from certreg.results import Brief

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from certreg.problem.terms import Named, Pairs, SpringSummary


@dataclass(frozen=True, slots=True, eq=False, init=False)
class RegistrationProblem(Brief):
    """Find the rigid motion that takes `source` to `target`, row i to row i.

    The arrays are copied and read-only. Only those that are mapped from a file for reading
    (`numpy.load(file, mmap_mode="r")`) stay in the file, of whatever type, and are read block by
    block whenever they are needed, so that a cloud may be larger than the memory. Nobody may
    change the file meanwhile. Where it happens all the same, the certificate is refused, or holds
    for the points that its digest names.

    Parameters
    ----------
    source, target
        (N, 3) arrays of numbers, N >= 1, in one unit of length, of any library that NumPy reads; or
        any object with `.points` (Open3D), `.vertices` (trimesh) or `.xyz` (laspy); or data frames.
        Those with labels must have the same in the same order: `certreg.pair` brings them into one.
    sigma
        Standard deviation of the noise per coordinate, a scalar or (N,), > 0, same unit; the weight
        is the double nearest to 1/sigma^2.
    weights
        Instead of sigma, (N,) or a scalar, >= 0, not all zero.
    normals, directions, covariances, information, factors
        General springs, one matrix W for every pair, in the frame of the target: (N, 3) normals
        of its surface (point to plane); (N, 3) directions of its lines; (N, 3, 3) or (N, 6)
        matrices, xx, xy, xz, yy, yz, zz: covariances of the noise (W is their inverse) or W itself;
        (N, 6), l11, l21, l22, l31, l32, l33, or (N, 3), its one column: a lower triangular L,
        W = L L^T. Of several kinds each pair has one, and NaN in the rows of the others; a pair
        with NaN in all is a point spring, L = I. Objects with such attributes (Open3D, small_gicp)
        and tables with such columns (nx, ny, nz, ...) may be given as they are. `sigma` divides L,
        and `weights` multiply W. With covariances alone the noise counts as given.
    damping
        Viscous damping per mass, mu > 0, per time unit of the virtual springs; where none is given
        sqrt(8), but `certify` takes the one of the fastest decay.
    scale
        "none", "asymmetric" or "symmetric", see `Scale`: whether the motion may scale, too. Noise
        in the source makes the asymmetric scale too small; the symmetric one is right where both
        clouds have the same relative noise, and too large with noise in the target alone.
    rotation_only
        Whether the motion has no translation, as between directions of stars: t = 0, and all sums
        are about the origin.

    Raises
    ------
    InvalidProblemError
        For what states no problem: array, row and remedy.

    Examples
    --------
    >>> RegistrationProblem([[0, 0, 0], [1, 0, 0], [0, 2, 0]], [[0, 0, 0], [1, 0, 0], [0, 2, 0]]).n
    3
    """

    pairs: Pairs
    source: NDArray[np.float64]
    target: NDArray[np.float64]
    springs: SpringSummary | None  # of general springs
    damping: float
    motion: Motion
    loss: PairLoss  # `bounded` makes others than the least squares
    noise_given: bool  # whether sigma was given: weights alone may be relative
    damping_given: bool
    _digest: list[str]  # once it was asked for; of arrays in memory, which nobody changes

    def __init__(  # noqa: PLR0913 - each kind of springs has a name of its own, a published contract
        self,
        source: Any,
        target: Any,
        *,
        sigma: ArrayLike | None = None,
        weights: ArrayLike | None = None,
        normals: Any = None,
        directions: Any = None,
        covariances: Any = None,
        information: Any = None,
        factors: Any = None,
        damping: float | None = None,
        scale: str | Scale = Scale.NONE,
        rotation_only: bool = False,
    ) -> None:
        require_one_noise(sigma, weights)
        source_points = finite_doubles(cloud_array(source, "source"), "source")
        target_points = finite_doubles(cloud_array(target, "target"), "target")
        n = len(source_points)
        require_as_many(n, len(target_points))
        given = GivenSprings(
            normals=normals,
            directions=directions,
            covariances=covariances,
            information=information,
            factors=factors,
        )
        require_same_labels(source, target=target, sigma=sigma, weights=weights, **given.rows)
        clouds = source_points, target_points
        pairs = stated_pairs(clouds, given, (source, target), sigma=sigma, weights=weights)
        for name, fact in (
            ("pairs", pairs),
            ("source", pairs.source),
            ("target", pairs.target),
            ("springs", pairs.summary),
            ("damping", checked_damping(DEFAULT_DAMPING if damping is None else damping)),
            ("damping_given", damping is not None),
            ("motion", checked_motion(scale, rotation_only)),
            ("loss", SQUARES),
            ("noise_given", sigma is not None or given.is_noise),
            ("_digest", list[str]()),
        ):
            object.__setattr__(self, name, fact)
        require_supported(self.cell)

    def __repr__(self) -> str:
        springs = [] if self.springs is None else [f"springs: {self.springs.kind}"]
        loss = [self.loss.kind.value] * self.loss.bounds.ndim
        words = (*springs, *self.motion.words, *["sigma given"] * self.noise_given, *loss)
        return f"<RegistrationProblem: {', '.join((f'n={self.n}', *words))}>"

    def modelled(self, scale: str | Scale, *, rotation_only: bool) -> RegistrationProblem:
        """The same problem, of a motion that may do more, or less.

        Parameters
        ----------
        scale, rotation_only
            As for a new problem.

        Returns
        -------
        RegistrationProblem
            Of the same arrays.

        Raises
        ------
        InvalidProblemError
            For other names, and for what is not supported.
        """
        other = self._changed(motion=checked_motion(scale, rotation_only), _digest=[])
        require_supported(other.cell)
        return other

    def under(self, loss: PairLoss) -> RegistrationProblem:
        """The same problem with another loss, whose bounds `bounded` checks.

        Parameters
        ----------
        loss
            With bounds of the pairs.

        Returns
        -------
        RegistrationProblem
            Of the same arrays.
        """
        return self._changed(loss=loss, _digest=[])

    def _changed(self, **changes: Any) -> RegistrationProblem:
        """Of the same arrays; `copy.copy` takes four times as long."""
        other = object.__new__(RegistrationProblem)
        for name in self.__slots__:
            object.__setattr__(other, name, changes.get(name, getattr(self, name)))
        return other

    @property
    def cell(self) -> Cell:
        """What was declared, for the table of what is supported."""
        return Cell(self.pairs.matrices, **self.motion.arguments, loss=self.loss.kind)

    @property
    def scale(self) -> Scale:
        """Whether the scale is free, and what the best one minimises."""
        return self.motion.scale

    @property
    def rotation_only(self) -> bool:
        """Whether the motion has no translation."""
        return self.motion.arguments["rotation_only"]

    @property
    def scaled(self) -> bool:
        """Whether the scale is free."""
        return self.motion.scale.free

    @property
    def observations(self) -> int:
        """How many numbers with noise the pairs are: three for a weight, the rank of a spring."""
        return self.pairs.observations

    @property
    def degrees_of_freedom(self) -> int:
        """Of the residuals, all parameters of the pose counted; below zero of too few pairs."""
        return self.motion.degrees(self.observations)

    def damped(self, damping: float) -> RegistrationProblem:
        """The same problem with another damping.

        Parameters
        ----------
        damping
            mu > 0.

        Returns
        -------
        RegistrationProblem
            Of the same arrays.

        Raises
        ------
        InvalidProblemError
            For others.
        """
        return self._changed(damping=checked_damping(damping), damping_given=True)

    def of_rows(self, rows: Sequence[int]) -> RegistrationProblem:
        """The least squares over some of the pairs, with their weights or springs, and their noise.

        Parameters
        ----------
        rows
            Of the pairs.

        Returns
        -------
        RegistrationProblem
            Of copies of their rows.

        Raises
        ------
        InvalidProblemError
            Where none of them counts: all have the weight 0, or a spring that is 0.
        """
        other = RegistrationProblem(
            **dict(self.pairs.rows(list(rows)).data()),
            damping=self.damping if self.damping_given else None,
            **self.motion.arguments,
        )
        object.__setattr__(other, "noise_given", self.noise_given)
        return other

    @property
    def n(self) -> int:
        """Number of correspondences."""
        return len(self.source)

    @property
    def weights(self) -> NDArray[np.float64]:
        """(N,), one weight for each pair.

        Raises InvalidProblemError where there are general springs: nobody takes them for weights.
        """
        return self.pairs.weights

    @property
    def factors(self) -> NDArray[np.float64] | None:
        """(N, 6), of general springs; None where there are weights."""
        return dict(self.pairs.data()).get("factors")

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user should know of general springs."""
        return () if self.springs is None else self.springs.notes

    @property
    def bounds(self) -> NDArray[np.float64]:
        """(N,), of the loss, in the unit of length: infinite for least squares over all pairs."""
        return np.broadcast_to(self.loss.bounds, (self.n,))

    @property
    def mapped(self) -> bool:
        """Whether a part of the problem stays in a file, which somebody else could change."""
        return any(mapped_file(array) is not None for _, array in self._stated)

    @property
    def equally_weighted(self) -> bool:
        """Whether all weights are the same."""
        one = self.weights[0]
        blocks = (contiguous(self.weights, rows) for rows in row_blocks(self.n))
        return all((block == one).all() for block in blocks)

    @property
    def points(self) -> Pairs:
        """All pairs in doubles, contiguous: of those that are mapped from a file a copy."""
        return self.block(slice(0, self.n))

    def block(self, rows: slice) -> Pairs:
        """Some of the pairs in doubles, contiguous.

        Parameters
        ----------
        rows
            Of the points.

        Returns
        -------
        Pairs
            Source, target and springs of these rows.

        Raises
        ------
        InvalidProblemError
            Where a file holds no proper points any more.
        """
        return self.pairs.block(rows)

    def data_bytes(self) -> bytes:
        """The bytes that state the problem: prefix, n (u64), then all doubles, little-endian."""
        return b"".join(self._pieces())

    def digest(self) -> str:
        """SHA-256 of `data_bytes()`, 64 hexadecimal digits: the identity of the problem."""
        if self._digest:
            return self._digest[0]
        digest = hashlib.sha256()
        for piece in self._pieces():
            digest.update(piece)
        if not self.mapped:
            self._digest.append(digest.hexdigest())
        return digest.hexdigest()

    def _pieces(self) -> Iterator[bytes | memoryview]:
        """What `data_bytes` holds, piece by piece."""
        yield PREFIXES[self.cell] + self.n.to_bytes(8, "little")
        for name, array in self._stated:
            for rows in row_blocks(len(array)):
                yield contiguous(array, rows, name).astype("<f8", copy=False).data

    @property
    def _stated(self) -> tuple[Named, ...]:
        """The arrays that state the problem, in the order of its digest, by name."""
        each = self.loss.bounds.ndim  # whether each pair has a bound
        return self.pairs.data(*[("max_residual", self.bounds)] if each else ())


def require_as_many(n: int, m: int) -> None:
    """Raises InvalidProblemError where the source has another number of points than the target."""
    if n != m:
        raise InvalidProblemError(
            f"source has {n} points, target has {m}: correspondences pair row i with row i, so "
            "both need the same number",
            array="target",
            value=m,
            limit=n,
        )
