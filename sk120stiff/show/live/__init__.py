"""The live page: the scene with everything computed by Python, over a websocket on loopback."""

from sk120stiff.show.live.server import LiveServer

__all__ = ["LiveServer"]
