"""What ROS 2's own parser takes a value of a parameter file for; it differs from PyYAML."""

from collections.abc import Callable
import math
import re
import sys

_WHITE = r'[ \t\n\v\f\r]*'
_TRUE = ('Y', 'y', 'yes', 'Yes', 'YES', 'true', 'True', 'TRUE', 'on', 'On', 'ON')
_FALSE = ('N', 'n', 'no', 'No', 'NO', 'false', 'False', 'FALSE', 'off', 'Off', 'OFF')
# As strtol and strtod of C read them; (?a) keeps to ASCII
_INTEGER = re.compile(_WHITE + '([-+]?)(?:0[xX]([0-9a-fA-F]+)|(0[0-7]+)|(0|[1-9][0-9]*))')
_REAL = re.compile(
    _WHITE + r'[-+]?(?:(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[-+]?[0-9]+)?|inf|infinity|nan)',
    re.IGNORECASE)
_HEXADECIMAL_REAL = re.compile(
    _WHITE + r'[-+]?0x(?:[0-9a-f]+\.?[0-9a-f]*|\.[0-9a-f]+)(?:p[-+]?[0-9]+)?', re.IGNORECASE)
_SPECIAL = re.compile(r'[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)')


def scalar(text: str, quoted: bool = False) -> bool | int | float | str:
    """Return what ROS 2 reads: true or false, a whole or a real number, or else a word."""
    text = text.partition('\0')[0]
    if quoted:
        return text
    if text in _TRUE or text in _FALSE:
        return text in _TRUE
    if match := _INTEGER.fullmatch(text):
        sign, hexadecimal, octal, decimal = match.groups()
        if hexadecimal or octal or len(decimal) < 20:  # the others have more than 64 bits
            number = int(hexadecimal or octal or decimal, 16 if hexadecimal else 8 if octal else 10)
            number = -number if sign == '-' else number
            if -2**63 <= number < 2**63:
                return number
    if _SPECIAL.fullmatch(text):
        return float(text.replace('.', ''))
    for form, convert in ((_REAL, float), (_HEXADECIMAL_REAL, float.fromhex)):
        if form.fullmatch(text):
            return _in_range(text, convert)
    return text


def is_surprisingly_octal(text: str) -> bool:
    """Tell a number such as 010 that ROS 2 reads as 8, for its leading zero."""
    match = _INTEGER.fullmatch(text)
    return bool(match and match[3]) and int(match[3], 8) != int(match[3])


def _in_range(text: str, convert: Callable[[str], float]) -> float | str:
    """Return a real number, or the text where it is too large or too small for one."""
    try:
        number = convert(text)
    except OverflowError:
        return text
    if math.isinf(number) and 'inf' not in text.lower():
        return text
    before, _, after = text.lower().partition('x')
    mantissa = re.split('p' if after else 'e', after or before)[0]
    return text if abs(number) < sys.float_info.min and re.search('[1-9a-f]', mantissa) else number
