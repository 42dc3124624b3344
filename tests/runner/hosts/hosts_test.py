"""Runs over two or three hosts: network namespaces, a router between them, and a real sshd on each.

Started by tests/two_hosts.sh, which sets the environment; one scenario per call:
  hosts_test.py SCENARIO FOLDER_OF_PROGRAMS
"""
import glob
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time

from hosts import PROGRAMS, SSHD, Hosts, on, experiment

TWO_HOSTS = os.environ['TWO_HOSTS']
SKIPPED = 77


def started(lab, hosts, robots_on='bench', within=120.0):
    """Waits until robots move on the host: the log grows."""
    deadline = time.time() + within
    while time.time() < deadline and lab.poll() is None:
        logs = glob.glob(hosts.path('runs/*/log.lcmlog'))
        if logs and os.path.getsize(logs[0]) > 200_000 and hosts.pids_on(robots_on, 'sim_svc'):
            return
        time.sleep(0.05)
    raise AssertionError('the run did not start: ' + (lab.communicate()[0] if lab.poll() is not None
                                                      else 'it waits'))


def recorded(hosts, text, within=60.0):
    """Waits until the log contains the text."""
    deadline = time.time() + within
    while time.time() < deadline:
        with open(hosts.run_folder() + '/log.lcmlog', 'rb') as log:
            if text.encode() in log.read():
                return
        time.sleep(0.1)
    raise AssertionError(f'not in the log: {text}')


def finished(lab, code=0, within=120):
    text, _ = lab.communicate(timeout=within)
    print(text)
    assert lab.returncode == code, (lab.returncode, text)
    return text


def ended_after(lab, hosts, text):
    """Ends the run when the log contains the text: a loaded machine takes long until then."""
    recorded(hosts, text)
    lab.send_signal(signal.SIGINT)
    finished(lab, within=180)


def summary_of(hosts):
    with open(os.path.join(hosts.run_folder(), 'summary.json'), encoding='utf8') as file:
        return json.load(file)


def check_complete(summary, channels=('ROBOT_STATUS', 'TRACKED_FRAME')):
    for channel in channels:
        streams = [s for s in summary['losses']['log'] if s['channel'] == channel]
        assert streams and all(s['received'] > 20 and s['lost'] == 0 for s in streams), streams


def texts(summary, key):
    return [remark['text'] for remark in summary[key]]


# A slow machine is not what these tests are about: the lab says so, skips work, and loses nothing.
SLOW_MACHINE = re.compile('sim_svc: stalled: [0-9]+ camera frames|analyzer: overloaded: results are computed')


def check_without_trouble(summary):
    """Every message of every program on every host is in the log, without faults or marks."""
    lossy = [s for s in summary['losses']['log'] if s['lost'] or s['lost_is_at_least']]
    assert not lossy, lossy
    assert not summary['losses']['listeners'], summary['losses']['listeners']
    trouble = [text for text in texts(summary, 'faults') + texts(summary, 'marks')
               if not SLOW_MACHINE.match(text)]
    assert not trouble, trouble
    assert all(link['lost'] == 0 for link in summary['links']), summary['links']


def run(hosts):
    """Robots on B, everything else on A: complete, nothing lost, nothing left behind."""
    text = finished(hosts.lab(experiment()))
    assert 'host     bench: bench' in text and 'clock' in text, text
    summary = summary_of(hosts)
    check_complete(summary)
    check_without_trouble(summary)
    assert len(summary['links']) == 2, summary['links']
    folder = hosts.run_folder()
    assert os.path.exists(folder + '/report.html')
    assert os.path.getsize(folder + '/logs/bench/dds_gateway.txt') > 0
    hosts.nothing_left()


def revive(hosts):
    """A service that dies on the host is restarted, and the run is marked."""
    lab = hosts.lab(experiment(duration=90))
    started(lab, hosts)
    os.kill(hosts.pids_on('bench', 'sim_svc')[0], signal.SIGKILL)
    ended_after(lab, hosts, 'and was restarted')
    faults = texts(summary_of(hosts), 'faults')
    assert any('sim_svc on bench died (killed by signal 9) and was restarted' in f for f in faults), faults
    hosts.nothing_left()


def cable(hosts, out=4.0):
    """The cable is unplugged: the host is silent, robots stop by their lease, the run goes on when it is back."""
    lab = hosts.lab(experiment(duration=out + 90))
    started(lab, hosts)
    subprocess.run([TWO_HOSTS, 'cut', 'B'], check=True)
    time.sleep(out)
    subprocess.run([TWO_HOSTS, 'restore', 'B'], check=True)
    ended_after(lab, hosts, 'host bench is back after')
    summary = summary_of(hosts)
    faults = texts(summary, 'faults')
    silences = [f for f in faults if re.match(r'host bench is silent since .*: its robots stand', f)]
    assert len(silences) == 1, faults
    assert not any('dds_gateway' in f for f in faults), faults  # reported only as the host
    assert any('host bench is back after' in m for m in texts(summary, 'marks')), summary['marks']
    assert all(r['lease_expired_share'] > 0 for r in summary['robots']), 'no robot stopped'
    assert all(r['boots'] <= 1 for r in summary['robots']), 'the robots\' service was restarted'
    hosts.nothing_left()


def cable_30s(hosts):
    cable(hosts, out=30.0)


def cable_for_good(hosts):
    """A host that stays away: the run is closed early, with its data."""
    lab = hosts.lab(experiment(duration=60, link='patience_s = 3'))
    started(lab, hosts)
    subprocess.run([TWO_HOSTS, 'cut', 'B'], check=True)
    text = finished(lab, code=3)
    assert 'host bench did not come back within 3 s (link.patience_s)' in text, text
    hosts.nothing_left()  # the agent ends by its timeout


def sshd_dies(hosts):
    """ssh ends: the agent ends its services; the runner reconnects and starts them again."""
    lab = hosts.lab(experiment(duration=90))
    started(lab, hosts)
    hosts.end_sshd('bench')
    hosts.nothing_left()
    hosts.start_sshd('bench')
    ended_after(lab, hosts, 'host bench is back after')
    summary = summary_of(hosts)
    faults = texts(summary, 'faults')
    assert any(f.startswith('host bench is gone since') for f in faults), faults
    assert any('host bench is back after' in m for m in texts(summary, 'marks')), summary['marks']
    hosts.nothing_left()


def slow_agent(hosts):
    """The agent of a lost connection ends slowly: the next one gets the files once."""
    lab = hosts.lab(experiment(duration=90))
    started(lab, hosts)
    first = hosts.pids_on('bench', 'lab')
    for pid in first:
        os.kill(pid, signal.SIGSTOP)
    hosts.end_sshd('bench')
    hosts.start_sshd('bench')
    deadline = time.time() + 60
    while not set(hosts.pids_on('bench', 'lab')) - set(first):
        assert time.time() < deadline, 'no second agent'
        time.sleep(0.05)
    recorded(hosts, 'host bench is gone since')
    for pid in first:
        os.kill(pid, signal.SIGCONT)
    ended_after(lab, hosts, 'host bench is back after')
    summary = summary_of(hosts)
    assert any('host bench is back after' in m for m in texts(summary, 'marks')), summary['marks']
    assert not any('exit code' in f for f in texts(summary, 'faults')), summary['faults']
    hosts.nothing_left()


def interrupted(hosts):
    """Ctrl-C ends all hosts."""
    lab = hosts.lab(experiment(duration=60), start_new_session=True)
    started(lab, hosts)
    os.killpg(lab.pid, signal.SIGINT)
    finished(lab)
    hosts.nothing_left()


def killed(hosts):
    """The runner is killed with SIGKILL: nothing remains on the other host."""
    lab = hosts.lab(experiment(duration=60))
    started(lab, hosts)
    lab.kill()
    hosts.nothing_left()


STUB = '''#!/usr/bin/env python3
import json, os, subprocess, sys, time
real = subprocess.Popen([%(real)r, 'host-agent'], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
hello = json.loads(real.stdout.readline())
hello.update(%(hello)s)
print(json.dumps(hello), flush=True)
for line in sys.stdin:
    order = json.loads(line)
    if order['do'] == 'stop':
        break
    if order['do'] == 'ping':
        print(json.dumps({'say': 'pong', 'asked': order['utime'],
                          'utime': int(time.time() * 1e6) + %(ahead)d}), flush=True)
'''


def refused(hosts, expected, hello=None, ahead=0, duration=5):
    folder = hosts.path('stub')
    os.makedirs(folder, exist_ok=True)
    with open(folder + '/lab', 'w', encoding='ascii') as stub:
        stub.write(STUB % {'real': PROGRAMS + '/lab', 'hello': repr(hello or {}), 'ahead': ahead})
    os.chmod(folder + '/lab', 0o755)
    text = finished(hosts.lab(experiment(duration, programs=folder)), code=2)
    assert re.search(expected, text), text
    assert not glob.glob(hosts.path('runs/*')), 'something was started'
    hosts.nothing_left()


def different(hosts):
    """Another version, other message types or another time: refused, with a fix."""
    refused(hosts, r'host bench: found another version of the lab, 9\.9\.9 .*there and \d.* here.*git pull',
            {'version': '9.9.9'})
    refused(hosts, r'host bench: found other message types', {'fingerprints': '1234'})
    refused(hosts, r'host bench: its clock is 100\d\.\d ms ahead of this one .*allowed 5 ms '
            r'\(link.max_clock_offset_ms\).*chrony', ahead=1_002_000)
    refused(hosts, r'host bench: its clock is 99\d\.\d ms behind', ahead=-998_000)


def unreachable(hosts):
    """Errors of ssh are reported in one line with a fix."""
    def refuse(text, expected):
        output = finished(hosts.lab(text), code=2)
        assert re.search(expected, output), output
        assert not glob.glob(hosts.path('runs/*')), 'something was started'

    refuse(experiment(programs='/nowhere'),
           r'host bench \(ssh bench\): the program lab was not found: .*hosts.bench.programs')
    refuse(experiment(services={'sim_svc': 'me@no-such-machine.invalid'}),
           r'no machine of that name is known')
    os.rename(hosts.path('authorized_keys'), hosts.path('nobody'))
    refuse(experiment(), r'does not let this user in without a password: ssh-copy-id bench')
    hosts.daemons['bench'].kill()
    hosts.daemons['bench'].wait()
    refuse(experiment(), r'no ssh server answers there')
    # Certificates are checked before a host is asked.
    folder = certificates(hosts)
    os.remove(folder + '/key.pem')
    os.symlink(hosts.path('key'), folder + '/key.pem')
    refuse(experiment(security=f'security = "{folder}"'),
           r'link\.security: .*/key\.pem: found a link to .*outside of the folder')
    refuse(experiment(security='security = "/nowhere"'), r'link\.security: /nowhere: not found')


def three(hosts):
    """Services on three hosts: each receives from each."""
    services = {'sim_svc': 'bench', 'analyzer': 'desk'}
    text = experiment(services=services) + f'[hosts.desk]\nprograms = "{PROGRAMS}"\n'
    finished(hosts.lab(text))
    summary = summary_of(hosts)
    check_complete(summary)
    check_without_trouble(summary)
    assert len(summary['links']) == 6, summary['links']
    hosts.nothing_left()


def certificates(hosts):
    """The security folder of the lab, with a private CA key that was left in it."""
    make = os.path.join(os.path.dirname(TWO_HOSTS), '../docs/examples/dds_security/make_certificates.sh')
    subprocess.run([make, hosts.path('keys'), 'lab'], check=True, stderr=subprocess.DEVNULL)
    shutil.copy(hosts.path('keys/ca/key.pem'), hosts.path('keys/lab/ca_key.pem'))
    return hosts.path('keys/lab')


def secured(hosts):
    """DDS Security between the hosts: works as without; only the needed files of the folder are sent."""
    folder = certificates(hosts)
    lab = hosts.lab(experiment(security=f'security = "{folder}"'))
    started(lab, hosts)
    there = glob.glob(os.path.join(hosts.temp, 'active-lab-host-*/security/link/*'))
    assert sorted(map(os.path.basename, there)) == [
        'cert.pem', 'governance.p7s', 'identity_ca.pem', 'key.pem', 'permissions.p7s',
        'permissions_ca.pem'], there
    assert os.stat(os.path.dirname(os.path.dirname(os.path.dirname(there[0])))).st_mode & 0o77 == 0
    finished(lab)
    summary = summary_of(hosts)
    check_complete(summary)
    check_without_trouble(summary)
    hosts.nothing_left()


OPEN_GATEWAY = '''#!/bin/sh
sed -e 's/^security = .*//' -e 's/^unsecured = .*//' -e 's/^\\[link\\]/[link]\\nunsecured = true/' "$2" >"$2.open"
experiment=$2.open
shift 2
exec %s/dds_gateway --experiment "$experiment" "$@"
'''


def unsecured_there(hosts):
    """A gateway without certificates is not joined; the start reports why."""
    programs = hosts.path('open')
    os.mkdir(programs)
    for program in glob.glob(PROGRAMS + '/*'):
        if os.path.basename(program) not in ('lab', 'dds_gateway'):
            os.symlink(program, os.path.join(programs, os.path.basename(program)))
    shutil.copy(PROGRAMS + '/lab', programs)  # finds the others beside itself
    with open(programs + '/dds_gateway', 'w', encoding='ascii') as file:
        file.write(OPEN_GATEWAY % PROGRAMS)
    os.chmod(programs + '/dds_gateway', 0o755)
    folder = certificates(hosts)
    text = finished(hosts.lab(experiment(security=f'security = "{folder}"', programs=programs)), code=2)
    assert re.search(r'the buses of .* and bench are not joined: .*link.security', text), text
    hosts.nothing_left()


def loss(hosts, duration=8):
    """A network that loses 2 % of its frames in each direction: the important channels are complete."""
    finished(hosts.lab(experiment(duration=duration)))
    summary = summary_of(hosts)
    check_complete(summary, ('ROBOT_STATUS', 'TRACKED_FRAME', 'ROBOT_COMMAND'))
    for stream in summary['losses']['log']:
        print(stream['sender'], stream['channel'], stream['received'], stream['lost'])
    for link in summary['links']:
        print(link)
    check_without_trouble(summary)
    assert os.path.exists(hosts.run_folder() + '/report.html')
    hosts.nothing_left()


def loss_long(hosts):
    loss(hosts, duration=60)


def doctor(hosts):
    """lab doctor FILE checks the hosts and leaves nothing behind."""
    def doctor_output(text):
        with open(hosts.path('doctor.toml'), 'w', encoding='ascii') as file:
            file.write(text)
        return on('A', [os.path.join(PROGRAMS, 'lab'), 'doctor', hosts.path('doctor.toml')],
                  env=dict(os.environ, PATH=hosts.path('bin') + ':' + os.environ['PATH']),
                  stdout=subprocess.PIPE, text=True).communicate(timeout=60)[0]

    output = doctor_output(experiment())
    assert re.search(r'ok    host bench .*the same lab, clock [+-]0\.\d+ ms, known to', output), output
    assert re.search(r'ok    DDS domain 0: 0 participants', output), output
    hosts.nothing_left()
    output = doctor_output(experiment(programs='/nowhere'))
    assert re.search(r'FIX   host bench \(ssh bench\): the program lab was not found', output), output


def main():
    scenario = globals()[sys.argv[1]]
    if not os.path.exists(SSHD) and not os.environ.get('LAB_TEST_NO_SKIP'):
        print('skipped: no sshd is installed (openssh-server)')
        sys.exit(SKIPPED)
    hosts = Hosts(('bench', 'desk') if scenario is three else ('bench',))
    try:
        scenario(hosts)
    except BaseException:
        for file in sorted(glob.glob(hosts.path('runs/*/logs/**/*.txt'), recursive=True)):
            with open(file, encoding='utf8', errors='replace') as stream:
                print(f'--- {file}\n{stream.read()[-3000:]}')
        for name in hosts.names:
            print(subprocess.run(['tail', '-n', '20', hosts.path(f'sshd_{name}.log')],
                                 capture_output=True, text=True, check=False).stdout)
        raise
    finally:
        hosts.end()
    print('passed')


main()
