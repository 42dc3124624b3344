// libsimavr never frees the names of its interrupt lines, about 7 kB per chip. The tests link this
// file too.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libsimavr\n"; }
