"""The page, Meshcat's script and the socket, for browsers on this machine; what they serve."""

from __future__ import annotations

import asyncio
import json
import logging
from contextlib import suppress
from typing import Any
from urllib.parse import urlsplit

from tornado.iostream import StreamClosedError
from tornado.web import HTTPError, RequestHandler
from tornado.websocket import WebSocketClosedError, WebSocketHandler

from sk120stiff.errors import ToolkitError
from sk120stiff.show.live.messages import Bounds, read_request
from sk120stiff.show.scene.frame import Request, compute_frame
from sk120stiff.show.scene.payload import frame_payload, scene_payload
from sk120stiff.show.scene.scene import Scene
from sk120stiff.show.scene.static import render_page, viewer_script

MAX_PAGES = 32  # open at the same time
PAUSE = 0.002  # seconds after an answer in which other pages have their turn
PATIENCE = 50  # refused requests after which a page is cut off
FLOOD = 5000  # overtaken requests after which a page is cut off; ours never overtakes itself

_log = logging.getLogger("sk120stiff.live")
_HEADERS = {
    "Cache-Control": "no-store",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "SAMEORIGIN",
}
_POLICY = (
    "default-src 'none'; script-src 'self' 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'"
)


class _Local(RequestHandler):
    """Answers only requests that name this server as their host: other names may be a trap."""

    def initialize(self, server: Served) -> None:
        self.server = server

    def prepare(self) -> None:
        if self.request.host not in self.server.hosts:
            raise HTTPError(403, reason="Unknown host")

    def set_default_headers(self) -> None:
        for name, value in _HEADERS.items():
            self.set_header(name, value)
        self.set_header("Content-Security-Policy", _POLICY)
        self.clear_header("Server")

    def write_error(self, status_code: int, **_: Any) -> None:
        self.set_header("Content-Type", "text/plain; charset=utf-8")
        self.finish(f"{status_code} {self._reason}\n")


class PageHandler(_Local):
    """The page itself."""

    def get(self) -> None:
        """Send it."""
        self.set_header("Content-Type", "text/html; charset=utf-8")
        self.write(self.server.page)


class ViewerHandler(_Local):
    """Meshcat's script from the installed package."""

    def get(self) -> None:
        """Send it."""
        self.set_header("Content-Type", "text/javascript; charset=utf-8")
        self.write(self.server.viewer)


class MissingHandler(_Local):
    """Everything else."""

    def prepare(self) -> None:
        """Say that there is nothing."""
        super().prepare()
        raise HTTPError(404, reason="Not found")


class SocketHandler(WebSocketHandler):
    """One open page. It keeps nothing but its connection: the state lives in the page."""

    def initialize(self, server: Served) -> None:
        """Called by tornado for each connection."""
        self.server = server
        self.refused = 0
        self.overtaken = 0
        self.newest: str | bytes | None = None
        self.work: asyncio.Task[None] | None = None

    def prepare(self) -> None:
        """Refuse requests that name another host, or an origin that tornado cannot read."""
        if self.request.host not in self.server.hosts:
            raise HTTPError(403, reason="Unknown host")
        origin = self.request.headers.get("Origin")
        if origin is not None and not self.check_origin(origin):
            raise HTTPError(403, reason="Unknown origin")

    def check_origin(self, origin: str) -> bool:
        """Only pages that this server has served may talk to it."""
        try:
            parts = urlsplit(origin)
        except ValueError:  # such as http://[bad
            return False
        return parts.scheme == "http" and parts.netloc in self.server.hosts

    def open(self, *_: str, **__: str) -> None:
        """Take the page in, unless too many are open."""
        if len(self.server.sockets) >= MAX_PAGES:
            self.close(1013, "too many pages")
            return
        self.server.sockets.add(self)

    def on_message(self, message: str | bytes) -> None:
        """Keep the newest request; one that it overtakes is never computed."""
        if self.newest is not None:
            self.overtaken += 1
            if self.overtaken >= FLOOD:
                self.close(1008, "too many requests")
        self.newest = message
        if self.work is None or self.work.done():
            self.work = asyncio.create_task(self._answer_all())

    async def _answer_all(self) -> None:
        with suppress(WebSocketClosedError, StreamClosedError):
            while self.newest is not None:
                message, self.newest = self.newest, None
                await self.write_message(self._answer(message))
                if self.refused >= PATIENCE:
                    self.close(1008, "too many requests that cannot be read")
                    return
                await asyncio.sleep(PAUSE)

    def _answer(self, message: str | bytes) -> str:
        try:
            number, request = read_request(message, self.server.bounds)
        except ToolkitError as error:
            self.refused += 1
            return json.dumps({"id": None, "error": str(error)})
        try:
            return json.dumps({"id": number, "frame": self.server.frame(request)}, allow_nan=False)
        except ToolkitError as error:
            return json.dumps({"id": number, "error": str(error)})
        except Exception:  # noqa: BLE001 - one picture that cannot be drawn must not end the others
            _log.exception("a picture could not be computed")
            return json.dumps({"id": number, "error": "this picture could not be computed"})

    def on_close(self) -> None:
        """Forget the page and what it still asks for."""
        self.server.sockets.discard(self)
        self.newest = None
        if self.work is not None:
            self.work.cancel()


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
