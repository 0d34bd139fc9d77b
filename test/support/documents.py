"""How the documents show what the code has."""

from thrust_allocator.parameters.definition import BY_AUTHORITY, REQUIRED


def shown(default) -> str:
    """Return a default value as the table of parameters shows it."""
    if default in (BY_AUTHORITY, REQUIRED):
        return 'required' if default is REQUIRED else 'by authority'
    if isinstance(default, tuple):
        return '[' + ', '.join(map(shown, default)) + ']'
    return f'{default:.5g}' if isinstance(default, float) else str(default).lower()
