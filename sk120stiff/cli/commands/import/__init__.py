"""`sk120stiff import`: files read, and what was understood of them."""

# The name of the folder is a keyword: here, and in its files, it is imported relatively.
from .entry import command

__all__ = ["command"]
