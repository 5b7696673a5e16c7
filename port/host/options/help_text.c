/* help_text.c: the help text.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>

#include "options/options.h"

static const char *const lines[] = {
    "smr: shape-matching registration of surfaces onto surfaces or images",
    "",
    "  smr register --model FILE... --target FILE... -o DIR   deform the model onto the targets",
    "  smr register --model FILE... --reference VOLUME --target VOLUME [--landmarks MODEL TARGET] -o DIR",
    "                                                         deform the model into an image",
    "  smr build --model FILE... -o MODEL.smr                 prepare a model (--reference: for images)",
    "  smr info MODEL.smr | FILE...                           what a model is made of",
    "  smr measure A B [--source S]                           distances both ways, Hausdorff, folds",
    "  smr replay LOG [--threads N]                           repeat a registration that register --log recorded",
    "  smr phantom -o DIR [--seed N] [--small]                a computed thigh to try it on: model, images, truth",
    "  smr bench --figure2 | --soak -o DIR                    time and error against ignored vertices; budgets",
    "  smr --help | --version",
    "",
    "Files: PLY, STL, OBJ, legacy VTK polydata, each also with .gz; coordinates are LPS millimetres",
    "(a file that says SPACE=RAS is turned). Structures carry the base names of their files; several",
    "targets are matched to them by name, one target serves all, the others are carried along.",
    "register writes DIR/NAME.ply for every structure and DIR/report.json; a .smr may be its model.",
    "",
    "Volumes: MetaImage, NIfTI-1, NRRD, also .gz. The reference is the image that fits the model's surfaces; a",
    ".smr built with --reference needs none. Landmarks: Slicer .mrk.json or .fcsv, or CSV label,x,y,z.",
    "",
    "register, and its defaults:",
    "  --landmarks MODEL TARGET        start by landmarks, matched by label: a thin-plate spline",
    "  --truth DIR                     with an image: measure the result against DIR/NAME.ply",
    "  --smoothing MM                  of that spline: 0 passes through every landmark (0; into an image 100)",
    "  --align none|rigid|similarity   start pose from the surfaces (none); with landmarks: fitted to them, no spline",
    "  --mirror-target x|y|z           negate a coordinate of the targets; --mirror-model likewise",
    "  --threads N                     (as many as processors)   --ticks N       upper bound (the schedule)",
    "  --budget-ms X                   time per tick, 0: no clock, deterministic (0)",
    "  --method rigid|polar            (rigid)                   --search MM     (60)",
    "  --stiffness X                   (0.8)                     --attraction X  target to model (0.5)",
    "  --slide X  share of goals along the surface (0)           --even X  last radius: as neighbours (0.5)",
    "  --relaxation X                  (1)                       --normal-angle DEG  (75)",
    "  --normals carried|exact         (carried)                 --node-budget N (512)",
    "  --reject-deviations X           (0: off)                  --reject-border",
    "  --plastic-um X                  (50)                      --plastic-every N (1)",
    "  --iterations N                  per radius (9)            --iterations-last N (60)",
    "  --active X                      share of the vertices that take part, the most important first (1)",
    "  --active-first X                the same at the start of the schedule, from where it grows (1)",
    "  --log FILE                      record what is done, for smr replay: the command line, checksums of the inputs, "
    "each tick",
    "  --quiet                         print nothing",
    "with a volume as the target the defaults are --radius 60,40,25,15 (larger ones first for a single structure) "
    "--search 30,2 (along the",
    "normal, at most 60) --plastic-every 5 --iterations 20 --iterations-last 40; --align without landmarks,",
    "--attraction, --normal-angle, --node-budget and --reject-... are for surfaces. More of images:",
    "  --search MM[,MM]                of profiles, first and last (30,2), at most half a radius",
    "  --gradient MM[,MM]              search for the edge, first and last (5,2)",
    "  --similarity ncc|ssd|concordance (the last)               --confidence X  least of a goal (0.3)",
    "  --sideways X  share of the image's way along the surface (0.5)",
    "  --active-enough N               active vertices of the smallest cluster that do, 0: --active alone decides (30)",
    "  --profile-samples N             (20)                      --profile-step MM (0.5)",
    "  --profile-inward X              share of the samples on the inner side (chosen from the voxels)",
    "phantom: --seed N another patient (1); --small fewer vertices and voxels; --threads N; --quiet",
    "bench: --figure2 writes figure2.csv and figure2.svg: times by one thread, errors by --threads N; --repeats N of",
    "  the times (7); --step N % ignored from point to point (10). --soak writes soak.csv: how far ticks end beyond",
    "  budgets of 1 to 33 ms by the wall clock; --seconds X each (4). Both: the computed thigh (--seed N, --small),",
    "  or --model, --reference, --target, --truth, --landmarks as for register; --quiet",
    "preparing (register, build, info):",
    "  --radius MM[,MM...]             cluster radii, coarse to fine (chosen from the surfaces)",
    "  --clusters auto|shared|separate (auto: separate at small radii)",
    "  --distance euclidean|geodesic   (euclidean)               --mass unit|area (unit)",
    "  --order forest|breadth-first    (forest)                  --block N        (chosen)",
    "build: --c-array NAME             C source instead when -o ends in .c, else beside it",
    "",
    "replay reads the inputs again, from where it is called, and says that all ticks agree, or which one differs; "
    "--threads N",
    "Exit status: 0 done, 1 not converged within --ticks, nothing of the target seen (results are written) or a replay "
    "that",
    "differs, 2 bad usage or input.",
};

void host_help(void)
{
    size_t i = 0;
    for (i = 0; i < sizeof lines / sizeof lines[0]; i++)
        (void)puts(lines[i]);
}
