"""lab calibrate twin: whole runs of the built programs.

    calibrate_twin_test.py FOLDER_OF_PROGRAMS
"""
import glob
import json
import os
import tempfile

from campaign_samples import run_lab as lab

NOISE_CM = 0.08
SPEED_NOISE = 0.3  # cm/sqrt(s)


def run(folder, seed, *settings):
    out = os.path.join(folder, f'run{seed}')
    keys = [f'seed={seed}', 'duration_s=60', 'camera.fps=20', 'robots[0].count=2', *settings]
    lab('run', 'abp', '--virtual-time', '--no-report', '--out', out,
        *[word for key in keys for word in ('--set', key)])
    return glob.glob(os.path.join(out, '*'))[0]


def read(*path):
    with open(os.path.join(*path), encoding='utf-8') as file:
        return file.read()


def main():
    true = [f'camera.position_noise_cm={NOISE_CM}', f'robot.speed_noise_cm_sqrt_s={SPEED_NOISE}']
    fit = ['--fit', 'camera.position_noise_cm=0.02:0.2', '--fit', 'robot.speed_noise_cm_sqrt_s=0:0.8',
           '--count', '150']
    with tempfile.TemporaryDirectory(prefix='lab-calibrate-twin-') as folder:
        runs = [run(folder, seed, *true) for seed in (1, 2)]
        held_out = run(folder, 3, *true)
        # The twins take the file's noise; it must not be known from there.
        out = os.path.join(folder, 'fitted')
        text = lab('calibrate', 'twin', *runs, *fit, '--held-out', held_out, '--out', out)
        assert 'held out' in text and 'agrees with its 40 twins' in text, text
        result = json.loads(read(out, 'fitted.json'))
        for parameter, value in zip(result['parameters'], (NOISE_CM, SPEED_NOISE)):
            assert parameter['determined'], text
            # Four standard errors: once in 10 000 for a true interval.
            assert abs(parameter['value'] - value) < 4 * parameter['standard_error'], text
            assert parameter['standard_error'] < 0.2 * value, text
        assert result['compared'][0]['agrees'] and result['compared'][0]['held_out'], text
        assert result['p_of_differences_between_runs'] > 1e-4, text

        # The keys that it wrote are keys of an experiment.
        keys = [line.split('#')[0].strip() for line in read(out, 'fitted.toml').splitlines()
                if not line.startswith('#')]
        assert len(keys) == 2, keys
        lab('check', 'abp', *[word for key in keys for word in ('--set', key.replace(' ', ''))])

        # The same command continues what is there, and gives the same.
        assert json.loads(read(out, 'fitted.json')) == result
        again = lab('calibrate', 'twin', *runs, *fit, '--held-out', held_out, '--out', out)
        assert json.loads(read(out, 'fitted.json')) == result, again

        # A run with other noise is told apart.
        other = run(folder, 4, 'camera.position_noise_cm=0.3',
                    'robot.speed_noise_cm_sqrt_s=0.8')
        text = lab('calibrate', 'twin', *runs, *fit, '--held-out', other, '--out', out)
        assert 'deviates from its 40 twins' in text, text

        # Wrong orders.
        text = lab('calibrate', 'twin', *runs, '--fit', 'camera.position_noise_cm=0.1,0.2', code=2)
        assert 'found values, expected a range KEY=LOW:HIGH' in text, text
        text = lab('calibrate', 'twin', os.path.join(folder, 'none'), *fit, code=2)
        assert 'found nothing, expected the folder of a run or a log' in text, text


main()
