#!/usr/bin/env python3
"""A wire between two interfaces of this network namespace that loses frames.

lossy_wire.py NEAR FAR PERCENT SEED     passes frames on until it is ended; says "ready" first
lossy_wire.py --whole-frames INTERFACE  has the kernel hand over frames as a wire carries them

tc's netem would do this, where the kernel has it.
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
SOL_PACKET = 263
SIOCETHTOOL = 0x8946
# Of the kernel's ethtool.h: checksums in hardware, segmentation, merging of received frames.
SET_OFFLOADS = {"tx checksum": 0x17, "tso": 0x1F, "gso": 0x24, "gro": 0x2C}


def hand_over_whole_frames(interface):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as control:
        for what, command in SET_OFFLOADS.items():
            value = ctypes.create_string_buffer(struct.pack("II", command, 0), 8)
            request = struct.pack("16sP16x", interface.encode(), ctypes.addressof(value))
            try:
                fcntl.ioctl(control.fileno(), SIOCETHTOOL, request)
            except OSError as error:
                sys.exit(f"lossy_wire.py: {interface}: {what} cannot be switched off: {error}")


def end_of(interface):
    end = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(ETH_P_ALL))
    end.setsockopt(SOL_PACKET, PACKET_IGNORE_OUTGOING, 1)
    end.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4 << 20)
    end.bind((interface, 0))
    end.setblocking(False)
    return end


def carry(near, far, share, chance):
    others = {near: far, far: near}
    while True:
        for end in select.select([near, far], [], [])[0]:
            for _ in range(256):
                try:
                    frame = end.recv(65536)
                    if chance.random() >= share:
                        others[end].send(frame)
                except OSError:  # nothing more, or a cable is out
                    break


def main():
    if sys.argv[1] == "--whole-frames":
        hand_over_whole_frames(sys.argv[2])
        return
    near, far, percent, seed = sys.argv[1:5]
    ends = end_of(near), end_of(far)
    print("ready", flush=True)
    carry(*ends, float(percent) / 100, random.Random(int(seed)))


if __name__ == "__main__":
    main()
