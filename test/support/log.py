"""A log that can be read."""


class Log:
    """A logger that keeps what it is given."""

    def __init__(self):
        self.lines = []

    def __getattr__(self, level):
        return lambda text: self.lines.append((level, text))
