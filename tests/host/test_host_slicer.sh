#!/bin/sh
# The scripted module of 3D Slicer, port/slicer: its logic on real runs, its window with stand-ins for Slicer.
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
have python3 || { skip "the module" "no python3"; finish; }
blob 12 30 20 60 0.05 >bone.ply
blob 14 33 19 63 0.08 >target.ply
export SMR
for part in logic window; do
    mkdir "a $part"
    python3 "$top/tests/host/slicer_module.py" $part bone.ply target.ply "a $part" >said.txt 2>err.txt
    status=$?
    cat said.txt
    tail -n 3 err.txt | sed 's/^/#   /'
    passed=$((passed + $(grep -c '^ok ' said.txt)))
    failed=$((failed + $(grep -c '^not ok ' said.txt)))
    check "all of $part ran" [ $status -eq 0 ]
done
check "without a module of Slicer, numpy or VTK in its logic" sh -c "! grep -nE 'import (slicer|qt|ctk|vtk|numpy)' '$top/port/slicer/SmrRegisterLib/smr_run.py'"
finish
