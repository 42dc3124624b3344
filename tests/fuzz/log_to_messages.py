#!/usr/bin/env python3
"""Makes an input of fuzz_messages and fuzz_log from a log: log_to_messages.py LOG INPUT [PER_CHANNEL]

Takes the first PER_CHANNEL (1) messages of each channel, in the order of the log (messages.hpp)."""
import collections
import re
import struct
import sys

SYNC = 0xEDA1DA01


def channels():
    """The names of channels::kAll, in its order."""
    text = open(__file__.rsplit('/', 3)[0] + '/common/bus/channels.hpp').read()
    names = dict(re.findall(r'string_view (k\w+) = "(\w+)"', text))
    return [names[word] for word in re.findall(r'k\w+', text.split('kAll{')[1].split('}')[0])]


def events(path):
    data = open(path, 'rb').read()
    at = 0
    while at + 28 <= len(data):
        sync, _, utime, name, size = struct.unpack_from('>IqqII', data, at)
        if sync != SYNC:
            sys.exit(f'{path}: byte {at}: found {sync:#x}, expected the sync word of an event')
        at += 28
        yield utime, data[at:at + name].decode(), data[at + name:at + name + size]
        at += name + size


def main():
    log, out = sys.argv[1:3]
    most = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    numbers = {name: number for number, name in enumerate(channels())}
    taken = collections.Counter()
    chosen = []
    for utime, channel, message in events(log):
        taken[channel] += 1
        if taken[channel] <= most and channel in numbers and len(message) < 65536:
            chosen.append((utime, numbers[channel], message[8:]))  # without its fingerprint
    with open(out, 'wb') as file:
        file.write(bytes([0]))  # all services, without tracker and runner; a replay at its usual place and speed
        for (utime, number, fields), later in zip(chosen, chosen[1:] + chosen[-1:]):
            wait = min((later[0] - utime) // 4000, 255)
            file.write(struct.pack('=BBH', number, wait, len(fields)) + fields)


main()
