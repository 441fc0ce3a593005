"""The live page: the scene with everything computed by Python, over a websocket on loopback."""

from sk120stiff.errors import require

require("tornado", needed_for="the live page")
from sk120stiff.show.live.server import LiveServer  # noqa: E402  (what is missing is said first)

__all__ = ["LiveServer"]
