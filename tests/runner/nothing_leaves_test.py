"""What leaves a machine with a second network interface during a run: no frame with data.

  nothing_leaves_test.py pinned|replaced|unpinned FOLDER_OF_PROGRAMS   (in a network of its own)
"""
import os
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

SCENARIO, PROGRAMS = sys.argv[1], os.path.abspath(sys.argv[2])

EXPERIMENT = '''
fileversion = 1
name = "quiet"
duration_s = 5
program = "abp"

[gateway]
ros = true

[[robots]]
count = 3
id = 1

[programs.abp]
model = "abp"
v_cm_s = 3
epsilon_s = 0.5
eta_rad_s = 3
'''


def sh(command):
    subprocess.run(command, shell=True, check=True)


def add_interface():
    """eth9, with an address and the default route, and its other end, on which we listen."""
    sh('ip link add eth9 type veth peer name far9 && ip link set dev eth9 up && '
       'ip link set dev far9 up && ip address add 192.168.9.1/24 dev eth9 && '
       'ip route add default via 192.168.9.2 dev eth9')


def is_data(frame):
    """Group membership reports and what the kernel says of itself are none."""
    kind = struct.unpack('!H', frame[12:14])[0]
    if kind == 0x0806:  # ARP
        return False
    if kind == 0x86dd:  # IPv6: MLD and neighbour discovery are ICMPv6, after an option for MLD
        return frame[20] not in (0, 58)
    if kind == 0x0800:
        return frame[23] != 2  # IGMP
    return True


class Capture:
    """Data frames that come out at the far end of the cable."""

    def __init__(self):
        self.data = []
        self.ended = False
        self.socket = None
        self.thread = threading.Thread(target=self.listen, daemon=True)
        self.open()
        self.thread.start()

    def open(self):
        listener = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(3))
        listener.bind(('far9', 0))
        listener.settimeout(0.1)
        self.socket = listener

    def listen(self):
        while not self.ended:
            try:
                frame, address = self.socket.recvfrom(65536)
            except (OSError, socket.timeout):
                continue
            if address[2] != socket.PACKET_OUTGOING and is_data(frame):
                self.data.append(frame)


def main():
    if subprocess.run('ip link add try9 type veth peer name try8 && ip link del try9', shell=True,
                      capture_output=True, check=False).returncode != 0:
        print('no veth pair can be made here')
        sys.exit(77)
    folder = tempfile.mkdtemp(prefix='lab-quiet-')
    add_interface()
    if SCENARIO == 'unpinned':
        sh('ip route del 224.0.0.0/4 dev lo')
    capture = Capture()
    # The capture must be able to see something.
    probe = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sh('ip neighbour add 192.168.9.2 lladdr 02:00:00:00:00:01 dev eth9')
    probe.sendto(b'probe', ('192.168.9.2', 9))
    time.sleep(0.3)
    assert len(capture.data) == 1, 'the capture is deaf'
    capture.data.clear()

    file = os.path.join(folder, 'quiet.toml')
    with open(file, 'w', encoding='ascii') as stream:
        stream.write(EXPERIMENT)
    lab = subprocess.Popen([os.path.join(PROGRAMS, 'lab'), 'run', file, '--no-report', '--out',
                            os.path.join(folder, 'runs')], stdout=subprocess.PIPE,
                           stderr=subprocess.STDOUT, text=True,
                           env=dict(os.environ, XDG_RUNTIME_DIR=folder))
    if SCENARIO == 'replaced':
        time.sleep(3)
        sh('ip link del eth9')
        time.sleep(0.3)
        add_interface()
        capture.open()
    text, _ = lab.communicate(timeout=50)
    print(text)
    assert lab.returncode == 0, lab.returncode
    warned = 'warn     multicast is routed over eth9' in text
    assert warned == (SCENARIO == 'unpinned'), text
    assert not capture.data, f'{len(capture.data)} frames left, the first: {capture.data[0].hex()}'
    capture.ended = True
    shutil.rmtree(folder)
    print('passed')


main()
