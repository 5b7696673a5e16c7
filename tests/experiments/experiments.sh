#!/bin/sh
# experiments: registrations of which the truth is known, by the command line, held to bounds; the last line is the sum.
# SPDX-License-Identifier: MIT
# usage: BUILD=... experiments.sh [short|full|all] [GROUP...]
# short: what `make check` runs; full: `make experiments`; all: every seed and table, about an hour. Groups are the
# functions of cases.sh. SMR_TEST_DATA says where the data are, SMR_JOBS how many groups run at once,
# SMR_EXPERIMENT_OPTIONS gives every registration more options. BUILD/experiments/GROUP.txt has the table, GROUP.figures
# a line "ROW.FIGURE VALUE" for each figure, in mm.
set -u
export LC_ALL=C
case ${CFLAGS:-} in *-fsanitize*) [ $# -gt 0 ] || { echo 'skip: instrumented code takes too long'; exit 77; } ;; esac
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "${BUILD:-build}" && pwd) || exit 1
tool=$build/case_tool
SMR=${SMR:-$build/smr}
SMR=$(cd "$(dirname "$SMR")" && pwd)/${SMR##*/}
export SMR
form=${1:-short}
[ $# -eq 0 ] || shift
out=$build/experiments
mkdir -p "$out"
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
trap 'kill $workers 2>/dev/null; exit 1' HUP INT TERM
ln -s "$(cd "${SMR_TEST_DATA:-../shared/data}" 2>/dev/null && pwd || echo none)" "$tmp/data"
workers=

# ---------------------------------------------------------------- what cases are written with

full() { [ "$form" != short ]; }
all() { [ "$form" = all ]; }
either() { if [ "$form" = "$1" ]; then echo "$2"; else echo "$3"; fi; } # form, words in it, words otherwise
say() { echo "$*"; }
skip() { echo "skip: $*"; }
need() { for d; do [ -e "$tmp/data/$d" ] || { skip "$d is not there (SMR_TEST_DATA=DIR says where the data are)"; return 1; }; done; }
keep() { sed "s|^|$1.|" >>"$figures"; } # row: figures of standard input
tool() { "$tool" "$@" || { fault "case_tool $*"; return 1; }; }
fault() { echo "MISS could not: $*"; }

# smr WORDS: statuses 0, 1, 3 and 4 mean that results were written.
smr() {
    "$SMR" "$@" --quiet >log 2>&1
    status=$?
    case $status in 0 | 1 | 3 | 4) ;; *) [ "${may_refuse:-0}" = 1 ] || { fault "smr $*"; cat log; } ;; esac
}

register() { # row, words of smr register: the result goes to the directory of the row's name
    row=$1; shift
    rm -rf "$row"
    : >told
    # shellcheck disable=SC2086
    smr register --threads 1 ${SMR_EXPERIMENT_OPTIONS:-} "$@" -o "$row"
    [ ! -f "$row/report.json" ] || awk -f "$here/../results/json.awk" "$row/report.json" |
        awk -v row="$row" -v status="$status" -f "$here/report.awk" >told
    sed -n 's/^table //p' told
    grep -v '^table ' told | keep "$row"
}

measure() { # row, case: figures of the row's result
    tool measure "$2" "$1" >told
    keep "$1" <told
    awk -v row="$1" '{ f[$1] = $2 } END { printf "  %-24s surface %7.3f vertex %7.3f unseen %7.3f\n",
        row, f["surface"], f["vertex"], f["unseen"] }' told
}

# An awk program that evaluates an expression of figures, ROW.FIGURE, and max(a, b).
evaluate() { # what to do with v, expression
    awk "function g(k) { if (!(k in f) || f[k] !~ /^-?[0-9]/) none = none \" \" k; return f[k] + 0 }
         function max(a, b) { return a > b ? a : b }
         { f[\$1] = \$2 }
         END { v = $(echo "$2" | sed -E 's/[a-z0-9][a-z0-9_:]*(\.[0-9]+)?\.[a-z][a-z0-9_.]*/g("&")/g'); if (none != \"\") v = \"no\" none; $1 }" "$figures"
}

record() { echo "$1 $(evaluate 'printf "%.6g", v' "$2")" >>"$figures"; } # figure, expression

bound() { # text, expression, limit: the expression's value is at most the limit's
    evaluate "l = $(evaluate 'printf "%.9g", (none == "" ? v : -1e9)' "$3"); ok = none == \"\" && v + 0 <= l
        printf \"  %-4s %-60s %s, at most %.4g\n\", ok ? \"ok\" : \"MISS\", \"$1\", none == \"\" ? sprintf(\"%8.3f\", v) : v, l" "$2" || fault "$1: $2"
}

# row, then expressions of its figures, each with its limit: names without a dot are the row's, ROW.FIGURE another row's.
within() {
    of=$1; shift
    while [ $# -gt 1 ]; do
        bound "$of: $1" "$(echo "$1" | sed -E ":a; s/(^|[^a-z0-9_.:])([a-z][a-z0-9_]*)(\$|[^a-z0-9_.:(])/\1$of.\2\3/; ta")" "$2"
        shift 2
    done
}

over() { # line: of its rows, LINE:..., how many, and of each figure the mean, the most, the least and the sum
    awk -v line="$1:" 'index($1, line) == 1 && match($1, /[.][a-z_]+$/) {
            k = substr($1, RSTART + 1)
            if (!(k in n) || $2 + 0 > most[k]) most[k] = $2 + 0
            if (!(k in n) || $2 + 0 < least[k]) least[k] = $2 + 0
            sum[k] += $2
            n[k]++ }
        END { print "rows", ("surface" in n) ? n["surface"] : n["status"] + 0
              for (k in n) printf "%s %.6f\n%s_most %.6f\n%s_least %.6f\n%s_sum %.6f\n", k, sum[k] / n[k], k, most[k], k, least[k], k, sum[k] }' \
        "$figures" >told
    keep "$1" <told
    awk -v row="$1" '{ f[$1] = $2 } END { printf "all of %-17s %d rows, %d hold; surface mean %.3f worst %.3f, vertex mean %.3f\n",
        row, f["rows"], f["held_sum"], f["surface"], f["surface_most"], f["vertex"] }' told
}

. "$here/cases.sh"
. "$here/cases_made.sh"
. "$here/cases_budgets.sh"

# ---------------------------------------------------------------- all groups

run_group() { # group
    mkdir "$tmp/$1.d" && cd "$tmp/$1.d" && ln -s ../data data || return 1
    figures=$out/$1.figures
    : >"$figures"
    "group_$1"
    times >told
    awk '{ for (i = 1; i <= 2; i++) { split($i, t, /[ms]/); s += 60 * t[1] + t[2] } } END { printf "%.1f s of a processor\n", s }' told
    cd "$tmp" && rm -rf "$tmp/$1.d"
}
work() { for group; do mkdir "$tmp/$group" 2>/dev/null && (run_group "$group") >"$out/$group.txt" 2>&1; done; }
[ $# -gt 0 ] || set -- $groups
for k in $(seq "${SMR_JOBS:-$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1)}"); do
    work "$@" &
    workers="$workers $!"
done
wait
passed=0; failed=0; skipped=0
for group; do
    echo "---- $group"
    cat "$out/$group.txt"
    p=$(grep -c '^  ok ' "$out/$group.txt"); f=$(grep -c -E '^ *MISS' "$out/$group.txt"); s=$(grep -c '^skip' "$out/$group.txt")
    [ $((p + f + s)) -gt 0 ] || { echo "MISS $group held nothing to a bound"; f=1; }
    passed=$((passed + p)); failed=$((failed + f)); skipped=$((skipped + s))
done
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
