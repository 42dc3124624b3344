"""A small campaign for the tests of the engines, and helpers."""
import filecmp
import os
import subprocess
import sys

EXPERIMENT = '''fileversion = 1
name = "engines"
duration_s = 20
program = "abp"
[[robots]]
id = 1
[programs.abp]
model = "abp"
v_cm_s = 3
[camera]
fps = 10
[sweep]
over = ["programs.abp.eta_rad_s=1,2,3", "programs.abp.epsilon_s=0.2,0.5"]
seeds = 2
'''


def programs():
    return os.path.abspath(sys.argv[1])


def lab():
    return os.path.join(programs(), 'lab')


def write_experiment(folder, text=EXPERIMENT):
    file = os.path.join(folder, 'engines.toml')
    with open(file, 'w', encoding='ascii') as out:
        out.write(text)
    return file


def run_lab(*arguments, code=0, **options):
    """Runs a command of the lab, and returns its output."""
    done = subprocess.run([lab(), *arguments], capture_output=True, text=True, **options)
    text = done.stdout + done.stderr
    assert done.returncode == code, f'{arguments}: exit code {done.returncode}\n{text}'
    return text


def sweep(arguments, code=0, **options):
    """Runs lab sweep, and returns its output."""
    return run_lab('sweep', *arguments, code=code, **options)


def reference(folder, file):
    """The same campaign on this machine."""
    out = os.path.join(folder, 'reference')
    sweep([file, '--out', out, '--no-figures'])
    return out


def results_of(campaign):
    return sorted(os.listdir(os.path.join(campaign, 'results')))


def check_same(one, other):
    """Same tables and results, byte by byte."""
    for name in ('campaign.csv', 'points.csv'):
        assert filecmp.cmp(os.path.join(one, name), os.path.join(other, name), shallow=False), name
    names = results_of(one)
    assert names == results_of(other), set(names) ^ set(results_of(other))
    for folder in ('results', 'summaries'):
        for name in names:
            assert filecmp.cmp(os.path.join(one, folder, name), os.path.join(other, folder, name),
                               shallow=False), name
