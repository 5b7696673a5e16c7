#!/bin/sh
# check_install: what `make install` puts down is all that a program needs: headers, archives and flags by pkg-config.
# SPDX-License-Identifier: MIT
set -u
. tests/checks.inc
need_file "$build/libsmr_pthread.a"
put() { ${MAKE:-make} -s BUILD="$build" CC="$cc" CFLAGS="${CFLAGS:-}" install "$@" >"$tmp/log" 2>&1 || { cat "$tmp/log"; exit 1; }; }
(umask 077 && put DESTDIR="$tmp/a place" PREFIX=/usr) || exit 1
closed=$(find "$tmp/a place" ! -perm -444)
[ -z "$closed" ] || { echo "not for all to read: $closed"; exit 1; }
for file in include/smr.h include/smr_pthread.h lib/libsmr.a lib/libsmr_pthread.a lib/pkgconfig/smr.pc bin/smr lib/smr/slicer/smr-register \
    lib/smr/slicer/SmrRegister.py lib/smr/slicer/SmrRegisterLib/smr_run.py; do
    [ -f "$tmp/a place/usr/$file" ] || { echo "not installed: $file"; exit 1; }
done
for file in man/man1/smr.1 man/man1/smr-register.1 bash-completion/completions/smr zsh/site-functions/_smr; do
    [ -s "$tmp/a place/usr/share/$file" ] || { echo "not installed: share/$file"; exit 1; }
done
if ${MAKE:-make} -s BUILD='a b' all >"$tmp/log" 2>&1 || ! grep -q 'without spaces' "$tmp/log"; then
    echo "a build directory with a space is not refused"
    exit 1
fi
need pkg-config
put DESTDIR= PREFIX="$tmp/root"
PKG_CONFIG_PATH=$tmp/root/lib/pkgconfig
export PKG_CONFIG_PATH
version=$("$tmp/root/bin/smr" --version) || exit 1
[ "$version" = "smr $(pkg-config --modversion smr)" ] || { echo "smr.pc has another version than $version"; exit 1; }
case $(pkg-config --libs smr) in
*-pthread*) ;;
*) echo "smr.pc leaves out -pthread, which the archives need"; exit 1 ;;
esac
cat >"$tmp/user.c" <<'END'
#include <smr_pthread.h>
static _Alignas(SMR_ALIGN) unsigned char memory[65536];
int main(void)
{
    smr_pthread *pool;
    const smr_config config = smr_config_default();
    const smr_status status = smr_pthread_create(&pool, memory, sizeof memory, 2);
    if (status == SMR_OK) smr_pthread_destroy(pool);
    return status != SMR_OK || config.cookie == 0u;
}
END
# shellcheck disable=SC2046
$cc -std=c11 ${CFLAGS:-} "$tmp/user.c" -o "$tmp/user" $(pkg-config --cflags --libs smr) || exit 1
"$tmp/user" || { echo "the program ended with status $?"; exit 1; }
