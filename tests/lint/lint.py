#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Gridspace contributors
# SPDX-License-Identifier: Apache-2.0
"""Keeps the house in order: who may include what (CONTRIBUTING.md, "The house"), licence headers, shell scripts, and
what pages say of files, links and commands (pages.py).

  lint.py              checks the tree; exit code 1 and one line per mistake
  lint.py --self-test  checks the checks: each rule must find the mistake that it is for, in a tree made up for it
"""
import argparse
import concurrent.futures
import fnmatch
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from pages import check_pages

ROOT = pathlib.Path(__file__).resolve().parents[2]

# Layers, lowest first. The first pattern that fits a file's path decides; a file sees its own layer and lower ones.
LAYERS = [
    ("common", 0, ["common/*"]),
    ("pure core", 1, ["bus/lockstep/*", "sim/solvers/*", "sim/fmu/*", "sim/network/*", "sim/circuit/*", "sim/line_constants/*", "sim/components/*", "sim/actions/*", "sim/controls/*", "sim/opendss/*", "sim/powerflow/*", "sim/phasor/*", "sim/emt/*",                       "sim/events/*", "sim/engine/*", "sim/runtime/*", "fmi/*", "ids/*", "gateways/iec61850/*", "gateways/mapping/*",
                      "recorder/mcap/*", "recorder/compare/*", "recorder/export/*", "recorder/signals/*",
                      "recorder/pcapng/*", "common/comtrade/*", "agents/*_logic.?pp", "agents/relay/*element*", "agents/relay/line_relay.?pp",
                      "agents/relay/common/*", "agents/relay/functions/*", "agents/attacker/*_attack.?pp"]),
    ("bus and wire", 2, ["bus/*", "gateways/ethernet/*", "idl/*"]),
    ("shell", 3, ["sim/*", "agents/*", "gateways/*", "recorder/*", "router/*", "sdk/*", "timebox/*"]),
    ("monitor and launcher", 4, ["monitor/*", "launcher/*"]),
]

# Headers that only some folders may see: (pattern of the header, where it is allowed, why)
ONLY_IN = [
    (r"fast(dds|rtps|cdr)/.*", ["bus/*", "bench/lockstep/*", "monitor/graph/*", "tests/*"], "Fast DDS stays behind bus/"),
    (r"(ida|nvector|sunmatrix|sunlinsol|sundials|cvode|kinsol)/.*", ["sim/phasor/*"], "SUNDIALS stays in sim/phasor"),
    (r"yaml-cpp/.*", ["common/config/yaml.cpp"], "YAML is read in common/config/yaml.cpp"),
    (r"minizip/.*", ["fmi/*", "tests/*"], "zip files are read in fmi"),
    (r"boost/math/.*", ["launcher/sweep/distribution.cpp", "launcher/certify/binomial_interval.cpp"], "distributions of studies and intervals of shares have a file each"),
    (r"boost/(?!math/).*", ["monitor/web/*.cpp", "monitor/web/connections.hpp", "monitor/web/transport.hpp", "launcher/run/monitor_http.cpp"], "Boost stays in monitor/web and its client"),
    (r"linux/if_packet\.h|netpacket/.*", ["gateways/ethernet/*", "bench/wire/*", "timebox/packet_*", "tests/integration/timebox/programs/*"], "packet sockets stay in gateways/ethernet"),
    (r"CLI/.*", ["common/command_line/command.cpp", "launcher/cli/help.cpp", "launcher/cli/main.cpp", "launcher/cli/completion_verb.cpp", "bench/*"],
     "command lines go through common/command_line"),
    (r"nlohmann/json\.hpp", ["*.cpp"], "heavy headers stay in .cpp files"),
    (r"Eigen/.*", ["sim/*", "ids/*", "tests/*", "bench/*"], "linear algebra belongs to the physics and the detector"),
]

# What a pure core does not know. `sim/emt` and `sim/phasor` are pure as well: engines are functions of state and input.
IMPURE_HEADERS = r"thread|mutex|shared_mutex|condition_variable|future|semaphore|atomic|chrono|ctime|time\.h|unistd\.h|poll\.h|sys/.*|net/.*|netinet/.*|arpa/.*|linux/.*|pthread\.h|signal\.h|csignal"
IMPURE_WORDS = r"\b(system_clock|steady_clock|high_resolution_clock|random_device|gettimeofday|clock_gettime|getenv|std::rand|srand)\b"
PURE_BUT = {  # a reason for each exception
    "recorder/mcap/mcap_writer.cpp": "writes to a file descriptor, so that a flush is a flush",
    "recorder/pcapng/pcapng_writer.cpp": "the same",
    "common/comtrade/comtrade_writer.cpp": "its file format wants calendar times, of an instant that is given to it",
    "ids/evaluation/evaluate.cpp": "it reports nanoseconds per sample beside the results, which do not depend on them",
    "ids/training/*": "training is an offline job that uses all processors; its result does not depend on how many",
}

# Folders that still include each other, to be parted. Nothing is added here.
CIRCLES = []

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.M)
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.S)
SOURCES = (".cpp", ".hpp", ".h", ".cc")


def fits(path, patterns):
    return any(fnmatch.fnmatch(path, p) for p in patterns)


def layer_of(path):
    return next(((name, level) for name, level, patterns in LAYERS if fits(path, patterns)), (None, None))


def project_files(root):
    try:
        listed = subprocess.run(["git", "-C", root, "ls-files", "--cached", "--others", "--exclude-standard"], capture_output=True,
                                text=True, check=True).stdout.splitlines()
    except (OSError, subprocess.CalledProcessError):
        listed = [str(p.relative_to(root)) for p in pathlib.Path(root).rglob("*") if p.is_file()]
    return sorted(f for f in listed if (pathlib.Path(root) / f).is_file())


def line_of(text, offset):
    return text.count("\n", 0, offset) + 1


def check_includes(root, path, text):
    name, level = layer_of(path)
    for match in INCLUDE.finditer(text):
        kind, header = match.groups()
        where = f"{path}:{line_of(text, match.start())}"
        for pattern, allowed, why in ONLY_IN:
            if re.fullmatch(pattern, header) and not fits(path, allowed):
                yield f"{where}: includes <{header}>: {why}"
        if level is None:
            continue
        if kind == '"':
            other, other_level = layer_of(header)
            same_folder = path.rpartition("/")[0] == header.rpartition("/")[0]
            if other_level is not None and other_level > level and not same_folder:
                yield f"{where}: the {name} includes {header} of the {other}: lower layers never know upper ones"
            physics, cyber = "sim/", ("agents/", "gateways/", "ids/")
            if path.startswith(cyber) and header.startswith(physics) or path.startswith(physics) and header.startswith(cyber):
                yield f"{where}: includes {header}: agents and gateways meet the simulator only in idl/"
            if header.startswith(("recorder/", "monitor/")) and not path.startswith(("recorder/", "monitor/", "launcher/")):
                yield f"{where}: includes {header}: nothing depends on the recorder or the monitor"
        if level == 1 and not fits(path, PURE_BUT):
            if kind == "<" and re.fullmatch(IMPURE_HEADERS, header):
                yield f"{where}: a pure core includes <{header}>: no sockets, threads or wall clock"
    if level == 1 and not fits(path, PURE_BUT):
        for match in re.finditer(IMPURE_WORDS, COMMENT.sub(lambda m: re.sub(r"[^\n]", " ", m.group()), text)):
            yield f"{path}:{line_of(text, match.start())}: a pure core uses {match.group()}: results depend on state and input alone"


SOLVERS = ("sim/emt/", "sim/phasor/", "sim/powerflow/", "sim/circuit/", "sim/actions/")
KIND_HEADER = re.compile(r"sim/components/(?!faces/)\w+/.*")


def check_kinds(path, text, lists):
    """Solvers know faces of elements and no kinds: no header of an element, and no list of one kind out of a network."""
    for match in INCLUDE.finditer(text):
        if KIND_HEADER.fullmatch(match.group(2)):
            yield f"{path}:{line_of(text, match.start())}: a solver includes {match.group(2)}: it knows faces of elements (sim/components/faces)"
    for match in re.finditer(r"\b(?:n|n_|network|network_)\.(\w+)\b", text):
        if match.group(1) in lists:
            yield f"{path}:{line_of(text, match.start())}: a solver names {match.group()}: it knows faces of elements and no kinds"


def kinds_of(root):
    """Names of the lists of the network's elements, but for buses."""
    home = pathlib.Path(root) / "sim/components/elements.hpp"
    return set(re.findall(r"std::vector<\w+> (\w+);", home.read_text())) - {"buses"} if home.exists() else {"lines"}


def folder_of(path):
    return path.rpartition("/")[0]


def circles(includes):
    """Groups of folders that include each other, directly or round about: strongly connected parts of {folder: {folder: where}}."""
    reach = {}
    for start in includes:
        seen, todo = set(), [start]
        while todo:
            for other in includes.get(todo.pop(), {}):
                if other not in seen:
                    seen.add(other)
                    todo.append(other)
        reach[start] = seen
    groups = {frozenset(b for b in reach[a] if a in reach.get(b, ())) for a in includes if a in reach[a]}
    return sorted(groups, key=sorted)


def check_circles(files):
    """Folders must not include each other: {path: text} of the sources. CIRCLES holds those that are still there."""
    includes = {}
    for path, text in files.items():
        for match in INCLUDE.finditer(text):
            kind, header = match.groups()
            a, b = folder_of(path), folder_of(header)
            if kind == '"' and header in files and a != b:
                includes.setdefault(a, {}).setdefault(b, f"{path}:{line_of(text, match.start())}")
    known = {frozenset(group) for group in CIRCLES}
    for group in circles(includes):
        if group not in known:
            places = sorted(where for a in group for b, where in includes[a].items() if b in group)
            yield f"{places[0]}: the folders {', '.join(sorted(group))} include each other ({'; '.join(places[1:6])})"
    for group in known - set(circles(includes)):
        if all(folder in {folder_of(p) for p in files} for folder in group):
            yield f"tests/lint/lint.py: {', '.join(sorted(group))} include each other no more: take them out of CIRCLES"


def check_conventions(path, text):
    head = text.split("\n", 4)[:4]
    if not any("SPDX-License-Identifier: Apache-2.0" in line for line in head):
        yield f"{path}:1: no SPDX licence identifier in the first lines"
    if path.endswith(".hpp") and "#pragma once" not in text:
        yield f"{path}:1: a header without #pragma once"
    if path.endswith(SOURCES):
        for match in re.finditer(r"^\s*using namespace std\s*;", text, re.M):
            yield f"{path}:{line_of(text, match.start())}: using namespace std"


def check_shell(root, scripts):
    if not shutil.which("shellcheck"):
        return
    done = subprocess.run(["shellcheck", "-x", *scripts], cwd=root, capture_output=True, text=True)
    if done.returncode:
        yield from done.stdout.splitlines()


def check_layout(root, sources):
    """clang-format with the tree's file, and no other version than the one that laid it out."""
    program = shutil.which("clang-format-19")
    if not program:
        return
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        chunks = [sources[i:i + 40] for i in range(0, len(sources), 40)]
        runs = pool.map(lambda files: subprocess.run([program, "--dry-run", *files], cwd=root, capture_output=True, text=True), chunks)
        places = [line for run in runs for line in run.stderr.splitlines() if "clang-format-violations" in line]
    for path in sorted({line.split(":")[0] for line in places}):
        yield f"{path}: not laid out as .clang-format says: clang-format-19 -i {path}"


def check_named_files(root, path, text):
    """What a page names in code quotes as a file or folder of the project is there."""
    tops = {entry.name for entry in pathlib.Path(root).iterdir() if entry.is_dir() and entry.name not in ("build", "runs")}
    for match in NAMED.finditer(text):
        name = match.group(1)
        there = (pathlib.Path(root) / name).exists() or any((pathlib.Path(root) / name).parent.glob(pathlib.Path(name).name + ".*"))
        if name.split("/")[0] in tops and not there:
            yield f"{path}:{line_of(text, match.start())}: names '{name}', which is not there"


def lint(root):
    mistakes, scripts, sources, kinds = [], [], [], kinds_of(root)
    pages = {path: (pathlib.Path(root) / path).read_text(errors="replace") for path in project_files(root) if path.endswith(".md")}
    for path, text in pages.items():
        mistakes += check_named_files(root, path, text)
    mistakes += check_pages(root, pages)
    for path in project_files(root):
        is_source = path.endswith(SOURCES)
        is_script = path.endswith((".sh", ".py")) or path in ("gridspace", ".ci/run")
        if not is_source and not is_script:
            continue
        text = (pathlib.Path(root) / path).read_text(errors="replace")
        mistakes += check_conventions(path, text)
        if is_source:
            sources.append(path)
            mistakes += check_includes(root, path, text)
            mistakes += check_kinds(path, text, kinds) if path.startswith(SOLVERS) else []
        elif not path.endswith(".py"):
            scripts.append(path)
    mistakes += check_circles({s: (pathlib.Path(root) / s).read_text(errors="replace") for s in sources if not s.startswith(("tests/", "bench/"))})
    if (pathlib.Path(root) / ".clang-format").exists():
        mistakes += check_layout(root, sources)
    if scripts:
        mistakes += check_shell(root, scripts)
    return mistakes


NAMED = re.compile(r"`([a-z_]+/[A-Za-z0-9_./-]*[A-Za-z0-9_])/?`")
HEAD = "// SPDX-License-Identifier: Apache-2.0\n"
SELF_TESTS = [  # (file, text, a word of the expected message; None: nothing is wrong)
    ("common/a.cpp", '#include "sim/network/network.hpp"', "lower layers"),
    ("sim/network/a.cpp", '#include "bus/node.hpp"', "lower layers"),
    ("sim/emt/a.cpp", '#include "sim/components/line/line.hpp"', "knows faces"),
    ("sim/emt/a.cpp", '#include "sim/components/faces/two_port.hpp"', None),
    ("sim/phasor/a.cpp", "auto x = network_.lines.size();", "no kinds"),
    ("sim/network/a.cpp", "auto x = network_.lines.size();", None),
    ("sim/phasor/a.cpp", '#include "bus/lockstep/barrier.hpp"', None),
    ("bus/a.cpp", '#include "agents/ev/ev_agent.hpp"', "lower layers"),
    ("recorder/app/a.cpp", '#include "launcher/run/run.hpp"', "lower layers"),
    ("agents/ev/ev_logic.cpp", '#include "bus/node.hpp"', "lower layers"),
    ("agents/ev/ev_agent.cpp", '#include "bus/node.hpp"', None),
    ("agents/ev/ev_agent.cpp", '#include "sim/network/network.hpp"', "only in idl/"),
    ("sim/app/a.cpp", '#include "gateways/ethernet/socket.hpp"', "only in idl/"),
    ("sim/app/a.cpp", '#include "recorder/mcap/mcap_writer.hpp"', "recorder or the monitor"),


    ("bus/a.cpp", "#include <fastdds/dds/domain/DomainParticipant.hpp>", None),
    ("sim/emt/a.cpp", "#include <ida/ida.h>", "SUNDIALS"),




    ("sim/app/a.cpp", "#include <yaml-cpp/yaml.h>", "YAML"),
    ("sim/network/a.cpp", "#include <thread>", "pure core"),
    ("gateways/iec61850/a.cpp", "#include <sys/socket.h>", "pure core"),
    ("ids/a.cpp", "auto t = std::chrono::steady_clock::now();", "state and input"),
    ("ids/a.cpp", "// not by steady_clock", None),

]
PAGE_TREE = {  # what the pages below are looked at beside
    "launcher/cli/verbs.cpp": HEAD + 'app.add_subcommand("run", ""); verb->add_flag("--quiet");\n',
    "configs/a.yaml": "a: 1\n",
    "docs/other.md": "# Other\n## A `b`, and (c)\n",
    "mkdocs.yml": "nav:\n  - page.md\n  - other.md\n",
}
PAGE_TESTS = [  # (text of docs/page.md, a word of the expected message; None: nothing is wrong)
    ("[o](other.md#a-b-and-c), [here](#d)\n# D\n```\n./gridspace run configs/a.yaml --quiet && echo\n```\n", None),
    ("[o](another.md)\n", "'another.md', which is not there"),
    ("![o](images/none.svg)\n", "'images/none.svg', which is not there"),
    ('<img src="images/none.svg" width="420">\n', "'images/none.svg', which is not there"),
    ("[o](other.md#d)\n", "no heading"),
    ("see `gridspace\n walk` and [an\nother](none.md)\n", "`gridspace walk`: there is no such verb"),
    ("see [an\nother](none.md)\n", "page.md:1: links to 'none.md'"),
    ("    ./gridspace walk\n", "`gridspace walk`: there is no such verb"),
    ("```\n./gridspace run configs/b.yaml\n```\n", "names 'configs/b.yaml'"),
    ("```\n./gridspace run \\\n  configs/a.yaml --loud\n```\n", "no verb has this option"),
]


def self_test():
    wrong = 0
    for path, text, expected in SELF_TESTS:
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / path
            file.parent.mkdir(parents=True)
            file.write_text(HEAD + text + "\n")
            found = lint(folder)
        if (expected is None and found) or (expected is not None and not any(expected in m for m in found)):
            print(f"self-test: {path} with {text!r}: expected {expected}, found {found}")
            wrong += 1
    with tempfile.TemporaryDirectory() as folder:
        for path, header in (("sim/a/x.hpp", "sim/b/y.hpp"), ("sim/b/y.hpp", "sim/c/z.hpp"), ("sim/c/z.hpp", "sim/a/x.hpp")):
            (pathlib.Path(folder) / path).parent.mkdir(parents=True)
            (pathlib.Path(folder) / path).write_text(f'{HEAD}#pragma once\n#include "{header}"\n')
        if not any("include each other" in m for m in lint(folder)):
            print("self-test: a circle of three folders is not found")
            wrong += 1
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "sim").mkdir()
        (pathlib.Path(folder) / "sim/a.hpp").write_text(HEAD + "#pragma once\n")
        (pathlib.Path(folder) / "README.md").write_text("see `sim/a.hpp`, `sim/b.hpp` and `other/c`\n")
        if [m for m in lint(folder)] != ["README.md:1: names 'sim/b.hpp', which is not there"]:
            print("self-test: a file that a page names and that is not there is not found")
            wrong += 1
    with tempfile.TemporaryDirectory() as folder:
        for path, text in (("docs/images/made.png", ""), ("docs/images/drawn.png", ""), ("docs/page.md", "![a](images/made.png) ![b](images/drawn.png)\n"),
                           ("tests/e2e/a.mjs", HEAD + 'await picture(page, "made");\nawait picture(page, "unseen");\n')):
            (pathlib.Path(folder) / path).parent.mkdir(parents=True, exist_ok=True)
            (pathlib.Path(folder) / path).write_text(text)
        found = lint(folder)
        for expected in ("shows 'images/drawn.png', which no test", "makes the picture 'unseen'", "drawn.png:1: no test"):
            if not any(expected in m for m in found) or any("'made'" in m for m in found):
                print(f"self-test: {expected} is not found of pictures: {found}")
                wrong += 1
    for page, expected in PAGE_TESTS:
        with tempfile.TemporaryDirectory() as folder:
            for name, text in PAGE_TREE.items():
                (pathlib.Path(folder) / name).parent.mkdir(parents=True, exist_ok=True)
                (pathlib.Path(folder) / name).write_text(text)
            (pathlib.Path(folder) / "docs/page.md").write_text(page)
            found = lint(folder)
        if (expected is None and found) or (expected is not None and not any(expected in m for m in found)):
            print(f"self-test: the page {page!r}: expected {expected}, found {found}")
            wrong += 1
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "docs").mkdir()
        (pathlib.Path(folder) / "docs/lost.md").write_text("# Lost\n")
        (pathlib.Path(folder) / "mkdocs.yml").write_text("nav:\n  - gone.md\n")
        if len([m for m in lint(folder) if "navigation" in m]) != 2:
            print("self-test: a page that the site does not have, and one that is not there, are not found")
            wrong += 1
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "a.py").write_text("x = 1\n")
        if not any("SPDX" in m for m in lint(folder)):
            print("self-test: a missing licence is not found")
            wrong += 1
    print(f"{len(SELF_TESTS) + len(PAGE_TESTS) + 4} checks of the checks, {wrong} failed")
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--self-test", action="store_true")
    parser.add_argument("--root", default=ROOT, type=pathlib.Path)
    arguments = parser.parse_args()
    if arguments.self_test:
        return 1 if self_test() else 0
    mistakes = lint(arguments.root)
    for mistake in mistakes:
        print(mistake)
    print(f"lint: {len(mistakes)} mistakes" if mistakes else "lint: clean")
    return 1 if mistakes else 0


if __name__ == "__main__":
    sys.exit(main())
