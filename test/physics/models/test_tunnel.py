"""A tunnel thruster that pushes one way alone, and what its driver must be told."""

import math

import pytest
from thrust_allocator.physics.models import Tunnel


@pytest.mark.parametrize('bollard', [(-100.0, 0.0), (0.0, 100.0)])
@pytest.mark.parametrize('across', [0.0, 0.4, 3.0])
def test_one_way(bollard, across):
    """The sense without thrust has none in any flow, the other one what eq. 3.13 leaves of it."""
    limits = Tunnel(bollard, decay=7.0, jet_mass=72.5).limits(0.3, 0.6 * across, 0.8 * across)
    left = 100.0 * math.exp(-7.0 * 72.5 * across**2 / 100.0)
    expected = [math.copysign(left, one) if one else 0.0 for one in bollard]
    assert limits == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize('bollard', [(-100.0, 0.0), (0.0, 100.0)])
def test_one_way_for_its_driver(bollard):
    """Half of what is left asks for more than half of Bollard thrust, and gives it back."""
    tunnel = Tunnel(bollard, decay=7.0, jet_mass=72.5)
    thrust = 0.5 * sum(tunnel.limits(0.0, 0.2, 0.1))
    told = tunnel.bollard_equivalent(thrust, 0.0, 0.2, 0.1)
    assert 0.5 < abs(told) / 100.0 < 1.0 and told * thrust > 0.0
    assert tunnel.thrust_in_flow(told, 0.0, 0.2, 0.1) == pytest.approx(thrust)
    assert tunnel.bollard_fraction(thrust, 0.0, 0.2, 0.1) == pytest.approx(told / 100.0)
