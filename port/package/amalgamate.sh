#!/bin/sh
# amalgamate: writes the core as one source, DIR/smr.c, and beside it smr.h, the port to POSIX threads and the licence.
# SPDX-License-Identifier: MIT
# usage: amalgamate.sh DIR            from the repository's top directory
#        amalgamate.sh --clashes      private names that more than one file has at file scope: "NAME FILE..."
#
# All headers come first, each after those that it includes, then the sources. A source's macros end with it. A private
# name that another file has, too, stands for a longer one within its source: `#define add keep_c_add`. What this reading
# of the files overlooks the compiler refuses, as a second definition of one name.
set -u
export LC_ALL=C
[ $# -eq 1 ] && [ -f src/base/base.h ] || { echo 'usage: amalgamate.sh DIR|--clashes, in the top directory' >&2; exit 2; }
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
trap 'exit 1' HUP INT TERM
find src -name '*.h' | sort >"$tmp/headers"
find src -name '*.c' | sort >"$tmp/sources"

# "FILE NAME" for each function, type, constant and table that is private to a file, and each macro of a header: whatever
# stands in the first column, as clang-format lays files out.
names() {
    awk '
    function say(name) { if (name ~ /^[A-Za-z][A-Za-z_0-9]*$/) print FILENAME, name }
    function first_word(text) { sub(/^[^A-Za-z_]*/, "", text); sub(/[^A-Za-z_0-9].*/, "", text); return text }
    function last_word(text) { sub(/[^A-Za-z_0-9]*$/, "", text); sub(/.*[^A-Za-z_0-9]/, "", text); return text }
    function constants(text,   n, i, part) { # "A = 1, B"
        sub(/\/\*.*/, "", text)
        n = split(text, part, ",")
        for (i = 1; i <= n; i++) if (part[i] ~ /^[ \t]*[A-Za-z_]/) say(first_word(part[i]))
    }
    FNR == 1 { listing = 0 }
    { sub(/^SMR_[A-Z]+ /, "") } # an attribute
    /^[ \t]*#[ \t]*define/ && FILENAME ~ /\.h$/ { sub(/^[ \t]*#[ \t]*define/, ""); say(first_word($0)); next }
    /^[ \t]*#/ { next }
    /^(typedef )?enum .*\{/ { listing = 1; sub(/^[^{]*\{/, "") }
    listing { end = index($0, "}"); constants(end ? substr($0, 1, end - 1) : $0); if (end) listing = 0 }
    /^\} [a-z_0-9]+(\[[^]]*\])?(;| =)/ { sub(/^\} /, ""); say(first_word($0)) }
    /^(typedef )?(struct|union|enum) [a-z_0-9]+ \{/ { sub(/ \{.*/, ""); say(last_word($0)) }
    /^typedef .*\(\*/ { sub(/.*\(\*/, ""); say(first_word($0)); next }
    /^typedef .*;/ { sub(/(\[.*)?;.*/, ""); sub(/ __attribute__.*/, ""); say(last_word($0)); next }
    /^SMR_[A-Z_]+\([a-z]/ { sub(/^[^(]*\(/, ""); say(first_word($0)) } # a function that a macro writes
    /^static [^(]*(=|\[|;)/ { sub(/ ?(=|\[|;).*/, ""); say(last_word($0)); next }
    /^static .*\(/ { sub(/\(.*/, ""); say(last_word($0)) }' "$@"
}

# shellcheck disable=SC2046
names $(cat "$tmp/headers" "$tmp/sources") | sort -u |
    awk '{ files[$2] = files[$2] " " $1; n[$2]++ } END { for (name in n) if (n[name] > 1) print name files[name] }' |
    sort >"$tmp/clashes"
[ "$1" != --clashes ] || { cat "$tmp/clashes"; exit 0; }

# Headers and sources in their order, without includes; tables (.def) are put in their places.
body() {
    grep -oE 'smr_[a-z0-9_]+\(' include/smr.h | tr -d '(' | sort -u >"$tmp/public"
    awk -v clashes="$tmp/clashes" -v names="$tmp/public" '
    # The file that an #include names in quotes; without a folder it is in the own one. Else "".
    function included(file, line,   name) {
        if (line !~ /^[ \t]*#[ \t]*include[ \t]*"/) return ""
        name = line; sub(/^[^"]*"/, "", name); sub(/".*/, "", name)
        if (name == "smr.h") return ""
        if (name ~ /\//) return "src/" name
        sub(/[^\/]*$/, name, file)
        return file
    }
    # 1: the line begins a function that smr.h does not declare, or declares functions by a type of functions. They are
    # static here: compilers drop what nothing calls.
    function internal(line) {
        if (line ~ /^smr_[a-z_0-9]+ smr_[a-z_0-9, ]+;/) return 1
        if (line !~ /^[a-z][a-z_0-9 ]*[ *]smr_[a-z_0-9]+\(/ || line ~ /^(static|typedef|extern|return) /) return 0
        sub(/\(.*/, "", line); sub(/.*[ *]/, "", line)
        return !(line in public)
    }
    function title(file) { print "\n/* ------------------------------------------------------------------ " file " */\n" }
    function copy(file,   line, name) {
        while ((getline line < file) > 0) {
            name = included(file, line)
            if (name ~ /\.def$/) copy(name)
            else if (internal(line)) print "static " line
            else if (line !~ /^[ \t]*#[ \t]*include/) print line
            if (file ~ /\.c$/ && sub(/^[ \t]*#[ \t]*define[ \t]+/, "", line)) {
                sub(/[^A-Za-z_0-9].*/, "", line)
                if (!((file, line) in ended)) macros = macros " " line
                ended[file, line] = 1
            }
        }
        close(file)
    }
    function header(file,   line, name, list, n, i) {
        if (file in written) return
        written[file] = 1
        while ((getline line < file) > 0) if ((name = included(file, line)) ~ /\.h$/) list = list " " name
        close(file)
        n = split(list, word, " ")
        for (i = 1; i <= n; i++) { split(list, word, " "); header(word[i]) }
        title(file)
        copy(file)
    }
    function source(file,   own, n, i) {
        own = file; sub(/.*\//, "", own); sub(/\.c$/, "_c_", own)
        title(file)
        n = split(renamed[file], word, " ")
        for (i = 1; i <= n; i++) print "#define " word[i] " " own word[i]
        macros = renamed[file]
        copy(file)
        n = split(macros, word, " ")
        for (i = 1; i <= n; i++) print "#undef " word[i]
    }
    BEGIN {
        while ((getline line < names) > 0) public[line] = 1
        while ((getline line < clashes) > 0) {
            n = split(line, word, " ")
            for (i = 2; i <= n; i++) if (word[i] ~ /\.c$/) renamed[word[i]] = renamed[word[i]] " " word[1]
        }
    }
    /\.h$/ { header($0) }
    /\.c$/ { source($0) }' "$tmp/headers" "$tmp/sources"
}

version=$(awk '/define SMR_VERSION_(MAJOR|MINOR|PATCH)/ { v = v s $3; s = "." } END { print v }' include/smr.h)
mkdir -p "$1" || exit 1
{
    cat <<END_OF_TEXT
/* smr.c: smr $version as one source, the headers and sources of src/. Written by \`make amalgamation\`, not to be edited.
 *
 * Compile it as C11, for example cc -std=c11 -O3 -ffp-contract=off -fno-math-errno -c smr.c, and never with -ffast-math.
 * Programs include smr.h and may be C or C++. smr_self_test() says whether flags and processor give the right bits.
 *
$(sed 's/^/ * /; s/ *$//' LICENSE)
 *
 * SPDX-License-Identifier: MIT */

/* A fused multiply-add rounds once where two operations round twice, and compilers fuse unless they are told not to. */
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off", "no-math-errno")
#endif

/* Names that are private to one source are local ones in others. */
#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wunused-function"
#endif

#include "smr.h"

END_OF_TEXT
    # shellcheck disable=SC2046
    grep -hE '^[ ]*#[ ]*include[ ]*<' $(cat "$tmp/headers" "$tmp/sources") | sort -u
    body
} >"$tmp/smr.c" || exit 1
cp include/smr.h port/pthread/smr_pthread.h port/pthread/smr_pthread.c LICENSE "$1" && mv "$tmp/smr.c" "$1/smr.c"
