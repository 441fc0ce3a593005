"""Attacks on the live page, over loopback alone: hostile requests and floods."""

from __future__ import annotations

import asyncio
import json
import socket
from collections.abc import Awaitable, Callable, Iterator
from pathlib import Path

from tornado.httpclient import AsyncHTTPClient, HTTPClientError, HTTPRequest
from tornado.websocket import WebSocketClientConnection, websocket_connect

from sk120stiff.show.live import LiveServer
from sk120stiff.show.live.handlers import FLOOD, MAX_PAGES, PATIENCE
from tests.attacks.judge import Verdict

REQUEST = {"a": [0.1] * 6, "wrench": [100, 0, -50, 0, 0, 0], "point": [0, 0, 0], "exaggeration": 50}
GROWTH = 60e6  # bytes that the whole of the attacks may add to the server
ORIGINS = (
    "http://evil.example", "https://127.0.0.1", "null", "http://127.0.0.1:1", "file://",
    "http://[bad", "http://", "://", "http://127.0.0.1@evil.example", "http://[::1", "chrome://x",
    "http://127.0.0.1.evil.example", "x" * 3000, "http://localhost:99999999",
)  # fmt: skip
HOSTS = (
    "rebound.example",
    "",
    "127.0.0.1",
    "[::1",
    "localhost:0",
    "127.0.0.1:1",
    "a b",
    "x" * 3000,
)
PATHS = (
    "nothing", "..%2f..%2fetc/passwd", "page/app.js", "../../etc/passwd", "%00", "socket/",
    "?a=b/../", "%2e%2e/%2e%2e/", "meshcat.js/..", "robots.txt", "x" * 4000, "\\..\\", "socket%00",
    ".git/config",
)  # fmt: skip
NUMBERS = ("NaN", "Infinity", "-Infinity", "1e400", "1e308", "-1e308", "99", "1e-320", '"1"',
           "null", "[]", "{}", "true", "[[1]]", "1" * 400)  # fmt: skip
TEXTS = (
    "", "{", "null", "[]", '{"id": 1}', "\u0000", '{"id":1,"a":"x"}', "[" * 5000, '{"id":' * 900,
    "1",
    '"x"', "NaN", json.dumps({"id": 1, **REQUEST, "more": 1}), "\ud83d\ude00", "{}{}", "'",
    json.dumps({"id": -1, **REQUEST}), json.dumps({"id": 1e300, **REQUEST}),
    json.dumps({"id": True, **REQUEST}), json.dumps({"id": 1, **REQUEST, "a": []}),
    json.dumps({"id": 1, **REQUEST, "a": [0.1] * 4000}),
    json.dumps({"id": 1, **REQUEST, "wrench": [0] * 7}),
)  # fmt: skip
RAW = (
    b"\x00" * 100, b"GET / HTTP/9.9\r\n\r\n", b"GET /socket HTTP/1.1\r\nHost: 127.0.0.1\r\n",
    b"POST / HTTP/1.1\r\nHost: {host}\r\nContent-Length: 99999999999\r\n\r\nx",
    b"POST / HTTP/1.1\r\nHost: {host}\r\nTransfer-Encoding: chunked\r\n\r\nZZ\r\n",
    b"GET / HTTP/1.1\r\n" + b"X: y\r\n" * 5000 + b"\r\n", b"\x16\x03\x01\x02\x00\x01",
    b"GET / HTTP/1.1\r\nHost: {host}\r\nHost: evil.example\r\n\r\n", b"A" * 200_000,
    b"GET  /\r\n\r\n", b"DELETE / HTTP/1.1\r\nHost: {host}\r\n\r\n",
    b"GET /socket HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
    b"Sec-WebSocket-Version: 99\r\nSec-WebSocket-Key: x\r\n\r\n",
)  # fmt: skip


async def page(server: LiveServer, **headers: str) -> WebSocketClientConnection:
    """An open socket, as a page has it."""
    address = f"ws://127.0.0.1:{server.port}/socket"
    return await websocket_connect(HTTPRequest(address, headers=headers))


async def ask(connection: WebSocketClientConnection, number: int = 1, **changes: object) -> dict:
    """The answer to a request."""
    await connection.write_message(json.dumps({"id": number, **REQUEST, **changes}))
    return json.loads(await connection.read_message() or "{}")


def hostile_requests(folder: Path) -> Iterator[Verdict]:
    """Every hostile request is refused, and the next honest one is answered."""
    del folder
    yield from _visited(_requests)


def floods(folder: Path, rounds: int = 3) -> Iterator[Verdict]:
    """Floods, pages without number, pages that vanish: the next one is served, memory is steady."""
    del folder
    yield from _visited(_floods, rounds)


def _visited(visit: Callable[..., Awaitable[list[Verdict]]], *more: object) -> list[Verdict]:
    from tests.show.scenes import sk120_scene

    async def both() -> list[Verdict]:
        server = LiveServer(sk120_scene(), port=0)
        running = server.start()
        try:
            return await asyncio.wait_for(visit(server, *more), 300)
        finally:
            running.stop()
            await running.close_all_connections()

    return asyncio.run(both())


async def _alive(server: LiveServer) -> str:
    """Is an honest page served, its numbers too? The loss where it is not."""
    try:
        one = await asyncio.wait_for(page(server, Origin=server.url.rstrip("/")), 10)
        answer = await asyncio.wait_for(ask(one), 10)
        one.close()
    except Exception as error:  # noqa: BLE001 - whatever it is, the page was not served
        return f"an honest page is not served: {type(error).__name__}: {error}"
    return "" if "frame" in answer else f"an honest page is told {answer}"


async def _requests(server: LiveServer) -> list[Verdict]:
    found = [Verdict(f"origin {o[:60]!r}", await _kept_out(server, Origin=o)) for o in ORIGINS]
    found += [Verdict(f"host {h[:60]!r}", await _kept_out(server, Host=h)) for h in HOSTS]
    found += [Verdict(f"path {path[:60]!r}", await _nothing_at(server, path)) for path in PATHS]
    for text in (*TEXTS, *_numbers()):
        found.append(Verdict(f"request {text[:70]!r}", await _refused(server, text)))
    for raw in RAW:
        found.append(Verdict(f"bytes {raw[:60]!r}", await _raw(server, raw)))
    return found


def _numbers() -> list[str]:
    """Requests in which one number is none, or out of range."""
    known = {key: json.dumps(value) for key, value in REQUEST.items()}
    out = []
    for key, plain in known.items():
        for bad in NUMBERS:
            text = f"[{bad}{plain[plain.find(',') :]}" if plain.startswith("[") else bad
            if key == "exaggeration" and bad == "99":  # an honest one
                continue
            if key == "wrench" and bad in ("99", "1e-320"):
                continue
            if key in ("a", "point") and bad == "1e-320":
                continue
            parts = [f'"{k}": {text if k == key else v}' for k, v in known.items()]
            out.append('{"id": 1, ' + ", ".join(parts) + "}")
    return out


async def _kept_out(server: LiveServer, **headers: str) -> str:
    try:
        one = await asyncio.wait_for(page(server, **headers), 10)
    except HTTPClientError as refusal:
        return "" if refusal.code in (400, 403) else f"refused with {refusal.code}"
    except OSError:
        return ""  # the connection is closed
    one.close()
    return "let in"


async def _nothing_at(server: LiveServer, path: str) -> str:
    try:
        answer = await AsyncHTTPClient().fetch(server.url + path, request_timeout=10)
    except HTTPClientError as refusal:
        return "" if refusal.code in (400, 404) else f"answered with {refusal.code}"
    except (OSError, ValueError, UnicodeError):
        return ""
    return "" if answer.body == server.page.encode() else "there is something"


async def _refused(server: LiveServer, text: str) -> str:
    one = await page(server)
    try:
        await one.write_message(text.encode("utf-8", "surrogatepass").decode("utf-8", "replace"))
        answer = json.loads(await asyncio.wait_for(one.read_message(), 10) or '{"error": "cut"}')
        if "error" not in answer:
            return f"answered: {str(answer)[:80]}"
        if answer["error"] == "cut":
            return ""
        honest = await asyncio.wait_for(ask(one), 10)
        return "" if "frame" in honest else f"then an honest request is told {honest}"
    finally:
        one.close()


async def _raw(server: LiveServer, raw: bytes) -> str:
    host = f"127.0.0.1:{server.port}".encode()
    reader, writer = await asyncio.open_connection("127.0.0.1", server.port)
    try:
        writer.write(raw.replace(b"{host}", host))
        await writer.drain()
        answer = await asyncio.wait_for(reader.read(4000), 0.3)
    except (TimeoutError, OSError):
        answer = b""
    finally:
        writer.close()
    status = answer.split(b" ", 2)[1:2]
    if status and not status[0].startswith(b"4"):
        return f"answered with {status[0].decode(errors='replace')}"
    return await _alive(server)


async def _floods(server: LiveServer, rounds: int) -> list[Verdict]:
    kinds = {"requests": _flooded, "garbage": _garbage, "pages": _many_pages, "vanishing": _vanish,
             "half open": _half_open}  # fmt: skip
    found: list[Verdict] = []
    for flood in kinds.values():  # what is loaded once
        await flood(server)
    before = _memory()
    for number in range(rounds):
        for name, flood in kinds.items():
            loss = await flood(server) or await _alive(server)
            found.append(Verdict(f"flood of {name} {number}", loss))
    for _ in range(200):
        if not server.sockets:
            break
        await asyncio.sleep(0.01)
    left = f"{len(server.sockets)} pages stay behind" if server.sockets else ""
    grown = _memory() - before
    loss = left or (f"grown by {grown / 1e6:.0f} MB" if grown > GROWTH else "")
    return [*found, Verdict("memory after all of it", loss)]


def _memory() -> int:
    with open("/proc/self/statm", encoding="ascii") as stream:
        return int(stream.read().split()[1]) * 4096


async def _flooded(server: LiveServer, text: str = json.dumps({"id": 1, **REQUEST})) -> str:
    one = await page(server)
    for _ in range(2 * FLOOD):
        one.write_message(text)
    while await asyncio.wait_for(one.read_message(), 60) is not None:
        pass
    return "" if one.close_code in (1008, None, 1006) else f"closed with {one.close_code}"


async def _garbage(server: LiveServer) -> str:
    one = await page(server)
    for _ in range(PATIENCE):
        await one.write_message("garbage")
        await asyncio.wait_for(one.read_message(), 10)
    cut = await asyncio.wait_for(one.read_message(), 10) is None and one.close_code == 1008
    return await _flooded(server, "garbage") if cut else "garbage is listened to for ever"


async def _many_pages(server: LiveServer) -> str:
    pages = [await page(server) for _ in range(MAX_PAGES)]
    more = await page(server)
    told = await asyncio.wait_for(more.read_message(), 10)
    loss = "" if told is None and more.close_code == 1013 else "more pages than are allowed"
    for one in pages:
        one.close()
    for _ in range(300):
        if not server.sockets:
            break
        await asyncio.sleep(0.01)
    return loss


async def _vanish(server: LiveServer) -> str:
    for _ in range(20):
        one = await page(server)
        await one.write_message(json.dumps({"id": 1, **REQUEST}))
        one.protocol._abort()  # no goodbye
    return ""


async def _half_open(server: LiveServer) -> str:
    raw = [socket.create_connection(("127.0.0.1", server.port)) for _ in range(50)]
    for one in raw:
        one.sendall(b"GET /socket HTTP/1.1\r\nHost: 127.0.0.1\r\n")
    loss = await _alive(server)
    for one in raw:
        one.close()
    return loss
