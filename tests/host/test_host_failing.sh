#!/bin/sh
# Reading, writing, or memory that fails at each call of each command, in turn: one line that names a file, exit status 2, no
# half-written file under a final name; or the call did not matter, and the result is whole. SMR_FULL=1: at each call, else at
# some; more registrations.
# SPDX-License-Identifier: MIT
# shellcheck disable=SC2086 # $run is words
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
need_stop "calls that fail"
blob 4 30 20 60 0 >a.ply
blob 4 30 20 60 0.05 >t.ply
cp t.ply u.ply
image v.mha 30 20 60

# Files below "out", with checksums of those that do not tell the time.
whole() {
    find out -type f 2>/dev/null | sort | while read -r f; do
        case $f in *.json | *.log | *.html | *.mrml | out/t*.csv) echo "$f" ;; *) cksum "$f" ;; esac
    done
}

# run VARIABLES ARGUMENTS...: into a new directory, or into one that is there already.
run() {
    run_with=$1
    shift
    rm -rf out
    [ "$made" = 0 ] || mkdir out
    # shellcheck disable=SC2086
    env MALLOC_PERTURB_=90 $run_with "$SMR" "$@" >out.txt 2>err.txt
}

# what_is_wrong STATUS: after a run in which a call failed.
what_is_wrong() {
    case $1 in
    "$good") [ "$(whole)" = "$wanted" ] || echo "status $1 with other results" ;;
    2)
        [ "$of" != memory ] || grep -q 'memory\|a system that starts them' err.txt || echo "no memory: $(head -n 1 err.txt)"
        [ "$(wc -l <err.txt)" -eq 1 ] || echo "$(wc -l <err.txt) lines: $(head -n 2 err.txt)"
        [ "$of" = memory ] || grep -qE "^smr: ($names): .*expected" err.txt || echo "no file: $(head -n 1 err.txt)"
        whole >left.txt # of a track frames that are whole stay
        [ "$1" = 2 ] && [ ! -e out/report.json ] && ! grep -vxF "$wanted" left.txt || echo "left: $(cat left.txt)"
        ;;
    1) grep -q ,unreadable, out/table.csv || echo "status $1: $(head -n 1 err.txt)" ;; # a row of a summary
    *) echo "status $1: $(head -n 1 err.txt)" ;;
    esac
}

# every NAME STEP ARGUMENTS...: fails at each STEP-th call for memory, and more often at others.
every() {
    every_name=$1 every_step=$2
    shift 2
    run "" "$@"
    good=$?
    wanted=$(whole)
    [ $good -ne 2 ] || not_ok "$every_name: $(cat err.txt)"
    for how in in:fail out:fail out:full memory:fail; do
        of=${how%:*} by=${how#*:} n=1 wrong=
        shim="LD_PRELOAD=$scratch/stop.so SMR_STOP_OF=$of"
        run "$shim SMR_STOP_COUNT=$scratch/count" "$@"
        last=$(cat count)
        step=1
        full || step=$(($([ "$of" = memory ] && echo 8 || echo 1) * every_step / 8 + 1))
        [ "${SMR_AGAIN:-0}" = 0 ] || step=$((3 * step))
        while [ $n -le "$last" ]; do
            run "$shim SMR_STOP_AT=$n SMR_STOP_BY=$by" "$@"
            found=$(what_is_wrong $?)
            [ -z "$found" ] || wrong="$wrong
#   call $n: $found"
            n=$((n + step))
        done
        if [ -z "$wrong" ]; then ok "$every_name, $how ($last calls)"; else not_ok "$every_name, $how:$wrong"; fi
    done
}

"$SMR" build --model a.ply -o a.smr --quiet
run="register --model a.ply --target t.ply --threads 1"
for more in "-o res --log run.log" "-o part --save 1.save"; do "$SMR" $run $more --ticks 3 --quiet; done
"$SMR" labels a.ply --like v.mha -o l.mha --quiet
printf 'label,x,y,z\na,1,2,3\nb,20,0,0\nc,0,20,4\nd,-5,-9,30\n' >p.csv
gzip -c t.ply >t.ply.gz
names='[avltu]\.(ply|mha|smr)|t\.ply\.gz|p\.csv|out.*|res.*|run\.log|1\.save|--[a-z]*'
made=0
every "register" 7 $run -o out --log out/run.log --ticks 3 --quiet
every "resume" 29 $run -o out --resume 1.save --save out/2.save --ticks 1 --quiet
every "track" 29 track --model a.ply --frames t.ply u.ply -o out --threads 1 --quiet
every "surfaces" 29 surfaces l.mha -o out --threads 1 --quiet
if full; then
    every "all outputs" 1 $run -o out --html --trace out/t.csv --slicer out/s.mrml --landmarks p.csv p.csv --ticks 3 --quiet
    every "a packed target" 1 register --model a.ply --target t.ply.gz --threads 1 -o out --ticks 3 --align rigid --quiet
    every "image" 1 register --model a.ply --reference v.mha --target v.mha -o out --iterations 2 --threads 1 --ticks 3 --quiet
fi
made=1
every "build" 7 build --model a.ply -o out/a.smr --quiet
every "carry" 7 carry --result res --points p.csv -o out/told.csv --quiet
every "field" 7 field --result res --spacing 30 -o out/field.mha --quiet
every "warp" 7 warp --result res --volume v.mha --spacing 30 -o out/w.mha --quiet
every "summary" 7 summary res -o out/table.csv --html out/page.html --quiet
every "labels" 7 labels a.ply --like v.mha -o out/l.mha --quiet
every "replay" 29 replay run.log --threads 1
every "measure" 7 measure a.ply t.ply
every "info" 7 info a.ply v.mha
finish
