#!/usr/bin/env python3
"""The gates of style: each looks at every file of the tree and exits 1 with one line a finding.

    gates.py GATE ROOT [BUILD]     GATE: format | names | spelling | includes | layout | programs | alone

format    clang-format changes nothing
names     clang-tidy finds no name against .clang-tidy in any header
spelling  codespell finds no misspelt word in code, comments, manual and experiments
includes  every file includes the standard headers whose names it uses
layout    no folder at the root that is not in docs/architecture.md, no include against the arrow or
          of another service's private header
programs  no name of a program of programs/ outside the folders that may know programs
alone     every header compiles without any other header before it (of those that their own source includes
          first, style_every_source_alone shows it)

77 is returned where the tool is not installed or is of another version than the one that decides.
"""
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

SKIPPED = 77
CODE = (".cpp", ".hpp", ".c", ".h")
ROOMS = ("lcmtypes", "robot", "light", "common", "robot_bridge", "projector_ctl", "tracker_svc", "sim_svc",
         "analyzer", "dds_gateway", "dashboard", "runner", "tests")
DATA = ("programs", "experiments", "python", "docs", "cmake", ".ci")
FOUNDATION = ("lcmtypes", "robot", "light", "common")
SERVICES = ("robot_bridge", "projector_ctl", "tracker_svc", "sim_svc", "analyzer", "dds_gateway", "dashboard")
# Folders of a service whose headers others include, each with its reason (docs/architecture.md).
SHARED_FOLDERS = ("robot_bridge/calibration/", "projector_ctl/calibration/", "tracker_svc/calibration/",
                  "dds_gateway/dds/")
# Folders that .gitignore names.
LEFT_BEHIND = ("build", "runs", "campaigns", "tests/benchmarks/results")
# The named exceptions to "no service includes another" (docs/architecture.md).
SERVICE_EXCEPTIONS = {("dashboard", "analyzer")}


def files_of(root, endings):
    """Paths of the tree below root, relative to it: what git tracks or could. In a copy without git,
    everything but what builds and runs leave behind."""
    listed = None
    if shutil.which("git"):
        listed = subprocess.run(["git", "-C", root, "ls-files", "-co", "--exclude-standard"],
                                capture_output=True, text=True)
    if listed is not None and listed.returncode == 0:
        names = listed.stdout.split("\n")
    else:
        names = []
        for folder, folders, found in os.walk(root):
            folders[:] = [name for name in folders
                          if name not in (".git", "__pycache__") and
                          os.path.relpath(os.path.join(folder, name), root) not in LEFT_BEHIND]
            names += [os.path.relpath(os.path.join(folder, name), root) for name in found]
    return sorted(name for name in names
                  if name.endswith(endings) and os.path.isfile(os.path.join(root, name)))


def need(tool, version=None):
    """The tool's path, or an end with SKIPPED and the reason."""
    path = shutil.which(tool)
    if path is None:
        print(f"skipped: {tool} is not installed")
        sys.exit(SKIPPED)
    if version is not None:
        found = subprocess.run([path, "--version"], capture_output=True, text=True).stdout
        number = re.search(r"version (\d+)", found)
        if number is None or int(number.group(1)) != version:
            print(f"skipped: {tool} {version} decides, found: {found.strip().splitlines()[0]}")
            sys.exit(SKIPPED)
    return path


def in_parts(items, size):
    return [items[i:i + size] for i in range(0, len(items), size)]


def in_parallel(work, parts):
    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        return list(pool.map(work, parts))


def check_format(root, _build):
    tool = need("clang-format", 14)

    def check(part):
        done = subprocess.run([tool, "--dry-run", "--Werror", "-ferror-limit=1", *part], cwd=root,
                              capture_output=True, text=True)
        return [line.split(":")[0] for line in done.stderr.splitlines() if " error: " in line]

    parts = in_parts(files_of(root, CODE), 40)
    found = sorted({name for names in in_parallel(check, parts) for name in names})
    return [f"{name}: clang-format would change it; run clang-format -i {name}" for name in found]


def compile_flags(build, root):
    """Include paths and macros of all compile commands; of a macro with several values, one."""
    flags = {"-I" + root: None}
    macros = {}
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as commands:
        for entry in json.load(commands):
            words = shlex.split(entry["command"])
            for word, following in zip(words, words[1:] + [""]):
                if word.startswith("-I"):
                    flags[word] = None
                elif word == "-isystem":
                    flags["-isystem" + following] = None
                elif word.startswith("-DLAB_"):
                    macros[word.split("=")[0]] = word
    return [*flags, *macros.values()]


def headers_of(root):
    """Our headers, but for those that only the robot's compiler or the emulator's library can read."""
    return [name for name in files_of(root, (".hpp",))
            if not name.startswith("robot/firmware/avr/") and "simavr" not in name]


def check_names(root, build):
    tool = need("clang-tidy", 14)
    flags = compile_flags(build, root)
    groups = {}
    for name in headers_of(root):
        # A unit a room; the helpers of tests, whose names need only differ within a folder, by folder.
        group = os.path.dirname(name) if name.startswith("tests/") else name.split("/")[0]
        groups.setdefault(group, []).append(name)

    with tempfile.TemporaryDirectory() as folder:
        def check(item):
            number, names = item
            unit = os.path.join(folder, f"unit_{number}.cpp")
            with open(unit, "w", encoding="utf-8") as text:
                text.writelines(f'#include "{name}"\n' for name in names)
            done = subprocess.run(
                [tool, "--quiet", "--checks=-*,readability-identifier-naming",
                 f"--config-file={root}/.clang-tidy", "--warnings-as-errors=*",
                 f"--header-filter={re.escape(os.path.realpath(root))}/.*|{re.escape(root)}/.*", unit, "--",
                 "-std=c++20", "-w", *flags],
                capture_output=True, text=True)
            # What g++ compiles and clang does not is no matter of names; a header that is missing is.
            return [line.replace(root + "/", "") for line in done.stdout.splitlines()
                    if "[readability-identifier-naming" in line or " file not found" in line]

        found = in_parallel(check, enumerate(groups.values()))
    return sorted({line for lines in found for line in lines})


def check_spelling(root, _build):
    tool = need("codespell")
    exceptions = os.path.join(root, "tests/style/spelling_exceptions.txt")
    names = files_of(root, CODE + (".md", ".toml", ".py", ".sh", ".cmake", ".lcm", ".idl", ".js", ".css",
                                   ".html", "CMakeLists.txt", "lab"))
    command = [tool, "--quiet-level=2"]
    if os.path.exists(exceptions):
        command += ["--ignore-words", exceptions]
    found = []
    for part in in_parts(names, 200):
        done = subprocess.run([*command, *part], cwd=root, capture_output=True, text=True)
        found += [line for line in done.stdout.splitlines() if "==>" in line]
    return found


# Names of the standard library and of GoogleTest, and the headers that declare them (any one of them).
STANDARD = {
    r"std::(?:string|to_string|stod|stoi|getline)\b": ("string",),
    r"std::string_view\b": ("string_view",),
    r"std::vector\b": ("vector",), r"std::array\b": ("array",), r"std::map\b": ("map",),
    r"std::set\b": ("set",), r"std::deque\b": ("deque",), r"std::span\b": ("span",),
    r"std::unordered_map\b": ("unordered_map",), r"std::unordered_set\b": ("unordered_set",),
    r"std::optional\b|std::nullopt\b": ("optional",), r"std::variant\b": ("variant",),
    r"std::function\b": ("functional",),
    r"std::(?:unique_ptr|shared_ptr|make_unique|make_shared|weak_ptr)\b": ("memory",),
    r"std::(?:sort|max_element|min_element|nth_element|clamp|any_of|all_of|none_of|find_if|count_if|lower_bound"
    r"|upper_bound|stable_sort|remove_if|fill_n)\b": ("algorithm",),
    r"std::(?:sqrt|sin|cos|tan|exp|log|hypot|atan2|isfinite|isnan|floor|ceil|lround|llround|remainder)\b":
        ("cmath", "complex"),
    r"std::(?:u?int(?:8|16|32|64)_t)\b": ("cstdint",),
    r"std::numeric_limits\b": ("limits",), r"std::accumulate\b": ("numeric",),
    r"std::numbers\b": ("numbers",), r"std::filesystem\b": ("filesystem",),
    r"std::(?:ifstream|ofstream)\b": ("fstream",), r"std::(?:ostringstream|istringstream)\b": ("sstream",),
    r"std::(?:cout|cerr)\b": ("iostream",), r"std::(?:thread|this_thread|jthread)\b": ("thread",),
    r"std::(?:mutex|lock_guard|scoped_lock|unique_lock)\b": ("mutex",), r"std::atomic\b": ("atomic",),
    r"std::chrono\b": ("chrono",), r"std::(?:runtime_error|invalid_argument|logic_error)\b": ("stdexcept",),
    r"\bTEST(?:_F|_P)?\(|\b(?:EXPECT|ASSERT)_[A-Z]+\(": ("gtest/gtest.h", "gmock/gmock.h"),
}


def without_comments(text):
    return re.sub(r'//[^\n]*|/\*.*?\*/|"(?:[^"\\\n]|\\.)*"', '""', text, flags=re.S)


def check_includes(root, _build):
    own = {}  # file: the headers in <> that it includes itself

    def angle_includes(name):
        if name not in own:
            with open(os.path.join(root, name), encoding="utf-8") as text:
                own[name] = set(re.findall(r"^\s*#\s*include\s+<([^>]+)>", text.read(), re.M))
        return own[name]

    found = []
    for name in files_of(root, (".cpp", ".hpp")):
        with open(os.path.join(root, name), encoding="utf-8") as text:
            code = text.read()
        have = set(angle_includes(name))
        # A source may rely on the header that has its name; a test on helpers of tests/ for GoogleTest.
        for other in re.findall(r'^\s*#\s*include\s+"([^"]+)"', code, re.M):
            of_its_name = os.path.splitext(other)[0] == os.path.splitext(name)[0]
            subject = name.endswith("_test.cpp") and other == name[len("tests/"):].replace("_test.cpp", ".hpp")
            if (of_its_name or subject) and os.path.exists(os.path.join(root, other)):
                have |= angle_includes(other)
        code = without_comments(code)
        for pattern, headers in STANDARD.items():
            use = re.search(pattern, code)
            if use and not any(header in have for header in headers):
                line = code[:use.start()].count("\n") + 1
                found.append(f"{name}:{line}: uses {use.group(0).rstrip('(')}, expected #include <{headers[0]}>")
    return found


def check_layout(root, _build):
    found = []
    listed = {name.split("/")[0] for name in files_of(root, "") if "/" in name}
    for folder in sorted(listed):
        if folder not in ROOMS + DATA:
            found.append(f"{folder}/: no such room; the rooms are {', '.join(ROOMS + DATA)}")
    for name in files_of(root, (".cpp", ".hpp")):
        room = name.split("/")[0]
        if room == "tests":
            continue
        with open(os.path.join(root, name), encoding="utf-8") as text:
            lines = text.read().splitlines()
        for number, line in enumerate(lines, 1):
            match = re.match(r'\s*#\s*include\s+"([^"]+)"', line)
            if match is None or "/" not in match.group(1):
                continue
            target = match.group(1)
            other = target.split("/")[0]
            where = f"{name}:{number}: includes {target}"
            if other == room or other not in ROOMS:
                continue
            if other == "tests":
                found.append(f"{where}; only tests include tests/")
            elif room in FOUNDATION:
                allowed = {"lcmtypes": (), "robot": (), "light": ("robot",), "common": ("lcmtypes", "robot", "light")}
                if other not in allowed[room]:
                    found.append(f"{where}; {room} may include {', '.join(allowed[room]) or 'no other room'}")
            elif room in SERVICES and other not in FOUNDATION and (room, other) not in SERVICE_EXCEPTIONS:
                found.append(f"{where}; no service includes another")
            elif other in SERVICES and target.count("/") > 1 and not target.startswith(SHARED_FOLDERS):
                found.append(f"{where}; it is private: headers at the top of {other}/ are for other rooms")
    return found


# Folders that may name programs of motion; other files that name some, and why (empty: any).
KNOW_PROGRAMS = ("programs/", "experiments/", "docs/", "tests/", "analyzer/laws/")
NAMES_PROGRAMS = {
    "CHANGELOG.md": ((), "says what was shipped"),
    "common/bus/upgrade/from_version_4.cpp": (("abp", "noisy_abp", "bp", "rtp", "wheels"),
                                              "logs of version 4 number the programs that have these names"),
    "common/camera/camera_source.cpp": (("rtp",), "a protocol of cameras"),
    "common/camera/camera_source.hpp": (("rtp",), "a protocol of cameras"),
    "dashboard/page/robot_panel.js": (("wheels",), "a row with the speeds of the wheels"),
    "dds_gateway/ros/ros_commands.cpp": (("stand",), "an order of ROS 2, which needs no program"),
    "sim_svc/world.cpp": (("wheels",), "the purpose of a stream of random numbers"),
}
# Names of programs that are also words: only where they stand alone in quotes or as a file.
PROGRAM_WORDS = ("memory", "resetting", "stand", "wheels")


def check_programs(root, _build):
    names = [os.path.basename(name)[:-len(".toml")] for name in files_of(root, (".toml",))
             if name.startswith("programs/")]
    if not names:
        return ["programs/: no program, expected files NAME.toml"]
    words = [rf"(?<=[\"'`]){name}(?=\\?[\"'`])|\b{name}\.toml\b" for name in names if name in PROGRAM_WORDS]
    others = [rf"(?<!\w){name}(?!\w)" for name in names if name not in PROGRAM_WORDS]
    pattern = re.compile("|".join(words + others))
    found = []
    for name in files_of(root, ""):
        if name.startswith(KNOW_PROGRAMS):
            continue
        try:
            with open(os.path.join(root, name), encoding="utf-8") as text:
                lines = text.read().splitlines()
        except UnicodeDecodeError:
            continue
        excepted = NAMES_PROGRAMS.get(name, (None,))[0]
        used = set()
        for number, line in enumerate(lines, 1):
            # An experiment may have the name of its program.
            for use in pattern.findall(re.sub(r"\bexperiments/\w+\.toml\b", "", line)):
                if excepted == () or excepted and use in excepted:
                    used.add(use)
                else:
                    found.append(f"{name}:{number}: names the program {use}; expected code for all programs alike")
        for unused in sorted(set(excepted or ()) - used):
            found.append(f"{name}: does not name the program {unused}; remove this exception in tests/style/gates.py")
    return found


def first_include_of_its_source(root, name):
    source = os.path.join(root, os.path.splitext(name)[0] + ".cpp")
    if not os.path.exists(source):
        return False
    with open(source, encoding="utf-8") as text:
        first = re.search(r'^\s*#\s*include\s+[<"]([^">]+)[">]', text.read(), re.M)
    return first is not None and first.group(1) == name


def check_alone(root, build):
    compiler = need("g++")
    flags = compile_flags(build, root)

    def check(name):
        done = subprocess.run([compiler, "-std=c++20", "-fsyntax-only", "-w", "-O0", *flags, "-include", name,
                               "-x", "c++", "/dev/null"], cwd=root, capture_output=True, text=True)
        errors = [line for line in done.stderr.splitlines() if " error: " in line]
        return [f"{name}: does not compile alone: {errors[0] if errors else done.stderr[:200]}"] \
            if done.returncode else []

    names = [name for name in headers_of(root) if not first_include_of_its_source(root, name)]
    return [line for lines in in_parallel(check, names) for line in lines]


GATES = {"format": check_format, "names": check_names, "spelling": check_spelling,
         "includes": check_includes, "layout": check_layout, "programs": check_programs, "alone": check_alone}


def main():
    if len(sys.argv) not in (3, 4) or sys.argv[1] not in GATES:
        print(__doc__)
        return 2
    found = GATES[sys.argv[1]](os.path.abspath(sys.argv[2]), sys.argv[3] if len(sys.argv) == 4 else None)
    for line in found:
        print(line)
    print(f"{sys.argv[1]}: {len(found)} findings")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
