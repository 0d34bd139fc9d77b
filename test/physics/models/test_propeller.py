"""The propeller's law against a second writing of it, in every direction and at every speed."""

import math

from hypothesis import example, given, strategies as st
import pytest
from support.vehicles import propeller


def limit(bollard: float, axial: float, opposed: float, incoming: float, speed: float,
          law: dict[str, float]) -> float:
    """Return the limit of one sense by the equations, given the angle of the flow it meets [N]."""
    first = max(math.pi / 2 - law['critical_angle_slope'] * speed, law['critical_angle_min'])
    second = math.pi / 2 + law['second_critical_angle_offset'] + (
        law['second_critical_angle_slope'] * speed)
    second = sorted((first, second, 2 * math.pi / 3))[1]  # the one in the middle
    if incoming <= first:
        change = -axial * speed * (1 - math.sin(math.pi / 2 * incoming / first))
    elif incoming <= second:
        change = 0.0
    else:
        share = (incoming - second) / (math.pi - second)
        change = -min(opposed * speed, (1 - law['opposed_floor']) * bollard) * (
            1 - math.cos(math.pi / 2 * share))
    return min(max(bollard + change, 0.0), bollard)


laws = st.fixed_dictionaries({
    'critical_angle_slope': st.floats(0.0, 0.5), 'critical_angle_min': st.floats(0.3, 1.57),
    'second_critical_angle_offset': st.floats(-0.5, 0.8),
    'second_critical_angle_slope': st.floats(-0.3, 0.5), 'opposed_floor': st.floats(0.0, 1.0)})
PAPER = {'critical_angle_slope': 0.2, 'critical_angle_min': math.pi / 3,
         'second_critical_angle_offset': 0.0, 'second_critical_angle_slope': 0.2,
         'opposed_floor': 0.85}


@given(laws, st.floats(0.0, 6.0), st.floats(0.0, math.pi), st.floats(0.0, 2 * math.pi))
@example(PAPER, 3.2, 2.6, 0.0)  # the second critical angle is at its cap
@example(PAPER | {'second_critical_angle_offset': 0.3}, 1.0, 2.3, 0.0)
@example(PAPER | {'second_critical_angle_offset': -0.3}, 1.0, 1.7, 0.0)
def test_each_sense_follows_its_law(law, speed, angle, roll):
    """Eq. 3.11, no loss between the critical angles, and the loss in opposed flow beyond them."""
    across = speed * math.sin(angle)
    lower, upper = propeller(**law).limits(
        speed * math.cos(angle), across * math.cos(roll), across * math.sin(roll))
    assert upper == pytest.approx(limit(120.1, 42.2, 17.5, angle, speed, law), abs=1e-6)
    assert -lower == pytest.approx(limit(68.2, 24.0, 9.9, math.pi - angle, speed, law), abs=1e-6)


def test_the_cap_and_the_sign_of_the_offset_show_where_they_are_tested():
    """Without them the examples above would come out otherwise, by newtons."""
    for speed, angle, law, other in (
            (3.2, 2.6, PAPER, PAPER | {'second_critical_angle_slope': 0.1}),
            (1.0, 2.3, PAPER | {'second_critical_angle_offset': 0.3},
             PAPER | {'second_critical_angle_offset': -0.3})):
        one, another = (limit(120.1, 42.2, 17.5, angle, speed, each) for each in (law, other))
        assert abs(one - another) > 1e-2
