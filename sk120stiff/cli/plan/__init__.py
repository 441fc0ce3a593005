"""`sk120stiff plan`: a plan made, checked, shown, and driven."""

from sk120stiff.cli.plan.entry import command

__all__ = ["command"]
