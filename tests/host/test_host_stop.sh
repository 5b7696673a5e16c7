#!/bin/sh
# A set of results is a set: whatever system call of the writing fails or is interrupted, a report.json tells of the
# files beside it, and after a signal that can be caught no temporary file is left. Power that goes at a call, or in the midst
# of a write, and with it half of what was not synced, leaves the old save or the new one.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
need_stop "results cut off at every system call"
step=1 # another compiler stops at each third call
[ "${SMR_AGAIN:-0}" = 0 ] || step=3
blob 4 30 20 60 0 >a.ply
blob 5 30 20 60 0.05 >b.ply
blob 5 31 21 62 0.05 >t1.ply
blob 5 35 25 66 0.05 >t2.ply

# run TARGET: registers two structures into "out" with a log there; the environment says where it is stopped.
run() { # status 4: --ticks ends first
    "$SMR" register --model a.ply b.ply --target "$1" -o out --log out/run.log --ticks 3 --threads 2 --quiet
}
stopped() { LD_PRELOAD=$scratch/stop.so SMR_STOP_AT=$1 SMR_STOP_BY=$2 run t2.ply >out.txt 2>err.txt; }
hash_of() { sed -n 's/.*"state_hash": "\([0-9a-f]*\)".*/\1/p' "$1/report.json"; }
same_set() { cmp -s "out/a.ply" "$1/a.ply" && cmp -s out/b.ply "$1/b.ply" && cmp -s out/run.log "$1/run.log"; }

for t in 1 2; do
    rm -rf out
    run t$t.ply
    mv out "set$t"
done
check "the two sets differ" sh -c "! cmp -s set1/a.ply set2/a.ply && ! cmp -s set1/run.log set2/run.log"
check "and so do their reports" [ "$(hash_of set1)" != "$(hash_of set2)" ]
LD_PRELOAD=$scratch/stop.so SMR_STOP_COUNT=$scratch/fresh.count run t2.ply
rm -rf out && cp -r set1 out
LD_PRELOAD=$scratch/stop.so SMR_STOP_COUNT=$scratch/old.count run t2.ply
check "a run that is not stopped replaces the set" same_set set2
check "the calls are counted" [ "$(cat old.count)" -ge 20 ]

# judge BY: is "out" what it claims to be? Prints what is wrong.
judge() {
    if [ -e out/report.json ]; then
        claims=set2
        [ "$(hash_of out)" = "$(hash_of set1)" ] && claims=set1
        same_set $claims || echo "report.json of $claims beside other files"
    fi
    case $1 in
    power | torn | broken) ;;
    *) ls -A out 2>/dev/null | grep -vxE 'a\.ply|b\.ply|carry\.bin|run\.log|report\.json' ;;
    esac
}

# every NAME BY STATUS START: stops at each call in turn. START: the old set in "out", or "" for no directory.
every() {
    every_name=$1 by=$2 wanted=$3 start=$4 n=1 wrong=
    last=$(cat "$([ -n "$start" ] && echo old.count || echo fresh.count)")
    while [ $n -le "$last" ]; do
        rm -rf out
        [ -z "$start" ] || cp -r "$start" out
        stopped $n "$by"
        status=$?
        found=$(judge "$by")
        # The last call of all may fail: the set is whole then.
        [ $status -eq "$wanted" ] || { [ "$wanted" != 137 ] && [ $status -eq 4 ] && same_set set2; } ||
            found="$found status $status"
        [ -n "$start" ] || [ "$wanted" = 137 ] || [ "$by" = broken ] || [ -e out/report.json ] || [ ! -e out ] ||
            found="$found a directory without report.json is left"
        [ -z "$found" ] || wrong="$wrong call $n: $found;"
        n=$((n + step))
    done
    if [ -z "$wrong" ]; then ok "$every_name ($last calls)"; else not_ok "$every_name: $wrong"; fi
}

for start in set1 ""; do
    where=$([ -n "$start" ] && echo "over an old set" || echo "into a new directory")
    every "a call fails, $where" fail 2 "$start"
    every "all calls fail from one on, $where" broken 2 "$start"
    every "SIGINT, $where" 2 130 "$start"
    [ "${SMR_AGAIN:-0}" = 0 ] || continue # the other signals take the same way, or none
    every "SIGTERM, $where" 15 143 "$start"
    every "SIGHUP, $where" 1 129 "$start"
    every "power goes, $where" power 137 "$start"
    every "power goes in the midst of a write, $where" torn 137 "$start"
done

# save TICKS ARGUMENTS...: registers, and saves after so many ticks.
save() {
    save_ticks=$1
    shift
    "$SMR" register --model a.ply b.ply --target t2.ply -o out --ticks "$save_ticks" --save out/run.save --threads 1 --quiet "$@"
}
for t in 3 5; do
    rm -rf out && save $t
    mv out/run.save $t.save
done
check "the two saves differ" sh -c "! cmp -s 3.save 5.save"
"$SMR" register --model a.ply b.ply --target t2.ply -o whole --threads 1 --quiet
# resumes SAVE: the save leads to the result of one run.
resumes() {
    "$SMR" register --model a.ply b.ply --target t2.ply -o rest --resume "$1" --threads 1 --quiet
    [ "$(hash_of rest)" = "$(hash_of whole)" ]
}
for old in 3.save ""; do
    for by in power torn; do
        n=1 wrong='' last=1 n_new=0
        while [ $n -le $last ]; do
            rm -rf out && mkdir out
            [ -z "$old" ] || cp $old out/run.save
            LD_PRELOAD=$scratch/stop.so SMR_STOP_AT=$n SMR_STOP_BY=$by save 5 2>err.txt
            if [ $? -eq 137 ]; then last=$((n + step)); fi
            if cmp -s out/run.save 5.save; then n_new=$((n_new + 1))
            elif [ -n "$old" ]; then cmp -s out/run.save $old || wrong="$wrong $n"
            elif [ -e out/run.save ]; then wrong="$wrong $n"; fi
            [ "${SMR_FULL:-0}" = 0 ] || [ ! -e out/run.save ] || resumes out/run.save || wrong="$wrong $n"
            n=$((n + step))
        done
        [ $last -gt 20 ] && [ $n_new -ge 1 ] || wrong="$wrong: $last calls, $n_new new ones"
        if [ -z "$wrong" ]; then ok "a save over '$old', $by: old or new after each of $last calls"; else
            not_ok "a save over '$old', $by: neither old nor new after call$wrong"
        fi
    done
done
check "the old save goes on" resumes 3.save
check "the new save goes on" resumes 5.save

# nohup: an ignored signal stays ignored.
rm -rf out
(trap '' HUP; stopped 3 1)
check "an ignored SIGHUP does not stop the run" same_set set2
finish
