"""Meshcat's own server, on loopback alone: by itself it listens on every address of a machine."""

from __future__ import annotations

import asyncio
import sys
import threading
from concurrent.futures import Future
from contextlib import redirect_stdout
from functools import partial
from typing import Any

from sk120stiff.errors import require

LOOPBACK = "127.0.0.1"


def meshcat_on_loopback() -> Any:
    """A `meshcat.Visualizer` and the server behind it, which ends with this process.

    Raises:
        MissingPart: meshcat is not installed.
    """
    require("meshcat", needed_for="Meshcat")
    import meshcat

    started: Future[str] = Future()
    threading.Thread(target=_serve, args=(started,), daemon=True, name="meshcat").start()
    with redirect_stdout(sys.stderr):  # it prints its address, and stdout is for answers
        return meshcat.Visualizer(zmq_url=started.result(timeout=30))


def _serve(started: Future[str]) -> None:
    from meshcat.servers.zmqserver import ZMQWebSocketBridge

    class Bridge(ZMQWebSocketBridge):  # type: ignore[misc]
        def make_app(self) -> Any:
            application = super().make_app()
            application.listen = partial(application.listen, address=LOOPBACK)
            return application

    try:
        asyncio.set_event_loop(asyncio.new_event_loop())
        bridge = Bridge(host=LOOPBACK)
    except Exception as error:  # noqa: BLE001  (it belongs to who asked for the server)
        started.set_exception(error)
        return
    started.set_result(bridge.zmq_url)
    bridge.run()
