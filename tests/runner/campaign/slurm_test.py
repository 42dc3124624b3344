"""The engine slurm with a real slurmctld, slurmd and munged of this machine, in a private network.

    slurm_test.py FOLDER_OF_PROGRAMS
"""
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from campaign_samples import EXPERIMENT, check_same, lab, reference, sweep, write_experiment

SKIPPED = 77
TOOLS = ('munged', 'slurmctld', 'slurmd', 'sbatch', 'squeue', 'scancel')
CONFIGURATION = '''ClusterName=lab
SlurmctldHost=localhost(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1
ReturnToService=2
MailProg=/bin/true
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
NodeName=node NodeHostname=localhost NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=debug Nodes=node Default=YES MaxTime=INFINITE State=UP
'''


def which(tool):
    return shutil.which(tool, path=os.environ['PATH'] + ':/usr/sbin:/sbin')


class Cluster:
    """One node, its controller and munged, with all files in a folder."""

    def __init__(self, folder):
        self.folder = folder
        self.daemons = []
        for name in ('state', 'spool'):
            os.mkdir(os.path.join(folder, name))
        self.configuration = os.path.join(folder, 'slurm.conf')
        user = subprocess.run(['id', '-un'], capture_output=True, text=True,
                              check=True).stdout.strip()
        with open(self.configuration, 'w', encoding='ascii') as file:
            file.write(CONFIGURATION.format(folder=folder, user=user))
        with open(os.path.join(folder, 'munge.key'), 'wb') as key:
            key.write(os.urandom(128))
        os.chmod(key.name, 0o600)
        os.chmod(folder, 0o755)
        self.environment = dict(os.environ, SLURM_CONF=self.configuration)

    def begin(self):
        # Slurm asks only for addresses of families that an interface has besides 127.0.0.1 (AI_ADDRCONFIG); the
        # private network has none.
        subprocess.run(['ip', 'address', 'add', '192.0.2.1/32', 'dev', 'lo'], check=True)
        folder = self.folder
        self.start('munged', '--foreground', '--force', f'--socket={folder}/munge.socket',
                   f'--key-file={folder}/munge.key', f'--pid-file={folder}/munged.pid',
                   f'--log-file={folder}/munged.log', f'--seed-file={folder}/munged.seed')
        self.wait(lambda: os.path.exists(folder + '/munge.socket'), 'munged')
        self.start('slurmctld', '-D', '-f', self.configuration)
        self.start('slurmd', '-D', '-N', 'node', '-f', self.configuration)
        self.wait(lambda: 'idle' in self.call('sinfo', '--noheader', '--format=%T'), 'the node')

    def start(self, tool, *arguments):
        log = open(os.path.join(self.folder, tool + '.output'), 'w', encoding='utf8')
        self.daemons.append(subprocess.Popen([which(tool), *arguments], env=self.environment,
                                             stdout=log, stderr=log))

    def call(self, tool, *arguments):
        return subprocess.run([which(tool), *arguments], env=self.environment, capture_output=True,
                              text=True).stdout

    def wait(self, ready, what):
        deadline = time.time() + 60
        while not ready():
            if time.time() > deadline:
                texts = ''
                for name in sorted(os.listdir(self.folder)):
                    if name.endswith(('.log', '.output')):
                        with open(os.path.join(self.folder, name), errors='replace') as file:
                            texts += f'--- {name}\n{file.read()[-2000:]}'
                raise AssertionError(f'{what} does not begin\n{texts}')
            time.sleep(0.2)

    def end(self):
        for daemon in reversed(self.daemons):
            daemon.terminate()
            try:
                daemon.wait(20)
            except subprocess.TimeoutExpired:
                daemon.kill()


def arrays(cluster, folder, file):
    """A job array in bundles gives the bytes of this machine."""
    out = os.path.join(folder, 'array')
    text = sweep([file, '--out', out, '--engine', 'slurm', '--bundle', '3', '--no-figures'],
                 env=cluster.environment)
    assert '4 tasks' in text, text
    assert 'done     12 of 12 runs' in text, text
    check_same(reference(folder, file), out)


def resubmission(cluster, folder):
    """A worker that is killed leaves rows without result: they are submitted again."""
    file = write_experiment(folder, EXPERIMENT.replace('duration_s = 20', 'duration_s = 3000'))
    out = os.path.join(folder, 'killed')
    process = subprocess.Popen([lab(), 'sweep', file, '--out', out, '--engine', 'slurm', '--bundle',
                                '6', '--no-figures'], env=cluster.environment, text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    killed = False
    deadline = time.time() + 300
    while not killed and process.poll() is None and time.time() < deadline:
        found = subprocess.run(['pgrep', '-f', f'sweep {out} --rows'], capture_output=True, text=True)
        for pid in found.stdout.split():
            os.kill(int(pid), signal.SIGKILL)
            killed = True
        time.sleep(0.02)
    text, _ = process.communicate(timeout=600)
    assert killed, text
    assert 'submission 2 of at most 3' in text, text
    assert process.returncode == 0, text
    local = os.path.join(folder, 'local')
    sweep([file, '--out', local, '--no-figures'])
    check_same(local, out)


def queued(cluster, folder):
    """--no-wait returns; the same command later collects."""
    file = write_experiment(folder, EXPERIMENT.replace('"engines"', '"queued"'))
    out = os.path.join(folder, 'queued')
    text = sweep([file, '--out', out, '--engine', 'slurm', '--bundle', '12', '--no-wait',
                  '--no-figures'], env=cluster.environment, code=1)
    assert 'goes on in the queue' in text, text
    text = sweep([file, '--out', out, '--engine', 'slurm', '--no-figures'], env=cluster.environment)
    assert 'done     12 of 12 runs' in text, text
    with open(os.path.join(out, 'slurm', 'jobs.txt'), encoding='ascii') as jobs:
        assert len(jobs.read().split()) == 1


def refused(cluster, folder, file):
    text = sweep([file, '--out', folder + '/refused', '--engine', 'slurm', '--bundle', '3', '--slurm',
                  '--partition=nowhere'], env=cluster.environment, code=2)
    assert 'sbatch: ' in text and 'invalid partition' in text.lower(), text


def main():
    missing = [tool for tool in TOOLS if not which(tool)]
    if missing or os.geteuid() != 0:
        print(f'skipped: not installed: {missing}' if missing else 'skipped: needs root')
        sys.exit(SKIPPED)
    os.environ['PATH'] += ':/usr/sbin:/sbin'
    with tempfile.TemporaryDirectory(prefix='lab-slurm-') as cluster_folder, \
            tempfile.TemporaryDirectory(prefix='lab-campaign-') as folder:
        cluster = Cluster(cluster_folder)
        try:
            cluster.begin()
            file = write_experiment(folder)
            arrays(cluster, folder, file)
            refused(cluster, folder, file)
            queued(cluster, folder)
            resubmission(cluster, folder)
        finally:
            cluster.end()


main()
