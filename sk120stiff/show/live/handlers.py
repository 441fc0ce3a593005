"""The page, Meshcat's script and the socket, for browsers on this machine alone."""

from __future__ import annotations

import asyncio
import json
import logging
import time
from contextlib import suppress
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from tornado.web import HTTPError, RequestHandler
from tornado.websocket import WebSocketClosedError, WebSocketHandler

from sk120stiff.errors import ToolkitError
from sk120stiff.show.live.messages import read_request

if TYPE_CHECKING:
    from sk120stiff.show.live.server import LiveServer

MAX_PAGES = 32  # open at the same time
SHORTEST = 0.004  # seconds between two answers to one page: a flood is slowed, not served
PATIENCE = 50  # refused requests after which a page is cut off

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

    def initialize(self, server: LiveServer) -> None:
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

    def initialize(self, server: LiveServer) -> None:
        """Called by tornado for each connection."""
        self.server = server
        self.refused = 0
        self.answered = 0.0

    def prepare(self) -> None:
        """Refuse requests that name another host."""
        if self.request.host not in self.server.hosts:
            raise HTTPError(403, reason="Unknown host")

    def check_origin(self, origin: str) -> bool:
        """Only pages that this server has served may talk to it."""
        parts = urlsplit(origin)
        return parts.scheme == "http" and parts.netloc in self.server.hosts

    def open(self, *_: str, **__: str) -> None:
        """Take the page in, unless too many are open."""
        if len(self.server.sockets) >= MAX_PAGES:
            self.close(1013, "too many pages")
            return
        self.server.sockets.add(self)

    async def on_message(self, message: str | bytes) -> None:
        """Answer one request; the next is not read before."""
        pause = self.answered + SHORTEST - time.monotonic()
        await asyncio.sleep(max(0.0, pause))
        self.answered = time.monotonic()
        with suppress(WebSocketClosedError):
            await self.write_message(self._answer(message))
        if self.refused >= PATIENCE:
            self.close(1008, "too many requests that cannot be read")

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
        """Forget the page."""
        self.server.sockets.discard(self)
