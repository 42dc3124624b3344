"""GNU parallel over ssh to a host that does not see the campaign's folder.

Started by tests/two_hosts.sh:
    parallel_hosts_test.py SCENARIO FOLDER_OF_PROGRAMS
"""
import os
import shutil
import subprocess
import sys
import tempfile

PROGRAMS = os.path.abspath(sys.argv[2])
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', 'hosts'))
import hosts as remote  # noqa: E402
sys.argv[1:] = [PROGRAMS]
from campaign_samples import check_same, lab, write_experiment  # noqa: E402

SKIPPED = 77


def main():
    for tool in ('parallel', 'rsync'):
        if not shutil.which(tool):
            print(f'skipped: {tool} is not installed')
            sys.exit(SKIPPED)
    if subprocess.run(['unshare', '-m', 'true'], check=False).returncode != 0:
        print('skipped: this system allows no mount namespaces')
        sys.exit(SKIPPED)
    with tempfile.TemporaryDirectory(prefix='lab-campaign-') as folder:
        # The host sees an empty folder in place of this one.
        start = remote.on

        def hidden(letter, command, **more):
            if command[0] == remote.SSHD:
                command = ['unshare', '-m', 'sh', '-c',
                           f'mount -t tmpfs none {folder} && exec "$@"', 'sh', *command]
            return start(letter, command, **more)
        remote.on = hidden
        hosts = remote.Hosts()
        try:
            file = write_experiment(folder)
            environment = dict(os.environ, PATH=hosts.path('bin') + ':' + os.environ['PATH'])

            def run(*arguments):
                done = subprocess.run(remote.on_command('A', [lab(), 'sweep', *arguments]),
                                      env=environment, capture_output=True, text=True)
                print(done.stdout + done.stderr)
                assert done.returncode == 0, done.returncode
                return done.stdout
            text = run(file, '--out', folder + '/far', '--engine', 'parallel', '--hosts', '2/bench',
                       '--no-figures', '--bundle', '5')
            assert 'results are sent back' in text, text
            run(file, '--out', folder + '/reference', '--no-figures')
            check_same(folder + '/reference', folder + '/far')
            assert not os.path.exists(folder + '/far/work/anything')
        finally:
            hosts.end()


main()
