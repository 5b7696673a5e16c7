#!/usr/bin/env python3
# mutants: plants single faults in src and counts those that the unit, property and golden tests find.
# SPDX-License-Identifier: MIT
"""usage: mutants.py [BUILD [N [SEED]]]     in the folder of the Makefile, after coverage.py; default build, 200, 1

Draws N faults: a line of src/**.c that some test runs, then a kind that the line allows, then a place. The changed
file lies in BUILD/mutants and goes before the library when a program of BUILD is linked, so one file is compiled and
the tree stays as it is. Only the programs that run the line are tried, until one fails. A fault that changes no byte of
the object file is `same`: no test can find it. A program that needs far more processor time than before has failed.
tests/coverage/equivalent.txt lists faults that change no promised result, and why; these are not tried.
Ends with the survivors. SLOWEST=S leaves out programs that took longer than S seconds in coverage.py; JOBS=J tries J
faults at once, 1 by default; FIRST=F leaves out the first F faults, to go on with a campaign.
"""
import collections
import concurrent.futures
import json
import math
import os
import random
import re
import shlex
import subprocess
import sys
import threading
from pathlib import Path

from coverage import is_good

RELATION = {"==": "!=", "!=": "==", "<": ">=", ">=": "<", ">": "<=", "<=": ">"}
BOUNDARY = {"<": "<=", "<=": "<", ">": ">=", ">=": ">"}
ARITHMETIC = {"+": "-", "-": "+", "*": "/", "/": "*", "%": "*", "<<": ">>", ">>": "<<",
              "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*="}
LOGIC = {"&&": "||", "||": "&&"}
PLACE = r"\*?\w+(?:->|\.|\w|\[[^\n;=]*?\])*"  # what an assignment may have on its left
STATEMENT = re.compile(rf"^ +((?:{PLACE} (?:[-+*/|&^]|<<|>>)?= |\w+\(|{PLACE}(?:\+\+|--))[^{{}};]*;)$", re.M)
ARRAY = re.compile(r"\b(?!return |else )\w+ \w+\[(\w+\]\[)*$")  # a declaration: a longer one is as good
NO_CODE = re.compile(r"""/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|^[ \t]*\#(?:[^\n]*\\\n)*[^\n]*""",
                     re.S | re.M)

TRAPS = ["-fsanitize=undefined", "-fsanitize-undefined-trap-on-error"]  # an index beyond its array ends the program

Site = collections.namedtuple("Site", "path line kind start end text")


def end_of_bracket(code, at):
    """Index behind the bracket that closes the one at `at`."""
    depth = 0
    while True:
        depth += {"(": 1, ")": -1}.get(code[at], 0)
        at += 1
        if depth == 0:
            return at


def changes(code):
    """Yields kind, start, end and new text of every fault that the code may get."""
    for kind, swaps in (("relation", RELATION), ("boundary", BOUNDARY), ("arithmetic", ARITHMETIC), ("logic", LOGIC)):
        for found in re.finditer(r"(?<= )[-+*/%<>=!&|]{1,2}(?= |$)", code, re.M):
            if found.group() in swaps:
                yield kind, found.start(), found.end(), swaps[found.group()]
    for found in re.finditer(r"(?<![\w.])(\d+)(\.\d+)?([uf]?)(?![\w.])", code):
        whole, fraction, suffix = found.groups("")
        if not ARRAY.search(code, code.rfind("\n", 0, found.start()) + 1, found.start()):
            yield "constant", found.start(), found.end(), f"{int(whole) + 1}{fraction}{suffix}"
    for found in re.finditer(r"\bif (?=\()", code):
        end = end_of_bracket(code, found.end())
        yield "condition", found.end(), end, f"(!{code[found.end():end]})"
    for found in STATEMENT.finditer(code):
        yield "statement", found.start(1), found.end(1), ";"
    for found in re.finditer(r"\breturn ([^;]+);", code):
        yield "return", found.start(1), found.end(1), f"!({found.group(1)})"


def sites_by_line(covered):
    """Lists of sites by file and line, of the covered lines only."""
    sites = collections.defaultdict(list)
    for path in sorted(path for path in covered if path.endswith(".c")):
        text = Path(path).read_text()
        code = NO_CODE.sub(lambda found: re.sub(r"[^\n]", " ", found.group()), text)
        for kind, start, end, new in changes(code):
            line = text.count("\n", 0, start) + 1
            if line in covered[path]:
                sites[path, line].append(Site(path, line, kind, start, end, new))
    return sites


def draw(sites, count, seed):
    """Each covered line is as likely as another, and so is each kind on it."""
    chance = random.Random(seed)
    lines = sorted(sites)
    drawn = []
    count = min(count, sum(map(len, sites.values())))
    while len(drawn) < count:
        here = sites[chance.choice(lines)]
        kind = chance.choice(sorted({site.kind for site in here}))
        site = chance.choice([site for site in here if site.kind == kind])
        if site not in drawn:
            drawn.append(site)
    return drawn


class Bench:
    """A built tree, and the commands that made its parts."""

    def __init__(self, folder, programs, equivalent):
        self.folder = folder
        self.programs = programs
        self.equivalent = equivalent
        self.sound = {}  # bytes of each unchanged object
        self.kills = collections.Counter()
        make = [os.environ.get("MAKE", "make"), f"BUILD={folder}"] + [f"{folder}/{name}" for name in programs]
        environment = {name: value for name, value in os.environ.items() if name not in ("MAKEFLAGS", "MFLAGS")}
        subprocess.run(make + ["-s"], check=True, env=environment)
        said = subprocess.run(make + ["-nB", "V=1"], check=True, env=environment, stdout=subprocess.PIPE, text=True)
        self.commands = {}
        for line in said.stdout.replace("\\\n", " ").splitlines():
            words = shlex.split(line) if " -o " in line else []
            if "-o" in words:
                self.commands[words[words.index("-o") + 1]] = words

    def scratch(self):
        """The folder of this thread."""
        name = f"{self.folder}/mutants/{threading.get_ident()}"
        os.makedirs(name, exist_ok=True)
        return name

    def compile(self, path, text):
        """The bytes of the object file, or None. It stays as mutant.o. Any optimisation gives the same results."""
        source, target = f"{self.scratch()}/mutant.c", f"{self.scratch()}/mutant.o"
        Path(source).write_text(text)
        had = f"{self.folder}/obj/{path[:-2]}.o"
        words = [{path: source, had: target}.get(word, word) for word in self.commands[had] if word[:2] not in ("-W", "-M")]
        words += ["-O2", "-g0", "-w", "-iquote", os.path.dirname(path)] + TRAPS
        if subprocess.run(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode != 0:
            return None
        return Path(target).read_bytes()

    def passes(self, name):
        """Links the program with mutant.o and runs it."""
        target = f"{self.scratch()}/mutant"
        words = list(self.commands[f"{self.folder}/{name}"])
        at = words.index("-o")
        words[at:at + 2] = ["-o", target, f"{target}.o"]
        if subprocess.run(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode != 0:
            return False
        seconds = self.programs[name]["seconds"]
        limits = ["timeout", "-s", "KILL", str(60 + 30 * seconds), "prlimit", f"--cpu={3 + math.ceil(4 * seconds)}",
                  "--core=0", f"--as={4 << 30}"]
        done = subprocess.run(limits + [target], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL)
        return is_good(name, done)

    def order(self, site):
        """The programs that run the line: quick ones, those named like the file and those that found faults in it come first."""
        words = set(re.split(r"[/_.]", site.path)) - {"src", "c"}

        def cost(name):
            alike = len(words.intersection(re.split(r"[/_]", name)))
            found = 5 * self.kills[name, site.path] + 0.2 * self.kills[name, ""]
            return (0.1 + self.programs[name]["seconds"]) / (1 + 10 * alike + found), name

        runs_line = lambda name: site.line in self.programs[name]["lines"].get(site.path, ())
        return sorted(filter(runs_line, self.programs), key=cost)

    def judge(self, site):
        """Returns the verdict and the program that found the fault."""
        if site in self.equivalent:
            return "equivalent", ""
        text = Path(site.path).read_text()
        if site.path not in self.sound:
            self.sound[site.path] = self.compile(site.path, text)
        got = self.compile(site.path, text[:site.start] + site.text + text[site.end:])
        if got is None:
            return "not compiled", ""
        if got == self.sound[site.path]:
            return "same", ""
        for name in self.order(site):
            if not self.passes(name):
                self.kills.update([(name, site.path), (name, "")])
                return "killed", name
        return "survived", ""


def change_and_line(site):
    text = Path(site.path).read_text()
    squeeze = lambda part: " ".join(part.split())
    return f"{squeeze(text[site.start:site.end])} -> {squeeze(site.text)}", squeeze(text.split("\n")[site.line - 1])


def describe(site):
    change, line = change_and_line(site)
    return f"{site.path}:{site.line}: {site.kind}: {change}   in: {line}"


def equivalents(sites):
    """The sites of the rows `source|>change|>words of the line|>number among such sites, or *|>why`. Each row must fit."""
    found = set()
    for row in Path("tests/coverage/equivalent.txt").read_text().splitlines():
        if row.startswith("#"):
            continue
        source, change, words, number, _ = row.split("|>")
        fits = [site for site in sites if site.path == f"src/{source}" and change_and_line(site)[0] == change
                and words in change_and_line(site)[1]]
        fits = fits if number == "*" else fits[int(number) - 1:int(number)]
        if not fits:
            sys.exit(f"tests/coverage/equivalent.txt fits nothing: {row}")
        found.update(fits)
    return found


def processor_seconds():
    now = os.times()
    return now.children_user + now.children_system


def main():
    folder, count, seed = (sys.argv[1:] + ["build", "200", "1"][len(sys.argv) - 1:])[:3]
    programs = json.loads(Path(f"{folder}/coverage/map.json").read_text())
    slowest = float(os.environ.get("SLOWEST", "inf"))
    left_out = [name for name in programs if programs[name]["seconds"] > slowest]
    programs = {name: ran for name, ran in programs.items() if name not in left_out}
    covered = collections.defaultdict(set)
    for ran in programs.values():
        for path, lines in ran["lines"].items():
            covered[path].update(lines)
    sites = sites_by_line(covered)
    bench = Bench(folder, programs, equivalents([site for path_line in sorted(sites) for site in sites[path_line]]))
    verdicts, survivors, start = collections.Counter(), [], processor_seconds()
    with concurrent.futures.ThreadPoolExecutor(int(os.environ.get("JOBS", "1"))) as threads:
        first = int(os.environ.get("FIRST", "0"))
        drawn = draw(sites, int(count), int(seed))[first:]
        tries = {threads.submit(bench.judge, site): number for number, site in enumerate(drawn, first + 1)}
        for done in concurrent.futures.as_completed(tries):
            site, (verdict, killer) = drawn[tries[done] - first - 1], done.result()
            verdicts[verdict] += 1
            if verdict == "survived":
                survivors.append(site)
            print(f"{tries[done]}: {verdict} {killer}   {describe(site)}", flush=True)
    tried = verdicts["killed"] + verdicts["survived"]
    print(f"\nsurvivors, seed {seed}; not run: {' '.join(left_out) or 'no program'}")
    for site in sorted(survivors):
        print(describe(site))
    print(f"{tried} mutants: {verdicts['killed']} killed ({100 * verdicts['killed'] / max(tried, 1):.1f} %), "
          f"{verdicts['survived']} survived; besides {verdicts['equivalent']} equivalent, {verdicts['same']} of the same code, "
          f"{verdicts['not compiled']} not compiled; {(processor_seconds() - start) / max(sum(verdicts.values()), 1):.1f} s of the processor each")


if __name__ == "__main__":
    sys.exit(main())
