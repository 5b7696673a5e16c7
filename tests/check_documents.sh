#!/bin/sh
# check_documents: documents keep to their sizes, a result stands in docs/RESULTS.md alone, links lead somewhere, and README's
# table is the one that RESULTS makes.
# SPDX-License-Identifier: MIT
# usage: check_documents.sh [ROOT]     the last line is the sum
set -u
export LC_ALL=C
cd "${1:-.}" || exit 1
[ -f README.md ] && [ -f docs/RESULTS.md ] || { echo "skip: no README.md or docs/RESULTS.md"; exit 77; }
passed=0; failed=0
ok() { passed=$((passed + 1)); }
fail() { echo "not ok $*"; failed=$((failed + 1)); }

# ---------------------------------------------------------------- sizes

limit() { # file, bytes, lines
    bytes=$(wc -c <"$1"); lines=$(wc -l <"$1")
    echo "$1: $((bytes)) of $2 bytes, $((lines)) of $3 lines"
    if [ "$bytes" -gt "$2" ] || [ "$lines" -gt "$3" ]; then fail "$1 is longer than $2 bytes or $3 lines"; else ok; fi
}
limit README.md 7000 130
limit docs/DESIGN.md 30000 363
all=$(cat README.md CHANGELOG.md docs/*.md .github/*.md .github/*/*.md docs/examples/*/*.md tests/*/*.md 2>/dev/null | wc -c)
echo "all documents: $((all)) of 244000 bytes"
if [ "$all" -le 244000 ]; then ok; else fail "the documents are longer than 244000 bytes together"; fi
safety=$(cat docs/safety/*.md | wc -c)
echo "docs/safety: $((safety)) of 60000 bytes"
if [ "$safety" -le 60000 ]; then ok; else fail "docs/safety is longer than 60000 bytes"; fi

# Lines of at most 120 characters; tables, pictures and code may be longer, but in DESIGN nothing may.
for file in README.md docs/*.md docs/safety/*.md; do
    long=$(awk -v all="$([ "$file" = docs/DESIGN.md ] && echo 1)" '
        /^ *```/ { code = !code }
        length($0) > 120 && (all || (!code && !/^ *[|!]/ && !/^     /)) { print FILENAME ":" FNR ": " length($0) " characters" }' "$file")
    [ "$file" = docs/RESULTS.md ] && long= # written by a command
    if [ -n "$long" ]; then echo "$long"; fail "$file: lines longer than 120 characters"; else ok; fi
done

# ---------------------------------------------------------------- one result, one place

# A result with two digits after the point is looked for with its unit behind it, or behind the number after a slash;
# one with three digits or more wherever it stands; "a / b" as a whole. Zero and numbers of fewer digits say nothing.
# In what tells how to do something single numbers may be alike by chance, so only "a / b" is looked for: both directions.
copies() { # all|pairs, document...
    what=$1; shift
    awk -v what="$what" '
        function escape(text) { gsub(/[.]/, "[.]", text); return text }
        function look(key, text, end) {
            if (text in known) return
            known[text] = 1
            of[++keys] = key; shown[keys] = text
            pattern[keys] = "(^|[^0-9.,+-])" escape(text) end
        }
        function look_pair(key, text) { if (text ~ /[.][0-9][0-9]/) look(key, text, "([^0-9.]|[.]?$|[.][^0-9])") }
        FILENAME == ARGV[1] {
            if ($0 !~ /^\| `/) next
            split($0, field, "|")
            key = field[2]; gsub(/[` ]/, "", key)
            if (key == "example.prints") next
            result = field[4]; gsub(/^ +| +$/, "", result)
            unit = result; gsub(/\([^)]*\)/, "", unit); gsub(/^[0-9. \/e-]+| +$/, "", unit)
            n = split(result, word, /[ \/]+/)
            if (result ~ /^[0-9.]+ \/ [0-9.]+/) look_pair(key, word[1] " / " word[2])
            if (key ~ /[.]mean_to$/) { first = word[1]; from = key; sub(/to$/, "from", from) }
            if (key == from) look_pair(key, first " / " word[1])
            for (i = 1; i <= n && what == "all"; i++) {
                if (word[i] !~ /^[0-9]+[.][0-9][0-9]+$/ || word[i] + 0 == 0) continue
                if (length(word[i]) - index(word[i], ".") > 2) look(key, word[i], "([^0-9.]|[.]?$|[.][^0-9])")
                else if (unit != "") look(key, word[i], "( / [0-9.]+)? " unit "([^a-z]|$)")
            }
            next
        }
        FNR == 1 { made = 0 }
        /^<!-- results -->$/ { made = 1 }
        /^<!-- \/results -->$/ { made = 0 }
        !made && /[0-9][.][0-9][0-9]/ {
            for (k = 1; k <= keys; k++)
                if ($0 ~ pattern[k]) { print FILENAME ":" FNR ": " shown[k] " is " of[k] " in docs/RESULTS.md"; bad = 1 }
        }
        END { print keys + 0 " numbers looked for"; exit bad }' docs/RESULTS.md "$@"
}
if copies all README.md docs/DESIGN.md docs/SPEC.md docs/PORTING.md docs/TIMING.md docs/TESTING.md; then ok
else fail "a result stands in two documents: name its key instead"; fi
if copies pairs docs/GUIDE.md docs/TUTORIAL.md CHANGELOG.md; then ok; else fail "a pair of results stands in two documents"; fi

# The search finds what it must: a copy in each form, and not a number that only begins or ends alike.
planted=$(mktemp) || exit 1
trap 'rm -f "$planted"' EXIT
one=$(awk -F '[|]' '/^\| `femur_pair.mean_to`/ { split($4, w, " "); print w[1] }' docs/RESULTS.md)
two=$(awk -F '[|]' '/^\| `demo.surface_before`/ { split($4, w, " "); print w[1] }' docs/RESULTS.md)
for text in "mean $one mm" "$one / 9.999" "| 9.999 / $one |" "$two mm" "$two / 9.99 mm"; do
    echo "$text" >"$planted"
    if copies all "$planted" >/dev/null; then fail "a copy is not found: $text"; else ok; fi
done
for text in "1$one" "${one}5" "-$one"; do
    echo "$text" >"$planted"
    if copies all "$planted" >/dev/null; then ok; else fail "not a copy, but taken for one: $text"; fi
done

pair=$(awk -F '[|]' '/^\| `femur_pair.mean_/ { split($4, w, " "); p = p (p == "" ? "" : " / ") w[1] } END { print p }' docs/RESULTS.md)
echo "| the defaults | $pair |" >"$planted"
if copies pairs "$planted" >/dev/null; then fail "a pair is not found: $pair"; else ok; fi

# ---------------------------------------------------------------- names of results, links, README's table

# `section.key` and RESULTS (`section`): what documents name must be there.
for name in $(sed -n 's/^<a id="\([a-z0-9_]*\)">.*/\1/p' docs/RESULTS.md); do echo "$name"; done >"$planted"
named=$(cat README.md docs/*.md docs/safety/*.md | tr '\n' ' ' | grep -oE 'RESULTS(\]\([^)]*\))?(, |'"'"'s? | \()`[a-z0-9_]+`(, `[a-z0-9_]+`)*' | grep -oE '`[a-z0-9_]+`' | tr -d '`' | sort -u)
for name in $named; do
    if grep -qx "$name" "$planted"; then ok; else fail "$name is named, but no section of docs/RESULTS.md"; fi
done

# Files and constants that documents name are there. CHANGELOG tells of the past.
find src include port tests fixtures docs .ci Makefile -type f >"$planted"
for file in README.md docs/DESIGN.md docs/SPEC.md docs/PORTING.md docs/TIMING.md docs/TESTING.md docs/safety/*.md; do
    lost=
    for name in $(grep -oE '`[A-Za-z_0-9/.]+\.(c|h|sh|txt|awk|inc)`' "$file" | tr -d '`' | grep -v '^DIR/\|NAME' | sort -u); do
        grep -qE "(^|/)$name\$" "$planted" || lost="$lost $name"
    done
    for name in $(grep -oE '`SMR_[A-Z0-9_]+`' "$file" | tr -d '`' | grep -v '_$' | sort -u); do
        grep -rqw -- "$name" src include port tests Makefile || lost="$lost $name"
    done
    if [ -n "$lost" ]; then fail "$file names what is not there:$lost"; else ok; fi
done

# The anchor that a heading gets, and those written out.
anchors() {
    sed -n 's/.*<a id="\([^"]*\)">.*/\1/p; s/^##* //p' "$1" | tr '[:upper:] ' '[:lower:]-' | tr -cd 'a-z0-9_\n-'
}
for file in README.md CHANGELOG.md docs/*.md docs/safety/*.md; do
    for link in $(grep -oE '\]\([^) ]+\)' "$file" | sed 's/^](//; s/)$//' | grep -vE '^(https?|mailto):' | sort -u); do
        path=${link%%#*}
        at=$(dirname "$file")/$path
        [ -n "$path" ] || at=$file
        if [ ! -e "$at" ]; then fail "$file: $link leads nowhere"
        elif [ "$link" != "$path" ] && ! anchors "$at" | grep -qx "${link#*#}"; then fail "$file: no such place: $link"
        else ok; fi
    done
done

if sh tests/results/readme_table.sh --check; then ok; else fail "README's table is not what RESULTS says: make results-short"; fi
echo "$passed passed, $failed failed, 0 skipped"
[ "$failed" -eq 0 ]
