#!/bin/sh
# check_style: length of files and functions, first lines, names of macros, no paths of a machine.
# SPDX-License-Identifier: MIT
set -u
tmp=$(mktemp) || exit 1
trap 'rm -f "$tmp"' EXIT
files=$(find src include port fixtures tests -name '*.[ch]' | sort)
scripts=$(find tests port -name '*.sh' | sort; [ -f .ci/run ] && echo .ci/run)

for file in $files $scripts; do
    lines=$(wc -l <"$file")
    [ "$lines" -le 500 ] || [ "$file" = include/smr.h ] || echo "$file: $lines lines, at most 500"
    head -n 40 "$file" | grep -q 'SPDX-License-Identifier: MIT' || echo "$file: no SPDX-License-Identifier"
    # What it is: words in line 1 or 2.
    sed -n '1,2p' "$file" | sed 's/^#!.*//' | grep -qE '[[:alpha:]]{2,}.*[[:alpha:]]{2,}' ||
        echo "$file: the first line does not say what it is"
done >"$tmp"

# A function's body runs from a brace in the first column to the next one.
for file in $(find src port fixtures -name '*.c'); do
    awk -v file="$file" '
        /^{/ { start = NR; next }
        /^}/ && start { if (NR - start + 1 > 60) print file ":" start ": function of " NR - start + 1 " lines, at most 60"
                        start = 0 }' "$file"
done >>"$tmp"

grep -rnE --include='*.[ch]' '^[[:space:]]*#[[:space:]]*define[[:space:]]' src include port/pthread port/template port/baremetal |
    grep -vE 'define[[:space:]]+(SMR_|smr_|_GNU_SOURCE|_POSIX_C_SOURCE)' | sed 's/$/   (macro without SMR_)/' >>"$tmp"
# Host code: macros that only one file sees may be short; those in a header carry the prefix.
grep -rnE --include='*.h' '^[[:space:]]*#[[:space:]]*define[[:space:]]' port/host |
    grep -vE 'define[[:space:]]+(HOST_|host_|SMR_|_[A-Z]|[A-Z_]+_H$)' | sed 's/$/   (macro without HOST_)/' >>"$tmp"

# The patterns are in pieces so that this file does not find itself.
root='/(home|root|work|Users|mnt)'
grep -rnE --exclude-dir=build --exclude-dir=.git "(^|[^[:alnum:]_./])$root/[[:alnum:]]" \
    src include port fixtures tests docs Makefile README.md CHANGELOG.md .ci 2>/dev/null |
    sed 's/$/   (path of a machine)/' >>"$tmp"

cat "$tmp"
[ ! -s "$tmp" ]
