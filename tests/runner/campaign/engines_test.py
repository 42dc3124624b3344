"""Engines without a cluster: lists of commands, a Snakemake workflow, GNU parallel on this machine.

    engines_test.py FOLDER_OF_PROGRAMS SCENARIO
"""
import os
import shutil
import subprocess
import sys
import tempfile

from campaign_samples import check_same, lab, reference, sweep, write_experiment

SKIPPED = 77


def commands(folder, file):
    out = os.path.join(folder, 'with commands')
    text = sweep([file, '--out', out, '--engine', 'commands', '--bundle', '5'])
    assert '3 lines' in text, text
    with open(os.path.join(out, 'commands.txt'), encoding='ascii') as lines:
        for line in lines:
            subprocess.run(line, shell=True, check=True)
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
    out = os.path.join(folder, 'parallel')
    text = sweep([file, '--out', out, '--engine', 'parallel', '--hosts', ':', '--no-figures'])
    assert 'they share the campaign' in text, text
    text = sweep([file, '--out', out + '2', '--engine', 'parallel', '--hosts', ':', '--lab-there',
                  '/nowhere/lab'], code=2)
    assert 'host :: found' in text and 'expected the lab of version' in text, text
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


def main():
    scenario = {'commands': commands, 'snakemake': snakemake, 'parallel': parallel,
                'workers': workers}[sys.argv[2]]
    with tempfile.TemporaryDirectory() as folder:
        file = write_experiment(folder)
        out = scenario(folder, file)
        check_same(reference(folder, file), out)


if __name__ == '__main__':
    main()
