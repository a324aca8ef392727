"""Global matrices of a frame in banded form, numbered so that the band is narrow."""

import numpy as np
from scipy import sparse
from scipy.linalg.lapack import dgbsv
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
        # Columns of the band lie one after the other, each with room on top for what pivoting fills in.
        self._shape = (self.free.size, 3 * self._reach + 1)
        self._slot = column * self._shape[1] + 2 * self._reach + row - column

    def solve(self, matrices: np.ndarray, diagonal: np.ndarray, *right: np.ndarray) -> np.ndarray:
        """Solve K x = b for each of ``right``; returns (free, b).

        K is assembled from element ``matrices`` (n, k, k), with ``diagonal`` (size,) added.

        Raises
        ------
        numpy.linalg.LinAlgError
            When K is singular.
        """
        return self.solve_with_sign(matrices, diagonal, *right)[1]

    def solve_with_sign(
        self, matrices: np.ndarray, diagonal: np.ndarray, *right: np.ndarray
    ) -> tuple[float, np.ndarray]:
        """The sign of det K beside what `solve` returns, and raises."""
        entries = matrices.ravel()[self._kept]
        band = np.bincount(self._slot, weights=entries, minlength=self._shape[0] * self._shape[1])
        band = band.reshape(self._shape)
        band[:, 2 * self._reach] += diagonal[self.free]
        columns = np.array(right).T
        factors, swaps, answer, fault = dgbsv(
            self._reach, self._reach, band.T, columns, overwrite_ab=True, overwrite_b=True
        )
        if fault:
            raise np.linalg.LinAlgError("the matrix is singular")
        odd = (factors[2 * self._reach] < 0.0).sum() + (swaps != np.arange(len(swaps))).sum()
        return -1.0 if odd % 2 else 1.0, np.asarray(answer)
