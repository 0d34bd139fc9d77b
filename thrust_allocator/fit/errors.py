"""What stops a fit and is a mistake in a table or on the command line."""


class FitError(Exception):
    """Something that the user can put right; the message is one line."""

    def __init__(self, message: str) -> None:
        """Keep the message, on one line even if what it quotes is not."""
        super().__init__(' '.join(message.split()))
