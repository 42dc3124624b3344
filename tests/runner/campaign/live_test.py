"""Live campaigns and the queue, with the built programs: rehearsals in virtual time.

    live_test.py FOLDER_OF_PROGRAMS
"""
import csv
import json
import os
import signal
import subprocess
import tempfile
import time

from campaign_samples import EXPERIMENT, lab, sweep, write_experiment

ROBOTS = EXPERIMENT.replace('id = 1\n', 'id = 1\ncount = 4\n')


def rows_of(campaign):
    with open(os.path.join(campaign, 'campaign.csv'), newline='', encoding='utf-8') as table:
        return list(csv.DictReader(table))


def journal_of(campaign):
    with open(os.path.join(campaign, 'journal.jsonl'), encoding='utf-8') as lines:
        return [json.loads(line) for line in lines]


def runs_of(campaign):
    return [entry for entry in journal_of(campaign) if entry['what'] == 'run' and 'end_us' in entry]


def check_rehearsal(folder):
    file = write_experiment(folder, ROBOTS)
    out = os.path.join(folder, 'rehearsal')
    text = sweep([file, '--live', '--rehearse', '--rest', '30', '--clear', file, '--out', out,
                  '--no-figures'])
    assert 'done     12 of 12 runs' in text, text
    assert 'in runs that count' in text, text
    rows = rows_of(out)
    assert [row['status'] for row in rows] == ['done'] * 12, rows
    assert {row['live.robots'] for row in rows} == {'4'}
    assert all(os.path.isfile(os.path.join(out, 'runs', row['run'], 'log.lcmlog')) for row in rows)
    order = [entry['row'] for entry in runs_of(out)]
    assert sorted(order[:6]) == list(range(6)), order  # the first runs of all points
    assert order != sorted(order), order
    rests = [entry for entry in journal_of(out) if entry['what'] == 'rest' and 'end_us' in entry]
    assert len(rests) == 12 and all(one['end_us'] - one['begin_us'] >= 30e6 for one in rests)
    again = sweep([out])
    assert 'done     12 of 12 runs' in again, again
    assert len(runs_of(out)) == 12  # nothing was played again
    for arguments, found in ((['--live'], 'a rehearsal, expected runs of the real lab'),
                             ([], 'a rehearsal, expected simulated runs')):
        text = sweep([file, *arguments, '--out', out], code=2)
        assert found in text, text
    begun = os.path.join(folder, 'begun')
    sweep([file, '--live', '--rehearse', '--seeds', '1', '--no-run', '--out', begun, '--no-figures'], code=1)
    text = sweep([begun, '--live'], code=2)
    assert 'found a rehearsal' in text and 'add --rehearse' in text, text
    assert 'done     6 of 6 runs' in sweep([begun, '--live', '--rehearse', '--no-figures'])


def check_kill(folder):
    """kill -9 in the middle: the same command continues, and the lost run is accounted for."""
    file = write_experiment(folder, ROBOTS)
    out = os.path.join(folder, 'killed')
    arguments = [file, '--live', '--rehearse', '--out', out, '--no-figures']
    process = subprocess.Popen([lab(), 'sweep', *arguments], stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
    while process.poll() is None and not (os.path.exists(os.path.join(out, 'journal.jsonl')) and
                                          len(runs_of(out)) >= 3):
        time.sleep(0.01)
    process.send_signal(signal.SIGKILL)
    process.wait()
    before = len(runs_of(out))
    assert 3 <= before < 12, before
    text = sweep(arguments)
    assert 'done     12 of 12 runs' in text, text
    assert len(runs_of(out)) == 12, len(runs_of(out))


def check_known(folder):
    file = write_experiment(folder, ROBOTS)
    out = os.path.join(folder, 'known')
    text = sweep([file, '--live', '--rehearse', '--seeds', '5', '--known', 'v_cm_s=50%', '--out', out,
                  '--no-figures'])
    assert len(runs_of(out)) == 12, text  # two runs of each point
    text = sweep([file, '--live', '--rehearse', '--known', 'speed=5%', '--out',
                  os.path.join(folder, 'unknown'), '--no-figures'], code=2)
    assert 'no such estimate' in text, text


def check_wrong(folder):
    file = write_experiment(folder, ROBOTS)
    for arguments, words in ((['--rest', '3'], 'add --live'),
                             (['--live', '--jobs', '2'], 'leave out --engine and --jobs'),
                             (['--live', '--until', 'soon'], 'expected a time as 07:30'),
                             (['--live', '--known', 'D_r'], 'expected QUANTITY=PERCENT'),
                             (['--live', '--clear', 'nothing.toml'], 'nothing.toml')):
        text = sweep([file, *arguments, '--out', os.path.join(folder, 'wrong')], code=2)
        assert words in text, text
        assert len(text.splitlines()) == 1, text
        assert not os.path.exists(os.path.join(folder, 'wrong')), arguments


def check_links(folder):
    """A campaign's folder may come from a stranger."""
    file = write_experiment(folder)
    out = os.path.join(folder, 'linked')
    sweep([file, '--seeds', '1', '--no-figures', '--out', out])
    elsewhere = os.path.join(folder, 'elsewhere')
    os.mkdir(elsewhere)
    os.symlink(elsewhere, os.path.join(out, 'figures'))
    text = sweep([out], code=2)
    assert 'figures: found a symbolic link' in text, text
    assert os.listdir(elsewhere) == []
    os.unlink(os.path.join(out, 'figures'))
    # Where engines write, and where GNU parallel's results are taken and removed.
    kept = os.path.join(elsewhere, 'kept.jsonl')
    with open(kept, 'w', encoding='ascii') as mine:
        mine.write('mine')
    for name in ('slurm', 'parallel', 'parallel/returned'):
        link = os.path.join(out, name)
        os.makedirs(os.path.dirname(link), exist_ok=True)
        os.symlink(elsewhere, link)
        text = sweep([out, '--retry'], code=2)
        assert name + ': found a symbolic link' in text, text
        os.unlink(link)
    # The file of the campaign writes nothing through a link either.
    before = sorted(os.listdir(out))
    for name in ('files', 'earlier'):
        os.symlink(elsewhere, os.path.join(out, name))
        text = sweep([file, '--seeds', '2', '--no-figures', '--out', out], code=2)
        assert name + ': found a symbolic link' in text, text
        os.unlink(os.path.join(out, name))
    assert sorted(os.listdir(out)) == before
    assert os.listdir(elsewhere) == ['kept.jsonl']
    os.remove(kept)
    os.rename(os.path.join(out, 'results'), os.path.join(folder, 'results'))
    os.symlink(elsewhere, os.path.join(out, 'results'))
    for arguments in ([out], [out, '--rows', '1']):
        text = sweep(arguments, code=2)
        assert 'results: found a symbolic link' in text, text
    assert os.listdir(elsewhere) == []


def check_folder_on_the_real_lab(folder):
    """A folder may come from a stranger: it moves no robots unless the user asks for it."""
    file = write_experiment(folder, ROBOTS)
    out = os.path.join(folder, 'real')
    sweep([file, '--live', '--no-run', '--seeds', '1', '--out', out, '--no-figures'], code=1)
    text = sweep([out], code=2)
    assert 'real: found a campaign on the real lab' in text and 'add --live' in text, text
    assert not os.path.exists(os.path.join(out, 'journal.jsonl'))
    sweep([out, '--no-run', '--no-figures'], code=1)
    simulated = os.path.join(folder, 'simulated')
    sweep([file, '--no-run', '--seeds', '1', '--out', simulated, '--no-figures'], code=1)
    text = sweep([simulated, '--live'], code=2)
    assert 'simulated: found a simulated campaign' in text, text


def queue(folder, arguments, code=0):
    done = subprocess.run([lab(), 'queue', *arguments], cwd=folder, capture_output=True, text=True)
    text = done.stdout + done.stderr
    assert done.returncode == code, f'{arguments}: exit code {done.returncode}\n{text}'
    return text


def check_queue(folder):
    write_experiment(folder, ROBOTS)
    common = ['engines.toml', '--no-figures', '--seeds', '1', '--over', 'programs.abp.eta_rad_s=1']
    queue(folder, ['add', *common, '--set', 'programs.abp.epsilon_s=0.2', '--out', 'one'])
    queue(folder, ['add', *common, '--set', 'nothing=3', '--out', 'two'])
    queue(folder, ['add', *common, '--set', 'programs.abp.epsilon_s=0.5', '--out', 'three'])
    text = queue(folder, ['add', 'nowhere.toml'], code=2)
    assert 'nowhere.toml' in text, text
    text = queue(folder, ['add', 'engines.toml', '--overr', '1'], code=2)
    assert '--overr' in text and len(text.splitlines()) == 1, text
    assert queue(folder, []).count('waiting') == 3
    queue(folder, ['run'], code=1)  # the second one fails
    text = queue(folder, [])
    assert text.count('(done') == 2 and text.count('(failed') == 1, text
    assert len(rows_of(os.path.join(folder, 'three'))) == 1
    queue(folder, ['remove', '2'])
    assert 'no such number' in queue(folder, ['remove', '2'], code=2)
    assert queue(folder, ['run']) == ''


def check_queue_of_a_stranger(folder):
    write_experiment(folder, ROBOTS)
    queue(folder, ['add', 'engines.toml', '--seeds', '1', '--no-figures', '--out', 'one'])
    file = os.path.join(folder, 'campaigns', 'queue.json')
    with open(file, encoding='utf-8') as text:
        entries = json.load(text)
    for words, needed in ((['--engine', 'parallel', '--hosts', 'sh -c "touch evil";exit'], 'engines'),
                          (['--engine=slurm', '--slurm', '--wrap=evil'], 'engines'),
                          (['--rows', '0', '--bundle-file', 'evil'], 'engines'),
                          (['--engine', 'commands', '--lab-there', 'evil'], 'engines'),
                          (['--live'], 'live')):
        last = [dict(entry, number=2, arguments=entry['arguments'] + words) for entry in entries]
        with open(file, 'w', encoding='utf-8') as text:
            json.dump(entries + last, text)
        for more in ([], ['--live' if needed == 'engines' else '--engines']):
            text = queue(folder, ['run', *more], code=2)
            assert text.endswith(f'lab queue run --{needed}\n'), text
            assert len(text.splitlines()) == 1, text
            assert queue(folder, []).count('waiting') == 2  # the first one was not started either
    last[0]['arguments'] = entries[0]['arguments'] + ['--live', '--lab-there', 'evil']
    with open(file, 'w', encoding='utf-8') as text:
        json.dump(entries + last, text)
    for one in ('--live', '--engines'):  # neither stands for the other
        assert 'lab queue run --live --engines' in queue(folder, ['run', one], code=2)
    assert 'evil' not in os.listdir(folder) and 'one' not in os.listdir(folder)
    words = ['two' if word == 'one' else word for word in entries[0]['arguments']]
    last[0]['arguments'] = words + ['--live', '--rehearse', '--engine', 'local']
    with open(file, 'w', encoding='utf-8') as text:
        json.dump(entries + last, text)
    queue(folder, ['run'])
    assert queue(folder, []).count('(done') == 2
    text = queue(folder, ['add', 'engines.toml', '--engine', 'slurm'])
    assert 'it runs with: lab queue run --engines' in text, text


def main():
    for check in (check_rehearsal, check_kill, check_known, check_links, check_wrong,
                  check_folder_on_the_real_lab, check_queue, check_queue_of_a_stranger):
        with tempfile.TemporaryDirectory(prefix='lab-live-campaign-') as folder:
            check(folder)


if __name__ == '__main__':
    main()
