#!/bin/sh
# Volumes and meshes are read as nibabel and VTK read them: places within 1e-4 mm, values equal. Skipped without them
# (Debian: python3-nibabel, python3-vtk9).
# SPDX-License-Identifier: MIT
cd "$(dirname "$0")/../.." || exit 1
. tests/host/host_common.inc
cd "$top" || exit 1
for module in nibabel vtk; do
    mkdir "$scratch/$module"
    python=${PYTHON:-python3}
    # a Python of the user's own need not have what Debian's has
    "$python" -c "import $module" 2>/dev/null || python=/usr/bin/python3
    "$python" tests/host/read_alike.py $module "$volume" "$tool" "$scratch/$module" \
        >"$scratch/said" 2>"$scratch/errors"
    status=$?
    if [ $status -eq 77 ] || ! command -v "$python" >/dev/null 2>&1; then
        skip "read as $module reads" "needs $python with $module"
        continue
    fi
    while IFS= read -r line; do
        case $line in
        "ok "*) ok "${line#ok }" ;;
        "not ok "*) not_ok "${line#not ok }" ;;
        *) echo "$line" ;;
        esac
    done <"$scratch/said"
    [ $status -eq 0 ] || { not_ok "read as $module reads"; sed 's/^/#   /' "$scratch/errors" | tail -5; }
done
finish
