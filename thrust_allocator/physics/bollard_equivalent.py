"""
Thrust in the flow and the Bollard-equivalent thrust: what the same propeller speed gives at rest.

A motor driver that was calibrated at rest maps newtons to a propeller speed by a Bollard-pull
curve. The equivalent thrust e is what it must be told to get the thrust tau in the flow. Loss is in
proportion to the speed of rotation, so to sqrt(e); this is ours, from eq. 3.11 to 3.13 of Kostenko
and Tolstonogov (2017), which give the loss at full speed only.
"""

from math import exp, log, sqrt

from scipy.special import wrightomega
from thrust_allocator.physics.models.propeller import PropellerLoss
from thrust_allocator.physics.models.tunnel import TunnelLoss

Loss = PropellerLoss | TunnelLoss | None


def thrust_in_flow(equivalent: float, loss: Loss, bollard_thrust: tuple[float, float],
                   along: float, across: float) -> float:
    """
    Return the thrust that a driver told `equivalent` delivers in the flow [N].

    :param equivalent: Bollard-equivalent thrust, within `bollard_thrust` [N].
    :param loss: how the thruster loses thrust in a flow, or None if it does not.
    :param bollard_thrust: limits at rest (reverse <= 0, forward >= 0) [N].
    :param along: speed of the thruster along its thrust axis [m/s].
    :param across: and across it, >= 0 [m/s].
    :return: of the sign of `equivalent`, or 0 where the propeller is too slow to push at all.
    """
    if loss is None or equivalent == 0.0:
        return equivalent
    side, e = (1, equivalent) if equivalent > 0.0 else (0, -equivalent)
    if isinstance(loss, TunnelLoss):
        thrust = e * exp(-loss.load(across) / e)
    else:
        full = abs(bollard_thrust[side])
        lost = full - abs(loss.law(bollard_thrust)(along, across)[side])
        thrust = max(e - lost * sqrt(e / full), 0.0)
    return thrust if side else -thrust


def bollard_equivalent(thrust: float, loss: Loss, bollard_thrust: tuple[float, float],
                       along: float, across: float) -> float:
    """
    Return what a driver calibrated at rest must be told to deliver `thrust` in the flow [N].

    The inverse of `thrust_in_flow` where the thrust is not 0; at the limit it is Bollard thrust.

    :param thrust: wanted in the flow, within the limits there [N].
    """
    if loss is None or thrust == 0.0:
        return thrust
    side, tau = (1, thrust) if thrust > 0.0 else (0, -thrust)
    full = abs(bollard_thrust[side])
    if isinstance(loss, TunnelLoss):
        load = loss.load(across)
        # tau = e exp(-load / e): with y = load / e, y + ln y = ln(load / tau)
        y = float(wrightomega(log(load) - log(tau)).real) if load > 0.0 else 0.0
        e = load / y if y > 1.0 else tau * exp(y)  # neither overflows nor divides by 0
    else:
        lost = full - abs(loss.law(bollard_thrust)(along, across)[side])
        half = 0.5 * lost / sqrt(full)  # tau = e - 2 half sqrt(e), a quadratic in sqrt(e)
        e = (half + sqrt(half * half + tau))**2
    e = min(e, full)  # which rounding could exceed
    return e if side else -e
