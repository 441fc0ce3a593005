"""A small server on loopback, gone with its process; closed pages leave nothing behind."""

from __future__ import annotations

import asyncio
import errno
import webbrowser
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets
from tornado.web import Application

from sk120stiff.errors import InputError
from sk120stiff.show.live.handlers import (
    MissingHandler,
    PageHandler,
    Served,
    SocketHandler,
    ViewerHandler,
)
from sk120stiff.show.live.messages import MAX_BYTES
from sk120stiff.show.scene.scene import Scene

LOOPBACK = "127.0.0.1"
FIRST_PORT = 7400
TRIES = 50


class LiveServer(Served):
    """Serves one scene to any number of pages, each with its own pose and load.

    Args:
        scene: What to show.
        host: Address to listen on; anything but loopback opens the page to the network.
        port: First port to try; the next ones follow where it is busy. 0 takes any.

    Raises:
        InputError: The address cannot be used, or no port is free.
    """

    def __init__(self, scene: Scene, *, host: str = LOOPBACK, port: int = FIRST_PORT) -> None:
        super().__init__(scene)
        self._listening = _bind(host, port)
        self.host = host
        self.port = int(self._listening[0].getsockname()[1])
        names = {host, "localhost", LOOPBACK} if host in (LOOPBACK, "localhost") else {host}
        self.hosts = {f"{_bracketed(name)}:{self.port}" for name in names}

    @property
    def url(self) -> str:
        """Address of the page."""
        return f"http://{_bracketed(self.host)}:{self.port}/"

    def start(self) -> HTTPServer:
        """Begin to answer, in the running event loop."""
        mine = {"server": self}
        application = Application(
            [
                (r"/", PageHandler, mine),
                (r"/meshcat\.js", ViewerHandler, mine),
                (r"/socket", SocketHandler, mine),
            ],
            default_handler_class=MissingHandler,
            default_handler_args=mine,
            compress_response=True,
            log_function=lambda _: None,
            websocket_max_message_size=MAX_BYTES,
            websocket_ping_interval=20,
            websocket_ping_timeout=15,
        )
        server = HTTPServer(application, max_body_size=MAX_BYTES, idle_connection_timeout=60)
        server.add_sockets(self._listening)
        return server

    async def run(self, ready: Callable[[str], None]) -> None:
        """Serve until cancelled."""
        server = self.start()
        try:
            ready(self.url)
            await asyncio.Event().wait()
        finally:
            for socket in list(self.sockets):
                socket.close(1001, "the program ends")
            server.stop()
            await server.close_all_connections()

    def serve(self, *, open_browser: bool = True) -> None:
        """Serve until the program is interrupted (Ctrl-C)."""

        def announce(url: str) -> None:
            if open_browser:
                asyncio.get_running_loop().run_in_executor(None, webbrowser.open, url)

        with suppress(KeyboardInterrupt):
            asyncio.run(self.run(announce))


def _bind(host: str, port: int) -> list[Any]:
    if not 0 <= port <= 65535:
        raise InputError(f"there is no port {port}", remedy="Choose one from 0 to 65535.")
    last = min(port + TRIES, 65536) if port else 1
    for candidate in range(port, last):
        try:
            return bind_sockets(candidate, address=host)
        except OSError as error:
            if error.errno in (errno.EADDRINUSE, errno.EACCES) and candidate + 1 < last:
                continue
            raise InputError(
                f"cannot listen on {host}, port {candidate} ({error.strerror})",
                remedy="Choose another --host or --port.",
            ) from error
    raise InputError("no port is free", where=host)


def _bracketed(host: str) -> str:
    return f"[{host}]" if ":" in host else host
