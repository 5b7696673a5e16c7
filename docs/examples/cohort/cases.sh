#!/bin/sh
# cases.sh: makes computed patients to try a cohort on: cases.sh [N] writes cases/p1 to cases/pN.
# SPDX-License-Identifier: MIT
# SMR: the program. One that is there is left as it is.
set -eu
for seed in $(seq "${1:-12}"); do
    [ -d "cases/p$seed" ] || "${SMR:-smr}" phantom --small --seed "$seed" --quiet -o "cases/p$seed"
done
