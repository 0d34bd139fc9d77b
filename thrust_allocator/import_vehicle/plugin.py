"""The thruster plugins of simulators: gz-sim's, under its older names too, and uuv_simulator's."""

from dataclasses import dataclass
import math
from xml.etree.ElementTree import Element

GZ_DEFAULT = 1000.0  # [N], what gz-sim's plugin takes without limits; no thruster's own


@dataclass(frozen=True)
class ThrusterPlugin:
    """What a plugin says of one thruster."""

    kind: str
    name: str
    joint: str | None  # about which the propeller turns
    link: str | None  # of the propeller, where the plugin names no joint
    limits: tuple[float | None, float | None]  # reverse, forward [N]
    notes: tuple[str, ...]
    water_density: float | None  # [kg/m^3]


def thruster_plugins(root: Element) -> list[ThrusterPlugin]:
    """Return the thruster plugins below an element, in the order of the file, or of their ids."""
    found = []
    for plugin in root.iter('plugin'):
        name, file = plugin.get('name', ''), plugin.get('filename', '')
        if name.endswith('::systems::Thruster') or 'thruster-system' in file:
            found.append((0, _gz(plugin)))
        elif 'uuv_thruster' in file:
            found.append((int(_number(plugin, 'thrusterID') or 0), _uuv(plugin)))
    return [plugin for _, plugin in sorted(found, key=lambda pair: pair[0])]


def _gz(plugin: Element) -> ThrusterPlugin:
    joint = _text(plugin, 'joint_name')
    limits = [_number(plugin, 'min_thrust_cmd'), _number(plugin, 'max_thrust_cmd')]
    notes = ()
    if _text(plugin, 'use_angvel_cmd').lower() in ('true', '1'):
        limits = [None, None]  # they are rad/s
        notes = ('the source commands revolutions: its limits are no newtons',)
    limits = [None if limit is not None and abs(limit) == GZ_DEFAULT else limit
              for limit in limits]
    return ThrusterPlugin('gz-sim', joint or '?', joint, None, _sensible(*limits), notes,
                          _number(plugin, 'fluid_density'))


def _uuv(plugin: Element) -> ThrusterPlugin:
    joint, link = _text(plugin, 'jointName') or None, _text(plugin, 'linkName') or None
    limits = (_number(plugin, 'thrustMin'), _number(plugin, 'thrustMax'))
    notes = ()
    if limits == (None, None):
        limits = _converted(plugin)
        if limits != (None, None):
            notes = ("limits from the plugin's conversion of its greatest input",)
    return ThrusterPlugin('uuv_simulator', link or joint or '?', joint, link, _sensible(*limits),
                          notes, None)


def _converted(plugin: Element) -> tuple[float | None, float | None]:
    """Return the thrust at the ends of the input, where the conversion is one that tells."""
    conversion = plugin.find('conversion')
    if conversion is None:
        return None, None
    efficiency = _number(plugin, 'thrust_efficiency')
    efficiency = 1.0 if efficiency is None else efficiency
    outputs = [_finite(word) for word in _text(conversion, 'outputValues').split()]
    if outputs and None not in outputs:
        return efficiency * min(outputs), efficiency * max(outputs)
    constant = _number(conversion, 'rotorConstant')
    ends = [_number(plugin, 'clampMin'), _number(plugin, 'clampMax')]
    if _text(conversion, 'type') != 'Basic' or constant is None or None in ends:
        return None, None
    low, high = (efficiency * constant * abs(end) * end for end in ends)
    return low, high


def _sensible(low: float | None, high: float | None) -> tuple[float | None, float | None]:
    """Return limits as [reverse <= 0, forward >= 0]; what is none of those says nothing."""
    low = low if low is not None and low <= 0.0 else None
    high = high if high is not None and high >= 0.0 else None
    return (None, None) if low == high == 0.0 else (low, high)


def _text(element: Element, tag: str) -> str:
    return (element.findtext(tag) or '').strip()


def _number(element: Element, tag: str) -> float | None:
    return _finite(_text(element, tag))


def _finite(text: str) -> float | None:
    try:
        number = float(text)
    except ValueError:
        return None
    return number if math.isfinite(number) else None
