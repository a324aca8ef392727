"""The block factor against dense linear algebra, for any graph."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numba import njit

from sim.kernels import blocks
from sim.ordering import minimum_degree


@njit
def factorise_and_solve(count, start, rows, fill, diagonal, lower, column, solution):  # type: ignore[no-untyped-def]
    """The kernels under test, which only compiled functions can call."""
    blocks.factorise(count, start, rows, fill, diagonal, lower, column)
    blocks.substitute(count, 0, start, rows, diagonal, lower, solution)


@st.composite
def graphs(draw: st.DrawFn) -> tuple[int, list[tuple[int, int]]]:
    count = draw(st.integers(1, 12))
    pairs = [(i, j) for i in range(count) for j in range(i)]
    return count, draw(st.lists(st.sampled_from(pairs), max_size=30)) if pairs else []


@given(graph=graphs(), seed=st.integers(0, 2**32 - 1))
def test_factor_solves_as_dense_algebra_does(graph: tuple[int, list[tuple[int, int]]], seed: int) -> None:
    count, edges = graph
    pattern = minimum_degree(count, edges)
    place = np.argsort(pattern.order)
    random = np.random.default_rng(seed)
    dense = np.zeros((3 * count, 3 * count))
    for a, b in edges:
        i, j = 3 * place[a], 3 * place[b]
        block = random.normal(size=(3, 3))
        dense[i : i + 3, j : j + 3] += block
        dense[j : j + 3, i : i + 3] += block.T
    dense += (np.abs(dense).sum(axis=1).max() + 1.0) * np.eye(3 * count)
    right = random.normal(size=(count, 3))

    diagonal = np.array([dense[3 * i : 3 * i + 3, 3 * i : 3 * i + 3].ravel() for i in range(count)])
    below = len(pattern.column_rows)
    lower = np.zeros((below, 9))
    for column in range(count):
        for slot in range(pattern.column_start[column], pattern.column_start[column + 1]):
            row = pattern.column_rows[slot]
            lower[slot] = dense[3 * row : 3 * row + 3, 3 * column : 3 * column + 3].ravel()
    column = np.zeros_like(lower)
    solution = right.copy()
    fill = np.append(pattern.fill_targets, 0)
    factorise_and_solve(count, pattern.column_start, pattern.column_rows, fill, diagonal, lower, column, solution)
    np.testing.assert_allclose(solution.ravel(), np.linalg.solve(dense, right.ravel()), rtol=1e-10, atol=1e-12)


def test_a_chain_fills_in_nothing() -> None:
    pattern = minimum_degree(100, [(i, i + 1) for i in range(99)])
    assert len(pattern.column_rows) == 99
    assert len(pattern.fill_targets) == 0


def test_a_ring_fills_in_once_a_body() -> None:
    pattern = minimum_degree(50, [(i, (i + 1) % 50) for i in range(50)])
    assert len(pattern.column_rows) <= 2 * 50


def test_rigid_springs_beside_light_bodies_lose_few_digits() -> None:
    """A block of 10¹⁰ j jᵀ + 1, whose inverse by cofactors would have no digit right."""
    j = np.array([0.6, 0.8, 0.05])
    matrix = 1e10 * np.outer(j, j) + np.eye(3)
    exact = np.eye(3) - np.outer(j, j) * (1e10 / (1.0 + 1e10 * (j @ j)))  # Sherman–Morrison
    diagonal, solution = matrix.reshape(1, 9).copy(), np.array([[1.0, -2.0, 3.0]])
    nothing = np.zeros(2, np.int64), np.zeros(0, np.int64)
    empty = np.zeros((0, 9))
    factorise_and_solve(1, *nothing, np.zeros(1, np.int64), diagonal, empty, empty, solution)
    np.testing.assert_allclose(solution[0], exact @ [1.0, -2.0, 3.0], rtol=1e-4)
