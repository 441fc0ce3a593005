"""`sk120stiff plan`: a plan made, checked, shown, and driven."""

from sk120stiff.cli.commands.plan.entry import command

__all__ = ["command"]
