"""A mock of the dashboard server: serves the page and the interface of docs/dashboard.md, so that the
page can be used and tested without a bus, robots or a build. Needs only the standard library.

  mock_lab.py [--port 8480] [--robots 20] [--read-only] [--replay] [--no-lab]
"""

import argparse
import http.server
import json
import math
import pathlib
import socket
import struct
import threading
import time
import urllib.parse
import zlib

import mock_topics

HERE = pathlib.Path(__file__).resolve().parent
PAGE = HERE.parents[2] / "dashboard" / "page"
OTHER_FILES = {"d3.min.js": pathlib.Path("/usr/share/javascript/d3/d3.min.js"),
             "d3_licence.txt": pathlib.Path("/usr/share/doc/libjs-d3/copyright")}
TYPES = {".html": "text/html; charset=utf-8", ".js": "text/javascript; charset=utf-8",
         ".css": "text/css; charset=utf-8", ".svg": "image/svg+xml", ".txt": "text/plain"}
POLICY = ("default-src 'self'; img-src 'self' data: blob:; media-src 'self' blob:; "
          "object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'")
TOKEN = "0123456789abcdef0123456789abcdef"


def png(columns, rows, shade):
    """A grey PNG picture. shade(column, row) returns 0..255."""
    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    lines = b"".join(b"\0" + bytes(shade(c, r) for c in range(columns)) for r in range(rows))
    head = struct.pack(">IIBBBBB", columns, rows, 8, 0, 0, 0, 0)
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(lines))
            + chunk(b"IEND", b""))


class MockLab:
    """Serves a simulated lab on 127.0.0.1. `silent`: no message arrives from the lab. world.deaf: robots
    that never confirm a stop. stop_serving() and then serve() restart the server on the same port."""

    def __init__(self, robots=20, port=0, read_only=False, replay=False, lab=True, pools=math.inf):
        self.world = mock_topics.World(robots, replay)
        self.read_only = read_only
        self.has_lab = lab
        self.silent = False
        self.mute = False  # the server sends nothing although the connection is open
        self.broken = set()  # paths that respond with 503
        self.pools = pools  # number of further results of the analyzer
        self.port = port
        self.operator_requests = []  # (time, body)
        self.requests = []  # (method, path)
        self.labs = []  # those that run on this machine
        self.started = {"state": "none", "code": None, "output": "", "address": None, "run": None}
        self.topics = {}
        self.versions = {}
        self.version = 0
        self.changed = threading.Condition()
        self.server = None
        self.sockets = set()
        self.running = True
        threading.Thread(target=self._play, daemon=True).start()

    def publish(self, topic, value):
        text = json.dumps(value, separators=(",", ":"))
        with self.changed:
            self.version += 1
            self.topics[topic] = text
            self.versions[topic] = self.version
            self.changed.notify_all()

    def _play(self):
        world, tick, heard = self.world, 0, None
        while self.running:
            now = time.monotonic()
            if not self.silent and self.has_lab:
                heard = now
                world.advance(0.05)
                if tick == 0:
                    self.publish("lab", world.lab())
                self.publish("frame", world.frame())
                if tick % 4 == 0:
                    for topic, value in world.often():
                        self.publish(topic, value)
                if tick % 20 == 0:
                    for topic, value in world.each_second(self.pools > 0):
                        self.publish(topic, value)
                    self.pools -= 1
                tick += 1
            if not self.has_lab and tick == 0:
                # As the server without a lab, which still publishes its empty default arena.
                self.publish("lab", {"run": "", "name": "", "description": "", "version": "",
                                     "replay": False, "arena_cm": [120.0, 90.0],
                                     "robot_diameter_cm": 7.5, "duration_s": 0.0, "robots": [],
                                     "programs": [], "bands": [], "script": [], "file": ""})
                self.publish("frame", {"t_us": 1, "robots": [], "unidentified": []})
                tick += 1
            if int(now * 20) % 20 == 0:
                self.publish("pulse", {"t_us": int(time.time() * 1e6),
                                       "bus_silent_s": heard and round(now - heard, 1)})
            time.sleep(max(0.0, 0.05 - (time.monotonic() - now)))

    def take_request(self, body):
        """@return (code, answer)"""
        if not isinstance(body, dict) or not isinstance(body.get("request"), str):
            return 400, {"error": "expected {\"request\": NAME, ...}"}
        self.operator_requests.append((time.monotonic(), body))
        note = self.world.take_request(body)
        if self.has_lab:
            self.publish("stop", self.world.stop())
        if note.startswith("refused"):
            return 409, {"error": note}
        self.publish("note", {"t_us": int(time.time() * 1e6), "request": body["request"], "text": note})
        return 202, {}

    @property
    def address(self):
        return f"http://127.0.0.1:{self.port}/"

    @property
    def address_with_token(self):
        return self.address + "#token=" + TOKEN

    def serve(self):
        lab = self

        class Server(http.server.ThreadingHTTPServer):
            daemon_threads = True
            allow_reuse_address = True

            def handle_error(self, request, client_address):
                pass  # a client that went away

        self.server = Server(("127.0.0.1", self.port),
                             type("Handler", (Handler,), {"lab": lab}))
        self.port = self.server.server_address[1]
        threading.Thread(target=self.server.serve_forever, args=(0.05,), daemon=True).start()
        return self

    def stop_serving(self):
        self.server.shutdown()
        self.server.server_close()
        self.server = None
        for connection in list(self.sockets):
            try:
                connection.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass

    def close(self):
        self.running = False
        if self.server:
            self.stop_serving()


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    lab = None

    def log_message(self, *_):
        pass

    def setup(self):
        super().setup()
        self.lab.sockets.add(self.connection)

    def finish(self):
        self.lab.sockets.discard(self.connection)
        super().finish()

    def answer(self, code, body=b"", kind="application/json"):
        if not isinstance(body, bytes):
            body = json.dumps(body).encode()
        self.send_response(code)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Content-Security-Policy", POLICY)
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.wfile.write(body)

    def do_GET(self):
        url = urllib.parse.urlsplit(self.path)
        which = urllib.parse.parse_qs(url.query)
        self.lab.requests.append(("GET", self.path))
        path, world = url.path, self.lab.world
        if path == "/" or path.startswith("/page/"):
            return self.file(path)
        if path == "/api/stream":
            return self.stream()
        if path in self.lab.broken:
            return self.answer(503, {"error": "not now"})
        if path == "/api/me":
            token = self.headers.get("X-Lab-Token") == TOKEN
            why = ("another machine's page is read-only" if self.lab.read_only else
                   "" if token else "no token: open the address that the lab printed")
            return self.answer(200, {"control": not why, "why": why})
        if path == "/api/light":
            return self.answer(200, world.light_raster(), "application/octet-stream")
        if path == "/api/camera.jpg":
            return self.answer(200, png(160, 120, lambda c, r: (c + r + world.ticks) % 256),
                               "image/png")
        if path.startswith("/api/ask/"):
            found = world.query(path[9:], which.get("which", [""])[0])
            return self.answer(404,
                               {"error": "no such thing"}) if found is None else self.answer(200,
                                                                                             found)
        if path == "/api/runs":
            return self.answer(200, world.runs())
        if path.startswith("/api/runs/") and path.endswith(".svg"):
            return self.answer(200, mock_topics.THUMBNAIL.encode(), "image/svg+xml")
        if path.startswith("/api/runs/") and path.endswith("film_clip.json"):
            return self.answer(200, mock_topics.FILM_CLIP)
        if path.startswith("/api/runs/") and path.endswith("film.mp4"):
            return self.answer(200, b"film", "video/mp4")
        if path.startswith("/api/runs/") and path.endswith(".html"):
            return self.answer(200, b"<!doctype html><title>report</title><p>report", "text/html")
        if path == "/api/campaigns":
            return self.answer(200, mock_topics.CAMPAIGNS)
        if path == "/api/compare":
            return self.answer(200, world.compare(which["runs"][0].split(",")))
        if path == "/api/experiments":
            return self.answer(200, mock_topics.EXPERIMENTS)
        if path == "/api/labs":
            return self.answer(200, self.lab.labs)
        if path == "/api/started":
            return self.answer(200, self.lab.started)
        return self.answer(404, {"error": "no such page"})

    def file(self, path):
        name = "index.html" if path == "/" else path[6:]
        file = OTHER_FILES.get(name, PAGE / name)
        if "/" in name or not file.is_file():
            return self.answer(404, {"error": "no such file"})
        return self.answer(200, file.read_bytes(), TYPES.get(file.suffix, "text/plain"))

    def stream(self):
        lab, seen = self.lab, 0
        self.send_response(200)
        self.send_header("Content-Type", "text/event-stream")
        self.send_header("Cache-Control", "no-store")
        self.send_header("Connection", "close")
        self.end_headers()
        while lab.running and lab.server:
            with lab.changed:
                lab.changed.wait_for(lambda: lab.version > seen, 1.0)
                news = sorted((v, t) for t, v in lab.versions.items() if v > seen)
                text = "".join(f"event: {t}\ndata: {lab.topics[t]}\n\n" for _, t in news)
                seen = lab.version
            if not lab.mute:
                self.wfile.write(text.encode())
        self.close_connection = True

    def do_POST(self):
        body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        self.lab.requests.append(("POST", self.path))
        if self.lab.read_only or self.headers.get("X-Lab-Token") != TOKEN:
            return self.answer(403, {"error": "this page is read-only"})
        try:
            order = json.loads(body)
        except ValueError:
            return self.answer(400, {"error": "not JSON"})
        if self.path == "/api/request":
            return self.answer(*self.lab.take_request(order))
        if self.path == "/api/check":
            bad = [s for s in order.get("set", []) if "=" not in s]
            return self.answer(200,
                               {"ok": not bad,
                                "text": f"--set {bad[0]}: expected key=value" if bad else
                                     f"{order['file']}: 1 robot, 3600 s, would start 5 programs"})
        if self.path == "/api/start":
            self.lab.started = {"state": "running", "code": None,
                                "output": "web  " + self.lab.address,
                                "address": self.lab.address_with_token, "run": None}
            return self.answer(202, {})
        return self.answer(404, {"error": "no such page"})


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--port", type=int, default=8480)
    options.add_argument("--robots", type=int, default=20)
    options.add_argument("--read-only", action="store_true")
    options.add_argument("--replay", action="store_true")
    options.add_argument("--no-lab", action="store_true")
    chosen = options.parse_args()
    lab = MockLab(chosen.robots, chosen.port, chosen.read_only, chosen.replay,
                  not chosen.no_lab).serve()
    print(lab.address_with_token, flush=True)
    try:
        while True:
            time.sleep(1)
    except KeyboardInterrupt:
        lab.close()


if __name__ == "__main__":
    main()
