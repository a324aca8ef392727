"""Linear systems of a plane body: positive definite, of one pattern from the first step to the last."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy import sparse
from scipy.linalg import cho_solve_banded, cholesky_banded
from scipy.sparse.csgraph import reverse_cuthill_mckee
from scipy.sparse.linalg import splu

#: Operations beyond which a sparse factorisation with its own ordering is cheaper than one within the band.
_BAND_LIMIT = 3e9


class SymmetricSolver:
    """Assembles symmetric matrices over free degrees of freedom and solves with them.

    The numbering, and the place of every entry, are found once, here: narrow in band if that is cheap (a beam is),
    sparse if not.

    Parameters
    ----------
    blocks : sequence of (n, k) int
        Degrees of freedom of elements, and of whatever else couples some of them.
    fixed : (m,) int
        Degrees of freedom left out.
    position : (size, 2) float
        Where the degrees of freedom are, to number them along the longer way.
    """

    def __init__(self, blocks: Sequence[np.ndarray], fixed: np.ndarray, position: np.ndarray) -> None:
        size = len(position)
        rows = np.concatenate([np.repeat(block, block.shape[1], axis=1).ravel() for block in blocks])
        columns = np.concatenate([np.tile(block, (1, block.shape[1])).ravel() for block in blocks])
        graph = sparse.csr_matrix((np.ones(rows.size), (rows, columns)), shape=(size, size))
        long = int(np.argmax(np.ptp(position, axis=0)))
        orders = (
            np.lexsort((position[:, 1 - long], np.round(position[:, long], 12))),
            reverse_cuthill_mckee(graph, symmetric_mode=True),
        )
        free = np.ones(size, dtype=bool)
        free[fixed] = False
        candidates = []
        for order in orders:
            place = np.full(size, -1)
            kept = order[free[order]]
            place[kept] = np.arange(kept.size)
            both = (place[rows] >= 0) & (place[columns] >= 0)
            reach = int(np.abs(place[rows] - place[columns])[both].max())
            candidates.append((reach, kept, place))
        reach, self.free, place = min(candidates, key=lambda found: found[0])
        row, column = place[rows], place[columns]
        n = self.free.size
        self._sparse = n * float(reach) ** 2 > _BAND_LIMIT
        inside = (row >= 0) & (column >= 0)
        if self._sparse:
            self._kept = np.flatnonzero(inside)
            flat, self._slot = np.unique(column[self._kept].astype(np.int64) * n + row[self._kept], return_inverse=True)
            self._rows = (flat % n).astype(np.int32)
            self._starts = np.searchsorted(flat, np.arange(n + 1, dtype=np.int64) * n).astype(np.int32)
            self._entries = flat.size
        else:
            self._kept = np.flatnonzero(inside & (row >= column))
            row, column = row[self._kept], column[self._kept]
            self._slot = column * (reach + 1) + row - column
            self._entries = n * (reach + 1)

    def factor(self, *blocks: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """A function that solves with the sum of ``blocks``, each (n, k, k), for right sides (free, b).

        Raises
        ------
        numpy.linalg.LinAlgError
            When the matrix is not positive definite, or singular.
        """
        values = np.concatenate([block.ravel() for block in blocks])[self._kept]
        entries = np.bincount(self._slot, weights=values, minlength=self._entries)
        n = self.free.size
        if self._sparse:
            matrix = sparse.csc_matrix((entries, self._rows, self._starts), shape=(n, n))
            try:
                whole = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
            except RuntimeError as error:  # SuperLU's word for a singular matrix
                raise np.linalg.LinAlgError(str(error)) from error
            solve: Callable[[np.ndarray], np.ndarray] = whole.solve
            return solve
        band = cholesky_banded(entries.reshape(n, -1).T, lower=True, overwrite_ab=True, check_finite=False)
        return lambda right: np.asarray(cho_solve_banded((band, True), right, check_finite=False))
