"""Command lines: one thin file per command."""
