#!/bin/sh
# check_layers: every file includes only what its layer allows; file names are unique.
# SPDX-License-Identifier: MIT
# The order of the layers is in src/LAYERS.
set -u
tmp=$(mktemp) || exit 1
trap 'rm -f "$tmp"' EXIT
standard='stddef|stdint|string|math|float|limits'

# 1. src: rank of the included layer below the own one, or the own layer itself.
grep -rnE --include='*.[ch]' '^[[:space:]]*#[[:space:]]*include' src | awk -v standard="$standard" '
    BEGIN {
        while ((getline line < "src/LAYERS") > 0) {
            if (line ~ /^#/ || line ~ /^[ \t]*$/) continue
            rank++
            n = split(line, word, /[ \t]+/)
            for (i = 1; i <= n; i++) if (word[i] != "") level[word[i]] = rank
        }
    }
    {
        split($0, part, ":"); file = part[1]; where = part[1] ":" part[2]
        split(file, path, "/"); layer = path[2]
        if (!(layer in level)) { print where ": folder is not in src/LAYERS"; next }
        text = $0; sub(/^[^#]*#[ \t]*include[ \t]*/, "", text)
        quoted = substr(text, 1, 1) == "\""
        name = text; sub(/^["<]/, "", name); sub(/[">].*$/, "", name)
        if (name == "smr.h") next
        if (!quoted) {
            if (name !~ ("^(" standard ")\\.h$")) print where ": system header " name
            next
        }
        if (name ~ /\.\./) { print where ": relative path " name; next }
        if (split(name, target, "/") == 1) {
            own = file; sub(/[^\/]*$/, name, own)
            if (system("test -f " own) != 0) print where ": " name " is not in its own folder"
            next
        }
        if (!(target[1] in level)) print where ": unknown layer " name
        else if (target[1] != layer && level[target[1]] >= level[layer])
            print where ": " layer " must not include " name
    }' >"$tmp"

# 2. One public header; ports and benchmarks see only it, each other, the fixtures and the tests' own helpers.
find include -type f ! -path include/smr.h -printf '%p: not the public header\n' >>"$tmp"
set --
for folder in port tests/bench; do [ -d "$folder" ] && set -- "$@" "$folder"; done
if [ $# -gt 0 ]; then
    grep -rnE --include='*.[ch]' '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' "$@" | while IFS= read -r line; do
        name=$(echo "$line" | sed 's/^[^"]*"\([^"]*\)".*/\1/')
        base=${name##*/}
        [ "$name" = smr.h ] && continue
        if [ -n "$(find port tests/bench tests/property fixtures -name "$base" 2>/dev/null | head -n 1)" ] &&
            [ -z "$(find src -name "$base" | head -n 1)" ]; then continue; fi
        echo "$(echo "$line" | cut -d: -f1,2): only smr.h and port headers, not $name"
    done >>"$tmp"
fi

# 3. Names.
find src include port tests fixtures -name '*.[ch]' | sed 's|.*/||' | sort | uniq -d |
    sed 's/$/: this file name is used twice/' >>"$tmp"

cat "$tmp"
[ ! -s "$tmp" ]
