#!/usr/bin/env python3
"""Tests tests/two_hosts.sh, which runs it: two_hosts_test.py PERCENT

Datagrams pass in both directions with the given loss, multicast does not pass, cables can be unplugged.
The listener counts until the sender has ended, however slow the machine is. It also counts the
datagrams that arrived but found its socket full, because these are not losses of the wire.
"""
import os
import socket
import subprocess
import sys
import time

SENT = 3000
CHILD = """
import select, socket, sys, time
kind, address, count = sys.argv[1], sys.argv[2], int(sys.argv[3])
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
if kind == "send":
    if address.startswith("239."):
        s.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 8)
        s.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton(sys.argv[4]))
    else:  # until the listener answers: frames that wait for the answer of ARP are lost
        s.settimeout(0.05)
        for _ in range(60):
            try:
                s.sendto(b"hello", (address, 9000))
                s.recv(2000)
                break
            except OSError:
                pass
        s.settimeout(None)
    for number in range(count):
        try:
            s.sendto(number.to_bytes(4, "big") + bytes(996), (address, 9000))
        except OSError:
            pass
        time.sleep(0.0002)
    # The listener ends with the first of these. 30 of them are not all lost by chance.
    for _ in range(30):
        try:
            s.sendto(b"end", (address, 9000))
        except OSError:
            pass
        time.sleep(0.05)
else:
    s.bind(("", 9000))
    if len(sys.argv) > 4:
        s.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
                     socket.inet_aton("239.1.2.3") + socket.inet_aton(sys.argv[4]))
    def socket_full():
        names, values = [l.split() for l in open("/proc/self/net/snmp") if l.startswith("Udp:")]
        return int(values[names.index("RcvbufErrors")])
    before = socket_full()
    print("ready", flush=True)
    got = 0
    ended = False
    while True:
        ready, _, _ = select.select([s] if ended else [s, sys.stdin], [], [], 0.5 if ended else None)
        if s in ready:
            datagram, origin = s.recvfrom(2000)
            if datagram == b"end":
                break
            if datagram == b"hello":
                s.sendto(b"hello", origin)
            else:
                got += 1
        elif ready:
            ended = True
        else:
            break
    print(got + socket_full() - before)
"""


def on(host, *arguments, **options):
    command = [os.environ["TWO_HOSTS"], "on", host, sys.executable, "-c", CHILD]
    return subprocess.Popen(command + [str(a) for a in arguments], text=True, **options)


def arrived(sender, receiver, address, count, group=()):
    listener = on(receiver, "hear", address, 0, *group, stdin=subprocess.PIPE,
                  stdout=subprocess.PIPE)
    assert listener.stdout.readline() == "ready\n"
    talker = on(sender, "send", address, count, os.environ["ADDRESS_" + sender])
    while talker.poll() is None and listener.poll() is None:
        time.sleep(0.02)
    talker.kill()
    talker.wait()
    return int(listener.communicate()[0])


def wire(*what):
    subprocess.run([os.environ["TWO_HOSTS"], *what], check=True)


def main():
    share = float(sys.argv[1]) / 100
    expected, error = SENT * (1 - share), (SENT * share * (1 - share)) ** 0.5
    for sender, receiver in ("AB", "BA"):
        got = arrived(sender, receiver, os.environ["ADDRESS_" + receiver], SENT)
        print(f"{sender} to {receiver}: {got} of {SENT}, expected {expected:.0f} +- {error:.0f}")
        # The number of arrivals has a binomial distribution.
        assert abs(got - expected) <= 4 * error, "wrong number of losses"
    # The router does not forward multicast.
    address_b = os.environ["ADDRESS_B"]
    assert arrived("A", "B", "239.1.2.3", 100, [address_b]) == 0, "multicast crossed the router"
    for out, back in (("cut", "restore"), ("mute", "unmute")):
        wire(out, "B")
        assert arrived("A", "B", address_b, 100) == 0, f"{out} has no effect"
        wire(back, "B")
        deadline = time.monotonic() + 60
        while arrived("A", "B", address_b, 100) == 0:
            assert time.monotonic() < deadline, f"{back} has no effect"


if __name__ == "__main__":
    main()
