"""What the pages of a live scene are given: page, viewer, bounds of requests, pictures."""

from __future__ import annotations

from typing import Any

from tornado.websocket import WebSocketHandler

from sk120stiff.show.live.messages import Bounds
from sk120stiff.show.scene.frame import Request, compute_frame
from sk120stiff.show.scene.payload import frame_payload, scene_payload
from sk120stiff.show.scene.scene import Scene
from sk120stiff.show.scene.static import render_page, viewer_script


class Served:
    """One scene, its page made once; `sockets` are the pages that are open.

    Requests must name one of `hosts`.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        payload = scene_payload(scene, live=True)
        self.bounds = Bounds.of(payload)
        self.page = render_page(payload, viewer=None)
        self.viewer = viewer_script()
        self.sockets: set[WebSocketHandler] = set()
        self.hosts: set[str] = set()

    def frame(self, request: Request) -> dict[str, Any]:
        """What the page draws for a request."""
        return frame_payload(compute_frame(self.scene.tree, self.scene.elastic, request))
