"""`sk120stiff identify`: springs from displacements, or geometry and springs from positions."""

from sk120stiff.cli.commands.identify.entry import command

__all__ = ["command"]
