"""What is wrong at present, in words: when it begins, when it is over, and when that is logged."""

from dataclasses import dataclass
from enum import IntEnum
from typing import Any

AFTERWARDS = 2 * 10**9  # time without a finding after which it is over [ns]
QUIET = 10 * 10**9  # shortest time between two lines about one finding [ns]
LONG_AGO = -2**62  # [ns]


class Level(IntEnum):
    """The levels of a diagnostic status."""

    OK = 0
    WARN = 1
    ERROR = 2


@dataclass
class Finding:
    """One kind of thing that is wrong, now or not long ago."""

    level: Level
    text: str
    gone: int | None = None  # since when it is no more; None: it is there [ns]
    logged: int = LONG_AGO  # when a line was written about it last [ns]
    known: bool = False  # whether that line says that it is there


class Findings:
    """
    What is wrong at present, by kind; a finding begins at once, and is over after 2 s without it.

    Each is logged when it begins and when it is over, by no more than one line in 10 s: of one that
    comes and goes faster, the log tells how things stand at the end of that time.
    """

    def __init__(self, logger: Any) -> None:
        """Log to `logger`, which has the methods info, warning and error."""
        self._logger = logger
        self._kinds: dict[str, Finding] = {}

    def note(self, kind: str, text: str, now: int, level: Level = Level.WARN) -> None:
        """
        Note what is wrong, or with an empty text that nothing is.

        :param now: time on a clock that may jump backwards [ns].
        """
        finding = self._kinds.get(kind)
        if text:
            if finding is None:
                finding = self._kinds[kind] = Finding(level, text)
            finding.level, finding.text, finding.gone = level, text, None
            if not finding.known:
                self._log(finding, now)
        elif finding is not None and finding.gone is None:
            finding.gone = now

    def present(self, kind: str) -> str:
        """Return the text of a finding that is there, or ''."""
        finding = self._kinds.get(kind)
        return finding.text if finding is not None and finding.gone is None else ''

    def overall(self, now: int) -> tuple[Level, str]:
        """Return the worst level, and all findings that are not over in one line, worst first."""
        for kind, finding in list(self._kinds.items()):
            if finding.gone is not None:
                finding.gone = min(finding.gone, now)
            over = self._is_over(finding, now)
            if over == finding.known:
                self._log(finding, now)
            if over and not finding.known and now - finding.logged >= QUIET:
                del self._kinds[kind]
        standing = [one for one in self._kinds.values() if not self._is_over(one, now)]
        if not standing:
            return Level.OK, 'allocating'
        worst_first = sorted(standing, key=lambda one: -one.level)
        return worst_first[0].level, '; '.join(one.text for one in worst_first)

    @staticmethod
    def _is_over(finding: Finding, now: int) -> bool:
        return finding.gone is not None and now - finding.gone >= AFTERWARDS

    def _log(self, finding: Finding, now: int) -> None:
        """Log how it stands with a finding, unless that was said not long ago."""
        finding.logged = min(finding.logged, now)  # after a jump backwards
        if now - finding.logged < QUIET:
            return
        over = self._is_over(finding, now)
        finding.logged, finding.known = now, not over
        if over:
            self._logger.info(f'no longer: {finding.text}')
        elif finding.level == Level.ERROR:
            self._logger.error(finding.text)
        else:
            self._logger.warning(finding.text)
