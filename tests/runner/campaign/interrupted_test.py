"""A campaign that is killed at random moments is complete at the end and equal to an undisturbed one.

    interrupted_test.py FOLDER_OF_PROGRAMS KILLS SEEDS
"""
import fcntl
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from campaign_samples import EXPERIMENT, check_same, lab, sweep, write_experiment


def running(session):
    """Processes of a session; after their parent's end, too."""
    found = subprocess.run(['pgrep', '-s', str(session)], capture_output=True, text=True).stdout
    return [int(one) for one in found.split() if alive(int(one))]


def alive(pid):
    try:
        with open(f'/proc/{pid}/stat', encoding='ascii') as stat:
            return stat.read().rsplit(')', 1)[1].split()[0] != 'Z'
    except OSError:
        return False


def count(folder):
    try:
        return len(os.listdir(os.path.join(folder, 'results')))
    except FileNotFoundError:
        return 0


def main():
    kills, seeds = int(sys.argv[2]), sys.argv[3]
    chance = random.Random(4)
    with tempfile.TemporaryDirectory(prefix='lab-campaign-') as folder:
        file = write_experiment(folder, EXPERIMENT)
        reference = os.path.join(folder, 'reference')
        sweep([file, '--out', reference, '--no-figures', '--seeds', seeds])
        total = count(reference)
        out = os.path.join(folder, 'killed')
        for number in range(kills):
            process = subprocess.Popen([lab(), 'sweep', file, '--out', out, '--no-figures', '--seeds',
                                        seeds], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                       start_new_session=True)
            # After some more results, so that the last one is killed near the end.
            wanted = count(out) + chance.randint(0, max(1, total // kills))
            while process.poll() is None and count(out) < wanted:
                time.sleep(0.002)
            time.sleep(chance.random() * 0.02)
            process.send_signal(signal.SIGKILL)
            process.wait()
            deadline = time.time() + 60
            while running(process.pid) and time.time() < deadline:
                time.sleep(0.01)
            assert not running(process.pid), 'runs go on without their campaign'
        before = count(out)
        assert before > 0, 'nothing was done before the kills'
        text = sweep([file, '--out', out, '--no-figures', '--seeds', seeds])
        assert f'done     {total} of {total} runs' in text, text
        check_same(reference, out)
        assert os.listdir(os.path.join(out, 'work')) == [], 'left behind'
        print(f'{kills} kills; {before} of {total} results were there before the last call')

        # Half of the files damaged, the folder moved, and the experiment file gone.
        results = sorted(os.listdir(os.path.join(out, 'results')))
        for name in results[::2]:
            path = os.path.join(out, 'results', name)
            with open(path, 'r+b') as result:
                result.truncate(os.path.getsize(path) // 2)
        moved = os.path.join(folder, 'moved campaign')
        shutil.move(out, moved)
        os.remove(file)
        text = sweep([moved, '--no-figures'])
        assert text.count('computed again') >= 1 and 'damaged' in text, text
        check_same(reference, moved)

        # A second call at the same time is refused.
        with open(os.path.join(moved, 'lock'), 'rb') as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            text = sweep([moved], code=2)
        assert 'another lab sweep runs this campaign' in text, text


main()
