#!/bin/sh
# check_dist: make dist and make sbom give the same bytes elsewhere, from the archive without git, under another umask and clock.
# SPDX-License-Identifier: MIT
set -u
. tests/checks.inc
need gzip sha256sum
case $(tar --version 2>/dev/null) in *GNU*) ;; *) need gtar ;; esac
pack() { ${MAKE:-make} -s "$@" sbom || { not_ok "make $*"; finish; }; }
pack BUILD="$tmp/here"
name=$(basename "$tmp"/here/*.tar.gz .tar.gz)
mkdir "$tmp/another place" && cd "$tmp/another place" || exit 1
gzip -dc "$tmp/here/$name.tar.gz" | tar -xf - && chmod -R go= . && find . -exec touch -d '2001-02-03' {} +
[ "$(id -u)" != 0 ] || chown -R 1234:1234 .
cd "$name" || exit 1
(umask 007 && unset LC_ALL && TZ=Asia/Tokyo LANG=C.UTF-8 pack BUILD=build)
for file in tar.gz spdx; do check "$name.$file is the same to the byte" cmp "$tmp/here/$name.$file" "build/$name.$file"; done
awk '/^FileName/ { file = substr($2, 3) } /^FileChecksum: SHA256/ { print $3 "  " file }' "build/$name.spdx" >"$tmp/sums"
check 'sums of its parts' sha256sum -c --quiet "$tmp/sums"
same 'parts' "$(wc -l <"$tmp/sums")" "$(find . -type f ! -path './build/*' | wc -l)"
finish
