#!/bin/sh
# scene.sh: scenes of --slicer drawn by VTK off-screen, and what the pictures must show; `make check-itk` runs it.
# SPDX-License-Identifier: MIT
# usage: BUILD=... SMR=... scene.sh      ends with 77 where VTK or a display is missing; pictures stay in BUILD/scene
cd "$(dirname "$0")/../.." || exit 1
out=$(pwd)/${BUILD:-build}/scene
python=
for candidate in python3 /usr/bin/python3; do
    [ -n "$python" ] || { "$candidate" -c 'import numpy, vtkmodules' 2>/dev/null && python=$candidate; }
done
[ -n "$python" ] || { echo "skip: needs python3-vtk9 and python3-numpy"; exit 77; }
command -v xvfb-run >/dev/null || { echo "skip: needs xvfb"; exit 77; }
. tests/host/host_common.inc
mkdir -p "$out" || exit 1
cd "$scratch" || exit 1
draws() { xvfb-run -a -s "-screen 0 1400x1400x24 -noreset" "$python" "$top/tests/itk/scene_render.py" "$1" "$2"; }
"$SMR" phantom --small --quiet -o thigh
set -- --model thigh/model/*.ply --quiet --accept look
check "register into an image" "$SMR" register "$@" --reference thigh/mri_reference.mha --target thigh/mri_patient.mha \
    --landmarks thigh/landmarks_reference.mrk.json thigh/landmarks_patient.mrk.json -o image --slicer image/scene.mrml
check "models over the patient's image, and the model's image carried there" draws image/scene.mrml "$out/image.png"
check "register onto surfaces" "$SMR" register "$@" --target thigh/truth/*.ply -o onto --slicer onto/scene.mrml
check "models and targets" draws onto/scene.mrml "$out/surfaces.png"
# The field of the scene is the inverse one: with the other one the images do not fit.
"$SMR" field --result image --spacing 3 -o image/field.nrrd --quiet
check "the other direction is seen to be wrong" sh -c "xvfb-run -a -s '-screen 0 1400x1400x24 -noreset' '$python' '$top/tests/itk/scene_render.py' image/scene.mrml wrong.png | grep -q '^not ok the transform'"
finish
