# cmake -DFILE=<type>.hpp -P CheckedDecoding.cmake
# What lcm-gen writes believes the counts in a packet: one flipped bit makes it ask for gigabytes, and
# overflows the length that it checks against. Every element takes a byte or more, so that no list is
# longer than what is left of the packet. A text takes one for its end, and ends nowhere else: it could
# not be sent again.
file(READ "${FILE}" code)
string(REGEX REPLACE "( +)(this->[a-z_0-9]+)\\.resize\\(this->([a-z_0-9]+)\\);"
  "\\1if(this->\\3 < 0 || this->\\3 > maxlen - pos) return -1;\n\\1\\2.resize(this->\\3);" code "${code}")
string(REGEX REPLACE "( +)(this->[a-z_0-9]+(\\[a0\\])?)(\\.assign\\([^\n]*, ([a-z_0-9]+) - +1\\)\;)"
  "\\1if(\\5 < 1) return -1;\n\\1\\2\\4\n\\1if(\\2.find('\\\\0') != std::string::npos) return -1;"
  code "${code}")
file(WRITE "${FILE}" "${code}")
