"""The attainable set: every wrench that thrusts inside their limits can give, by its faces."""

from itertools import combinations
from math import comb

import numpy as np

MOST_FACES = 5000  # of a set that is asked at every tick
MOST_CHOICES = 25_000  # sets of thrusters that are looked at for their faces
NO_SERVICE = 1e-9  # a singular value, relative to the largest, that serves no DOF
DEGENERATE = 1e-7  # thrusters whose columns are closer to dependent span no face
ALONG_FACE = 1e-9  # share of the way to a face, relative to the fastest, that leads along it
ON_FACE = 1e-12  # from a face, relative to set and point, that is on it
TINY = 1e-300  # instead of 0, for the distance of a face of a set that is flat
DIGITS = 8  # in which the normals of one face agree


class TooManyFaces(ValueError):
    """A vehicle whose attainable set has too many faces to ask at every tick."""

    def __init__(self, faces: int) -> None:
        """Keep the number of faces, or of what there may be of them."""
        super().__init__(f'the attainable set has up to {faces} faces, must have at most '
                         f'{MOST_FACES}')
        self.faces = faces


class AttainableSet:
    """
    The set {B_D tau: lower <= tau <= upper} of wrenches over some DOFs D, a zonotope.

    A face lies along r - 1 thrusters, r the rank of B_D. So its normal n depends on B_D alone, and
    the limits only shift it: n f <= max(n B, 0) upper + min(n B, 0) lower. Any question about the
    set then takes two matrix products, one for the wrench and one for the limits.

    The part of a wrench that no thruster can give, whatever its limits, is not looked at: the
    wrench is taken to its nearest point in the range of B_D, in the metric of the weights R.
    """

    def __init__(self, matrix: np.ndarray, wrench_weights: np.ndarray,
                 enabled: np.ndarray | None = None) -> None:
        """
        Find the faces.

        :param matrix: B, (6, p).
        :param wrench_weights: R, (6,); a DOF of weight 0 is not in D.
        :param enabled: (p,) whether a thruster counts; the limits of the others must be 0.
        :raises TooManyFaces: if there are more than `MOST_FACES`.
        """
        root = np.sqrt(np.asarray(wrench_weights, dtype=float))
        scaled = root[:, np.newaxis] * matrix  # S B
        if enabled is not None:
            scaled = scaled * np.asarray(enabled, dtype=float)
        left, singular, right = np.linalg.svd(scaled, full_matrices=False)
        rank = int(np.sum(singular > NO_SERVICE * singular[0])) if singular[0] > 0.0 else 0
        self._root, self._range = root, left[:, :rank]
        # tau = pinv(S B) S f gives the part of f in the range of B_D, exactly
        self._per_wrench = np.ascontiguousarray(
            right[:rank].T / singular[:rank] @ (left[:, :rank].T * root))
        p = matrix.shape[1]
        self._inside = bytes(p * [1] + p * [0])  # above the lower limit and not above the upper one
        columns = self._range.T @ scaled
        normals = _normals(columns)
        self._normals = np.ascontiguousarray(
            np.vstack([normals, -normals]) @ (self._range.T * root))  # (faces, 6)
        if self.faces > MOST_FACES:
            raise TooManyFaces(self.faces)
        slopes = normals @ columns  # M, (faces / 2, p)
        above, below = np.maximum(slopes, 0.0), np.minimum(slopes, 0.0)
        self._distances = np.ascontiguousarray(
            np.block([[below, above], [-above, -below]]))  # of the faces from 0, per limit

    @property
    def rank(self) -> int:
        """Return r: in how many independent ways the thrusters act on D."""
        return self._range.shape[1]

    @property
    def faces(self) -> int:
        """Return how many faces there are, both ways of each normal counted."""
        return len(self._normals)

    def scale(self, wrench: np.ndarray, limits: np.ndarray) -> float:
        """
        Return the largest alpha in [0, 1] for which alpha times a wrench is attainable.

        :param wrench: f, (6,); only the DOFs in D count [N, N*m].
        :param limits: (2, p), row 0 lower (<= 0), row 1 upper (>= 0) [N].
        """
        if (self._per_wrench.dot(wrench) > limits).tobytes() == self._inside or not self.faces:
            return 1.0
        ways = self._normals.dot(wrench)
        ways[ways <= ALONG_FACE * ways.max()] = 0.0
        distances = self._distances.dot(limits.ravel())
        return 1.0 / max(1.0, (ways / np.maximum(distances, TINY)).max().item())

    def room(self, point: np.ndarray, directions: np.ndarray, limits: np.ndarray) -> np.ndarray:
        """
        Return where the line from a point along each direction enters and leaves the set.

        :param point: (6,); only the DOFs in D count, and of these what thrusts can give [N, N*m].
        :param directions: (n, 6); what they have outside D does not count.
        :param limits: (2, p), row 0 lower, row 1 upper [N].
        :return: (n, 2), the smallest t and the largest for which point + t direction is attainable:
            around 0 for an attainable point; NaN where the line misses the set, 0 where it leaves
            the range of B_D.
        """
        flat = limits.ravel()
        distances = self._distances.dot(flat) - self._normals.dot(point)
        near = distances > -ON_FACE * (np.abs(self._distances).dot(np.abs(flat))
                                       + np.abs(self._normals).dot(np.abs(point)))
        distances = np.where(near, np.maximum(distances, 0.0), distances)
        ways = self._normals @ directions.T  # (faces, n)
        along = np.abs(ways) <= ALONG_FACE * np.abs(ways).max(axis=0, initial=0.0)
        share = distances[:, np.newaxis] / np.where(along, 1.0, ways)
        largest = np.where(along | (ways < 0.0), np.inf, share).min(axis=0, initial=np.inf)
        smallest = np.where(along | (ways > 0.0), -np.inf, share).max(axis=0, initial=-np.inf)
        missed = (smallest > largest) | (along & (distances < 0.0)[:, np.newaxis]).any(axis=0)
        found = np.where(missed[:, np.newaxis], np.nan, np.stack([smallest, largest], axis=1))
        return np.where(self.serves(directions)[:, np.newaxis], found, 0.0)

    def serves(self, directions: np.ndarray) -> np.ndarray:
        """Tell which directions lie in the range of B_D, and are not 0 in D."""
        scaled = directions * self._root
        missed = scaled - scaled @ self._range @ self._range.T
        size = np.linalg.norm(scaled, axis=1)
        return (size > 0.0) & (np.linalg.norm(missed, axis=1) <= DEGENERATE * size)


def _normals(columns: np.ndarray) -> np.ndarray:
    """
    Return the unit normals of the faces of a zonotope, one of each pair, (n, r).

    :param columns: (r, p) of rank r, the directions that its edges may have.
    :raises TooManyFaces: if there are too many sets of thrusters to look at.
    """
    rank = len(columns)
    if rank < 2:
        return np.ones((rank, rank))
    sizes = np.linalg.norm(columns, axis=0)
    used = sizes > NO_SERVICE * sizes.max()
    edges = _unique((columns[:, used] / sizes[used]).T)  # parallel thrusters are one
    if comb(len(edges), rank - 1) > MOST_CHOICES:
        raise TooManyFaces(2 * comb(len(edges), rank - 1))
    chosen = np.array(list(combinations(range(len(edges)), rank - 1)))
    _, singular, right = np.linalg.svd(edges[chosen])  # of (n, r - 1, r)
    spanning = singular[:, -1] > DEGENERATE * singular[:, 0]
    return _unique(right[spanning, -1])


def _unique(vectors: np.ndarray) -> np.ndarray:
    """Return each of the unit vectors (n, r) once, of v and -v only one."""
    signs = np.sign(vectors @ np.cos(np.arange(1.0, vectors.shape[1] + 1.0)))
    signed = vectors * np.where(signs == 0.0, 1.0, signs)[:, np.newaxis]
    _, first = np.unique(np.round(signed, DIGITS) + 0.0, axis=0, return_index=True)
    return signed[np.sort(first)]
