"""The fit finds the coefficients that made a table, and says how well it knows them."""

import numpy as np
import pytest
from support.tow import COSINE, covered, fitted, PAPER, QUADRATIC, tow, truths, TUNNEL

CASES = [(COSINE, 'cosine', False), (QUADRATIC, 'cosine', True), (PAPER, 'paper', False),
         (TUNNEL, 'tunnel', False)]
IDS = ['cosine', 'quadratic', 'paper', 'tunnel']


@pytest.mark.parametrize('model, kind, quadratic', CASES, ids=IDS)
def test_without_noise_it_finds_what_made_the_table(model, kind, quadratic):
    """Both senses and the Bollard limits come back to a thousandth."""
    angles = (90.0,) if kind == 'tunnel' else (0.0, 30.0, 45.0, 60.0, 150.0, 180.0)
    solution = fitted(tow(model, angles=angles), kind, quadratic)
    found = [*solution.coefficients, *map(abs, solution.problem.curves.limits(solution.x))]
    assert found == pytest.approx([*truths(solution, model).values()], rel=1e-3)
    assert np.abs(solution.error).max() < 0.01


@pytest.mark.parametrize('model, kind, quadratic', CASES, ids=IDS)
def test_intervals_hold_the_truth(model, kind, quadratic):
    """Of twelve noisy tables no interval misses it often; of 100, in doc/fit.md, seldom."""
    tables = 12
    hits, worst = covered(model, kind, quadratic, tables)
    assert min(hits.values()) >= 0.75 * tables, hits
    c = max(error for name, error in worst.items() if name.split()[0] in ('speed_loss', 'decay'))
    most = {'quadratic': 0.15, 'tunnel': 0.1}
    assert c < most.get('quadratic' if quadratic else kind, 0.06), worst


def test_an_outlier_moves_little():
    """A row that is off by half of the thrust takes C by less than its interval, not by half."""
    rows = tow(COSINE, 0.005, 3)
    plain = fitted(rows).coefficients
    place = next(i for i, row in enumerate(rows)
                 if row.speed == 1.0 and row.angle == 0.0 and row.command > 0.0)
    rows[place] = rows[place].__class__(**{**rows[place].__dict__, 'thrust': 10.0})
    assert fitted(rows).coefficients == pytest.approx(plain, rel=0.1)
    assert fitted(rows).coefficients != pytest.approx(plain, rel=1e-6)


def test_the_jacobian_is_the_derivative():
    """Against central differences, away from the solution, all unknowns at once."""
    solution = fitted(tow(QUADRATIC, 0.01, 1), 'cosine', True)
    problem, x = solution.problem, solution.problem.start * 1.05
    expected = np.array([(problem.delivered(x + step) - problem.delivered(x - step)) / 2e-6
                         for step in 1e-6 * np.eye(len(x))]).T
    assert problem.jacobian(x) == pytest.approx(expected, abs=0.02 * np.abs(expected).max())
