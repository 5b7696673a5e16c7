#!/bin/sh
# check_kept: a model, a log and a save of each minor version from 1.0 on, in tests/golden/kept, are read, as LIFECYCLE promises.
# SPDX-License-Identifier: MIT
# usage: check_kept.sh [--update]    --update (make kept-update) writes those of the version in smr.h, before its release
# Between releases, while the CHANGELOG has unreleased changes, a log may differ and a save may be refused.
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
version=$("$SMR" --version | sed 's/^smr \(.*\)\.[0-9]*$/\1/')
case $version in 0.*) [ "${1:-}" = --update ] || { skip "files of 1.x" "this is $version"; finish; } ;; esac
changes=$(sed -n '/^## \[Unreleased\]/,/^## \[[0-9]/p' "$top/CHANGELOG.md" | grep -c '^- ')
register="register --model model.smr --target target.ply --threads 1 --quiet"
hash_of() { value "$1/report.json" state_hash; }
if [ "${1:-}" = --update ]; then
    mkdir one two && blob 5 30 20 60 0.05 >one/femur.ply && blob 5 32 21 60 0.02 >two/femur.ply
    for d in one two; do { sed '/end_header/q' $d/femur.ply; sed '1,/end_header/d' $d/femur.ply | awk 'NF == 3 { $1 += 90 } 1'; } >$d/tibia.ply; done
    blob 6 33 19 63 0.08 >target.ply
    "$SMR" build --model one/femur.ply one/tibia.ply --also two -o model.smr --radius 60,30,20 --quiet
    "$SMR" $register --log run.log -o done
    "$SMR" $register --save run.save --ticks 20 -o part
    "$SMR" replay run.log | sed -n 's/.* \(all [0-9]* ticks agree\).*/\1/p' >said.txt
    hash_of done >>said.txt
    [ "$(wc -l <said.txt)" -eq 2 ] && [ -s run.save ] || { cat said.txt; exit 1; }
    mkdir -p "$top/tests/golden/kept/$version" && cp model.smr target.ply run.log run.save said.txt "$top/tests/golden/kept/$version"
    exit
fi
# damaged FILE: one byte in its middle is another.
damaged() {
    cp "$1" bad && at=$(($(wc -c <"$1") / 2))
    byte=$(od -An -tu1 -j $at -N 1 bad | tr -d ' ')
    # shellcheck disable=SC2059
    printf "\\$(printf %03o $((255 - byte)))" | dd of=bad bs=1 seek=$at conv=notrunc 2>/dev/null
}
for kept in "$top"/tests/golden/kept/*; do
    of=${kept##*/}
    mkdir "$of" && cd "$of" && cp "$kept"/* . || exit 1
    # Within one minor version the bits stay.
    strict() { [ "$of" = "$version" ] && [ "$changes" -eq 0 ]; }
    { read -r agree && read -r state; } <said.txt
    check "$of: the model is read" "$SMR" info model.smr
    check "$of: and registered" has_verdict look "$SMR" $register -o fresh
    "$SMR" replay run.log >out.txt 2>&1
    case $? in
    0) check "$of: the log agrees" grep -q "$agree" out.txt ;;
    *) check "$of: the log is read" sh -c "! $(strict && echo true || echo false) && grep -qE 'tick [0-9]+ of $(echo "$agree" | tr -dc 0-9) differs' out.txt" ;;
    esac
    has_verdict look "$SMR" $register --resume run.save -o resumed >why.txt
    case $?$(strict && echo strict) in
    0) ok "$of: the save goes on" ;;
    *strict) same "$of: the save goes on to its end $(cat why.txt)" "$(hash_of resumed)" "$state" ;;
    *) check "$of: the save is refused by its name" grep -q '^smr: run.save: .*save' err.txt ;;
    esac
    damaged model.smr && refused "$of: a damaged model" . "$SMR" info bad
    damaged run.log && refused "$of: a damaged log" . "$SMR" replay bad
    damaged run.save && refused "$of: a damaged save" . "$SMR" $register --resume bad -o no
    cd ..
done
finish
