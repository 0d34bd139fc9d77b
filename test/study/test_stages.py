"""The picture of doc/bounds.md: each of its stages by a formula of its own, and its command."""

import math

import numpy as np
import pytest
from support.vehicles import described
from thrust_allocator.physics.bounds import ThrustBounds
from thrust_allocator.physics.models import Fin
from thrust_allocator.solve.problem import AllocationProblem
from thrust_allocator.study.manoeuvre import Manoeuvre
from thrust_allocator.study.report import main_dofs
from thrust_allocator.study.stages import main, stages
from thrust_allocator.study.sweep import shares


def test_each_stage_takes_what_the_one_before_has_left():
    """MT-2012's tunnel: 122.1 N, worn, at 14 V, at speed, cut off, faded, and a step from 10 N."""
    tunnel = described('mt2012').thrusters[4]
    speeds = np.array([0.0, 0.2, 0.4, 0.6])
    found = list(stages(tunnel, speeds).values())
    full = 0.9 * 122.1 * (14.0 / 16.0)**1.2
    left = full * np.exp(-7.0 * 1025.0 * 0.0707 * speeds**2 / full)
    cut = np.maximum(0.0, (left - 0.1 * full) / 0.9)
    faded = np.minimum(cut, cut[2])
    for one, expected in zip(found, (122.1, 0.9 * 122.1, full, left, cut, faded,
                                     np.minimum(faded, 10.0 + 500.0 * 0.02)), strict=True):
        assert one == pytest.approx(np.broadcast_to(expected, 4), rel=1e-9)


def test_the_command(tmp_path, capsys):
    """It writes picture and table where it is told, and its usage if it is not."""
    assert main([str(tmp_path / 'bounds')]) == 0
    assert {file.suffix for file in tmp_path.iterdir()} == {'.png', '.svg', '.csv'}
    assert main([]) == 2 and 'usage' in capsys.readouterr().err


def test_delphin2_hovers_on_tunnels_and_cruises_on_fins():
    """With pitch and yaw both are told of, and they are the fins' from 0.6 m/s on."""
    vehicle = described('delphin2_fins')
    problem, bounds = AllocationProblem(vehicle), ThrustBounds(vehicle)
    manoeuvre = Manoeuvre((0.0, 0.0, 0.0, 0.0, 4.0, 4.0), (3.0, 0.0, 0.0))
    thrusts = np.array([problem.solve(manoeuvre.command(velocity), bounds(velocity)).thrusts
                        for velocity in (manoeuvre.velocity(speed, 0.0) for speed in (0.2, 0.9))])
    assert main_dofs(manoeuvre, None) == [4, 5]
    for dof, percent in ((4, 77.0), (5, 71.0)):
        found = shares(vehicle, thrusts, dof)
        assert found['tunnels'] == pytest.approx([100.0, 100.0 - percent], abs=0.6)
        assert found[Fin.PLURAL] == pytest.approx([0.0, percent], abs=0.6)
    assert math.isclose(thrusts[1, 5], thrusts[1, 6], rel_tol=1e-6)  # a pair turns together
