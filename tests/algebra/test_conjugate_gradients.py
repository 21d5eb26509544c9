"""The energy that conjugate gradients find, and what they say is missing."""

import numpy as np
import pytest

from ngsxfem_contact.algebra.conjugate_gradients import conjugate_gradients


def laplace(n):
    return 2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1) + 0.05 * np.eye(n)


@pytest.mark.parametrize("accuracy", [0.1, 0.01, 1e-4])
def test_the_energy_is_found_to_the_accuracy(accuracy):
    A, r = laplace(60), np.random.default_rng(0).uniform(-1, 1, 60)
    exact = r @ np.linalg.solve(A, r)
    found = conjugate_gradients(lambda x: A @ x, lambda r: r / 2.05, r, accuracy, 100)
    assert found.energy == pytest.approx(found.x @ A @ found.x, rel=1e-10) == pytest.approx(found.x @ r, rel=1e-10)
    assert 0 <= 1 - found.energy / exact < 3 * accuracy and len(found.gains) < 60


def test_it_stays_in_the_range_of_the_preconditioner_and_stops_at_the_most():
    A, r, some = laplace(20), np.ones(20), np.arange(20) % 2
    assert not conjugate_gradients(lambda x: A @ x, lambda r: some * r, r, 1e-12, 50).x[some == 0].any()
    assert len(conjugate_gradients(lambda x: A @ x, lambda r: r, r, 0.0, 3).gains) == 3
    nothing = conjugate_gradients(lambda x: A @ x, lambda r: r, 0 * r, 0.1, 3)
    assert nothing.energy == 0 and nothing.missing == 0 and not nothing.x.any()
