/* help_text.c: the help text of the whole program.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "options/option_text.h"

#define NAME_WIDTH 33 /* where sentences start */

static const char *const start_lines[] = {
    "smr: shape-matching registration of surfaces onto surfaces or images",
    "",
    "  smr register --model FILE... --target FILE... -o DIR   deform the model onto the targets",
    "  smr register --model FILE... --reference VOLUME --target VOLUME [--landmarks MODEL TARGET] -o DIR",
    "                                                         deform the model into an image",
    "  smr register --model FILE... --landmark-goals MODEL NOW [--target ...] -o DIR",
    "                                                         deform the model to tracked points, alone or as well",
    "  smr build --model FILE... -o MODEL.smr                 prepare a model (--reference: for images)",
    "  smr info MODEL.smr | FILE...                           what a model, volumes, label maps, landmarks are",
    "  smr measure A B [--source S]                           distances both ways, Hausdorff, folds",
    "  smr measure LABELS LABELS|DIR                          Dice, Hausdorff95, distances, volumes of label maps",
    "  smr track --model FILE... --frames FILE... -o DIR      follow a target that moves, frame by frame",
    "  smr replay LOG [--threads N]                           repeat a registration from its log, to the last bit",
    "  smr carry --result DIR --points FILE -o FILE           points to where a registration took them, or back",
    "  smr field --result DIR -o FILE                         its displacement field, for ITK and 3D Slicer",
    "  smr warp --result DIR --volume FILE -o FILE            the model's image, deformed as the model was",
    "  smr summary DIR... -o TABLE.csv [--html PAGE.html]     a row for each result of register; a page of all",
    "  smr surfaces LABELS -o DIR                             a label map's structures as smooth closed surfaces",
    "  smr labels DIR --like VOLUME -o FILE                   closed surfaces as a label map on the volume's grid",
    "  smr phantom -o DIR [--seed N] [--small]                a computed thigh to try it on: model, images, truth",
    "  smr bench --figure1 | --figure2 | --soak -o DIR        distance over time; ignored vertices; budgets",
    "  smr --help | --version | COMMAND --help                this text; all of a command's options",
    "",
    "Files: PLY, STL, OBJ, legacy VTK polydata, each also with .gz; coordinates are LPS millimetres",
    "(a file that says SPACE=RAS is turned). Structures carry the base names of their files; several",
    "targets are matched to them by name, one target serves all, the others are carried along.",
    "register writes DIR/NAME.ply for every structure and DIR/report.json; a .smr may be its model.",
    "smr-register makes a module of 3D Slicer of it (--xml), with options of its own beside these: --image VOLUME for",
    "--target, --model-landmarks FILE and --target-landmarks FILE, --output SURFACE, --field FILE.nrrd.",
    "",
    "Volumes: MetaImage, NIfTI-1, NRRD, also .gz. The reference is the image that fits the model's surfaces; a",
    ".smr built with --reference needs none. Landmarks: Slicer .mrk.json or .fcsv, or CSV label,x,y,z.",
    "",
    "register, and its defaults:",
    "  --landmarks MODEL TARGET       start by landmarks, matched by label: a thin-plate spline",
    "  --landmark-goals MODEL NOW     draw points of the model, carried along at rest, to where they are now; start",
    "                                 pose: fitted to them, unless --align or --landmarks say otherwise",
    "  --landmark-weight W|hard       of each, one over the variance of its place (1); hard: it ends there",
    "  --truth DIR|LABELS             with an image: measure the result against DIR/NAME.ply, or a label map",
    "  --smoothing MM                 of that spline: 0 passes through every landmark (0; into an image 100)",
    "  --align none|rigid|similarity  start pose from the surfaces (none); with landmarks: fitted to them, no spline",
    "  --mirror-target x|y|z          negate a coordinate of the targets; --mirror-model likewise",
    "  --threads N                    threads (as many as processors)",
    "  --ticks N                      upper bound of ticks (the schedule)",
    "  --budget-ms X                  time per tick, 0: no clock, deterministic (0)",
    "  --log FILE                     record what is done, for smr replay: the command line, checksums of the inputs,",
    "                                 each tick",
    "  --trace FILE.csv               a row for each iteration: radius, time, distances, likeness, strain, movement",
    "  --paper                        model and registration as the paper has them, where no option says otherwise;",
    "                                 also of track, build and info",
    "  --save FILE                    write where it stopped, after --ticks perhaps; --resume FILE goes on from there,",
    "                                 with the same inputs and options, to the same bits",
    "  --html                         report.html beside report.json: the result to look at in any browser, with",
    "                                 slices of the image, in one file",
    "  --vertex-errors                seen, expected_error (mm), local_volume of each vertex in the results (ply, vtk)",
    "  --format ply|stl|vtk|obj       of the results, binary but for OBJ; also of track (ply)",
    "  --slicer FILE.mrml             a scene for 3D Slicer: results, targets, volumes, landmarks, and the field",
    "                                 DIR/field.nrrd that carries the model's images and points to the patient",
    "  --volume                       closed structures keep the volume that they have at rest, in the start's scale;",
    "  --volume-ratio NAME=R...       structures get R times that volume, 0.1 to 10; the others keep theirs",
    "  --contact                      keep structures out of each other; also of track",
    "  --contact-with FILE...         surfaces that stay where they are, which structures keep out of, too",
    "  --accept good|look             the worst verdict whose exit status is 0 (good)",
    "  --json                         the result as one line of JSON on standard output, and nothing else there",
    "  --skip-done                    compute nothing where -o has this command's result of the same inputs: the same",
    "                                 exit status, and a line that says so; anything else is computed anew",
    "  --quiet                        print nothing",
};

static const char *const other_lines[] = {
    "  --clusters auto|shared|separate",
    "                                 separate at small radii (auto), nowhere or everywhere",
    "build: --c-array NAME            C source instead when -o ends in .c, else beside it",
    "track: each FILE of --frames, a surface or a cloud, is a frame, or a DIRECTORY with one a structure. Writes",
    "  DIR/FRAME/NAME.ply and DIR/track.csv; --fps N frames a second (30); --ticks N of a frame at most (30);",
    "  --points FILE goes along, as for carry: columns of track.csv, and DIR/FRAME/points in the file's format;",
    "  --track-radius MM of the clusters, the model's nearest to it (chosen); --track-ahead X of the last way, first;",
    "  --html DIR/report.html: frames in a 3D view, curves of track.csv; --align, --search, --coverage, --contact,",
    "  --contact-with, --volume and others as for register",
    "phantom: --seed N another patient (1); --small fewer vertices and voxels; --threads N; --quiet",
    "bench: --figure1 writes figure1.csv and figure1.svg: distance over time by one thread, for four radii; of the",
    "  computed thigh's femur (--seed N, --small), or --model, --target, --align, --landmarks as for register.",
    "  --figure2 writes figure2.csv and figure2.svg: times by one thread, errors by --threads N; --repeats N of",
    "  the times (7); --step N % ignored from point to point (10). --soak writes soak.csv: how far ticks end beyond",
    "  budgets of 1 to 33 ms by the wall clock; --seconds X each (4). Both: the computed thigh (--seed N, --small),",
    "  or --model, --reference, --target, --truth, --landmarks as for register; --quiet",
    "",
    "carry: points of the model's space: .mrk.json (orientations, too), .fcsv, .csv, surfaces, in and out; --inverse:",
    "  of the result's space; --threads N; --quiet. Exit status 3: of some points the way back was not found",
    "field: .nrrd or .mha, LPS: adds to points of the model's space their way (--inverse: of the result's space, which",
    "  is what deforms images and what 3D Slicer wants); --like VOLUME its grid, or --spacing MM around the model (3)",
    "warp: --volume the image that fits the model; --like VOLUME the patient's grid, or --spacing MM around the result",
    "surfaces: .nrrd, .seg.nrrd, .nii, .mha, also .gz. Writes DIR/NAME.ply and DIR/labels.ctbl; --names FILE of",
    "  lines \"7 femur\", or a colour table of 3D Slicer; --passes N of smoothing (80); --triangles N",
    "  of each structure at most (all); --threads N; --quiet",
    "labels: .seg.nrrd, .nrrd, .mha, .nii or .nii.gz. Voxels in several surfaces go to that in which they lie deepest;",
    "  values from DIR/labels.ctbl or --names FILE, else 1, 2 ... by name; --threads N; --quiet",
    "",
    "summary: of directories that register wrote, in the natural order of their names; --times columns of times, too;",
    "  --html a page with pictures, failed ones first; --quiet. Exit status 1: a report is missing or cannot be read",
    "",
    "replay reads the inputs again, from where it is called, and says that all ticks agree, or which one differs;",
    "  --threads N",
    "Exit status: 0 done; register: by the verdict in report.json, 0 good, 3 look, 1 failed, or 4 where --ticks ended",
    "first; track: by that of the worst frame; results are written in each case. 1 a replay that differs, 2 bad",
    "usage or input, or the text could not be printed.",
};

/* An option of register: name, value and sentence. */
static void print_option(const host_option *o)
{
    char sentence[512];
    const int n = printf("  %s %s", o->name, host_option_value(o, HOST_REGISTER));
    host_option_sentence(o, HOST_REGISTER, sentence, sizeof sentence);
    if (n < NAME_WIDTH - 1)
        (void)printf("%*s", NAME_WIDTH - 1 - n, "");
    host_print_wrapped(n < NAME_WIDTH - 1 ? NAME_WIDTH - 1 : (size_t)n, NAME_WIDTH - 1, sentence);
}

/* The options of register for this kind of target (0: any), or those of preparing, that set a setting. */
static void print_settings(const char *title, int prepares, int targets)
{
    size_t i = 0;
    (void)puts(title);
    for (i = 0; i < host_option_count; i++) {
        const host_option *const o = &host_option_table[i];
        const smr_setting *const s = host_option_setting(o);
        if (s != NULL && (o->commands & HOST_REGISTER) != 0 && o->prepares == prepares &&
            (prepares || o->targets == targets))
            print_option(o);
    }
}

static void print_lines(const char *const *lines, size_t n)
{
    size_t i = 0;
    for (i = 0; i < n; i++)
        (void)puts(lines[i]);
}

void host_help(void)
{
    print_lines(start_lines, sizeof start_lines / sizeof start_lines[0]);
    print_option(host_option_find("--search", HOST_REGISTER));
    print_settings("register, any target:", 0, 0);
    print_settings("register, surfaces as targets:", 0, HOST_FOR_SURFACES);
    print_settings("register, an image as the target:", 0, HOST_FOR_IMAGES);
    print_settings("preparing (register, track, build, info); profiles with register and build alone, for images:", 1,
                   0);
    print_lines(other_lines, sizeof other_lines / sizeof other_lines[0]);
}
