#!/bin/sh
# cohort_engines: docs/examples/cohort by every engine that is there: the same table, also when killed in the middle.
# SPDX-License-Identifier: MIT
# usage: SMR=build/smr cohort_engines.sh [PATIENTS]     (12; minutes; the last line is the sum)
#
# GNU parallel, Snakemake and Slurm (Debian: parallel, snakemake, slurm-wlm); what is missing is skipped. Slurm is brought
# up here as one node: root, munged, slurmctld and slurmd with a configuration of their own; all of it is ended again.
set -u
cd "$(dirname "$0")/.." || exit 1
. tests/host/host_common.inc
export SMR
examples=$top/docs/examples/cohort
n=${1:-12}
base=$scratch
cd "$base" || exit 1
mkdir reference && cd reference || exit 1
sh "$examples/cases.sh" "$n"
started=$(date +%s)
JOBS=2 sh "$examples/run_xargs.sh" >log 2>&1
check "xargs: $n patients" test "$(grep -c . table.csv)" -eq $((n + 1))
echo "# xargs: $(($(date +%s) - started)) s; $(sed 1d table.csv | cut -d , -f 2 | sort | uniq -c | tr -s ' \n' ' ')"

begin() { mkdir -p "$base/$1" && cd "$base/$1" && ln -s ../reference/cases cases; }
done_now() { if [ -d runs ]; then cat runs/*.jsonl 2>/dev/null | grep -c 'skipped": false'; else echo 0; fi; }
# Waits until a third of all patients are done.
wait_for_some() {
    for tick in $(seq 3000); do
        [ "$(done_now)" -ge $((n / 3)) ] && return
        sleep 0.05
    done
}
# judge ENGINE EARLY: the table, and how often each patient was computed.
judge() {
    echo "# $1: $2 of $n done when it was killed; then $(done_now) computed, $(grep -c 'skipped": true' runs.jsonl) found done"
    check "$1: killed in the middle" test "$2" -ge 1 -a "$2" -lt "$n"
    check "$1: nothing lost" test "$(grep -o '"output": "[^"]*"' runs.jsonl | sort -u | wc -l)" -eq "$n"
    check "$1: nothing done twice" test -z "$(grep 'skipped": false' runs.jsonl | grep -o 'output": "[^"]*' | sort | uniq -d)"
    check "$1: the same table" cmp table.csv ../reference/table.csv
}
# Kills a whole session by its processes' numbers, without warning.
kill_session() {
    for tick in $(seq 20); do # some may be started meanwhile
        pids=$(ps -o pid= -s "$1")
        # shellcheck disable=SC2086
        [ -n "$pids" ] && kill -KILL $pids 2>/dev/null
        sleep 0.05
    done
    wait "$1" 2>/dev/null
}

# by_session ENGINE RESUME COMMAND...: starts the command, kills it and all that it started, resumes by the line RESUME.
by_session() {
    by_name=$1 by_resume=$2
    shift 2
    begin "$by_name"
    setsid "$@" >log 2>&1 &
    by_leader=$!
    wait_for_some
    kill_session $by_leader
    by_early=$(done_now)
    sh -c "$by_resume" >>log 2>&1 || { not_ok "$by_name: resumed"; tail -n 5 log | sed 's/^/#   /'; }
    judge "$by_name" "$by_early"
}

if command -v parallel >/dev/null && parallel --version 2>/dev/null | grep -q GNU; then
    by_session parallel "JOBS=2 sh $examples/run_parallel.sh" env JOBS=2 sh "$examples/run_parallel.sh"
else
    skip "GNU parallel" "not installed"
fi
if command -v snakemake >/dev/null; then
    snake="snakemake --snakefile $examples/Snakefile --cores 2"
    by_session snakemake "$snake --unlock; $snake --rerun-incomplete" $snake
else
    skip "Snakemake" "not installed"
fi

# ---------------------------------------------------------------- Slurm, one node

slurm=$base/slurm_files
start_slurm() { # ends with 0 once the node is idle
    "$slurm_munged" --force --foreground --key-file="$slurm/munge.key" --socket="$slurm/munge.socket" \
        --pid-file="$slurm/munged.pid" --log-file="$slurm/munged.log" --seed-file="$slurm/munged.seed" >"$slurm/munged.out" 2>&1 &
    munged=$!
    for tick in $(seq 50); do [ -S "$slurm/munge.socket" ] && break; sleep 0.1; done
    start_slurm_daemons
}
start_slurm_daemons() {
    slurmctld -D -f "$slurm/slurm.conf" >"$slurm/ctld.log" 2>&1 &
    slurmctld=$!
    slurmd -D -f "$slurm/slurm.conf" >"$slurm/slurmd.log" 2>&1 &
    slurmd=$!
    for tick in $(seq 200); do
        [ "$(sinfo -h -o %T 2>/dev/null)" = idle ] && return 0
        sleep 0.1
    done
    return 1
}
configure_slurm() {
    node=$(hostname -s)
    mkdir -p "$slurm/state" "$slurm/spool" && chmod 755 "$base" "$slurm" || return 1
    dd if=/dev/urandom of="$slurm/munge.key" bs=128 count=1 2>/dev/null && chmod 600 "$slurm/munge.key"
    cat >"$slurm/slurm.conf" <<END
ClusterName=one
SlurmctldHost=$node(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket=$slurm/munge.socket
CredType=cred/munge
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/spool
SlurmctldPidFile=$slurm/slurmctld.pid
SlurmdPidFile=$slurm/slurmd.pid
SlurmctldPort=16817
SlurmdPort=16818
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
SlurmctldTimeout=30
SlurmdTimeout=30
MinJobAge=10
SchedulerParameters=sched_interval=2
NodeName=$node NodeAddr=127.0.0.1 CPUs=$(getconf _NPROCESSORS_ONLN) State=UNKNOWN
PartitionName=all Nodes=$node Default=YES MaxTime=60 State=UP
END
    echo "CgroupAutomount=no" >"$slurm/cgroup.conf"
    export SLURM_CONF=$slurm/slurm.conf
}
# Ends the processes that were started here, and what they started.
kill_slurm() {
    for parent in $slurmd $slurmctld; do
        kill -KILL $(ps -o pid= --ppid "$parent") "$parent" 2>/dev/null
        wait "$parent" 2>/dev/null
    done
}
slurm_munged=$(command -v munged || ls /usr/sbin/munged 2>/dev/null)
if ! command -v sbatch >/dev/null || ! command -v slurmctld >/dev/null || ! command -v slurmd >/dev/null || [ -z "$slurm_munged" ]; then
    skip "Slurm" "not installed"
elif [ "$(id -u)" != 0 ] || ! configure_slurm || ! start_slurm; then
    skip "Slurm" "cannot be brought up here: $(tail -n 1 "$slurm/slurmd.log" "$slurm/ctld.log" 2>/dev/null | tr '\n' ' ')"
    [ -n "${slurmd:-}" ] && kill_slurm
    [ -n "${munged:-}" ] && kill "$munged"
else
    begin slurm
    setsid sh "$examples/run_slurm.sh" >log 2>&1 &
    leader=$!
    wait_for_some
    kill_session $leader # who waits for it
    jobs=$(squeue -h -o %A | sort -u | tr '\n' ' ')
    # shellcheck disable=SC2086
    scancel --signal=KILL --full $jobs && scancel $jobs
    for tick in $(seq 100); do [ -z "$(squeue -h)" ] && break; sleep 0.1; done
    early=$(done_now)
    sh "$examples/run_slurm.sh" >>log 2>&1 || { not_ok "Slurm: resumed"; tail -n 5 log | sed 's/^/#   /'; }
    judge slurm "$early"
    kill_slurm
    kill "$munged"
fi
finish
