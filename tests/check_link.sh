#!/bin/sh
# check_link: each way to link the library gives the golden hash: archives by pkg-config and CMake, CMake's add_subdirectory,
# the shared library, the amalgamation. The golden run's own objects are the same for all; only the library is another.
# SPDX-License-Identifier: MIT
# usage: BUILD=... CC=... CFLAGS=... check_link.sh        the last line is the sum
# SMR_FULL=1: more of CMake's flags. SMR_LINK=all, or SMR_EXPERIMENTS: all build types; a core for AArch64 without a host program.
set -u
export LC_ALL=C
. tests/checks.inc
need_plain
golden_objects=
for name in golden golden_goals golden_images golden_save print; do
    golden_objects="$golden_objects $build/obj/tests/golden/$name.o"
done
# shellcheck disable=SC2086
need_file $golden_objects "$build/libsupport.a" "$build/libsmr_pthread.a"
unset MAKEFLAGS MFLAGS
top=$(pwd)
work=$build/link # kept: a second run compiles what changed
mkdir -p "$work" || exit 1
all() { [ "${SMR_LINK:-${SMR_EXPERIMENTS:-}}" = all ]; }
want=$(cat tests/golden/expected.txt)
minor=$(awk '/define SMR_VERSION_(MAJOR|MINOR)/ { v = v s $3; s = "." } END { print v }' include/smr.h)
case $minor in 0.*) series=$minor ;; *) series=${minor%.*} ;; esac # versions with one interface
golden() { # name, command...
    tried=$1; shift
    got=$("$@" threads 2 2>&1)
    same "$tried: the golden hash" "$got" "$want"
}
make_in() { # build directory, flags, targets and variables...
    dir=$1; flags=$2; shift 2
    ${MAKE:-make} -s -j2 BUILD="$dir" CC="$cc" CFLAGS="$flags" "$@"
}
# Flags with which a compiler fuses products and sums unless it is told not to; GCC does with -O2, of which this is enough.
native=
known -march=native && native=-march=native
fusing() { # compiler
    case $($1 --version | head -n 1) in
    *clang*) echo "-O1 $native" ;;
    *) echo "-O1 -fexpensive-optimizations $native" ;;
    esac
}
cxx=
for candidate in ${CXX:-} g++ clang++; do if [ -z "$cxx" ] && have "$candidate"; then cxx=$candidate; fi; done

# The amalgamation compiles in the background: without any flag that the bits rest on, for it has them itself.
one=$work/amalgamation
check 'make amalgamation' make_in "$work" '' amalgamation || finish
compilers=
for compiler in gcc clang; do
    have $compiler || continue
    compilers="$compilers $compiler"
    # shellcheck disable=SC2046
    (cd "$one" && $compiler $(fusing $compiler) -Wall -Wextra -Werror -c smr.c -o "$tmp/smr_$compiler.o" >"$tmp/$compiler.log" 2>&1) &
done

# A user's program, in C and C++, without a line of the tests.
cat >"$tmp/user.c" <<'C'
#include <smr.h>
#include <smr_pthread.h>
#include <stdio.h>
int main(void)
{
    const smr_config config = smr_config_default();
    const unsigned floats = (unsigned)smr_self_test();
    if (floats != 0u) printf("smr_self_test() is %u\n", floats);
    return floats != 0u || config.cookie == 0u || smr_pthread_bytes(2u) == 0u;
}
C
cp "$tmp/user.c" "$tmp/user.cpp"

# ---------------------------------------------------------------- the shared library

# Names of functions that the public headers declare, read without the preprocessor.
declared() {
    cat include/smr.h port/pthread/smr_pthread.h | tr '\n' ' ' | sed 's|/\*|\n&|g; s|\*/|&\n|g' | sed '/^\/\*/d' |
        grep -oE 'smr_[a-z0-9_]+ *\(' | tr -d ' (' | sort -u
}
declared >"$tmp/declared"
if check 'make shared' make_in "$work" -O1 shared; then
    shared=$work/libsmr.so
    nm -D --defined-only "$shared" | awk '{ print $NF }' | sort >"$tmp/exported"
    check 'functions were declared' [ -s "$tmp/declared" ]
    check 'the shared library has the functions of the headers and no other name' diff "$tmp/declared" "$tmp/exported"
    same 'it needs none of its own names' "$(nm -D --undefined-only "$shared" | awk '{ print $NF }' | grep '^smr_')" ''
    same 'its soname' "$(objdump -p "$shared" | sed -n 's/^ *SONAME *//p')" "libsmr.so.$series"
fi

# ---------------------------------------------------------------- installed: pkg-config, then CMake in another place

lib=lib/$($cc -print-multiarch 2>/dev/null || echo any)
root=$tmp/root
make_in "$build" "${CFLAGS:-}" install DESTDIR= PREFIX="$root" LIBDIR="$root/$lib" >"$tmp/log" 2>&1 || { cat "$tmp/log"; exit 1; }
link_golden() { # to, compiler, libraries...
    to=$1; with=$2; shift 2
    # shellcheck disable=SC2086
    check "$to links" $with -o "$tmp/$to" $golden_objects "$build/libsupport.a" "$@" -lm
}
by_pkg_config() { # name, flags of pkg-config...
    name=$1; shift
    # shellcheck disable=SC2046
    link_golden "$name" "$cc" $(pkg-config "$@" --libs smr) || return
    # shellcheck disable=SC2046
    check "$name: a program" $cc "$tmp/user.c" -o "$tmp/user" $(pkg-config "$@" --cflags --libs smr) &&
        LD_LIBRARY_PATH=$root/$lib check "$name: the program runs" "$tmp/user"
    LD_LIBRARY_PATH=$root/$lib golden "$name" "$tmp/$name"
}
if have pkg-config; then
    PKG_CONFIG_PATH=$root/$lib/pkgconfig
    export PKG_CONFIG_PATH
    by_pkg_config archives
    check 'make install-shared' make_in "$work" -O1 install-shared DESTDIR= PREFIX="$root" LIBDIR="$root/$lib"
    same 'smr.pc: the shared library alone' "$(pkg-config --libs-only-l smr | tr -d ' ')" -lsmr
    by_pkg_config shared
    same 'the program asks for the shared library' "$(objdump -p "$tmp/shared" | grep -c 'NEEDED.*libsmr')" 1
    # shellcheck disable=SC2046
    link_golden static "$cc" -static $(pkg-config --static --libs smr) && golden static "$tmp/static"
else
    skip 'pkg-config' 'needs pkg-config'
    make_in "$work" -O1 install-shared DESTDIR= PREFIX="$root" LIBDIR="$root/$lib" >"$tmp/log" 2>&1 || cat "$tmp/log"
fi

# A header and an archive, without POSIX threads or a host: what a cross compiler makes.
core=$tmp/core
check 'make install-core' make_in "$build" "${CFLAGS:-}" install-core DESTDIR="$tmp/a stage" PREFIX=/opt
found=$(cd "$tmp/a stage/opt" && find . -type f | sort | tr '\n' ' ')
same 'install-core: header and archive' "$found" \
    './include/smr.h ./lib/cmake/smr/smrConfig.cmake ./lib/cmake/smr/smrConfigVersion.cmake ./lib/libsmr.a ./lib/pkgconfig/smr.pc '
mv "$tmp/a stage/opt" "$core" 2>/dev/null
mv "$root" "$tmp/moved" && root=$tmp/moved

# ---------------------------------------------------------------- CMake

cat >"$tmp/CMakeLists.txt" <<'CMAKE'
cmake_minimum_required(VERSION 3.13)
project(user C)
if(SMR_TREE)
  add_subdirectory("${SMR_TREE}/port/cmake" smr)
else()
  find_package(smr ${ASKED} REQUIRED COMPONENTS ${PARTS})
endif()
if(TARGET smr::pthread)
  add_executable(golden ${GOLDEN})
  set_target_properties(golden PROPERTIES LINKER_LANGUAGE C)
  target_link_libraries(golden ${SUPPORT} smr::pthread m)
  add_executable(user user.c)
  target_link_libraries(user smr::pthread)
endif()
CMAKE
absolute() { for word in "$@"; do case $word in /*) ;; *) word=$top/$word ;; esac; printf '%s;' "$word"; done; }
# shellcheck disable=SC2086
golden_list=$(absolute $golden_objects)
support=$(absolute "$build/libsupport.a")
configure() { # build tree, options...
    tree=$1; shift
    env -u CFLAGS CC="$cc" cmake -S "$tmp" -B "$tree" -DGOLDEN="$golden_list" -DSUPPORT="${support%;}" "$@"
}
by_cmake() { # name, build tree, options...
    name=$1; tree=$2; shift 2
    check "$name: configured" configure "$tree" "$@" && check "$name: built" cmake --build "$tree" -j2 || return
    check "$name: the program runs" "$tree/user"
    golden "$name" "$tree/golden"
}
subdirectory() { # name, options...
    name=$1; shift
    by_cmake "add_subdirectory $name" "$tmp/sub_$(echo "$name" | tr -c 'a-zA-Z0-9\n' _)" -DSMR_TREE="$top" "$@"
}
in_haste() { configure "$tmp/fast" -DSMR_TREE="$top" -DCMAKE_C_FLAGS=-ffast-math && cmake --build "$tmp/fast" --target smr; }
if have cmake; then
    by_cmake find_package "$tmp/found" -DCMAKE_PREFIX_PATH="$root" -DASKED="$minor" -DPARTS='smr;pthread'
    by_cmake 'find_package shared' "$tmp/found_shared" -DCMAKE_PREFIX_PATH="$root" -Dsmr_SHARED=ON -DPARTS=smr
    refuse 'find_package of a later version' 'version' configure "$tmp/later" -DCMAKE_PREFIX_PATH="$root" -DASKED=9.0 -DPARTS=smr
    refuse 'find_package of an earlier interface' 'version' configure "$tmp/earlier" -DCMAKE_PREFIX_PATH="$root" -DASKED=0.1 -DPARTS=smr
    check 'find_package of a core' configure "$tmp/of_core" -DCMAKE_PREFIX_PATH="$core" -DPARTS=smr
    check 'find_package of the core where there are no threads' configure "$tmp/alone" -DCMAKE_PREFIX_PATH="$root" \
        -DCMAKE_DISABLE_FIND_PACKAGE_Threads=ON -DPARTS=smr
    refuse 'find_package of threads where there are none' 'Threads' configure "$tmp/lacking" -DCMAKE_PREFIX_PATH="$root" \
        -DCMAKE_DISABLE_FIND_PACKAGE_Threads=ON -DPARTS=pthread
    refuse 'find_package of threads that a core lacks' 'no pthread' configure "$tmp/none" -DCMAKE_PREFIX_PATH="$core" -DPARTS=pthread
    for flag in $(sed -n 's/^STD *:= *-std=c11 //p' Makefile); do
        check "CMake sets $flag" grep -e "PRIVATE.* $flag" port/cmake/CMakeLists.txt
    done
    if ! full || all; then subdirectory "$(fusing "$cc")" -DCMAKE_C_FLAGS="$(fusing "$cc")"; fi # else with all that asks for fusing
    if full || all; then
        lto= # GCC inlines what the library does into a program that fuses, when both are optimised at link time
        known -flto && lto=-flto
        subdirectory "gnu17, contraction asked for $lto" -DCMAKE_C_STANDARD=17 -DCMAKE_C_EXTENSIONS=ON \
            -DCMAKE_C_FLAGS="$(fusing "$cc") -ffp-contract=fast $lto"
        mkdir "$tmp/cxx" && cp "$tmp/user.cpp" "$tmp/cxx" && cat >"$tmp/cxx/CMakeLists.txt" <<'CMAKE'
cmake_minimum_required(VERSION 3.13)
project(user CXX)
find_package(smr REQUIRED)
add_executable(user user.cpp)
target_link_libraries(user smr::pthread)
CMAKE
        if [ -n "$cxx" ]; then
            check 'a project of C++ alone: configured' env CXX="$cxx" cmake -S "$tmp/cxx" -B "$tmp/cxx/build" -DCMAKE_PREFIX_PATH="$root" &&
                check 'a project of C++ alone: built' cmake --build "$tmp/cxx/build" && check 'it runs' "$tmp/cxx/build/user"
        fi
    fi
    if all; then
        subdirectory 'without a build type'
        subdirectory 'Debug' -DCMAKE_BUILD_TYPE=Debug -DCMAKE_C_FLAGS="$native"
        for type in Release RelWithDebInfo; do
            subdirectory "$type $native" -DCMAKE_BUILD_TYPE=$type -DCMAKE_C_FLAGS="$native" -DCMAKE_INTERPROCEDURAL_OPTIMIZATION=ON
        done
    fi
    refuse 'add_subdirectory -ffast-math' 'ffast-math changes results' in_haste
else skip 'CMake' 'needs cmake'; fi

# ---------------------------------------------------------------- the amalgamation

check 'smr.h is the header' cmp include/smr.h "$one/smr.h"
check 'smr.c has the licence' grep 'Permission is hereby granted' "$one/smr.c"
check 'its port' "$cc" -std=c11 -Wall -Wextra -Werror -pthread -I"$one" -c "$one/smr_pthread.c" -o "$tmp/port.o"
wait
object=
for compiler in gcc clang; do
    case $compilers in *$compiler*) ;; *) skip "amalgamation, $compiler" "needs $compiler"; continue ;; esac
    if [ -f "$tmp/smr_$compiler.o" ] && [ ! -s "$tmp/$compiler.log" ]; then
        object=$tmp/smr_$compiler.o
        ok "amalgamation, $compiler $(fusing $compiler): no warning"
        link_golden one_$compiler $compiler "$object" "$tmp/port.o" -pthread && golden "amalgamation, $compiler" "$tmp/one_$compiler"
    else not_ok "amalgamation, $compiler"; sed 's/^/#   /' "$tmp/$compiler.log" | head -n 20; fi
done
if [ -n "$cxx" ] && [ -n "$object" ]; then
    check "a C++ program, $cxx" "$cxx" -Wall -Wextra -Werror -I"$one" "$tmp/user.cpp" "$object" "$tmp/port.o" -pthread -o "$tmp/user_cxx" &&
        check 'the C++ program runs' "$tmp/user_cxx"
    link_golden golden_cxx "$cxx" "$object" "$tmp/port.o" -pthread && golden "amalgamation, linked by $cxx" "$tmp/golden_cxx"
else skip 'a C++ program' 'needs g++ or clang++'; fi
# Another processor, one that fuses without being asked: the core installed alone, and the one source without flags.
if all; then
    cross=$work/aarch64
    prefix=aarch64-linux-gnu
    if have $prefix-gcc && have qemu-aarch64; then
        objects=$(echo "$golden_objects" | sed "s|$build/obj|$cross/obj|g")
        # shellcheck disable=SC2086
        check 'AArch64: install-core' ${MAKE:-make} -s -j2 BUILD="$cross" CC=$prefix-gcc \
            AR=$prefix-ar CFLAGS=-O1 PREFIX="$tmp/aarch64" DESTDIR= install-core $objects "$cross/libsupport.a"
        check 'AArch64: the one source' $prefix-gcc -O2 -pthread -I"$one" -c "$one/smr.c" -o "$tmp/smr_aarch64.o"
        check 'AArch64: its port' $prefix-gcc -O2 -pthread -I"$one" -c "$one/smr_pthread.c" -o "$tmp/port_aarch64.o"
        for library in "$tmp/smr_aarch64.o" "$tmp/aarch64/lib/libsmr.a"; do
            # shellcheck disable=SC2086
            check 'AArch64: links' $prefix-gcc -static -o "$tmp/golden_aarch64" $objects "$cross/libsupport.a" \
                "$tmp/port_aarch64.o" "$library" -pthread -lm && golden "AArch64, ${library##*/}" qemu-aarch64 "$tmp/golden_aarch64"
        done
    else skip 'AArch64' 'needs gcc-aarch64-linux-gnu and qemu-user'; fi
fi
refuse 'amalgamation, -ffast-math' 'ffast-math changes results' $cc -ffast-math -fsyntax-only "$one/smr.c"
# FLT_EVAL_METHOD is 16 for a processor that evaluates _Float16 in its own type, in GNU dialects: float is float there.
for compiler in gcc clang; do
    flags='-std=gnu17 -march=sapphirerapids -Wall -Wextra -Werror -fsyntax-only'
    # shellcheck disable=SC2086
    $compiler $flags "$tmp/user.c" -Iinclude -Iport/pthread 2>/dev/null || { skip "$compiler $flags" "needs $compiler that knows them"; continue; }
    # shellcheck disable=SC2086
    for file in src/base/self_test.c "$one/smr.c"; do check "$compiler $flags ${file##*/}" $compiler $flags -Iinclude -Isrc "$file"; done
done
finish
