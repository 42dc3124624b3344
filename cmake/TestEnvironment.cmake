# What ctest's tests find in their environment. CI: a lab that a test starts in real time has no page
# in a browser (docs/dashboard.md) unless the test asks for it.
set(ENV{CI} true)
