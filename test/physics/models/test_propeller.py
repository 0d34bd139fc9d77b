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


PAIRS = st.tuples(*[st.floats(0.0, 1e6)] * 2)
allowed = st.fixed_dictionaries({  # what the rules let through with the law `cosine`
    'bollard_thrust': st.tuples(st.floats(-1e6, 0.0), st.floats(1e-3, 1e6)),
    'speed_loss': PAIRS | st.tuples(*[st.floats(0.0, 50.0)] * 2),
    'speed_loss_quadratic': PAIRS | st.tuples(*[st.floats(0.0, 50.0)] * 2),
    'opposed_loss': PAIRS, 'opposed_floor': st.floats(0.0, 1.0),
    'second_critical_angle_offset': st.floats(-1e6, 1e6),
    'second_critical_angle_slope': st.floats(-1e6, 1e6), 'angle_law': st.just('cosine')})
flows = st.tuples(st.floats(0.0, 50.0), st.floats(0.0, math.pi), st.floats(0.0, 2 * math.pi))


def in_flow(model, speed, angle, roll):
    """Return speed along and across the thrust axis, and the limits there (reverse, forward)."""
    across = speed * math.sin(angle)
    flow = speed * math.cos(angle), across * math.cos(roll), across * math.sin(roll)
    lower, upper = model.limits(*flow)
    return flow, (-lower, upper)


def quadratic_loss(model, side, incoming, speed):
    """Return the part of the axial loss that C_2 makes, before anything is clipped [N]."""
    return model.speed_loss_quadratic[side] * speed**2 * math.cos(incoming)**2


@given(allowed, flows)
@example({'speed_loss': (24.0, 42.2), 'speed_loss_quadratic': (2.0, 7.0)}, (1.5, 0.4, 1.0))
def test_cosine_follows_its_closed_form(changes, flow):
    """-(C v + C_2 v^2) cos^2 up to a right angle, none up to the second one, then opposed flow."""
    model = propeller(**changes | {'angle_law': 'cosine'})
    speed, angle, roll = flow
    (along, one, other), limits = in_flow(model, speed, angle, roll)
    for side, (sense, limit) in enumerate(zip((-1.0, 1.0), limits)):
        bollard = abs(model.bollard_thrust[side])
        incoming = math.atan2(math.hypot(one, other), sense * along)
        v = math.sqrt(along**2 + one**2 + other**2)
        second = math.pi / 2 + model.second_critical_angle_offset \
            + model.second_critical_angle_slope * v
        second = min(max(second, math.pi / 2), 2 * math.pi / 3)
        if incoming <= math.pi / 2:
            loss = model.speed_loss[side] * v * math.cos(incoming)**2 + quadratic_loss(
                model, side, incoming, v)
        elif incoming <= second:
            loss = 0.0
        else:
            loss = min(model.opposed_loss[side] * v, (1 - model.opposed_floor) * bollard) * (
                1 - math.cos(math.pi / 2 * (incoming - second) / (math.pi - second)))
        assert limit == pytest.approx(max(bollard - loss, 0.0), rel=1e-9, abs=1e-9)
        assert 0.0 <= limit <= bollard


@given(allowed, flows, st.floats(0.0, 2 * math.pi))
def test_cosine_is_symmetric_about_the_axis_and_between_the_senses(changes, flow, roll):
    """The flow's side makes no difference; turned round, with its data, limits change places."""
    model = propeller(**changes)
    _, limits = in_flow(model, *flow)
    assert in_flow(model, *flow[:2], roll)[1] == pytest.approx(limits, rel=1e-9, abs=1e-6)
    turned = propeller(**changes | {
        name: changes[name][::-1] for name in ('speed_loss', 'speed_loss_quadratic', 'opposed_loss')
    } | {'bollard_thrust': tuple(-one for one in changes['bollard_thrust'][::-1])})
    (along, *across), _ = in_flow(model, *flow)
    lower, upper = turned.limits(-along, *across)
    assert (upper, -lower) == pytest.approx(limits, rel=1e-9, abs=1e-6)


@given(allowed, st.sampled_from(['paper', 'cosine']), flows, st.sampled_from([0, 1]),
       st.floats(1e-6, 1.0))
def test_the_quadratic_part_does_not_go_with_the_revolutions(changes, law, flow, side, share):
    """tau = e - dL_1 sqrt(e / T_0) - dL_2, and the equivalent is its inverse to 1e-6 N."""
    model = propeller(**changes | {'angle_law': law})
    motion, limits = in_flow(model, *flow)
    full = abs(model.bollard_thrust[side])
    thrust = (-1.0, 1.0)[side] * share * limits[side]
    if thrust == 0.0:
        return
    e = model.bollard_equivalent(thrust, *motion)
    assert abs(thrust) * (1.0 - 1e-9) <= abs(e) <= full
    assert math.copysign(1.0, e) == math.copysign(1.0, thrust)
    assert model.thrust_in_flow(e, *motion) == pytest.approx(thrust, rel=1e-12, abs=1e-6)

    incoming = math.atan2(math.hypot(*motion[1:]), (-1.0, 1.0)[side] * motion[0])
    if law == 'cosine' and incoming <= math.pi / 2:
        steady = quadratic_loss(model, side, incoming, math.hypot(*motion))
        turning = full - limits[side] - steady
        assert abs(thrust) == pytest.approx(
            abs(e) - turning * math.sqrt(abs(e) / full) - steady, rel=1e-9, abs=1e-6)


def test_with_the_papers_law_the_quadratic_stands_in_the_same_bracket():
    """(C v + C_2 v^2) (1 - sin): a hand's worth of figures, and none across the flow."""
    model = propeller(speed_loss_quadratic=(3.0, 5.0))
    _, (_, forward) = in_flow(model, 1.2, 0.5, 0.3)
    first = math.pi / 2 - 0.2 * 1.2
    share = 1.0 - math.sin(math.pi / 2 * 0.5 / first)
    assert forward == pytest.approx(120.1 - (42.2 * 1.2 + 5.0 * 1.44) * share, abs=1e-9)
    assert in_flow(model, 1.2, math.pi / 2, 0.0)[1] == pytest.approx((68.2, 120.1), abs=1e-9)


def test_cosine_knows_no_critical_angle():
    """The angles of the paper's law make no difference to the other one."""
    one, other = (propeller(angle_law='cosine', critical_angle_slope=slope, critical_angle_min=1.2)
                  for slope in (0.2, 0.5))
    assert in_flow(one, 1.0, 0.7, 0.0)[1] == in_flow(other, 1.0, 0.7, 0.0)[1]
