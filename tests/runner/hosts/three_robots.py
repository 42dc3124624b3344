"""The experiment of the tests between computers: three robots that run one program."""

ROBOTS = '''
[[robots]]
count = 3
id = 1

[programs.abp]
model = "abp"
v_cm_s = 3
epsilon_s = 0.5
eta_rad_s = 3
'''


def experiment(name, duration_s, tables):
    """The text of the file. `tables` has what differs between the tests: [network], [link] ..."""
    return f'''
fileversion = 1
name = "{name}"
duration_s = {duration_s}
program = "abp"

{tables}
{ROBOTS}'''
