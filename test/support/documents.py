"""How the documents show what the code has."""

from thrust_allocator.parameters.definition import REQUIRED


def shown(default) -> str:
    """Return a default value as the table of parameters shows it."""
    if default is REQUIRED or default is None:
        return 'required' if default is REQUIRED else '–'
    if isinstance(default, tuple):
        return '[' + ', '.join(map(shown, default)) + ']'
    return f'{default:.5g}' if isinstance(default, float) else str(default).lower()
