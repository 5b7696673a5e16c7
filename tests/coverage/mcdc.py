#!/usr/bin/env python3
# mcdc: modified condition/decision coverage of src by the unit, property and golden tests, from clang's instrumentation.
# SPDX-License-Identifier: MIT
"""usage: mcdc.py [BUILD]     in the folder of the Makefile; BUILD is the build directory, build

A condition counts where two runs of its decision show that it alone changes the outcome. tests/coverage/justified.txt
lists conditions that no run can show, `source|words of the decision|condition, from 1, or *|why`, * as source for all,
^ before words with which the decision begins; a line there that fits no uncovered condition fails. BUILD/mcdc/missed.txt
lists what is neither covered nor justified. Needs clang and llvm from version 19 on; CLANG, LLVM_COV and LLVM_PROFDATA
name others. Decisions that clang does not instrument, because another decision stands within one of their conditions,
are counted apart.
"""
import functools
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from coverage import find_programs

CLANG = os.environ.get("CLANG", "clang-19")
COV = os.environ.get("LLVM_COV", "llvm-cov-19")
PROFDATA = os.environ.get("LLVM_PROFDATA", "llvm-profdata-19")
LIST = "tests/coverage/justified.txt"


def build(folder, programs):
    """Instruments the core alone. Returns the decisions that clang leaves out, as lines of its warnings."""
    make = [os.environ.get("MAKE", "make"), "-s", f"BUILD={folder}", "CC=" + CLANG]
    environment = {name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MFLAGS", "CFLAGS")}
    left_out = Path(folder) / "left_out.txt"
    os.makedirs(folder, exist_ok=True)
    done = subprocess.run(make + ["CFLAGS=-O1 -fprofile-instr-generate -fcoverage-mapping -fcoverage-mcdc",
                                  f"{folder}/libsmr.a"], env=environment, stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr)
    warned = {line.split(": warning:")[0] for line in done.stderr.splitlines() if "unsupported MC/DC" in line}
    if warned:
        left_out.write_text("".join(line + "\n" for line in sorted(warned)))
    subprocess.run(make + ["CFLAGS=-O1 -w", "LDFLAGS=-fprofile-instr-generate"] + [f"{folder}/{name}" for name in programs],
                   check=True, env=environment)
    return left_out.read_text().splitlines() if left_out.exists() else []


def run(folder, programs):
    """Runs what has not run since it was built; returns the profiles."""
    profiles = []
    os.makedirs(f"{folder}/raw", exist_ok=True)
    for name in programs:
        profile = Path(f"{folder}/raw/{name.replace('/', '_')}.profraw")
        if not profile.exists() or profile.stat().st_mtime < Path(f"{folder}/{name}").stat().st_mtime:
            done = subprocess.run(["timeout", "1800", f"{folder}/{name}"], stdin=subprocess.DEVNULL,
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                  env={**os.environ, "LLVM_PROFILE_FILE": str(profile)})
            if done.returncode != 0:
                print(f"{name} fails: what it ran counts here")
        if profile.exists():
            profiles.append(str(profile))
    return profiles


@functools.lru_cache(maxsize=None)
def words_of(path, line, column, last, end):
    rows = Path(path).read_text().split("\n")[line - 1:last]
    if not rows:
        return ""
    rows[-1] = rows[-1][:end - 1]
    rows[0] = rows[0][column - 1:]
    return " ".join(" ".join(rows).split())


def decisions(folder, profiles):
    """Yields source, first line, text and flags of the conditions of each decision; an inline function's runs add up."""
    merged = f"{folder}/all.profdata"
    subprocess.run([PROFDATA, "merge", "-sparse", "-o", merged] + profiles, check=True)
    whole = f"{folder}/whole"
    Path(f"{whole}.c").write_text("int main(void) { return 0; }")
    subprocess.run([CLANG, "-fprofile-instr-generate", f"{whole}.c", "-Wl,--whole-archive", f"{folder}/libsmr.a",
                    "-Wl,--no-whole-archive", "-lm", "-o", whole], check=True)
    text = subprocess.run([COV, "export", "-instr-profile", merged, whole], check=True,
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
    found = {}
    for function in json.loads(text)["data"][0]["functions"]:
        for record in function["mcdc_records"]:
            # clang names the file that uses a macro, and the place in the file that defines it
            names = [os.path.relpath(name) for name in [function["filenames"][record[4]]] + function["filenames"]]
            key = next(((name, *record[:4]) for name in names if re.search(r"&&|\|\|", words_of(name, *record[:4]))),
                       (names[0], *record[:4]))
            flags = record[-1]
            had = found.setdefault(key, [False] * len(flags))
            found[key] = [a or b for a, b in zip(had, flags)]
    for key, flags in sorted(found.items()):
        yield key[0], key[1], words_of(*key), flags


def row_fits(row, path, text, number):
    source, words, condition = row[:3]
    begins = words[0] == "^"
    return (source == "*" or path.endswith("/" + source)) and condition in ("*", number) and \
        (text.startswith(words[1:]) if begins else words in text)


def main():
    for tool in (CLANG, COV, PROFDATA):
        if shutil.which(tool) is None:
            print(f"MC/DC: skip: needs {tool}")
            return 0
    folder = (sys.argv[1] if len(sys.argv) > 1 else "build") + "/mcdc"
    programs = find_programs()
    left_out = build(folder, programs)
    rows = [row.split("|") for row in Path(LIST).read_text().splitlines() if row and row[0] != "#"]
    used = [False] * len(rows)
    total = covered = justified = n_decisions = 0
    missed = []
    for path, line, text, flags in decisions(folder, run(folder, programs)):
        n_decisions += 1
        for number, flag in enumerate(flags, 1):
            total += 1
            covered += flag
            fits = [i for i, row in enumerate(rows) if row_fits(row, path, text.replace("|", "/"), str(number))]
            if not flag:
                justified += bool(fits)
                for i in fits:
                    used[i] = True
                if not fits:
                    missed.append(f"{path}:{line}: condition {number} of {len(flags)}: {text}\n")
    Path(f"{folder}/missed.txt").write_text("".join(missed))
    print(f"MC/DC: {covered} of {total} conditions in {n_decisions} decisions, {100 * covered / total:.2f} %; with "
          f"{justified} justified ones {100 * (covered + justified) / total:.2f} %; {len(left_out)} decisions not "
          f"instrumented; the rest: {folder}/missed.txt")
    for row, fits in zip(rows, used):
        if not fits:
            print(f"not ok {LIST}: nothing uncovered fits {row[0]}|{row[1]}|{row[2]}")
    return 0 if all(used) else 1


if __name__ == "__main__":
    sys.exit(main())
