# shellcheck shell=sh disable=SC2086,SC2046,SC2154
# cases_budgets: experiments on ticks that have a budget; read by experiments.sh, as cases.sh is.
# SPDX-License-Identifier: MIT

# Femurs 12 mm and 6 degrees off, structures and an image, in ticks of any budget: as near as without one and with the same
# verdict, and with --budget-exact the same bits; into an image always. All: 100 runs and 100 exact ones.
group_budgets() {
    need femurs || return
    hash_of() { sed -n 's/.*"state_hash": "\(.*\)".*/\1/p' $1/report.json; }
    budgeted() { # row, its case or nothing, distances, words of smr register
        free=$1 case=$2 distances=$3; shift 3
        one() { register "$@"; [ -z "$case" ] || measure "$1" $case; }
        one $free:0 "$@"
        for ms in $(either all '0.3 1 5 20' '0.3 5'); do for time in $(seq $(either all 5 1)); do
            at=$free:$time:$ms
            one $at "$@" --budget-ms $ms
            register exact "$@" --budget-ms $ms --budget-exact
            [ "$(hash_of $free:0)" = "$(hash_of exact)" ]; echo "$at.other $?" >>"$figures"
            within $at "max(good-$free:0.good,$free:0.good-good)" 0 other 0 $(for d in $distances; do echo "$d-1.05*$free:0.$d" 0.05; done)
            rm -r $at
        done; done
    }
    for bone in $(either all 'femur_2007_5028_left femur_2008_0019_left femur_vhm_left' femur_2007_5028_left_3k); do
        tool make seed=1 shift=12 turn=6 case data/femurs/$bone.ply | keep $bone
        smr build --model case/model/*.ply -o $bone.smr
        budgeted $bone case 'vertex surface' --model $bone.smr --target case/target/*.ply
        rm -r case
    done
    full && need hip_thigh_vhm hip_thigh_vhm_otherside thigh_patient || return 0
    smr build $thigh -o thigh.smr
    budgeted image '' mean --model thigh.smr $(into patient)
    ! all || budgeted thigh '' mean --model data/hip_thigh_vhm/*.ply --target data/hip_thigh_vhm_otherside/*.ply
}
