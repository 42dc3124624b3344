"""lab twin, and [analysis] twins: whole runs of the built programs.

    twins_test.py FOLDER_OF_PROGRAMS
"""
import csv
import glob
import json
import os
import shutil
import tempfile

from campaign_samples import run_lab as lab

EXPERIMENT = '''fileversion = 1
name = "original"
duration_s = 30
[[robots]]
id = 1
[[robots]]
id = 2
[programs.abp]
model = "abp"
v_cm_s = 3
[light_table]
bands = [{light = [0.3, 1], program = "abp"}]
[light]
steps = [
  {hold_s = 12, layers = [{kind = "uniform", intensity = 0.1}]},
  {hold_s = 18, layers = [{kind = "uniform", intensity = 0.9}]},
]
[camera]
fps = 20
position_noise_cm = 0.03
heading_noise_deg = 0.6
frame_loss = 0.1
dropout = 0.1
'''


def run(folder, name, *arguments):
    out = os.path.join(folder, name)
    text = lab('run', os.path.join(folder, 'original.toml'), '--virtual-time', '--out', out, *arguments)
    return glob.glob(os.path.join(out, '*'))[0], text


def read(*path):
    with open(os.path.join(*path), encoding='utf-8') as file:
        return file.read()


def main():
    with tempfile.TemporaryDirectory(prefix='lab-twins-') as folder:
        with open(os.path.join(folder, 'original.toml'), 'w', encoding='ascii') as file:
            file.write(EXPERIMENT)
        original, _ = run(folder, 'plain')
        text = lab('twin', original, '--count', '12', '--no-figures')
        assert 'agrees with its 12 twins' in text, text
        result = json.loads(read(original, 'twin.json'))
        assert result['twins'] == 12 and result['p_all_looks'] >= 0.01, result
        names = [look['look'] for look in result['looks']]
        assert 'abp.D_r_rad2_s' in names and any(name.startswith('abp.msd at') for name in names), names
        rows = list(csv.DictReader(read(original, 'twins.csv').splitlines()))
        assert [row['look'] for row in rows] == names
        assert read(original, 'report.html').count('Simulated twins') == 1

        # The twins have the frames and the losses of the run, and other motion.
        own = json.loads(read(original, 'summary.json'))
        summaries = [json.loads(read(name)) for name in
                     glob.glob(os.path.join(original, 'twins', 'summaries', '*'))]
        assert len(summaries) == 12
        frames = sum(1 for _ in open(os.path.join(original, 'twins', 'frames.csv'), encoding='ascii')) - 1
        assert 500 < frames < 580, frames  # of 600, with a loss of 10 %
        for summary in summaries:
            seen = sum(stream['received'] for stream in summary['losses']['log']
                       if stream['channel'] == 'TRACKED_FRAME')
            assert 0 <= seen - frames < 40, (seen, frames)  # some come before the script and at its end
            steps = [step['commanded_s'] for step in summary['steps']]
            assert steps == [step['commanded_s'] for step in own['steps']], steps
        values = {summary['programs'][0]['pool']['estimates']['v_cm_s']['value'] for summary in summaries}
        assert len(values) == 12, values

        # The folder of a run may come from a stranger: no link leads the twins elsewhere.
        elsewhere = os.path.join(folder, 'elsewhere')
        os.mkdir(elsewhere)
        os.rename(os.path.join(original, 'twins'), os.path.join(folder, 'moved'))
        os.symlink(elsewhere, os.path.join(original, 'twins'))
        text = lab('twin', original, '--count', '12', '--no-figures', code=2)
        assert 'twins: found a symbolic link' in text and os.listdir(elsewhere) == [], text
        os.unlink(os.path.join(original, 'twins'))
        os.rename(os.path.join(folder, 'moved'), os.path.join(original, 'twins'))
        # Not even one with the name of a file that gnuplot writes or reads.
        mine = os.path.join(folder, 'mine')
        with open(mine, 'w', encoding='ascii') as file:
            file.write('mine')
        links = [os.path.join(original, 'twins', name) for name in
                 ('figures.gp', 'gnuplot.txt', 'twins_msd_abp.svg', 'twins_msd_abp.pdf')]
        for link in links:
            os.symlink(mine, link)
        lab('twin', original, '--count', '12')
        assert read(mine) == 'mine' and all(os.path.islink(link) for link in links)
        assert '<svg' in read(original, 'twins.html')
        assert not glob.glob(os.path.join(original, 'twins', '.figures*'))
        for link in links:
            os.unlink(link)

        # More twins keep those that are there; the section of the report is replaced.
        before = {name: os.path.getmtime(name) for name in
                  glob.glob(os.path.join(original, 'twins', 'results', '*'))}
        lab('twin', original, '--count', '15', '--no-figures')
        after = glob.glob(os.path.join(original, 'twins', 'results', '*'))
        assert len(after) == 15 and all(os.path.getmtime(name) == time for name, time in before.items())
        assert read(original, 'report.html').count('Simulated twins') == 1

        # At the end of a run; from a log alone.
        other, text = run(folder, 'with', '--seed', '9', '--set', 'analysis.twins=10')
        assert 'its 10 twins' in text and os.path.exists(os.path.join(other, 'twin.json')), text
        log = os.path.join(folder, 'alone.lcmlog')
        shutil.copy(os.path.join(original, 'log.lcmlog'), log)
        lab('twin', log, '--count', '10', '--no-figures')
        assert os.path.exists(os.path.join(folder, 'alone.lcmlog-twins', 'twin.json'))
        # A log in the current folder has no folder in its name.
        lab('twin', 'alone.lcmlog', '--count', '10', '--no-figures', '--out', os.path.join(folder, 'here'),
            cwd=folder)

        # What cannot be compared is said in one line.
        assert 'found nothing' in lab('twin', os.path.join(folder, 'nowhere'), code=2)
        empty = os.path.join(folder, 'empty')
        os.mkdir(empty)
        assert 'log' in lab('twin', empty, code=2)
        text = lab('twin', original, '--count', '3', code=2)
        assert '--count' in text, text
        for command in (['twin', original], ['calibrate', 'twin', original]):
            text = lab(*command, '--out', log, code=2)
            assert text.startswith('lab: --out: found no folder at') and len(text.splitlines()) == 1, text
        text = lab('run', os.path.join(folder, 'original.toml'), '--virtual-time', '--set',
                   'analysis.twins=5', code=2)
        assert 'found 5, allowed 0 or 10 to 1000' in text, text
        with open(os.path.join(folder, 'replay.toml'), 'w', encoding='ascii') as file:
            file.write(EXPERIMENT.replace('id = 1\n', f'id = 1\nbody = "replay"\nlog = "{original}"\n')
                       .replace('[[robots]]\nid = 2\n', ''))
        lab('run', os.path.join(folder, 'replay.toml'), '--virtual-time', '--no-report', '--out',
            os.path.join(folder, 'replay'))
        text = lab('twin', glob.glob(os.path.join(folder, 'replay', '*'))[0], code=2)
        assert 'all robots of this run are replayed' in text, text
        damaged = os.path.join(folder, 'damaged')
        shutil.copytree(original, damaged)
        with open(os.path.join(damaged, 'log.lcmlog'), 'r+b') as file:
            file.truncate(3000)
        text = lab('twin', damaged, code=2)
        assert len(text.splitlines()) <= 2, text


main()
