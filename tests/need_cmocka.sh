#!/bin/sh
# need_cmocka: makes sure that the test library CMocka is there; fetches it where that is possible.
# SPDX-License-Identifier: MIT
# usage: need_cmocka.sh CC     (SMR_NO_FETCH=1: never fetch)
set -u
cc=${1:-cc}
tmp=$(mktemp -d) || exit 1
trap 'rm -rf "$tmp"' EXIT
cat > "$tmp/probe.c" <<'C'
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>
int main(void) { return 0; }
C
probe() { $cc "$tmp/probe.c" -o "$tmp/probe" -lcmocka >/dev/null 2>&1; }
probe && exit 0
if [ "${SMR_NO_FETCH:-0}" != 1 ] && [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    echo "check: CMocka is missing, fetching libcmocka-dev"
    export DEBIAN_FRONTEND=noninteractive
    get() { apt-get -o DPkg::Lock::Timeout=300 install -y --no-install-recommends libcmocka-dev; }
    get >"$tmp/log" 2>&1 || { apt-get update && get; } >"$tmp/log" 2>&1
    probe && exit 0
fi
echo "check: the tests need CMocka: install libcmocka-dev (Debian, Ubuntu), cmocka-devel or cmocka" >&2
exit 1
