#!/usr/bin/env python3
# coverage: lines and branches of src that the unit, property and golden tests run, and which program runs which line.
# SPDX-License-Identifier: MIT
"""usage: coverage.py [BUILD]     in the folder of the Makefile of any version; BUILD is the build directory, build

Prints a table by folder. BUILD/coverage/missed.txt lists the lines and branches that no program ran;
BUILD/coverage/map.json has the lines and the seconds of each program, for mutants.py.
A branch is one outcome of one condition: `a && b` has four. This is condition coverage, which does not show that each
condition alone decides; that would be MC/DC, which gcc has from version 14 on. CC (gcc) and GCOV (gcov) must be of one
version.
"""
import collections
import glob
import json
import os
import resource
import subprocess
import sys
from pathlib import Path


RECORDED = {"golden": "expected.txt", "answers": "answers.txt"}  # programs whose words tests/golden has


def find_programs():
    """Names of the test programs below the build directory."""
    sources = sum((sorted(glob.glob(f"tests/{kind}/test_*.c")) for kind in ("unit", "property", "golden")), [])
    return [*RECORDED] + [path[:-len(".c")] for path in sources]


def build(folder, programs):
    """The core is instrumented; the rest is optimised as ever, because loops over the oracle take long."""
    make = [os.environ.get("MAKE", "make"), "-s", f"BUILD={folder}", "CC=" + os.environ.get("CC", "gcc")]
    environment = {name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MFLAGS", "CFLAGS")}
    for rest in (["CFLAGS=-O1 --coverage", f"{folder}/libsmr.a"],
                 ["CFLAGS=", "LDFLAGS=--coverage"] + [f"{folder}/{name}" for name in programs]):
        subprocess.run(make + rest, check=True, env=environment)


def run(folder, name):
    done = subprocess.run(["timeout", "1800", f"{folder}/{name}"], stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    return is_good(name, done)


def is_good(name, done):
    """True if the run ended with 0 and said the recorded words, if there are any."""
    said = name not in RECORDED or done.stdout == Path("tests/golden", RECORDED[name]).read_bytes()
    return done.returncode == 0 and said


def read_counts(files):
    """Yields file, line, count and the counts of the line's branches, from gcov's notes or counters."""
    if not files:
        return
    command = [os.environ.get("GCOV", "gcov"), "--json-format", "--stdout", "--branch-probabilities"] + files
    text = subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout
    for document in text.splitlines():
        for source in json.loads(document)["files"]:
            path = os.path.normpath(source["file"])
            if path.startswith("src/"):
                for line in source["lines"]:
                    yield path, line["line_number"], line["count"], [branch["count"] for branch in line["branches"]]


class Totals:
    """What any program ran. The same line in several objects, as of an inline function, counts once."""

    def __init__(self):
        self.lines = collections.defaultdict(bool)     # (path, line)
        self.branches = collections.defaultdict(bool)  # (path, line, index)

    def add(self, files):
        """Returns the lines run, by file."""
        ran = collections.defaultdict(set)
        for path, line, count, branches in read_counts(files):
            self.lines[path, line] |= count > 0
            for index, taken in enumerate(branches):
                self.branches[path, line, index] |= taken > 0
            if count > 0:
                ran[path].add(line)
        return {path: sorted(lines) for path, lines in ran.items()}

    def table(self):
        sums = collections.defaultdict(lambda: [0, 0, 0, 0])
        for column, flags in ((0, self.lines), (2, self.branches)):
            for key, covered in flags.items():
                for name in (os.path.dirname(key[0]), "all"):
                    sums[name][column] += covered
                    sums[name][column + 1] += 1
        for name in sorted(sums, key=lambda name: (name == "all", name)):
            a, b, c, d = sums[name]
            yield (f"{name:40} lines {a:6}/{b:<6} {100 * a / b:6.2f} %   "
                   f"branches {c:6}/{d:<6} {100 * c / max(d, 1):6.2f} %")

    def missed(self):
        untaken = collections.Counter(key[:2] for key, covered in self.branches.items() if not covered)
        for (path, line), covered in sorted(self.lines.items()):
            if not covered:
                yield f"{path}:{line}: not run"
            elif untaken[path, line]:
                yield f"{path}:{line}: {untaken[path, line]} branches not taken"


def main():
    folder = (sys.argv[1] if len(sys.argv) > 1 else "build") + "/coverage"
    programs = find_programs()
    build(folder, programs)
    counters = lambda: sorted(glob.glob(f"{folder}/obj/src/**/*.gcda", recursive=True))
    for path in counters():
        os.remove(path)
    totals = Totals()
    totals.add(sorted(glob.glob(f"{folder}/obj/src/**/*.gcno", recursive=True)))  # also what no program links
    ran, failed = {}, 0
    for name in programs:
        start = resource.getrusage(resource.RUSAGE_CHILDREN)
        passed = run(folder, name)
        end = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = end.ru_utime + end.ru_stime - start.ru_utime - start.ru_stime  # of the processor
        lines = totals.add(counters())
        if passed:
            ran[name] = {"seconds": round(seconds, 3), "lines": lines}
        else:
            failed += 1
            print(f"{name} fails: its lines count here, but mutants.py does not run it")
        for path in counters():
            os.remove(path)
    with open(f"{folder}/missed.txt", "w") as out:
        out.writelines(line + "\n" for line in totals.missed())
    with open(f"{folder}/map.json", "w") as out:
        json.dump(ran, out)
    print("\n".join(totals.table()))
    print(f"{len(programs)} programs, {failed} failed; what none ran: {folder}/missed.txt")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
