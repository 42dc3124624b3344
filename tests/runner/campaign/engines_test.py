"""Engines without a cluster: lists of commands, a Snakemake workflow, GNU parallel on this machine, and
Slurm's tools in a replica.

    engines_test.py FOLDER_OF_PROGRAMS SCENARIO
"""
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from campaign_samples import check_same, lab, reference, sweep, write_experiment

SKIPPED = 77
AWKWARD = 'it\'s 100%j "$(touch evil)" `touch evil`'  # name of a folder

# Runs the tasks of an array at once, and notes how it was called.
SBATCH = '''#!/bin/sh
printf '%s\\n' "$@" > "$CALLED"
for argument; do
  case $argument in --array=0-*) last=${argument#--array=0-} ;; esac
done
for task in $(seq 0 "$last"); do
  SLURM_ARRAY_TASK_ID=$task sh "$argument" >&2 || exit 1
done
echo 7
'''


def require_nothing_executed(folder):
    for parent, _, names in os.walk(folder):
        assert 'evil' not in names, parent


def commands(folder, file):
    out = os.path.join(folder, 'commands ' + AWKWARD)
    text = sweep([file, '--out', out, '--engine', 'commands', '--bundle', '5'])
    assert '3 lines' in text, text
    with open(os.path.join(out, 'commands.txt'), encoding='ascii') as lines:
        for line in lines:
            subprocess.run(line, shell=True, check=True, cwd=folder)
    sweep([out, '--no-run', '--no-figures'])
    return out


def snakemake(folder, file):
    """Without Snakemake: the rules' commands, as its Python would format them."""
    out = os.path.join(folder, 'snake')
    sweep([file, '--out', out, '--engine', 'snakemake', '--bundle', '5'])
    snakefile = os.path.join(out, 'Snakefile')
    if shutil.which('snakemake'):
        subprocess.run(['snakemake', '--cores', '2', '--directory', out, '--snakefile', snakefile],
                       check=True)
        return out
    with open(snakefile, encoding='ascii') as text:
        head = text.read().split('rule tables')[0]
    scope = {}
    exec(head, scope)  # the lists, which are plain Python
    assert len(scope['ROWS']) == 3, scope['ROWS']
    for rows in scope['ROWS']:
        subprocess.run(f'{scope["LAB"]} sweep {scope["CAMPAIGN"]} --rows {rows}', shell=True,
                       check=True)
    sweep([out, '--no-run', '--no-figures'])
    return out


def parallel(folder, file):
    """GNU parallel on this machine, in place of hosts that share the folder."""
    if not shutil.which('parallel'):
        print('skipped: GNU parallel is not installed')
        sys.exit(SKIPPED)
    out = os.path.join(folder, 'parallel ' + AWKWARD)
    text = sweep([file, '--out', out, '--engine', 'parallel', '--hosts', ':', '--no-figures'],
                 cwd=folder)
    assert 'they share the campaign' in text, text
    text = sweep([file, '--out', out + '2', '--engine', 'parallel', '--hosts', ':', '--lab-there',
                  '/nowhere/lab'], code=2)
    assert 'host :: found' in text and 'expected the lab of version' in text, text
    interrupt(folder, file)
    return out


def interrupt(folder, file):
    """Ctrl-C while a host does not answer, as an ssh that waits for a password."""
    waits = os.path.join(folder, 'waits')
    with open(waits, 'w', encoding='ascii') as tool:
        tool.write('#!/bin/sh\ntouch asked\nsleep 1000\n')
    os.chmod(waits, 0o755)
    process = subprocess.Popen([lab(), 'sweep', file, '--out', 'interrupted', '--engine', 'parallel', '--hosts',
                                './waits x', '--no-figures'], cwd=folder, stdout=subprocess.PIPE,
                               stderr=subprocess.STDOUT, text=True)
    while process.poll() is None and not os.path.exists(os.path.join(folder, 'asked')):
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    text = process.communicate()[0]
    assert process.returncode == 2 and 'host ./waits x: ended by the user' in text, text


def slurm(folder, file):
    tools = os.path.join(folder, 'tools')
    os.mkdir(tools)
    for name, text in (('sbatch', SBATCH), ('squeue', '#!/bin/sh\n')):  # no task is left
        with open(os.path.join(tools, name), 'w', encoding='ascii') as tool:
            tool.write(text)
        os.chmod(tool.name, 0o755)
    called = os.path.join(folder, 'called')
    out = os.path.join(folder, 'slurm ' + AWKWARD)
    text = sweep([file, '--out', out, '--engine', 'slurm', '--bundle', '5', '--no-figures'], cwd=folder,
                 env=dict(os.environ, PATH=tools + ':' + os.environ['PATH'], CALLED=called))
    assert '3 tasks' in text and 'done     12 of 12 runs' in text, text
    with open(called, encoding='utf-8') as lines:
        output = [line for line in lines.read().splitlines() if line.startswith('--output=')]
    jobs = os.path.join(out, 'slurm', 'jobs.txt')
    with open(jobs, encoding='ascii') as ids:
        assert ids.read() == '7\n'
    # What a stranger wrote there is no argument of squeue, and jobs of other users are not waited for.
    with open(os.path.join(tools, 'squeue'), 'w', encoding='ascii') as tool:
        tool.write('#!/bin/sh\nprintf "%s " "$@" >> "$CALLED.squeue"\n')
    with open(jobs, 'w', encoding='ascii') as ids:
        ids.write('--help 1,2 12345678901 ' + ' '.join(str(number) for number in range(1000)))
    os.unlink(os.path.join(out, 'results', os.listdir(os.path.join(out, 'results'))[0]))
    sweep([out, '--engine', 'slurm', '--bundle', '5', '--no-figures'], cwd=folder,
          env=dict(os.environ, PATH=tools + ':' + os.environ['PATH'], CALLED=called))
    with open(called + '.squeue', encoding='utf-8') as lines:
        asked = lines.read()
    assert asked.count('--me ') == 101 and '--jobs 999' in asked and '--help' not in asked, asked
    assert output == ['--output=' + out.replace('%', '%%') + '/slurm/%A_%a.log'], output
    return out


def workers(folder, file):
    """Two workers at the same rows, and rows that are there already."""
    out = os.path.join(folder, 'workers')
    sweep([file, '--out', out, '--engine', 'commands', '--bundle', '100'])
    both = [subprocess.Popen([lab(), 'sweep', out, '--rows', '0-11']) for _ in range(2)]
    assert [one.wait() for one in both] == [0, 0]
    sweep([out, '--rows', '3,5-7'])
    text = sweep([out, '--rows', '12'], code=2)
    assert 'expected numbers of rows from 0 to 11' in text, text
    sweep([out, '--no-run', '--no-figures'])
    return out


def strangers(folder, file):
    """A campaign of a stranger puts nothing of its own into scripts and command lines."""
    def refused(campaign, engine, words, *arguments):
        text = sweep([campaign, '--engine', engine, '--bundle', '5', *arguments], code=2, cwd=folder)
        assert words in text, text
    lines = os.path.join(folder, 'lines\ntouch evil\n')
    for engine in ('slurm', 'parallel', 'snakemake', 'commands'):
        refused(file, engine, 'found a control character', '--out', lines, '--hosts', ':')
    perl = os.path.join(folder, '{=system("touch evil")=}')
    refused(file, 'parallel', 'found a brace', '--out', perl, '--hosts', ':')

    out = os.path.join(folder, 'out')
    sweep([file, '--out', out, '--engine', 'commands', '--bundle', '5'])
    request = os.path.join(out, 'campaign.toml')
    with open(request, encoding='utf-8') as text:
        asked = text.read()
    with open(request, 'w', encoding='utf-8') as text:
        text.write(asked.replace('name = "engines"', r'name = "x\ntouch evil"'))
    for engine in ('slurm', 'commands'):
        refused(out, engine, 'campaign.toml: name: found')
    with open(request, 'w', encoding='utf-8') as text:
        text.write(asked)
    for name in ('profiles', '.snakemake'):
        os.symlink(folder, os.path.join(out, name))
        refused(out, 'snakemake', name + ': found')
        os.unlink(os.path.join(out, name))
    for campaign in (lines, perl, out):
        assert os.listdir(os.path.join(campaign, 'results')) == [], campaign
        assert not os.path.exists(os.path.join(campaign, 'slurm')), campaign
    sweep([out, '--no-figures'])
    return out


def main():
    scenario = {'commands': commands, 'snakemake': snakemake, 'parallel': parallel, 'slurm': slurm,
                'workers': workers, 'strangers': strangers}[sys.argv[2]]
    with tempfile.TemporaryDirectory() as folder:
        file = write_experiment(folder)
        out = scenario(folder, file)
        require_nothing_executed(folder)
        check_same(reference(folder, file), out)


if __name__ == '__main__':
    main()
