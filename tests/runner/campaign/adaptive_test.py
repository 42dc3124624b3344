"""An adaptive campaign: killed at random moments it chooses the same runs as an undisturbed one, and
bad plans get one line.

    adaptive_test.py FOLDER_OF_PROGRAMS
"""
import filecmp
import json
import os
import random
import signal
import subprocess
import tempfile
import time

from campaign_samples import EXPERIMENT, check_same, lab, results_of, sweep, write_experiment

PLAN = '''
[sweep.adaptive]
goal = "law"
quantity = "D_r_rad2_s"
robot_time_s = 500
runs_per_round = 3
'''


def rounds_of(campaign):
    with open(os.path.join(campaign, 'adaptive.jsonl'), encoding='ascii') as lines:
        return [json.loads(line) for line in lines]


def check_rounds(campaign, text):
    """25 runs of 20 s, each noted with its reason before it was run, each told in one line."""
    rounds = rounds_of(campaign)
    runs = [run for one in rounds for run in one['runs']]
    assert len(runs) == 25 and len({run['run'] for run in runs}) == 25, len(runs)
    assert sorted({name.split('-')[0] for name in results_of(campaign)}) == sorted(
        run['run'] for run in runs)
    assert [one['round'] for one in rounds] == list(range(1, 10)), rounds
    assert rounds[0]['error'] is None and rounds[-1]['error'] < rounds[2]['error'], rounds
    for one in rounds:
        assert one['expected_error'] > 0 and all(run['variance_reduction'] > 0 for run in one['runs'])
    assert rounds[1]['robot_time_s'] == 60, rounds[1]
    told = [line for line in text.splitlines() if line.startswith('round ')]
    assert len(told) == len(rounds), text
    assert 'the robot time of 8 min 20 s is spent' in text, text
    with open(os.path.join(campaign, 'surface.csv'), encoding='ascii') as surface:
        lines = surface.read().splitlines()
    assert lines[0].endswith(',D_r_rad2_s,D_r_rad2_s.standard_error') and len(lines) == 7, lines


def kill_at_random(arguments, campaign, chance):
    """Kills a campaign again and again until it is done; returns the number of kills."""
    kills = 0
    while True:
        process = subprocess.Popen([lab(), 'sweep', *arguments], stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL, start_new_session=True)
        wanted = count(campaign) + chance.randint(1, 4)
        while process.poll() is None and count(campaign) < wanted:
            time.sleep(0.002)
        time.sleep(chance.random() * 0.02)
        if process.poll() is not None:
            assert process.returncode == 0, process.returncode
            return kills
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        kills += 1


def count(campaign):
    try:
        return len(results_of(campaign))
    except FileNotFoundError:
        return 0


def check_refusals(folder, file):
    def refused(text, arguments, *words):
        other = write_experiment(folder, text)
        out = os.path.join(folder, 'refused')
        found = sweep([other, '--adaptive', '--out', out, *arguments], code=2)
        assert not os.path.exists(out), 'a folder was made'
        lines = [line for line in found.splitlines() if line]
        assert len(lines) == 1 and all(word in lines[0] for word in words), found

    whole = EXPERIMENT + PLAN
    refused(EXPERIMENT, [], 'found no table [sweep.adaptive]')
    refused(whole, ['--engine', 'commands'], '--engine')
    refused(whole, ['--common-seeds'], 'independent seeds')
    refused(whole.replace('robot_time_s = 500', ''), [], 'robot_time_s', 'error')
    refused(whole.replace('"law"', '"laws"'), [], 'sweep.adaptive.goal', '"laws"')
    refused(whole.replace('quantity = "D_r_rad2_s"', ''), [], 'sweep.adaptive.quantity')
    refused(whole + 'parameter = "eat"\n', [], '"eat"', 'eta, epsilon')
    refused(whole, ['--over', 'description=a,b'], 'description=a', 'positive numbers')
    refused(whole.replace('= 500', '= 19'), [], 'at least 20')
    refused(whole + 'level = 1\n', [], 'level', 'boundary')
    write_experiment(folder, whole.replace('D_r_rad2_s', 'D_r_rad_s'))
    found = sweep([file, '--adaptive', '--out', os.path.join(folder, 'column'), '--no-figures'],
                  code=2)
    assert 'found "D_r_rad_s"' in found and 'abp.D_r_rad2_s' in found, found


def main():
    chance = random.Random(4)
    with tempfile.TemporaryDirectory(prefix='lab-campaign-') as folder:
        file = write_experiment(folder, EXPERIMENT + PLAN)
        same = ['--adaptive', '--no-figures', '--seeds', '30']
        reference = os.path.join(folder, 'reference')
        text = sweep([file, '--out', reference, *same])
        check_rounds(reference, text)

        killed = os.path.join(folder, 'killed')
        kills = kill_at_random([file, '--out', killed, *same], killed, chance)
        assert kills >= 3, kills
        check_same(reference, killed)
        for name in ('adaptive.jsonl', 'surface.csv'):
            assert filecmp.cmp(os.path.join(reference, name), os.path.join(killed, name),
                               shallow=False), name
        print(f'{kills} kills')

        # With more robot time it goes on, from the folder alone too.
        write_experiment(folder, EXPERIMENT + PLAN.replace('500', '620'))
        text = sweep([file, '--out', killed, *same])
        assert len(results_of(killed)) == 31 and len(rounds_of(killed)) == 11, text
        text = sweep([killed, '--no-figures'])
        assert 'round ' not in text and 'the robot time of 10 min 20 s is spent' in text, text

        # The same in a rehearsal of a live campaign, whose rests are robot time.
        live = os.path.join(folder, 'live')
        text = sweep([file, '--out', live, *same, '--live', '--rehearse', '--rest', '60', '--keep',
                      'nothing'])
        assert len(results_of(live)) == 7, text

        # D_r = epsilon eta^2 / 6 is 0.2 at eta = 2.45 and 1.55.
        write_experiment(folder, EXPERIMENT.replace('duration_s = 20', 'duration_s = 200') +
                         PLAN.replace('"law"', '"boundary"\nlevel = 0.2').replace('500', '5000'))
        boundary = os.path.join(folder, 'boundary')
        text = sweep([file, '--out', boundary, *same])
        assert 'known    boundary D_r_rad2_s = 0.2: error ' in text, text
        with open(os.path.join(boundary, 'boundary.csv'), encoding='ascii') as lines:
            heading, *positions = lines.read().splitlines()
        assert heading == ('programs.abp.epsilon_s,programs.abp.eta_rad_s,'
                           'programs.abp.eta_rad_s.standard_error'), heading
        for line, expected in zip(positions, ((0.2, 2.449), (0.5, 1.549)), strict=True):
            epsilon, eta, sigma = map(float, line.split(','))
            assert epsilon == expected[0] and sigma < 0.2, line
            assert abs(eta - expected[1]) < 0.05 + 4 * sigma, line

        check_refusals(folder, file)


main()
