#!/bin/sh
# smr-register: `smr register` as a command line module of 3D Slicer (SlicerExecutionModel); --xml describes it.
# SPDX-License-Identifier: MIT
#
# Installed without a dot in its name in a folder of its own, PREFIX/lib/smr/slicer, which is what Slicer's settings take
# as an additional module path. Options are those of `smr register` but for
#   --image VOLUME                 a target that is a volume
#   --model-landmarks FILE, --target-landmarks FILE     the two files of --landmarks
#   --output SURFACE               the result, PLY, STL, VTK or OBJ by its extension; of a model of one structure
#   --field FILE.nrrd              NRRD: the transform that carries points and images of the model to the patient
#   --returnparameterfile FILE     verdict and expected error
# Slicer passes each number and word, also where nobody changed it: what has the default that --xml says is dropped, so
# that the target's kind decides. -o DIR keeps all results: smr writes there. No output may be an input. Exit status:
# 0 also where somebody should look at the result, since Slicer loads nothing otherwise; else that of smr.
set -u
case $0 in */*) here=${0%/*} ;; *) here=. ;; esac
link=$(readlink -f "$0" 2>/dev/null) && [ -n "$link" ] && here=${link%/*}
if [ -z "${SMR:-}" ]; then
    SMR=$here/../../../bin/smr
    [ -x "$SMR" ] || SMR=smr
fi
[ "${1:-}" = --xml ] && exec "$SMR" register --xml

refuse() { echo "smr-register: $*" >&2; exit 2; }
output= field= image= from= to= values= kept=
defaults=$("$SMR" register --xml) || exit 2
defaults=$(printf '%s\n' "$defaults" | sed -n '/<boolean>/d; s/.*<longflag>\([^<]*\)<.*<default>\([^<]*\)<.*/\1 \2/p')

# Whether a flag has a default; whether this value is the default, as a text or as a number.
has_default() { printf '%s\n' "$defaults" | grep -q "^$1 "; }
is_default() {
    [ -z "$2" ] && return 0
    printf '%s\n' "$defaults" | flag=$1 value=$2 awk '
        function number(t) { return t ~ /^[-+]?[0-9]*[.]?[0-9]+([eE][-+]?[0-9]+)?$/ }
        $1 == ENVIRON["flag"] { a = $2; b = ENVIRON["value"]; same = a "" == b "" || (number(a) && number(b) && a + 0 == b + 0) }
        END { exit !same }'
}

n=$#
while [ "$n" -gt 0 ]; do
    flag=$1
    shift
    n=$((n - 1))
    case $flag in
    --image | --model-landmarks | --target-landmarks | --output | --field | --returnparameterfile | -o)
        [ "$n" -gt 0 ] || refuse "$flag: expected a value"
        value=$1
        shift
        n=$((n - 1))
        case $flag in
        --image) image=$value ;;
        --model-landmarks) from=$value ;;
        --target-landmarks) to=$value ;;
        --output) output=$value ;;
        --field) field=$value ;;
        --returnparameterfile) values=$value ;;
        -o) kept=$value ;;
        esac
        ;;
    --*)
        if [ "$n" -gt 0 ] && has_default "${flag#--}"; then
            value=$1
            shift
            n=$((n - 1))
            is_default "${flag#--}" "$value" || set -- "$@" "$flag" "$value"
        else
            set -- "$@" "$flag"
        fi
        ;;
    *) set -- "$@" "$flag" ;;
    esac
done
[ -z "$image" ] || set -- "$@" --target "$image"
if [ -n "$from$to" ]; then
    [ -n "$from" ] && [ -n "$to" ] || refuse "landmarks: expected those of the model and those of the target"
    set -- "$@" --landmarks "$from" "$to"
fi

# The format by the output's name, which is the only surface then.
extension=ply
if [ -n "$output" ]; then
    case $output in
    *.ply) ;;
    *.stl) extension=stl ;;
    *.vtk) extension=vtk ;;
    *.obj) extension=obj ;;
    *) refuse "$output: expected a name that ends in .ply, .stl, .vtk or .obj" ;;
    esac
    set -- "$@" --format $extension
fi

# Whether this file is one of the inputs, or lies in a directory that is one.
# shellcheck disable=SC3013
is_input() {
    result=$1
    shift
    for word; do
        [ "$result" -ef "$word" ] && return 0
        [ -d "$word" ] || continue
        for one in "$word"/*; do
            [ "$result" -ef "$one" ] && return 0
        done
    done
    return 1
}
for wanted in "$output" "$field" "$values"; do
    [ -z "$wanted" ] || ! is_input "$wanted" "$@" || refuse "$wanted: expected an output that is none of the inputs"
done
scratch=$(mktemp -d) || exit 2
trap 'rm -rf "$scratch"' EXIT
trap 'exit 1' HUP INT TERM
out=${kept:-$scratch/out}
[ -z "$field" ] || set -- "$@" --slicer "$out/scene.mrml" # which has it beside it, as coarse as need be

echo '<filter-start><filter-name>smr register</filter-name><filter-comment>registering</filter-comment></filter-start>'
"$SMR" register "$@" --accept look -o "$out"
status=$?
[ "$status" -ne 2 ] && [ "$status" -lt 126 ] || exit 2

# copy RESULT OUTPUT: nothing is to be done where both are one file of DIR.
# shellcheck disable=SC3013
copy() { [ "$1" -ef "$2" ] || cp "$1" "$2" || exit 2; }
if [ -n "$output" ]; then # the folder may hold older surfaces: report.json says which is the result
    surface=$(sed -n '/^  "results": \[/,/^  \]/s/^ *"file": "\(.*\.'$extension'\)",*$/\1/p' "$out/report.json" |
        sed 's/\\\(["\\]\)/\1/g')
    [ -f "$out/$surface" ] || refuse "--output: expected a model of one structure, -o DIR takes several"
    copy "$out/$surface" "$output"
fi
[ -z "$field" ] || copy "$out/field.nrrd" "$field"
if [ -n "$values" ]; then
    sed -n 's/^  "verdict": "\([a-z]*\)".*/verdict = \1/p; s/^  "expected_error_mm": \([0-9.e+-]*\),*$/expected_error = \1/p' \
        "$out/report.json" >"$values" || exit 2
fi
echo '<filter-end><filter-name>smr register</filter-name></filter-end>'
exit "$status"
