# The environment of all tests. With CI set, a lab in real time starts no dashboard (docs/dashboard.md)
# unless the test requests it.
set(ENV{CI} true)
