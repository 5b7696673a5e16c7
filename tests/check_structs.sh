#!/bin/sh
# check_structs: no struct or union in a header of the runtime has more than 40 members.
# SPDX-License-Identifier: MIT
# `float a, b[3];` is two members; those of an unnamed struct or union count for the struct around it.
set -u

tmp=$(mktemp) || exit 1
trap 'rm -f "$tmp"' EXIT
find src/registration src/options src/log src/verdict -name '*.h' | sort | xargs awk '
    # The line without comments; "comment" tells whether one is open at its end.
    function code_of(line,    kept, at) {
        kept = ""
        while (line != "") {
            at = index(line, comment ? "*/" : "/*")
            if (!comment) kept = kept (at ? substr(line, 1, at - 1) " " : line)
            line = at ? substr(line, at + 2) : ""
            if (at) comment = !comment
        }
        return kept
    }
    # How many names a declaration declares: commas outside of brackets, and one.
    function names_in(declaration) {
        while (match(declaration, /\([^()]*\)|\[[^][]*\]/))
            declaration = substr(declaration, 1, RSTART - 1) substr(declaration, RSTART + RLENGTH)
        return gsub(/,/, ",", declaration) + 1
    }
    function judge(title, n) {
        ++structs
        gsub(/^[ \t]*(typedef)?[ \t]*|[ \t]+$/, "", title)
        if (n > 40) print FILENAME ": " title " has " n " members, at most 40"
    }
    FNR == 1 { depth = 0; text = ""; comment = 0; directive = 0; closed = 0 }
    {
        line = code_of($0)
        if (directive || line ~ /^[ \t]*#/) { directive = line ~ /\\$/; next }
        for (i = 1; i <= length(line); ++i) {
            c = substr(line, i, 1)
            if (c == "{") {
                title[++depth] = text
                record[depth] = text ~ /(^|[ \t])(struct|union)([ \t]|$)/ && text !~ /\)/
                members[depth] = 0
                text = ""; closed = 0
            } else if (c == "}") {
                closed = record[depth] ? depth : 0
                --depth; text = ""
            } else if (c == ";") {
                n = names_in(text)
                if (closed) {
                    judge(title[closed], members[closed])
                    if (text ~ /^[ \t]*$/) n = members[closed]
                }
                if (depth && record[depth]) members[depth] += n
                text = ""; closed = 0
            } else text = text c
        }
        text = text " "
    }
    END { if (structs == 0) print "src: no struct was found" }' >"$tmp"
cat "$tmp"
[ ! -s "$tmp" ]
