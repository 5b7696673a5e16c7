# shellcheck shell=sh disable=SC2086,SC2046
# cases: experiments on data as they are, a function for each group; written with the words of experiments.sh, which reads it.
# SPDX-License-Identifier: MIT

groups='thigh parts track persons references volume contact landmarks scene verdict shown noise points mri ct fusing joints budgets dense' # the longest first
! full || groups="views carry $groups"

thigh='--model data/hip_thigh_vhm/*.ply --reference data/thigh_patient/mri_reference.mha'
marks() { echo "--landmarks data/thigh_patient/landmarks_reference.mrk.json ${2:-data/thigh_$1/landmarks_$1.mrk.json}"; }
into() { echo "--target data/thigh_$1/mri_$1.mha --truth data/thigh_$1/truth $(marks "$@")"; } # person, landmarks

seven='m_right 2008 2007 vhm_left hip_thigh hip_bone hip_right'
femurs='m_right 2008 2007 vhm_left hip_thigh'
file_of() { # bone
    case $1 in
    m_right) echo data/femurs/femur_m_right.ply ;; 2008) echo data/femurs/femur_2008_0019_left_3k.ply ;;
    2007) echo data/femurs/femur_2007_5028_left_3k.ply ;; vhm_left) echo data/femurs/femur_vhm_left.ply ;;
    hip_thigh) echo data/hip_thigh_vhm/femur.ply ;; hip_bone) echo data/hip_thigh_vhm/hip_bone.ply ;;
    hip_right) echo data/ct_hips_surfaces/hip_bone_right.ply ;;
    esac
}
as_left() { case $1 in *_left | 200*) file_of "$1" ;; *) echo "x:$(file_of "$1")" ;; esac; } # right ones are mirrored

# ---------------------------------------------------------------- images

# The paper's experiment: 24 structures into the image of a known patient and of another real person. Starts that are
# off: landmarks moved by up to 20 mm along each axis.
group_thigh() {
    need hip_thigh_vhm thigh_patient thigh_person || return
    smr build $thigh -o thigh.smr
    into_thigh() { who=$1; row=$2; shift 2; register $row --model thigh.smr $(into $who) "$@"; }
    off() { tool click data/thigh_$1/landmarks_$1.mrk.json 20 $2 off.csv && register off_$1:$2 --model thigh.smr $(into $1 off.csv); }
    into_thigh patient patient
    into_thigh person person
    within patient status 0 to 0.2 from 0.2 worst_to 0.5 worst_from 0.5 by_vertex 1.6 folds 0 1-started_landmarks_spline 0
    within person status 0 to 1 from 1 worst_to 5 worst_from 5 folds 10
    full || return 0
    for seed in $(seq $(either all 20 1)); do off patient $seed; done
    over off_patient
    within off_patient mean-patient.mean 0.1 patient.mean-mean 0.1 mean_most 0.5
    for seed in $(seq $(either all 10 1)); do off person $seed; done
    over off_person
    within off_person mean-person.mean 0.5 person.mean-mean 0.5 mean_most-person.mean 0.5 person.mean-mean_least 0.5
    for x in $(either all '0.2 0.4 0.6 0.8 0.95' '0.2 0.95'); do into_thigh patient stiffness_$x --stiffness $x; within stiffness_$x mean 0.5; done
    for x in $(either all '5 10 15 20' 5); do into_thigh patient search_$x --search $x; within search_$x mean 0.5; done
    for x in $(either all '20 40 60 80' 20); do
        into_thigh patient fixed_$x --active-enough 0 --active 0.$x
        within fixed_$x mean 0.5
        into_thigh patient growing_$x --active-enough 0 --active-first 0.$x
        within growing_$x mean 0.5
    done
    into_thigh patient all --active-enough 0 --active 1
    within all mean 0.5
    into_thigh patient polar --method polar
    apart patient polar
    bound 'polar, not rigid: to the truth, more' polar.to-patient.to 0.1
    bound 'polar, not rigid: from the truth, more' polar.from-patient.from 0.1
    within polar apart 0.1
    register paper $thigh $(into patient) --paper # a reference written independently came to 0.19 and 0.22 mm
    within paper to 0.25 from 0.25
}

# Rician noise of 5, 10 and 20 % of the images' 99.5 percentile.
group_noise() {
    need hip_thigh_vhm thigh_patient thigh_person || return
    smr build $thigh -o thigh.smr
    noise() { # who, percent, bound on the larger mean
        tool rician data/thigh_$1/mri_$1.mha noise.mha $(echo $2 | awk '{ print $1 / 100 }') 1
        register $1_$2 --model thigh.smr --target noise.mha --truth data/thigh_$1/truth $(marks $1)
        within $1_$2 mean $3 folds 0
    }
    noise patient 10 0.16
    full || return 0
    noise patient 20 0.27
    noise person 20 0.76
    all || return 0
    noise patient 5 0.12
    noise person 5 0.7
    noise person 10 0.7
}

apart() { # row, row: mean distance between vertices of the same index
    for file in $1/*.ply; do tool apart $file $2/${file##*/}; done |
        awk '$1 == "sum" { s += $2 } $1 == "vertices" { n += $2 } END { print "apart", s / n }' | keep $2
}

# A femur, with the image it was made from as the reference, 15 mm, 8 degrees and a deformation of 5 mm off; distances
# where the image shows it.
group_mri() {
    need femurs volumes/mri_hip_thigh_m.mha || return
    femur=data/femurs/femur_m_right.ply image=data/volumes/mri_hip_thigh_m.mha
    smr build --model $femur --reference $image -o femur.smr
    for seed in $(seq $(either short 1 10)); do
        tool displaced $femur $image $seed case && tool measure case case/model | sed 's/^/start_/' | keep mri:$seed
        # The image ends above the femur's end, of which the verdict tells.
        register mri:$seed --model femur.smr --target $image --landmarks case/from.csv case/to.csv --accept look
        measure mri:$seed case
        within mri:$seed to_seen 1 from_seen 1 2-start_to_seen 0
    done
    over mri
    # Landmarks that are up to 20 mm off carry no spline.
    for seed in $(seq $(either all 20 3)); do
        awk 'NR % 5 == 1' case/from.csv >few.csv
        tool click few.csv 20 $seed off.csv && register clicked:$seed --model femur.smr --target $image --landmarks few.csv off.csv --accept look
        measure clicked:$seed case
    done
    over clicked
    within clicked to_seen_most-1.15*to_seen_least 0
}

# Five subjects' femurs, brought to one topology by registering one onto each: of each an end is shown, and the other four
# follow it, one by one and as the shapes of one model. Errors are those of the part that is not shown.
group_references() {
    need femurs thigh_person || return
    five='person m_right 2008 2007 vhm_left'
    right_of() { case $1 in person) echo data/thigh_person/truth/femur.ply ;; m_right) file_of $1 ;; *) echo "x:$(file_of $1)" ;; esac; }
    mkdir one_person && cp data/thigh_person/truth/femur.ply one_person
    for k in m_right 2008 2007 vhm_left; do
        register one_$k --model one_person/femur.ply --target $(file_of $k) --align similarity $([ $k = m_right ] || echo --mirror-target x)
    done
    shown() { # row, shape whose case it is, words of the model
        tool pair case one_$2/femur.ply $(right_of $who) 0 0 $shares one_$who/femur.ply | keep $1
        tool spread case 12 0 1 0 from.csv to.csv
        register $1 --model $3 --target case/target/*.ply --landmarks from.csv to.csv --align similarity
        measure $1 case
        rm -r case $1
    }
    for who in $(either short 2008 "$five"); do
        others=$(echo $five | sed "s/\<$who\>//")
        first=$(echo $others | cut -d ' ' -f 1)
        smr build --model one_$first/femur.ply --also $(for k in $others; do [ $k = $first ] || echo one_$k; done) -o $who.smr
        for shares in $(either short '0.6:1' "$(either all '0.75:1 0:0.25 ' '')0.6:1 0:0.4"); do
            at=$who:$shares shares=$(echo $shares | tr : ' ')
            at=$(echo $at | tr -d .)
            sum=0 least=-1e9
            for k in $others; do
                shown alone:$at:$k $k one_$k/femur.ply
                sum="$sum+alone:$at:$k.unseen" least="max($least,-alone:$at:$k.unseen)"
            done
            shown blend:$at $first $who.smr
            record ratio:$at.mean "blend:$at.unseen/(($sum)/4)"
            record ratio:$at.best "-blend:$at.unseen/$least"
        done
    done
    over alone; over blend; over ratio
    bound 'not shown: blend over single references, mean' ratio.mean 0.88
    bound 'not shown: blend over single references, worst' ratio.mean_most 1.1
}

# Images that show the upper 30, 50 or 70 % of a bone, then reference images that show two thirds. Starts: landmarks that the
# image shows, spread over the bone, as they are and moved by up to 20 mm. True places: the patient's; those that a
# registration onto the whole true surface finds.
group_shown() {
    need hip_thigh_vhm thigh_patient thigh_person ct_hips_surfaces volumes/ct_hips.mha || return
    femur=data/hip_thigh_vhm/femur.ply hip=data/ct_hips_surfaces/hip_bone_right.ply
    mri=data/thigh_patient/mri_reference.mha ct=data/volumes/ct_hips.mha
    fixed='--settle-share 0 --curvature 0 --iterations 9 --iterations-last 60' # landmarks come from these results: they stay as drawn
    smr register --model $femur --target data/thigh_person/truth/femur.ply $(marks person) --smoothing 0 $fixed -o person
    smr register --model $hip --target data/ct_hips_surfaces/hip_bone_left.ply --mirror-target x --align rigid $fixed -o hip
    shown() { # row, seed of landmarks that are off or 0, most in the visible part, words
        row=$1 most=$3
        tool click $4/to.csv 20 $2 off.csv
        shift 3
        c=$1; shift
        register $row --vertex-errors --landmarks $c/from.csv off.csv "$@"
        measure $row $c
        within $row to_seen $most 'status*(3-status)' 0 ratio 2 0.5-ratio 0
    }
    for who in patient person hip; do
        model=$femur reference=$mri image=data/thigh_$who/mri_$who.mha whole=data/thigh_$who/truth/femur.ply most=1.3 words='--align rigid'
        case $who in
        patient) places=$whole ;;
        person) places=person/femur.ply most=3 words='' ;; # a rigid start is too far off
        hip) places=hip/hip_bone_right.ply model=$hip reference=$ct image=$ct whole=x:data/ct_hips_surfaces/hip_bone_left.ply words='--align rigid --mirror-target x' ;;
        esac
        tool crop 1 $image $places $model $places $whole all_$who
        tool spread all_$who 24 0 1 0 all_$who/from.csv all_$who/there.csv
        sign=$([ $who = hip ] && echo -1 || echo 1)
        awk -F , -v s=$sign '{ printf "%s,%.9g,%s,%s\n", $1, s * $2, $3, $4 }' all_$who/there.csv >all_$who/to.csv
        for share in $(either short 50 '30 50 70'); do
            tool crop 0.$share $image $places $model $places $whole case all_$who/from.csv all_$who/to.csv
            for seed in $([ $who = person ] || full && echo 0) $([ $who = person ] || echo 1); do
                shown $who:$share:$seed $seed $most case --model $model --reference $reference --target case/image.mha $words
            done
        done
        full || continue
        tool crop 0.67 $reference $model $model $places $whole case all_$who/to.csv all_$who/from.csv
        mv case/from.csv to && mv case/to.csv case/from.csv && mv to case/to.csv
        shown ${who}_reference 0 $most case --model $model --reference case/image.mha --target $image $words
    done
    over patient; over person; over hip
    full || return 0
    # A start by far landmarks ends beside the bone, and the verdict is not good.
    tool crop 0.7 data/thigh_person/mri_person.mha person/femur.ply $femur person/femur.ply data/thigh_person/truth/femur.ply case
    register wrong --model $femur --reference $mri --target case/image.mha $(marks person)
    within wrong good 0
}

# The right hip into the mirrored CT, whose right side is the left hip. The right verdict is "look": muscles look alike
# in CT and tendons end some millimetres off, which is told of the gluteus medius and minimus.
group_ct() {
    need ct_hips_surfaces volumes/ct_hips.mha || return
    d=data/ct_hips_surfaces
    mkdir truth
    extreme() { # label, surface's file, mirror, direction: the mean of the ten vertices that lie farthest in it
        tool vertices $2 | awk -v s=$3 -v d="$4 $5 $6" 'BEGIN { split(d, by) } { printf "%.6f %s %s %s\n", s * $1 * by[1] + $2 * by[2] + $3 * by[3], $1, $2, $3 }' |
            sort -rn | awk -v label="$1" 'NR <= 10 { x += $2; y += $3; z += $4 } END { printf "%s,%.12g,%.12g,%.12g\n", label, x / 10, y / 10, z / 10 }'
    }
    # By a right side in LPS: left of the body is +x, its back +y, its head +z. The field of view cuts the bones below.
    for side in right left; do
        s=$([ $side = left ] && echo -1 || echo 1) bone=$d/hip_bone_$side.ply femur=$d/femur_proximal_$side.ply
        extreme crest $bone $s 0 0 1
        extreme front $bone $s -0.5 -1 0.5
        extreme back $bone $s 0 1 0.3
        extreme symphysis $bone $s 1 -1 -0.5
        extreme trochanter $femur $s -1 0.5 0.3
        extreme head $femur $s 1 0 0.5
    done >all.csv
    head -n 6 all.csv >right.csv
    tail -n 6 all.csv >left.csv
    for file in $d/*_left.ply; do name=${file##*/}; cp $file truth/${name%_left.ply}_right.ply; done
    set -- --model $d/*_right.ply --reference data/volumes/ct_hips.mha --target data/volumes/ct_hips.mha \
        --mirror-target x --truth truth --landmarks right.csv left.csv --align rigid
    register start "$@" --search 0,0 --gradient 0,0 --iterations 1 --iterations-last 1 # no force acts
    register hip "$@"
    within hip status 3 3-status 0 1-started_landmarks_rigid 0 6-structures 0 1-good_hip_bone_right 0 \
        good_gluteus_medius_right 0 good_gluteus_minimus_right 0
    for name in femur_proximal gluteus_maximus gluteus_medius gluteus_minimus hip_bone iliopsoas; do
        within hip to_${name}_right 2
    done
}

# Points under the surfaces of the computed thigh, carried by a registration into its patient's image.
group_carry() {
    smr phantom $(either all '' --small) -o thigh
    register result --model thigh/model/*.ply --reference thigh/mri_reference.mha --target thigh/mri_patient.mha \
        --truth thigh/truth --landmarks thigh/landmarks_reference.mrk.json thigh/landmarks_patient.mrk.json
    for depth in 4 15; do
        tool depths $depth points.ply truth.ply thigh/model/*.ply
        smr carry --result result --points points.ply -o carried.ply
        tool apart carried.ply truth.ply | awk '{ v[$1] = $2 } END { print "error", v["sum"] / v["vertices"] }' | keep depth_$depth
    done
    bound '4 mm under the surface, more than the vertices' depth_4.error-result.by_vertex 0.4
    bound '15 mm under the surface, more than the vertices' depth_15.error-result.by_vertex 1
}

# ---------------------------------------------------------------- surfaces

# Structures that keep apart, with the force off and on; a femur around a computed stem.
group_contact() {
    need hip_thigh_vhm thigh_patient thigh_person femurs || return
    onto() { # row, structures, words
        row=$1 model="" target=""
        for name in $2; do model="$model data/hip_thigh_vhm/$name.ply" target="$target data/thigh_patient/truth/$name.ply"; done
        shift 2
        register $row --model $model --target $target $(marks patient) "$@"
    }
    keeps_apart() { # what, farther
        within on_$1 deepest/off_$1.deepest 0.2 overlap/off_$1.overlap 0.2 mean-off_$1.mean $2 folds-off_$1.folds 10
    }
    names=$(either short 'femur vastus_intermedius rectus_femoris' \
        "$(cd data/hip_thigh_vhm && echo *.ply | sed 's/\.ply//g')")
    onto off_surfaces "$names"
    onto on_surfaces "$names" --contact
    keeps_apart surfaces 0.1
    # The neighbour does not move: of the surfaces that the patient's femur reaches into. Two starts, for a deepest
    # place is one vertex: by landmarks, and the model where it is.
    for start in "$(marks patient)" ''; do
        for with in '' --contact-with; do
            row=fixed${with:+_on}${start:+_marks}
            register $row --model data/hip_thigh_vhm/femur.ply --target data/thigh_patient/truth/femur.ply $start \
                ${with:+$with data/thigh_patient/truth/vastus_intermedius.ply}
            "$SMR" measure $row/femur.ply data/thigh_patient/truth/vastus_intermedius.ply |
                sed -n 's/^contact: deepest \([0-9.]*\) mm *overlap \([0-9.]*\) .*/cut \1\noverlap \2/p' | keep $row
        done
    done
    bound 'a fixed neighbour: deepest place, on over off, mean of two starts' \
        "(fixed_on.cut+fixed_on_marks.cut)/(fixed.cut+fixed_marks.cut)" 0.2
    for row in '' _marks; do within fixed_on$row overlap/fixed$row.overlap 0.05 mean-fixed$row.mean 0.1; done
    full || return 0
    register off_image $thigh $(into person)
    register on_image $thigh $(into person) --contact
    keeps_apart image 0.15
}

# Known deformations of models of about 4,000, 15,000 and 60,000 vertices: denser ones end no farther from the truth. In
# full also loops: of A onto B, registered back onto A, how far each vertex is from where it was.
group_dense() {
    need ct_hips_surfaces femurs hip_thigh_vhm thigh_person || return
    denser() { # bone, seed, deformation, sigma, densities
        for times in 0 $5; do
            row=dense_$times:$1:$2
            tool make seed=$2 deform=$3 sigma=$4 shift=0 turn=0 noise=0 dense=$times case $(file_of $1) >/dev/null
            register $row --model case/model/*.ply --target case/target/*.ply
            measure $row case
            rm -r case
        done
    }
    denser hip_right 1 12 40 1
    bound 'hip bone of 16,000 vertices: error over that of 4,000' dense_1:hip_right:1.vertex/dense_0:hip_right:1.vertex 1.1
    all || return 0
    denser hip_right 2 8 20 1
    denser hip_right 3 15 60 1
    denser 2008 1 12 40 '1 2'
    denser 2007 2 8 30 1
    for times in 0 1; do over dense_$times; done
    bound 'five of 15,000 vertices: error over that of 4,000' dense_1.vertex_sum/dense_0.vertex_sum 1.05
    bound 'a femur of 56,000 vertices: error over that of 4,000' dense_2:2008:1.vertex/dense_0:2008:1.vertex 1.1
    loop() { # row, A, B
        tool pair case $2 $3 0 0 -1 2 >/dev/null
        register there --model case/model/*.ply --target case/target/*.ply --align similarity
        register $1 --model there/*.ply --target case/model/*.ply --align similarity
        tool apart $1/*.ply case/model/*.ply | awk '{ v[$1] = $2 } END { print "loop", v["sum"] / v["vertices"] }' | keep $1
        rm -r case
    }
    loop loop_hip data/hip_thigh_vhm/hip_bone.ply data/thigh_person/truth/hip_bone.ply
    loop loop_ct $(file_of hip_right) x:data/ct_hips_surfaces/hip_bone_left.ply
    set -- $femurs
    while [ $# -gt 1 ]; do
        one=$1; shift
        for other; do loop femurs:$one:$other $(as_left $one) $(as_left $other); done
    done
    over femurs
    bound 'loop of a hip bone over another person' loop_hip.loop 0.9
    bound 'loop of a hip bone over the other side' loop_ct.loop 0.35
    bound 'ten loops of femurs over other people, mean' femurs.loop 0.45
}

# Transforms averaged by matrices and by logarithms: as close, and nothing folds more.
group_fusing() {
    need femurs hip_thigh_vhm thigh_patient || return
    compare() { # row, words, how far apart
        register $1_linear $2 --fusing linear
        register $1_lie $2 --fusing lie
        bound "$1: means differ by" "max($1_lie.mean-$1_linear.mean,$1_linear.mean-$1_lie.mean)" $3
        bound "$1: more folds" $1_lie.folds-$1_linear.folds 0
    }
    femurs="--model $(file_of 2007) --target $(file_of 2008) --align similarity --plastic-every"
    compare elastic "$femurs 0 --method rigid" 0.005
    all || return 0
    thighs="--model data/hip_thigh_vhm/*.ply --target data/thigh_patient/truth/*.ply $(marks patient) --plastic-every"
    compare plastic "$femurs 1 --method rigid" 0.002
    compare polar "$femurs 0 --method polar" 0.02
    compare thigh_plastic "$thighs 1 --method rigid" 0.005
    compare thigh_elastic "$thighs 0 --method rigid" 0.005
}

# Volumes that are kept. The area times the mean distance is at least what the volumes differ by, so volumes at rest have
# a distance that no method falls below. Smoothing: onto surfaces with noise, measured to those without.
group_volume() {
    need hip_thigh_vhm thigh_patient/truth || return
    names=$(either short 'femur sartorius' "$(cd data/hip_thigh_vhm && echo *.ply | sed 's/\.ply//g')")
    onto() { # row, directory of the targets, words
        row=$1 from=$2 model="" target=""
        shift 2
        for name in $names; do model="$model data/hip_thigh_vhm/$name.ply" target="$target $from/$name.ply"; done
        register $row --model $model --target $target --align rigid "$@"
    }
    truth=data/thigh_patient/truth
    tool size $(for n in $names; do echo data/hip_thigh_vhm/$n.ply; done) >rest
    tool size $(for n in $names; do echo $truth/$n.ply; done) >true
    onto off $truth
    onto same $truth --volume-ratio $(paste -d ' ' rest true | awk '{ printf "%s=%.9g ", $1, $5 / $2 }')
    onto kept $truth --volume
    onto asked $truth --volume-ratio $(awk '{ name[NR] = $1 } END { for (i = 1; i <= NR; i++) printf "%s=%.9g ", name[i], 0.8 + 0.45 * (i - 1) / (NR - 1) }' rest)
    paste -d ' ' rest true | awk '{ d = $5 - $2; differ += d < 0 ? -d : d; area += $6 } END { print "least", differ / area }' | keep kept
    for row in same kept asked; do
        within $row volume_off 0.01 folds-off.folds 0
    done
    bound "the target's volumes: distance" same.mean off.mean+0.05
    bound 'volumes at rest: distance' kept.mean kept.least+0.1
    names=$(either short femur 'femur sartorius vastus_lateralis gluteus_medius adductor_brevis')
    tool noisy noisy 1 7 $(for n in $names; do echo $truth/$n.ply; done)
    for x in 0 0.5 $(either all '0.2 0.7' ''); do
        onto smooth_$x noisy --smooth $x
        for name in $names; do "$SMR" measure smooth_$x/$name.ply $truth/$name.ply; done |
            awk '/^A to B: mean/ { s += $5; n++ } END { print "clean", s / n }' | keep smooth_$x
    done
    bound 'half is smoothed: to the surfaces without noise, over none' smooth_0.5.clean/smooth_0.clean 0.75
}

# Hip bone, femur and patella, deformed by 3 mm with noise of 0.5 mm, the hip flexed: onto a target of each, and onto one
# file of all. A figure of one surface with bent limbs, whole and without its upper third, whose arms nothing shows: the
# whole one is found, the third's lack moves little of the rest, and the verdict is good on neither.
group_joints() {
    need hip_thigh_vhm || return
    v=data/hip_thigh_vhm
    for degrees in $(either all '20 40 60' '40 60'); do for joined in $(either all '0 1' 1); do
        row=joint:$degrees:$joined whole=whole:$degrees:$joined
        tool make flex=$degrees joined=$joined deform=3 case $v/hip_bone.ply $v/femur.ply $v/patella.ply >/dev/null
        register $row --model case/model/*.ply --target case/target/*.ply --align parts
        measure $row case
        within $row vertex 1 surface 0.3 1-good 0
        if full; then # not as parts: never good where it is wrong
            register $whole --model case/model/*.ply --target case/target/*.ply
            measure $whole case
            bound "$whole: good beyond 3 mm" "$whole.vertex>3 && $whole.good" 0
        fi
        rm -r case
    done; done
    full || return 0
    for degrees in $(either all '20 40 60 90' '20 40 60'); do for cut in 0 1; do
        row=figure:$degrees:$cut
        tool figure 1 $degrees $cut case
        register $row --model case/model/*.ply --target case/target/*.ply --align rigid
        measure $row case
        bound "$row: good" "$row.good" 0
        [ $cut -eq 1 ] || within $row surface 0.3 vertex 0.5+$degrees*$degrees/1000
        case $row in figure:20:1) within $row shown 1.27 ;; figure:40:1) within $row shown 4 ;; figure:60:1) within $row shown 17.3 ;; esac
        rm -r case
    done; done
}
