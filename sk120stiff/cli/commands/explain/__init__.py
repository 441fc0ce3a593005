"""`sk120stiff explain`: what is missing, and what it does to a task."""

from sk120stiff.cli.commands.explain.entry import command

__all__ = ["command"]
