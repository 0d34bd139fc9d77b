"""What stops a replay and is no mistake in a vehicle's description."""


class ReplayError(Exception):
    """Something that the user can put right; the message is one line."""

    def __init__(self, message: str) -> None:
        """Keep the message, on one line even if what it quotes is not."""
        super().__init__(' '.join(message.split()))
