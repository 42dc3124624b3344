#!/usr/bin/env python3
"""BP, ABP and RTP in turn by rising light, commanded from outside of a running lab.

    mkdir -p build/python && lcm-gen -p --ppath build/python lcmtypes/*.lcm
    PYTHONPATH=build/python python3 docs/examples/light_switching.py udpm://239.255.76.67:7667?ttl=0
"""
import argparse
import socket
import struct
import time
import urllib.parse

from lab import light_command_t, light_layer_t, light_status_t, robot_status_t

SHORT, FRAGMENT = 0x4C433032, 0x4C433033  # "LC02", "LC03"


class Bus:
    """LCM over UDP multicast: channels and encoded messages."""

    def __init__(self, url):
        parts = urllib.parse.urlparse(url)
        ttl = int(urllib.parse.parse_qs(parts.query).get("ttl", ["0"])[0])
        self.group, self.sent, self.pieces = (parts.hostname, parts.port), 0, {}
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, ttl)
        self.socket.bind(self.group)
        member = socket.inet_aton(parts.hostname) + socket.inet_aton("0.0.0.0")
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)

    def send(self, channel, message):
        """Up to 60 kB; LCM's fragments are needed beyond."""
        header = struct.pack(">II", SHORT, self.sent) + channel.encode() + b"\0"
        self.socket.sendto(header + message.encode(), self.group)
        self.sent += 1

    def receive(self, seconds):
        """The next channel and message, (None, None) when there is none in this time."""
        self.socket.settimeout(max(seconds, 1e-3))
        try:
            packet, sender = self.socket.recvfrom(65536)
        except socket.timeout:
            return None, None
        magic, number = struct.unpack_from(">II", packet)
        if magic == FRAGMENT:  # a large message comes in pieces, the channel with the first
            part, parts = struct.unpack_from(">HH", packet, 16)
            pieces = self.pieces.setdefault((sender, number), {})
            pieces[part] = packet[20:]
            if len(pieces) < parts:
                return None, None
            packet = b"\0" * 8 + b"".join(pieces[i] for i in range(parts))
            del self.pieces[sender, number]
        channel, _, message = packet[8:].partition(b"\0")
        return channel.decode(), message


def now():
    return time.time_ns() // 1000


def uniform(intensity):
    layer = light_layer_t()
    layer.kind, layer.intensity = light_layer_t.UNIFORM, intensity
    layer.grid = b""  # lcm-gen's own default for bytes is a text
    return [layer]


def show(bus, instance, seq, label, layers, hold):
    """Shows the layers for `hold` seconds; says when they were seen and what the robots ran."""
    command = light_command_t()
    command.sender, command.instance, command.seq = "light_switching.py", instance, seq
    command.priority, command.from_utime, command.label = light_command_t.MANUAL, now(), label
    command.layers, command.num_layers = layers, len(layers)
    shown, programs, spoken = None, {}, 0
    end = time.monotonic() + hold
    while time.monotonic() < end:
        if time.monotonic() - spoken > 0.5:  # messages may be lost: a command is repeated
            spoken, command.utime = time.monotonic(), now()
            bus.send("LIGHT_COMMAND", command)
        channel, message = bus.receive(0.1)
        if channel == "LIGHT_STATUS":
            status = light_status_t.decode(message)
            if (status.command_instance, status.command_seq) == (instance, seq):
                shown = status.first_shown_utime
        elif channel == "ROBOT_STATUS":
            for robot in robot_status_t.decode(message).robots:
                programs[robot.robot_id] = robot.program.name
    if shown is None:
        raise SystemExit(f"{label}: the projector did not show it")
    print(f"{label}: shown after {(shown - command.from_utime) / 1000:.1f} ms,"
          f" programs now {sorted(programs.items())}", flush=True)


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("url", help="of the bus, as lab run prints it")
    arguments.add_argument("--hold", type=float, default=30, help="s, of each light")
    options = arguments.parse_args()
    bus, instance = Bus(options.url), now()
    lights = [("dim: BP", 0.2), ("half: ABP", 0.5), ("bright: RTP", 0.9)]
    for seq, (label, intensity) in enumerate(lights, start=1):
        show(bus, instance, seq, label, uniform(intensity), options.hold)


if __name__ == "__main__":
    main()
