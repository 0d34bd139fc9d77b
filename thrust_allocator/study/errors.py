"""What stops a study and is no mistake in a vehicle's description."""


class StudyError(Exception):
    """Something that the user can put right; the message is one line."""

    def __init__(self, message: str) -> None:
        """Keep the message, on one line even if what it quotes is not."""
        super().__init__(' '.join(message.split()))


def missing(what: str, extra: str) -> str:
    """Say that something is not installed, and which extra of this package brings it in a clone."""
    return f"{what}, is not installed: pip install '.[{extra}]'"
