"""misra.py: findings of cppcheck's MISRA C:2012 addon over src against the deviations that docs/safety/MISRA.md declares.

usage: misra.py FOLDER [AMALGAMATION]   FOLDER gets misra.txt, all findings as "RULE FILE LINE TEXT"

The library is looked at as one source, as amalgamate.sh writes it: each header counts once, and rules across sources see all of
them. Of each rule at most one finding counts on a line. Needs cppcheck with its addons; the form of the addon is that of 2.10.

SPDX-License-Identifier: MIT
"""
import glob
import os
import re
import subprocess
import sys

TABLE = "docs/safety/MISRA.md"


def one_source(folder):
    """Writes the amalgamation with its renaming macros carried out, which are no part of src; returns its lines."""
    subprocess.check_call(["sh", "port/package/amalgamate.sh", folder])
    path = os.path.join(folder, "smr.c")
    with open(path, encoding="utf-8") as file:
        lines = file.read().split("\n")
    renamed = {}
    for i, line in enumerate(lines):
        macro = re.match(r"#define ([a-z]\w*) (\w+_[ch]_\1)$", line)
        if macro:
            renamed[macro[1]] = macro[2]
            lines[i] = ""
        elif re.match(r"#undef [a-z]\w*$", line) and line[7:] in renamed:
            del renamed[line[7:]]
            lines[i] = ""
        elif renamed:
            lines[i] = re.sub(r"\b(" + "|".join(renamed) + r")\b", lambda word: renamed[word[0]], line)
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(lines))
    return lines


def load_addon():
    """The addon's module, with two look-ups replaced that take hours on one large source."""
    places = {}

    def at_place(tokens, token):
        if not places:
            for raw in tokens:
                places.setdefault((raw.file, raw.linenr), []).append(raw)
        return places.get((token.file, token.linenr), [])

    found = glob.glob("/usr/lib/*/cppcheck/addons/misra.py") + glob.glob("/usr/*/cppcheck/addons/misra.py") + \
        glob.glob("/usr/local/*/cppcheck/addons/misra.py")
    if not found:
        print("skip: needs cppcheck's addons")
        sys.exit(77)
    sys.path.insert(0, os.path.dirname(found[0]))
    with open(found[0], encoding="utf-8") as file:
        source = file.read()
    slow = "            for rawToken in rawTokens:\n                if (rawToken.file == token.file and"
    source = source.replace(slow, slow.replace("in rawTokens:", "in at_place(rawTokens, token):"))
    module = {"__name__": "misra", "__file__": found[0], "at_place": at_place}
    exec(compile(source, "misra.py", "exec"), module)
    checker = module["MisraChecker"]
    for name in dir(checker):
        if name.startswith("_save_ctu_summary"):
            setattr(checker, name, lambda *_: None)  # for rules between sources, of which there is one
    return module


def findings(folder):
    """The set of (rule, file, line)."""
    module = load_addon()
    dump = os.path.join(folder, "smr.c")
    subprocess.check_call(["cppcheck", "--std=c11", "-q", "--dump", "--max-configs=1", "--platform=unix64", dump],
                          stderr=subprocess.DEVNULL)
    found = set()
    module["MisraChecker"].reportError = lambda self, place, chapter, rule: found.add(
        (f"{chapter}.{rule}", os.path.basename(place.file), int(place.linenr)))
    arguments, sys.argv = sys.argv, ["misra.py", "--quiet", dump + ".dump"]
    checker = module["MisraChecker"](module["MisraSettings"](module["get_args_parser"]().parse_args()))
    sys.argv = arguments
    checker.parseDump(dump + ".dump")
    return found


def main():
    folder = sys.argv[1]
    os.makedirs(folder, exist_ok=True)
    text = {"smr.c": one_source(folder)}
    with open("include/smr.h", encoding="utf-8") as file:
        text["smr.h"] = file.read().split("\n")
    counts, shown = {}, {}
    for rule, file, line in sorted(findings(folder), key=lambda f: ([int(n) for n in f[0].split(".")], f[1], f[2])):
        words = text.get(file, [""] * line)[line - 1].strip()
        if rule == "20.5" and not words.startswith("#undef SMR_SETTING") and not words.startswith("#undef SMR_GROUP"):
            continue  # the amalgamation ends each source's macros
        counts[rule] = counts.get(rule, 0) + 1
        shown.setdefault(rule, []).append(f"{rule} {file} {line} {words}")
    with open(os.path.join(folder, "misra.txt"), "w", encoding="utf-8") as file:
        file.writelines(line + "\n" for rule in shown for line in shown[rule])
    with open(TABLE, encoding="utf-8") as file:
        declared = {row[1]: int(row[2].replace(",", "")) for row in
                    re.finditer(r"^\| D-[\d.]+ \| ([\d.]+) \| \w+ \| ([\d,]+) \|", file.read(), re.M)}
    failed = 0
    for rule, count in counts.items():
        most = declared.get(rule)
        if most is None or count > most:
            failed += 1
            print("\n".join("#   " + line for line in shown[rule][-5:]))
            print(f"not ok rule {rule}: {count} findings, " + ("no deviation is declared" if most is None else f"{most} declared"))
    for rule in declared:
        if rule not in counts:
            failed += 1
            print(f"not ok rule {rule}: a deviation is declared, and nothing is found")
    print(" ".join(f"{rule}:{count}" for rule, count in counts.items()))
    print(f"{len(counts)} rules, {sum(counts.values())} findings, listed in {folder}/misra.txt")
    print(f"{len(counts) - min(failed, len(counts))} passed, {failed} failed, 0 skipped")
    return failed != 0


sys.exit(main())
