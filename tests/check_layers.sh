#!/bin/sh
# check_layers: every file includes and calls only what its layer allows; no circle of calls; file names are unique.
# SPDX-License-Identifier: MIT
# usage: BUILD=... CC=... NM=... check_layers.sh
# src/LAYERS has the order of the rooms. A room is a folder with sources. Calls, functions
# in tables among them, are read from the symbols of objects that are compiled without inlining, into BUILD/layers. An arrow
# is a symbol that an object of one room needs and an object of another room defines. Prints all rooms with their arrows.
set -u
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
bad=$tmp/bad
: >"$bad"
standard='stddef|stdint|string|math|float|limits'

# The words of src/LAYERS: "room FOLDER RANK", "table FILE".
awk '/^#/ || NF == 0 { next }
    $1 == "table" { for (i = 2; i <= NF; i++) print "table", "src/" $i; next }
    { rank++; for (i = 1; i <= NF; i++) print "room", $i, rank }' src/LAYERS >"$tmp/layers"

# 1. Includes in src: the own room or one on a line above: functions within headers leave no symbol, and must not be
# called upwards either. Reads lines of grep -n.
check_includes() {
    awk -v standard="$standard" -v layers="$tmp/layers" '
    BEGIN { while ((getline line < layers) > 0) { split(line, word, " "); if (word[1] == "room") rank[word[2]] = word[3] } }
    function room_of(f) { sub(/\/[^\/]*$/, "", f); return f }
    {
        split($0, part, ":"); file = part[1]; where = part[1] ":" part[2]; from = room_of(substr(file, 5))
        if (!(from in rank)) { print where ": folder is not in src/LAYERS"; next }
        text = $0; sub(/^[^#]*#[ \t]*include[ \t]*/, "", text)
        quoted = substr(text, 1, 1) == "\""
        name = text; sub(/^["<]/, "", name); sub(/[">].*$/, "", name)
        if (name == "smr.h") next
        if (!quoted) {
            if (name !~ ("^(" standard ")\\.h$")) print where ": system header " name
            next
        }
        if (name ~ /\.\./) { print where ": relative path " name; next }
        to = room_of(name)
        if (name !~ /\//) print where ": " name " without its folder"
        else if (!(to in rank)) print where ": " to " is not in src/LAYERS, " name
        else if (to != from && rank[to] >= rank[from]) print where ": " to " is not above " from " in src/LAYERS, " name
    }'
}
grep -rnE --include='*.[ch]' '^[[:space:]]*#[[:space:]]*include' src | check_includes >>"$bad"

# The rule can fail: of these includes the first five are refused, and no other.
cat >"$tmp/planted" <<'END'
src/registration/surface_goals/target_to_model_pulls.c:1:#include "registration/folds/folds.h"
src/registration/config/config.c:2:#include "registration/shape/deformed_shape.h"
src/registration/folds/fold_find.c:3:#include "registration/registration.h"
src/registration/shape/schedule_state.h:4:#include "registration/goals/external_forces.h"
src/options/image/image_goals.c:5:#include "options/partial/partial.h"
src/registration/folds/fold_find.c:6:#include "registration/evolve/evolve_positions.h"
src/registration/api/init.c:7:#include "registration/registration.h"
src/registration/goals/external_forces.c:8:#include "registration/shape/schedule_state.h"
src/registration/api/init.c:9:#include "registration/tick/iteration_steps.h"
src/registration/folds/fold_find.c:10:#include "registration/folds/folds.h"
END
refused=$(check_includes <"$tmp/planted" | sed 's/^[^:]*:\([0-9]*\):.*/\1/' | tr '\n' ' ')
[ "$refused" = '1 2 3 4 5 ' ] ||
    echo "check_layers: of the planted includes 1 2 3 4 5 are wrong, refused were: $refused" >>"$bad"

# 2. One public header; ports and benchmarks see only it, each other, the fixtures and the tests' own helpers.
find include -type f ! -path include/smr.h -printf '%p: not the public header\n' >>"$bad"
find src -name '*.h' | sed 's|.*/|src |' >"$tmp/headers"
find port tests/bench tests/property fixtures -name '*.[ch]' 2>/dev/null | sed 's|.*/|port |' >>"$tmp/headers"
grep -rnE --include='*.[ch]' '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' port tests/bench 2>/dev/null |
    awk -v headers="$tmp/headers" '
    BEGIN { while ((getline line < headers) > 0) { split(line, word, " "); known[word[1], word[2]] = 1 } }
    {
        split($0, part, ":"); name = $0; sub(/^[^"]*"/, "", name); sub(/".*$/, "", name)
        base = name; sub(/.*\//, "", base)
        if (name == "smr.h" || (("port", base) in known && !(("src", base) in known))) next
        print part[1] ":" part[2] ": only smr.h and port headers, not " name
    }' >>"$bad"
grep -rnE --include='*.[ch]' '^[[:space:]]*#[[:space:]]*include[[:space:]]*"[^/"]*"' port/host |
    grep -vE '"(smr|smr_pthread|fixture_[a-z_]*)\.h"' | sed 's/$/   (named without its folder of port\/host)/' >>"$bad"

# 3. Names.
find src include port tests fixtures -name '*.[ch]' | sed 's|.*/||' | sort | uniq -d |
    sed 's/$/: this file name is used twice/' >>"$bad"

# 4. Who includes a header of another room uses it: some name that the header declares is in the file, or,
# behind a dot or an arrow, some member that no other header there has.
find src -name '*.[ch]' | sort | xargs awk '
    # Code without comments, texts and directives; macros and includes are noted on the way.
    FNR == 1 { n_files++; file[n_files] = FILENAME; within = 0 }
    {
        line = $0; clean = ""
        while (line != "") {
            if (within) {
                k = index(line, "*/"); if (!k) break
                line = substr(line, k + 2); within = 0
            } else {
                k = index(line, "/*"); if (!k) { clean = clean line; break }
                clean = clean substr(line, 1, k - 1) " "; line = substr(line, k + 2); within = 1
            }
        }
        if (clean ~ /^[ \t]*#[ \t]*include[ \t]*"/) {
            sub(/^[^"]*"/, "", clean); sub(/".*/, "", clean)
            includes[FILENAME] = includes[FILENAME] " " clean
        } else {
            if (clean ~ /^[ \t]*#[ \t]*define/) {
                name = clean; sub(/^[ \t]*#[ \t]*define[ \t]+/, "", name); sub(/[^A-Za-z0-9_].*/, "", name)
                macro[FILENAME] = macro[FILENAME] " " name
                sub(/^[ \t]*#[ \t]*define[ \t]+[A-Za-z0-9_]+/, "", clean); body[FILENAME] = body[FILENAME] " " clean; next
            }
            if (clean ~ /^[ \t]*#/) next
            gsub(/"[^"]*"/, " ", clean); code[FILENAME] = code[FILENAME] " " clean
        }
    }
    # Marks what a header declares: seen[name] as it is, member[name] behind a dot or an arrow.
    function declared(h, n, i, t, token, brace, paren, list, was, before, type) {
        for (i in seen) delete seen[i]
        for (i in member) delete member[i]
        n = split(macro[h], token, " ")
        for (i = 1; i <= n; i++) if (token[i] !~ /_H$/) seen[token[i]] = 1
        t = code[h]; gsub(/[^A-Za-z0-9_ \t]/, " & ", t)
        n = split(t, token, /[ \t]+/); brace = paren = list = type = 0; was = before = ""
        for (i = 1; i <= n; i++) {
            t = token[i]; if (t == "") continue
            if (t == "{") { brace++; if (was == "enum" || before == "enum") list = brace
                            if (before ~ /^(struct|union|enum)$/) seen[was] = 1 }
            else if (t == "}") { if (list == brace) list = 0; brace-- }
            else if (t == "(") { if (!brace && !paren && was ~ /^[A-Za-z_]/ && was !~ /^_(S|A)/) seen[was] = 1; paren++ }
            else if (t == ")") paren--
            else if (t == ";" || t == "[" || t == "," || t == ":") {
                if (!paren && was ~ /^[A-Za-z_]/) { if (!brace) seen[was] = 1; else if (!list) member[was] = 1 }
            }
            if (list && !paren && t ~ /^[A-Za-z_]/ && (was == "{" || was == ",")) seen[t] = 1
            if (paren == 1 && !brace && was == "*" && before == "(") seen[t] = 1
            before = was; was = t
        }
    }
    function uses(f, text, n, i, token) {
        text = code[f] " " body[f]; gsub(/->/, " . ", text); gsub(/\./, " . ", text)
        gsub(/[^A-Za-z0-9_. \t]/, " ", text)
        n = split(text, token, /[ \t]+/)
        for (i = 1; i <= n; i++) if ((token[i] in seen) || (i > 1 && token[i - 1] == "." && (token[i] in member))) return 1
        return 0
    }
    function room(f) { sub(/\/[^\/]*$/, "", f); return f }
    END {
        for (k = 1; k <= n_files; k++) if (file[k] ~ /\.h$/) { declared(file[k]); for (i in member) headers[i]++ }
        for (k = 1; k <= n_files; k++) {
            h = file[k]; if (h !~ /\.h$/ || room(h) == "src/base") continue
            declared(h)
            for (i in member) if (headers[i] > 1) delete member[i]
            for (m = 1; m <= n_files; m++) {
                if (room(file[m]) == room(h) || index(includes[file[m]] " ", " " substr(h, 5) " ") == 0) continue
                if (!uses(file[m])) print file[m] ": includes " substr(h, 5) " and uses nothing that it declares"
            }
        }
    }' >>"$bad"

# 5. Calls. make compiles what changed; objects of sources that are gone are not read.
compiler=${CC:-cc}
if ! command -v "${compiler%% *}" >/dev/null || ! command -v "${NM:-nm}" >/dev/null; then
    cat "$bad"
    echo 'skip: calls are not checked without a compiler and nm'
    [ -s "$bad" ] && exit 1
    exit 77
fi
objects=${BUILD:-build}/layers
if ! env -u MAKEFLAGS -u MFLAGS "${MAKE:-make}" -s -j2 BUILD="$objects" CC="$compiler" CFLAGS='-O0 -w' \
    layer-objects >"$tmp/make" 2>&1; then
    cat "$bad" "$tmp/make"
    exit 1
fi
find src port/host -name '*.c' | sort >"$tmp/sources"
sed "s|^\(.*\)\.c\$|$objects/obj/\1.o|" "$tmp/sources" | xargs "${NM:-nm}" -A -P -g >"$tmp/nm" || echo 'nm failed' >>"$bad"
# nm: "BUILD/layers/obj/SOURCE.o: NAME TYPE ..."
sed "s|^$objects/obj/\([^:]*\)\.o: |\1.c |" "$tmp/nm" >"$tmp/symbols"
tr '\n' ' ' <include/smr.h | sed 's|/\*|\n&|g; s|\*/|&\n|g' | sed '/^\/\*/d' | # without comments
    grep -oE 'smr_[a-z0-9_]+ *\(' | tr -d ' (' >"$tmp/public"

awk -v layers="$tmp/layers" -v public="$tmp/public" -v sources="$tmp/sources" -v bad="$tmp/calls" -v pairs="$tmp/pairs" '
    function room_of(f) { sub(/\/[^\/]*$/, "", f); return f }
    # 1 when a room of src may call another.
    function below(to, from) { return level[substr(to, 5)] + 0 < level[substr(from, 5)] + 0 }
    BEGIN {
        while ((getline line < layers) > 0) {
            split(line, word, " ")
            if (word[1] == "table") table[word[2]] = 1
            else level[word[2]] = word[3]
        }
        while ((getline line < public) > 0) open[line] = 1
        while ((getline line < sources) > 0) {
            r = room_of(line)
            if (!(r in files)) room[++n] = r
            files[r]++; there[line] = 1
            if (r ~ /^src\// && !(substr(r, 5) in level)) lost[r] = 1
        }
        for (r in level) if (!(("src/" r) in files)) print "src/LAYERS: no sources in src/" r >bad
        for (r in lost) print r ": folder is not in src/LAYERS" >bad
        for (f in table) if (!(f in there)) print "src/LAYERS: no " f >bad
    }
    $3 == "U" || $3 == "w" || $3 == "v" { need[++m] = $1 " " $2; next }
    { home[$2] = $1 }
    END {
        for (i = 1; i <= m; i++) {
            split(need[i], word, " ")
            if (!(word[2] in home)) continue
            from = room_of(word[1]); to = room_of(home[word[2]])
            if (word[1] != home[word[2]] && from ~ /^src\// && !(word[1] in table)) print word[1], home[word[2]] >pairs
            if (from == to) continue
            if (word[1] in table) { exempt[word[1]]++; continue }
            arrows[from]++; all++
            if (!((from, to, word[2]) in named)) why[from, to] = why[from, to] " " word[2]
            named[from, to, word[2]] = 1
            reach[from, to] = 1
            if (from ~ /^port\// && to ~ /^src\// && !(word[2] in open))
                print word[1] ": calls " word[2] " of " to ", which is not in smr.h" >bad
            else if (from ~ /^src\// && (to !~ /^src\// || !below(to, from)))
                print word[1] ": calls " word[2] " of " to ", which is not below " from >bad
        }
        # Rooms that reach each other lie on a circle.
        for (k = 1; k <= n; k++) for (i = 1; i <= n; i++) if ((room[i], room[k]) in reach)
            for (j = 1; j <= n; j++) if ((room[k], room[j]) in reach) reach[room[i], room[j]] = 1
        for (i = 1; i <= n; i++) {
            if (!((room[i], room[i]) in reach) || (i in told)) continue
            circles++; text = steps = ""
            for (j = 1; j <= n; j++) if ((room[i], room[j]) in reach && (room[j], room[i]) in reach) {
                told[j] = 1; text = text " " room[j]
                for (k = 1; k <= n; k++) if ((room[j], room[k]) in why && (room[k], room[i]) in reach)
                    steps = steps "\n    " room[j] " -> " room[k] ":" why[room[j], room[k]]
            }
            print "a circle of calls:" text steps >bad
        }
        printf "%-24s %5s %6s  %s\n", "room", "files", "arrows", "to"
        for (i = 1; i <= n; i++) {
            text = ""
            for (j = 1; j <= n; j++) if ((room[i], room[j]) in why) text = text " " room[j]
            printf "%-24s %5d %6d %s\n", room[i], files[room[i]], arrows[room[i]], text
        }
        for (f in exempt) printf "%s is a table of steps: %d arrows of its own, not counted\n", f, exempt[f]
        printf "rooms %d, arrows %d, circles %d\n", n, all, circles
        if (!m) print "no symbols were found" >bad
    }' "$tmp/symbols" >"$tmp/rooms"

# 6. No circle of calls between files either, inside rooms too.
tsort "$tmp/pairs" 2>&1 >/dev/null | sed 's/^/a circle of calls, /' >>"$bad"

cat "$bad"
[ ! -f "$tmp/calls" ] || cat "$tmp/calls"
cat "$tmp/rooms"
[ ! -s "$bad" ] && [ ! -s "$tmp/calls" ]
