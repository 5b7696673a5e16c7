#!/bin/sh
# install: puts parts of a build below DESTDIR, with files that say for pkg-config and CMake what of smr is there.
# SPDX-License-Identifier: MIT
# usage: BUILD=... DESTDIR=... PREFIX=... LIBDIR=... VERSION=... SERIES=... install.sh PART...     from the top directory
# Parts: core, pthread, program, shared. Those already there stay, and the files tell of them, too.
set -eu
lib=$DESTDIR$LIBDIR
install -d "$DESTDIR$PREFIX/include" "$lib/pkgconfig" "$lib/cmake/smr"
for part in "$@"; do
    case $part in
    core)
        install -m 644 include/smr.h "$DESTDIR$PREFIX/include"
        install -m 644 "$BUILD/libsmr.a" "$lib" ;;
    pthread)
        install -m 644 port/pthread/smr_pthread.h "$DESTDIR$PREFIX/include"
        install -m 644 "$BUILD/libsmr_pthread.a" "$lib" ;;
    program)
        install -d "$DESTDIR$PREFIX/bin"
        install -m 755 "$BUILD/smr" "$DESTDIR$PREFIX/bin"
        install -d "$DESTDIR$PREFIX/lib/smr/slicer"
        install -m 755 port/host/slicer/smr-register.sh "$DESTDIR$PREFIX/lib/smr/slicer/smr-register"
        install -d "$DESTDIR$PREFIX/lib/smr/slicer/SmrRegisterLib"
        install -m 644 port/slicer/SmrRegister.py "$DESTDIR$PREFIX/lib/smr/slicer"
        install -m 644 port/slicer/SmrRegisterLib/smr_run.py "$DESTDIR$PREFIX/lib/smr/slicer/SmrRegisterLib" ;;
    shared)
        install -m 644 include/smr.h port/pthread/smr_pthread.h "$DESTDIR$PREFIX/include"
        install -m 755 "$BUILD/libsmr.so.$VERSION" "$lib"
        ln -sf "libsmr.so.$VERSION" "$lib/libsmr.so.$SERIES"
        ln -sf "libsmr.so.$SERIES" "$lib/libsmr.so" ;;
    *) echo "install.sh: no such part: $part" >&2; exit 2 ;;
    esac
done

# What -lsmr alone does not bring: the shared library holds the threads' port and names its own libraries.
libs='-lsmr -lm'
[ ! -f "$lib/libsmr_pthread.a" ] || libs='-lsmr_pthread -lsmr -pthread -lm'
private=
[ ! -f "$lib/libsmr.so" ] || { private=$(echo "$libs" | sed 's/-lsmr //'); libs=-lsmr; }

# Paths below the prefix are written relative to it, so that an installed tree may move.
libdir=$LIBDIR
include=$PREFIX/include
case $LIBDIR in
"$PREFIX"/*)
    below=${LIBDIR#"$PREFIX"/}
    libdir="\${prefix}/$below"
    include=$(echo "$below/cmake/smr" | sed 's|[^/][^/]*|..|g')/include ;;
esac

values=$(printf '%s\n' "PREFIX=$PREFIX" "LIBDIR=$libdir" "INCLUDE=$include" "VERSION=$VERSION" "SERIES=$SERIES" \
    "LIBS=$libs" "PRIVATE=$private" | sed 's/[\&|]/\\&/g; s/^\([A-Z]*\)=\(.*\)/s|@\1@|\2|g/')
# All may read them, whatever the umask.
fill() { sed "$values" "$1" >"$2" && chmod 644 "$2"; }
fill port/package/smr.pc.in "$lib/pkgconfig/smr.pc"
fill port/cmake/smrConfig.cmake.in "$lib/cmake/smr/smrConfig.cmake"
fill port/cmake/smrConfigVersion.cmake.in "$lib/cmake/smr/smrConfigVersion.cmake"
