"""`sk120stiff compensate`: a path read, compensated, and written."""

from sk120stiff.cli.commands.compensate.entry import command

__all__ = ["command"]
