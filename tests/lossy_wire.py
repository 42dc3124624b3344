#!/usr/bin/env python3
"""Forwards frames between two interfaces of this network namespace and loses some of them.

lossy_wire.py NEAR FAR PERCENT SEED     prints "ready", then forwards frames until it is killed
lossy_wire.py --whole-frames INTERFACE  switches off offloads, so that frames have the size and checksums of a cable

A replacement for netem of tc, which not every kernel has.
"""
import ctypes
import fcntl
import random
import select
import socket
import struct
import sys

ETH_P_ALL = 0x0003
PACKET_IGNORE_OUTGOING = 23
SO_SNDBUFFORCE, SO_RCVBUFFORCE = 32, 33  # beyond the limits of sysctl, for root
SOL_PACKET = 263
SIOCETHTOOL = 0x8946
# From linux/ethtool.h: checksums in hardware, segmentation, merging of received frames.
SET_OFFLOADS = {"tx checksum": 0x17, "tso": 0x1F, "gso": 0x24, "gro": 0x2C}


def switch_off_offloads(interface):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        for what, command in SET_OFFLOADS.items():
            value = ctypes.create_string_buffer(struct.pack("II", command, 0), 8)
            request = struct.pack("16sP16x", interface.encode(), ctypes.addressof(value))
            try:
                fcntl.ioctl(control.fileno(), SIOCETHTOOL, request)
            except OSError as error:
                sys.exit(f"lossy_wire.py: {interface}: {what} cannot be switched off: {error}")


def open_socket(interface):
    end = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(ETH_P_ALL))
    end.setsockopt(SOL_PACKET, PACKET_IGNORE_OUTGOING, 1)
    # On a loaded machine this process waits for its turn. No frame is lost in that time.
    for option in (SO_SNDBUFFORCE, SO_RCVBUFFORCE):
        end.setsockopt(socket.SOL_SOCKET, option, 64 << 20)
    end.bind((interface, 0))
    end.setblocking(False)
    return end


def forward(near, far, share, random_source):
    others = {near: far, far: near}
    while True:
        for end in select.select([near, far], [], [])[0]:
            for _ in range(256):
                try:
                    frame = end.recv(65536)
                    if random_source.random() >= share:
                        others[end].send(frame)
                except OSError:  # no more frames, or the interface is down
                    break


def main():
    if sys.argv[1] == "--whole-frames":
        switch_off_offloads(sys.argv[2])
        return
    near, far, percent, seed = sys.argv[1:5]
    ends = open_socket(near), open_socket(far)
    print("ready", flush=True)
    forward(*ends, float(percent) / 100, random.Random(int(seed)))


if __name__ == "__main__":
    main()
