"""A run to whose bus another computer sends messages and the fragments that make liblcm write out of bounds.

  two_hosts.sh bus_attack_test.py FOLDER_OF_PROGRAMS   (the lab is on host A, the attacker on the router)
"""
import glob
import json
import os
import re
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import time

import three_robots

PROGRAMS = os.path.abspath(sys.argv[1])
PORT = 23471

EXPERIMENT = three_robots.experiment('attacked', 4, f'[network]\nport = {PORT}\n')

MESSAGE = b'LC02' + bytes(4) + b'ROBOT_COMMAND\0' + b'forged'
FIRST = b'LC03' + struct.pack('>IIIHH', 9, 2000, 0, 0, 3) + b'LIGHT_COMMAND\0' + bytes(1000)
# Offset and size add up to 2^32.
SECOND = b'LC03' + struct.pack('>IIIHH', 9, 2000, 2**32 - 60000, 1, 3) + bytes(60000)
# Sent on host A itself: nothing that LCM would send, and the fragments.
JUNK = """
import socket
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
s.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
for datagram in (b"no message of LCM", %r, %r):
    s.sendto(datagram, ("239.255.76.67", %d))
"""


def main():
    folder = tempfile.mkdtemp(prefix='lab-attacked-')
    file = os.path.join(folder, 'attacked.toml')
    with open(file, 'w', encoding='ascii') as stream:
        stream.write(EXPERIMENT)
    lab = subprocess.Popen([os.environ['TWO_HOSTS'], 'on', 'A', os.path.join(PROGRAMS, 'lab'), 'run', file,
                            '--out', os.path.join(folder, 'runs')],
                           stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                           env=dict(os.environ, XDG_RUNTIME_DIR=folder))
    logs = os.path.join(folder, 'runs', '*', 'log.lcmlog')
    while lab.poll() is None and not any(os.path.getsize(log) for log in glob.glob(logs)):
        time.sleep(0.05)
    attacker = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    bursts = 0
    while lab.poll() is None:
        for datagram in (MESSAGE, FIRST, SECOND):
            attacker.sendto(datagram, (os.environ['ADDRESS_A'], PORT))
        if bursts % 25 == 0:
            subprocess.run([os.environ['TWO_HOSTS'], 'on', 'A', sys.executable, '-'],
                           input=JUNK % (FIRST, SECOND, PORT), text=True, check=True)
        bursts += 1
        time.sleep(0.02)
    text = lab.stdout.read()
    print(text)
    assert lab.returncode == 0, lab.returncode
    assert bursts >= 10, bursts  # how many depends on the load of the machine
    (summary,) = glob.glob(os.path.join(folder, 'runs', '*', 'summary.json'))
    with open(summary, encoding='utf-8') as stream:
        losses = json.load(stream)['losses']
    print(losses)
    assert losses['decode_errors'] == {}, 'a forged message was recorded'
    rows = [row for row in losses['listeners'] if row['sender'].startswith('not sent to the group, last 10.77.1.254:')]
    assert [row['listener'] for row in rows] == ['lab'], 'the attack is not reported'
    for service in ('lab', 'analyzer'):
        assert [row for row in losses['listeners'] if row['listener'] == service and
                row['sender'].startswith('not an LCM datagram, last ')], service
    (log,) = glob.glob(os.path.join(folder, 'runs', '*', 'logs', 'analyzer.txt'))
    with open(log, encoding='utf-8') as stream:
        assert re.search(r'the bus refused \d+: not an LCM datagram, the last from 10\.77\.1\.1:', stream.read())
    assert not glob.glob(logs + '.*'), 'the recorder was restarted'
    shutil.rmtree(folder)
    print('passed')


main()
