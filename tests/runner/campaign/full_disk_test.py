"""A campaign on a disk that becomes full: a clear line, nothing lost that was there.

    full_disk_test.py FOLDER_OF_PROGRAMS      (root, or a user namespace, for a small file system)
"""
import os
import subprocess
import sys
import tempfile

from campaign_samples import lab, reference, results_of, sweep, write_experiment, check_same

SKIPPED = 77


def main():
    if os.environ.get('LAB_FULL_DISK') != '1':
        for new in (['-m'], ['-Urm']):
            if subprocess.run(['unshare', *new, 'true'], check=False).returncode == 0:
                os.execvpe('unshare', ['unshare', *new, sys.executable, *sys.argv],
                           dict(os.environ, LAB_FULL_DISK='1'))
        print('skipped: this system allows no mount namespaces')
        sys.exit(SKIPPED)
    with tempfile.TemporaryDirectory(prefix='lab-campaign-') as folder:
        small = os.path.join(folder, 'small')
        os.mkdir(small)
        if subprocess.run(['mount', '-t', 'tmpfs', '-o', 'size=130m', 'none', small],
                          check=False).returncode != 0:
            print('skipped: cannot mount a small file system')
            sys.exit(SKIPPED)
        file = write_experiment(folder)
        out = os.path.join(small, 'campaign')
        sweep([file, '--out', out, '--no-figures', '--seeds', '1'])
        before = results_of(out)

        # Too little for the campaign: refused before anything begins.
        filler = os.path.join(small, 'filler')
        with open(filler, 'wb') as file_of_zeros:
            file_of_zeros.write(bytes(60_000_000))
        text = sweep([file, '--out', out, '--seeds', '2', '--no-figures'], code=2)
        assert 'too little disk' in text and 'are free' in text, text
        assert results_of(out) == before

        # It becomes full while it runs (the worker does not ask for space beforehand).
        with open(filler, 'ab') as file_of_zeros:
            try:
                while True:
                    file_of_zeros.write(bytes(65536))
                    file_of_zeros.flush()
            except OSError:
                pass
        done = subprocess.run([lab(), 'sweep', out, '--rows', '6-11'], capture_output=True, text=True)
        assert done.returncode == 1, done.stdout + done.stderr
        assert 'less than 100 MB are free' in done.stderr or 'No space left' in done.stderr, done.stderr
        assert results_of(out) == before

        os.remove(filler)
        text = sweep([out, '--no-figures'])
        assert 'done     12 of 12 runs' in text, text
        check_same(reference(folder, file), out)
        subprocess.run(['umount', small], check=True)


main()
