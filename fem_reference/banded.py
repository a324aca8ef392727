"""Global matrices of a frame in banded form, numbered so that the band is narrow."""

import numpy as np
from scipy import sparse
from scipy.linalg import solve_banded
from scipy.sparse.csgraph import reverse_cuthill_mckee


class BandedSolver:
    """Assembles element matrices over the free degrees of freedom and solves with them.

    The numbering and the place of every element entry in the band are found once, here.

    Parameters
    ----------
    dofs : (n, k) int
        Global degrees of freedom of each element.
    fixed : (m,) int
        Degrees of freedom left out.
    size : int
        Number of global degrees of freedom.
    """

    def __init__(self, dofs: np.ndarray, fixed: np.ndarray, size: int) -> None:
        width = dofs.shape[1]
        rows, columns = np.repeat(dofs, width, axis=1).ravel(), np.tile(dofs, (1, width)).ravel()
        graph = sparse.csr_matrix((np.ones(rows.size), (rows, columns)), shape=(size, size))
        order = reverse_cuthill_mckee(graph, symmetric_mode=True)
        #: Free degrees of freedom in the order of the band.
        self.free = order[~np.isin(order, fixed)]
        position = np.full(size, -1)
        position[self.free] = np.arange(self.free.size)
        row, column = position[rows], position[columns]
        self._kept = np.flatnonzero((row >= 0) & (column >= 0))
        row, column = row[self._kept], column[self._kept]
        self._reach = int(np.abs(row - column).max())
        self._shape = (2 * self._reach + 1, self.free.size)
        self._slot = (self._reach + row - column) * self.free.size + column

    def solve(self, matrices: np.ndarray, diagonal: np.ndarray, *right: np.ndarray) -> np.ndarray:
        """Solve K x = b for each of ``right``; returns (free, b).

        K is assembled from element ``matrices`` (n, k, k), with ``diagonal`` (size,) added.
        """
        entries = matrices.ravel()[self._kept]
        band = np.bincount(self._slot, weights=entries, minlength=self._shape[0] * self._shape[1])
        band = band.reshape(self._shape)
        band[self._reach] += diagonal[self.free]
        columns = np.column_stack(right)
        reach = (self._reach, self._reach)
        answer: np.ndarray = solve_banded(reach, band, columns, overwrite_ab=True, overwrite_b=True, check_finite=False)
        return answer
