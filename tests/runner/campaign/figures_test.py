"""The figures of a campaign are those of its page.

    figures_test.py FOLDER_OF_PROGRAMS
"""
import os
import tempfile

from campaign_samples import sweep, write_experiment


def figures_of(campaign):
    return {os.path.splitext(name)[0] for name in os.listdir(os.path.join(campaign, 'figures'))
            if name.endswith('.svg')}


def main():
    with tempfile.TemporaryDirectory(prefix='lab-figures-') as folder:
        out = os.path.join(folder, 'campaign')
        sweep([write_experiment(folder), '--out', out, '--show', 'abp.v_cm_s'])
        first = figures_of(out)
        assert any('v_cm_s' in name for name in first), first
        own = os.path.join(out, 'figures', 'notes.txt')
        with open(own, 'w', encoding='ascii') as file:
            file.write('mine')
        sweep([out, '--show', 'abp.D_r_rad2_s'])
        second = figures_of(out)
        assert any('D_r_rad2_s' in name for name in second), second
        assert not any('v_cm_s' in name for name in second), second
        assert os.path.exists(own)


main()
