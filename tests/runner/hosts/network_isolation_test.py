"""During a run no frame with data leaves a machine through its second network interface.

  network_isolation_test.py pinned|replaced|unpinned FOLDER_OF_PROGRAMS   (in a private network)
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

import three_robots

SCENARIO, PROGRAMS = sys.argv[1], os.path.abspath(sys.argv[2])
LOOPBACK = os.path.join(os.path.dirname(os.path.abspath(__file__)),
                        '../../../docs/examples/ros2/cyclonedds.xml')

EXPERIMENT = three_robots.experiment('quiet', 5, '[gateway]\nros = true\n')


def sh(command):
    subprocess.run(command, shell=True, check=True)


def is_data(frame):
    """False for the kernel's own traffic: ARP, IGMP, neighbour discovery and MLD."""
    kind = struct.unpack('!H', frame[12:14])[0]
    if kind == 0x0806:  # ARP
        return False
    if kind == 0x86dd:  # IPv6: MLD and neighbour discovery are ICMPv6, after an option for MLD
        return frame[20] not in (0, 58)
    if kind == 0x0800:
        return frame[23] != 2  # IGMP
    return True


class Capture:
    """A veth pair: eth9 has an address and the default route; data frames are captured at the other end."""

    def __init__(self):
        self.data = []
        self.ended = False
        self.plug_in()
        self.thread = threading.Thread(target=self.listen, daemon=True)
        self.thread.start()

    def plug_in(self):
        """Starts listening before the interface is up."""
        sh('ip link add eth9 type veth peer name far9 && ip link set dev far9 up')
        self.socket = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(3))
        self.socket.bind(('far9', 0))
        self.socket.settimeout(0.1)
        sh('ip link set dev eth9 up && ip address add 192.168.9.1/24 dev eth9 && '
           'ip neighbour add 192.168.9.2 lladdr 02:00:00:00:00:01 dev eth9 && '
           'ip route add default via 192.168.9.2 dev eth9')

    def listen(self):
        while not self.ended:
            try:
                frame, address = self.socket.recvfrom(65536)
            except OSError:  # timeout, or the interface was removed
                continue
            if address[2] != socket.PACKET_OUTGOING and is_data(frame):
                self.data.append(frame)

    def prove(self):
        """Checks that the capture works, with a frame of our own."""
        deadline = time.time() + 60
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            while not any(frame.endswith(b'probe') for frame in self.data):
                assert time.time() < deadline, 'the capture receives nothing'
                probe.sendto(b'probe', ('192.168.9.2', 9))
                time.sleep(0.1)
        time.sleep(0.2)
        self.data[:] = [frame for frame in self.data if not frame.endswith(b'probe')]


class Reader:
    """A ROS 2 node on this machine that reads the poses, so that DDS sends data."""

    def __init__(self):
        self.count = 0
        self.process = subprocess.Popen(
            [os.path.join(PROGRAMS, 'lab_cyclone_peer'), '0', 'file://' + LOOPBACK],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.process.stdin.write('reader rt/lab/poses geometry_msgs::msg::dds_::PoseArray_\n')
        self.process.stdin.flush()
        threading.Thread(target=self.listen, daemon=True).start()

    def listen(self):
        for line in self.process.stdout:
            self.count += line.startswith('got rt/lab/poses ')

    def end(self):
        self.process.stdin.close()
        self.process.wait(timeout=60)


def main():
    if subprocess.run('ip link add try9 type veth peer name try8 && ip link del try9', shell=True,
                      capture_output=True, check=False).returncode != 0:
        print('no veth pair can be created here')
        sys.exit(77)
    folder = tempfile.mkdtemp(prefix='lab-quiet-')
    if SCENARIO == 'unpinned':
        sh('ip route del 224.0.0.0/4 dev lo')
    capture = Capture()
    capture.prove()
    reader = Reader()

    file = os.path.join(folder, 'quiet.toml')
    with open(file, 'w', encoding='ascii') as stream:
        stream.write(EXPERIMENT)
    lab = subprocess.Popen([os.path.join(PROGRAMS, 'lab'), 'run', file, '--no-report', '--out',
                            os.path.join(folder, 'runs')], stdout=subprocess.PIPE,
                           stderr=subprocess.STDOUT, text=True,
                           env=dict(os.environ, XDG_RUNTIME_DIR=folder))
    if SCENARIO == 'replaced':
        deadline = time.time() + 60
        while reader.count == 0:
            assert time.time() < deadline and lab.poll() is None, 'no poses from the run'
            time.sleep(0.1)
        sh('ip link del eth9')
        time.sleep(0.3)
        capture.plug_in()
        capture.prove()
        before = reader.count
    text, _ = lab.communicate(timeout=150)
    print(text)
    assert lab.returncode == 0, lab.returncode
    warned = 'warn     multicast is routed over eth9' in text
    assert warned == (SCENARIO == 'unpinned'), text
    assert not capture.data, f'{len(capture.data)} frames left, the first: {capture.data[0].hex()}'
    assert reader.count > (before if SCENARIO == 'replaced' else 0), 'nothing was received over DDS'
    capture.ended = True
    reader.end()
    shutil.rmtree(folder)
    print('passed')


main()
