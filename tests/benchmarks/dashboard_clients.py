#!/usr/bin/env python3
"""CPU time of `dashboard` in a lab of 100 robots with no, one and ten clients, each for the same time in
the same run.

  tests/in_private_network.sh tests/benchmarks/dashboard_clients.py build/dev/bin [SECONDS]
"""

import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROBOTS, RATE_HZ, PORT = 100, 20, 28470


def start(programs, folder):
    output = open(folder / "output", "w", encoding="utf-8")
    lab = subprocess.Popen(
        [programs / "lab", "run", ROOT / "experiments" / "swarm.toml", "--web", "--no-report",
         "--out", folder / "runs", "--set", f"robots[0].count={ROBOTS}",
         "--set", f"camera.fps={RATE_HZ}", "--set", f"robot.status_rate_hz={RATE_HZ}",
         "--set", f"dashboard.port={PORT}"],
        stdout=output, stderr=subprocess.STDOUT, env=dict(os.environ, XDG_RUNTIME_DIR=str(folder)))
    end = time.monotonic() + 30
    while time.monotonic() < end and lab.poll() is None:
        if re.search(r"web\s+http://", (folder / "output").read_text(encoding="utf-8")):
            return lab
        time.sleep(0.1)
    lab.terminate()
    raise SystemExit("no dashboard address: " + (folder / "output").read_text(encoding="utf-8"))


def pid_of_dashboard(lab):
    for entry in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            parent = int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1])
            if parent == lab.pid and os.readlink(entry / "exe").endswith("/dashboard"):
                return int(entry.name)
        except OSError:
            continue
    raise SystemExit("no dashboard process")


def spent_s(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def memory_MB(pid):
    text = pathlib.Path(f"/proc/{pid}/status").read_text()
    return int(re.search(r"VmRSS:\s+(\d+)", text)[1]) / 1024


class Client(threading.Thread):
    """Reads the stream and discards it."""

    def __init__(self):
        super().__init__(daemon=True)
        self.bytes = 0
        self.socket = socket.create_connection(("127.0.0.1", PORT))
        self.socket.sendall(b"GET /api/stream HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n" % PORT)
        self.start()

    def run(self):
        while chunk := self.socket.recv(1 << 16):
            self.bytes += len(chunk)

    def close(self):
        self.socket.shutdown(socket.SHUT_RDWR)
        self.join()
        self.socket.close()


def main():
    programs = pathlib.Path(sys.argv[1]).resolve()
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 20
    with tempfile.TemporaryDirectory() as name:
        lab = start(programs, pathlib.Path(name))
        try:
            pid = pid_of_dashboard(lab)
            time.sleep(15)  # until the script runs and curves arrive
            costs = {}
            for count in (0, 1, 10):
                clients = [Client() for _ in range(count)]
                time.sleep(2)
                heard, before, began = sum(c.bytes for c in clients), spent_s(pid), time.monotonic()
                time.sleep(seconds)
                took = time.monotonic() - began
                costs[count] = (spent_s(pid) - before) / took
                heard = (sum(c.bytes for c in clients) - heard) / took / 1000
                print(f"{count:2d} clients: {100 * costs[count]:.2f} % of a core, "
                      f"{heard:.0f} kB/s, {memory_MB(pid):.1f} MB")
                for client in clients:
                    client.close()
            print(f"ten clients cost {costs[10] / costs[1]:.2f} times one "
                  f"({ROBOTS} robots, {RATE_HZ} Hz)")
        finally:
            lab.send_signal(signal.SIGINT)
            lab.wait(30)


if __name__ == "__main__":
    main()
