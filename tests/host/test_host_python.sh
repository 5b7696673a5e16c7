#!/bin/sh
# port/python/smr.py: structs and calls as the header has them, the same bits as a C program, errors, ownership, example.
# SPDX-License-Identifier: MIT
# PYTHON: an interpreter with numpy. SMR_LIBRARY: the shared library; otherwise the archives of BUILD become one here.
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
cd "$top" || exit 1
calls=$top/tests/host/python_calls.py
structs=$top/tests/host/python_structs.py

python=
for one in ${PYTHON:-} python3 /usr/bin/python3; do
    [ -n "$python" ] || ! "$one" -c 'import numpy' 2>/dev/null || python=$one
done
[ -n "$python" ] || { skip "Python" "no python3 with numpy"; finish; }
export PYTHONDONTWRITEBYTECODE=1 OPENBLAS_NUM_THREADS=1
if [ -z "${SMR_LIBRARY:-}" ] && [ -e "$build/libsmr.so" ] && [ ! "$build/libsmr.so" -ot "$build/libsmr.a" ]; then
    SMR_LIBRARY=$(cd "$build" && pwd)/libsmr.so
elif [ -z "${SMR_LIBRARY:-}" ]; then
    SMR_LIBRARY=$scratch/libsmr.so
    # Compilers that make position-independent programs make objects that do for this; others need make shared.
    # shellcheck disable=SC2086
    $CC ${CFLAGS:-} -shared -Wl,-Bsymbolic -o "$SMR_LIBRARY" -Wl,--whole-archive "$build/libsmr.a" \
        "$build/libsmr_pthread.a" -Wl,--no-whole-archive -pthread -lm 2>"$scratch/link.log" ||
        { skip "Python" "no shared library from these archives"; finish; }
fi
export SMR_LIBRARY
case " ${CFLAGS:-} " in
*-fsanitize=*address*) # the interpreter's own leaks are not ours
    preload=libasan.so
    case $($CC --version) in *clang*) preload=libclang_rt.asan-$(uname -m).so ;; esac
    preload=$($CC -print-file-name=$preload)
    export ASAN_OPTIONS="${ASAN_OPTIONS:-}${ASAN_OPTIONS:+:}detect_leaks=0"
    run() { LD_PRELOAD=$preload "$python" "$@"; }
    run -c 'import ctypes; ctypes.CDLL(__import__("os").environ["SMR_LIBRARY"])' 2>/dev/null ||
        { skip "Python" "the interpreter does not load an instrumented library"; finish; }
    ;;
*) run() { "$python" "$@"; } ;;
esac

run "$structs" >"$scratch/structs.c"
check "structs, calls and sentences are listed" [ $? -eq 0 ]
check "they are the header's" "$CC" -std=c11 -Iinclude -fsyntax-only "$scratch/structs.c"
check "as many structs as there are" [ "$(grep -c '"size of' "$scratch/structs.c")" -eq 24 ]
sed 's/offsetof(smr_verdict, strain) == /&1/' "$scratch/structs.c" >"$scratch/wrong.c"
check "a wrong offset does not compile" sh -c "! '$CC' -std=c11 -Iinclude -fsyntax-only '$scratch/wrong.c'"

mkdir "$scratch/in"
arguments=$(run "$calls" inputs "$scratch/in")
# shellcheck disable=SC2086
check "the C program compiles" "$CC" -std=c11 -O1 ${CFLAGS:-} -Iinclude -Iport/pthread tests/host/twin_tool.c \
    "$build/libsmr_pthread.a" "$build/libsmr.a" -pthread -lm -o "$scratch/twin_tool"
# shellcheck disable=SC2086
check "it runs" sh -c "'$scratch/twin_tool' '$scratch/in' $arguments >'$scratch/c.txt'"
run "$calls" twin "$scratch/in" >"$scratch/python.txt" 2>"$scratch/python.err"
check "Python runs" [ $? -eq 0 ]
sed 's/^/#   /' "$scratch/python.err" | tail -3
for name in surface polar align points landmarks image track.4 carry back facts; do
    line=$(grep "^$name " "$scratch/c.txt")
    check "$name: the bits of C ($(echo "$line" | cut -d' ' -f2))" [ -n "$line" -a "$line" = "$(grep "^$name " "$scratch/python.txt")" ]
done
check "and all else" cmp "$scratch/c.txt" "$scratch/python.txt"

run "$calls" behave "$scratch/in" >"$scratch/behave.txt" 2>&1
status=$?
cat "$scratch/behave.txt"
passed=$((passed + $(grep -c '^ok ' "$scratch/behave.txt")))
failed=$((failed + $(grep -c '^not ok ' "$scratch/behave.txt")))
check "all of it ran" [ $status -eq 0 ]

SMR_LIBRARY=$scratch/none.so run "$structs" >"$scratch/out.txt" 2>"$scratch/err.txt"
check "a library that is not there is named" grep -q 'ImportError.*libsmr.so was not found' "$scratch/err.txt"

mkdir "$scratch/figure"
run docs/examples/python/register_bone.py "$scratch/figure/bone" >"$scratch/said.txt" 2>&1
check "the example runs" [ $? -eq 0 ]
tail -2 "$scratch/said.txt" | sed 's/^/#   /'
check "it is good" grep -q '^verdict: good' "$scratch/said.txt"
run docs/examples/python/register_bone.py --svg "$scratch/figure/bone" >"$scratch/said.txt" 2>&1
check "its picture without matplotlib is well-formed" "$python" -c "import sys, xml.dom.minidom as m
sys.exit(len(m.parse('$scratch/figure/bone.svg').getElementsByTagName('path')) < 1000)"

# The package in a virtual environment: it carries the library, and is found without SMR_LIBRARY.
if [ "${SMR_AGAIN:-0}" = 1 ]; then skip "the package" "SMR_AGAIN"; finish; fi
"$python" -c 'import setuptools, wheel, venv, pip' 2>/dev/null || { skip "the package" "no pip, venv, setuptools or wheel"; finish; }
venv=$scratch/venv
"$python" -m venv --system-site-packages --without-pip "$venv"
check "pip installs the package" "$venv/bin/python" -m pip --disable-pip-version-check install -q --no-index --no-build-isolation \
    "$top/port/python"
cd "$scratch" || exit 1
unset SMR_LIBRARY
run_installed() { (python=$venv/bin/python; run "$@"); }
where=$(run_installed -c 'import smr; print(smr.__file__, smr._lib._name, len(smr.SETTINGS) > 9, smr._lib.smr_self_test())')
# shellcheck disable=SC2086
set -- $where
check "it is the installed one, with its own library" [ "${1%/smr/*}/smr/libsmr.so $3 $4" = "$2 True 0" -a "${1#"$venv"/lib}" != "$1" ]
version=$("$venv/bin/python" -c 'from importlib.metadata import version; print(version("smr-registration"))')
check "its version is the header's" [ "$version" = "$("$build/smr" --version | sed 's/^smr //')" ]
finish
