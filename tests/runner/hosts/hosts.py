"""Remote hosts for tests: a real sshd on each of them, and checks for leftovers of a run.

The environment variables that describe them are set by tests/two_hosts.sh.
"""
import fnmatch
import glob
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import three_robots

PROGRAMS = os.path.abspath(sys.argv[2]) if len(sys.argv) > 2 else ''
PORT = 2222
SSHD = shutil.which('sshd') or '/usr/sbin/sshd'


class Hosts:
    """sshd on B (and C), an ssh client configured for them, and a temporary folder."""

    def __init__(self, names=('bench',)):
        self.folder = tempfile.mkdtemp(prefix='lab-hosts-test-')
        self.names = dict(zip(names, ('B', 'C')))
        self.daemons = {}
        self.temp = os.path.join(self.folder, 'tmp')
        os.mkdir(self.temp)
        os.makedirs('/run/sshd', exist_ok=True)
        for key in ('key', 'host_key'):
            subprocess.run(['ssh-keygen', '-q', '-t', 'ed25519', '-N', '', '-f', self.path(key)],
                           check=True)
        shutil.copy(self.path('key.pub'), self.path('authorized_keys'))
        with open(self.path('ssh_config'), 'w', encoding='ascii') as config:
            for name, letter in self.names.items():
                config.write(f'Host {name}\n  HostName {os.environ["ADDRESS_" + letter]}\n')
            config.write(f'Host *\n  Port {PORT}\n  User {os.environ.get("USER", "root")}\n'
                         f'  IdentityFile {self.path("key")}\n  IdentitiesOnly yes\n'
                         f'  UserKnownHostsFile {self.path("known")}\n'
                         '  StrictHostKeyChecking yes\n')
        with open(self.path('host_key.pub'), encoding='ascii') as file:
            kind, key = file.read().split()[:2]
        with open(self.path('known'), 'w', encoding='ascii') as known:
            for letter in self.names.values():
                known.write(f'[{os.environ["ADDRESS_" + letter]}]:{PORT} {kind} {key}\n')
        os.mkdir(self.path('bin'))
        with open(self.path('bin/ssh'), 'w', encoding='ascii') as wrapper:
            wrapper.write(f'#!/bin/sh\nexec {shutil.which("ssh")} -F {self.path("ssh_config")} "$@"\n')
        os.chmod(self.path('bin/ssh'), 0o755)
        for name in self.names:
            self.start_sshd(name)

    def path(self, name):
        return os.path.join(self.folder, name)

    def start_sshd(self, name):
        letter = self.names[name]
        address = os.environ['ADDRESS_' + letter]
        config = self.path(f'sshd_{name}')
        with open(config, 'w', encoding='ascii') as file:
            file.write(f'Port {PORT}\nListenAddress {address}\nHostKey {self.path("host_key")}\n'
                       f'AuthorizedKeysFile {self.path("authorized_keys")}\nStrictModes no\n'
                       f'UsePAM no\nPermitRootLogin yes\nPidFile none\n'
                       f'SetEnv TMPDIR={self.temp} XDG_RUNTIME_DIR={self.path("runtime_" + name)}\n')
        log = open(self.path(f'sshd_{name}.log'), 'a', encoding='ascii')
        self.daemons[name] = on(letter, [SSHD, '-D', '-e', '-f', config], stderr=log)
        for _ in range(100):
            probe = subprocess.run(on_command('A', [self.path('bin/ssh'), '-o', 'BatchMode=yes', name,
                                                    'true']), capture_output=True, text=True)
            if probe.returncode == 0:
                return
            time.sleep(0.05)
        with open(log.name, encoding='utf8', errors='replace') as output:
            raise AssertionError(f'sshd refuses the connection: {probe.stderr}{output.read()[-2000:]}')

    def end_sshd(self, name):
        """Kills sshd and all of its connections, which are programs sshd-* since OpenSSH 9.8."""
        self.daemons[name].kill()
        for pid in self.pids_on(name, 'sshd*'):
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass

    def lab(self, experiment, *options, **more):
        """Starts the runner on A."""
        file = self.path('hosts.toml')
        with open(file, 'w', encoding='ascii') as stream:
            stream.write(experiment)
        environment = dict(os.environ, PATH=self.path('bin') + ':' + os.environ['PATH'],
                           XDG_RUNTIME_DIR=self.path('runtime_A'))
        return on('A', [os.path.join(PROGRAMS, 'lab'), 'run', file, '--out', self.path('runs'),
                        *options], env=environment, stdout=subprocess.PIPE,
                  stderr=subprocess.STDOUT, text=True, **more)

    def run_folder(self):
        runs = glob.glob(self.path('runs/*'))
        assert len(runs) == 1, runs
        return runs[0]

    def left_on(self, name):
        """Command lines of lab processes on the host, and folders of host agents."""
        network = os.readlink(f'/proc/{os.environ["HOST_" + self.names[name]]}/ns/net')
        found = glob.glob(os.path.join(self.temp, 'active-lab-host-*'))
        for process in glob.glob('/proc/[0-9]*'):
            try:
                if os.readlink(process + '/ns/net') != network:
                    continue
                with open(process + '/cmdline', 'rb') as file:
                    line = file.read().replace(b'\0', b' ').decode()
            except OSError:
                continue
            if PROGRAMS in line or 'host-agent' in line:
                found.append(line)
        return found

    def pids_on(self, name, program):
        """Processes on the host; the name of the program may be a pattern."""
        network = os.readlink(f'/proc/{os.environ["HOST_" + self.names[name]]}/ns/net')
        pids = []
        for process in glob.glob('/proc/[0-9]*'):
            try:
                with open(process + '/comm', encoding='ascii') as file:
                    found = fnmatch.fnmatchcase(file.read().strip(), program)
                if found and os.readlink(process + '/ns/net') == network:
                    pids.append(int(os.path.basename(process)))
            except OSError:
                pass
        return pids

    def nothing_left(self, within=60.0):
        deadline = time.time() + within
        while time.time() < deadline:
            left = [line for name in self.names for line in self.left_on(name)]
            if not left:
                return
            time.sleep(0.1)
        raise AssertionError(f'left behind: {left}')

    def end(self):
        for daemon in self.daemons.values():
            daemon.kill()
        shutil.rmtree(self.folder, ignore_errors=True)


def on_command(letter, command):
    return ['nsenter', '-t', os.environ['HOST_' + letter], '-n', *command]


def on(letter, command, **more):
    return subprocess.Popen(on_command(letter, command), **more)


def experiment(duration=5, link='', services=None, programs=None, security='unsecured = true'):
    placed = services or {'sim_svc': 'bench'}
    text = '\n'.join(f'[services.{name}]\nhost = "{host}"\n' for name, host in placed.items())
    folder = PROGRAMS if programs is None else programs
    return three_robots.experiment(
        'hosts', duration,
        f'[link]\n{security}\n{link}\n\n[hosts.bench]\nprograms = "{folder}"\n\n{text}\n')
