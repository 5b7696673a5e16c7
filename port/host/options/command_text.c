/* command_text.c: the commands in words, the help of one command and of the whole program.
 * SPDX-License-Identifier: MIT */

#include <stdio.h>
#include <string.h>
#include "options/options_table.h"

#define TEXT_COLUMN 30 /* behind which sentences start */

#define MESH_FILES                                                                                                     \
    "Surfaces are PLY, STL, OBJ or legacy VTK polydata, each also with .gz; volumes MetaImage, NIfTI-1 or NRRD. "      \
    "Coordinates are LPS millimetres; a file that says SPACE=RAS is turned. Structures carry the base names of their " \
    "files."

#define MODULE                                                                                                         \
    "smr-register makes a module of 3D Slicer of register (--xml), with options of its own: --image VOLUME for "       \
    "--target, --model-landmarks FILE, --target-landmarks FILE, --output SURFACE, --field FILE.nrrd."

const host_command_text host_command_texts[] = {
    {"register",
     HOST_REGISTER,
     "deform a model onto surfaces, points or landmarks, or into an image",
     {"--model FILE... --target FILE... -o DIR [OPTION]...",
      "--model FILE... --reference VOLUME --target VOLUME [--landmarks MODEL TARGET] -o DIR [OPTION]...",
      "--model FILE... --landmark-goals MODEL NOW [--target FILE...] -o DIR [OPTION]..."},
     {MESH_FILES,
      "Several targets are matched to structures by name, one target serves all, and structures without one are "
      "carried along. A target without triangles is a cloud of points. The reference is the image that fits the "
      "model's surfaces; a .smr that was built with --reference needs none. Landmarks are Slicer's .mrk.json or .fcsv, "
      "or CSV with label,x,y,z.",
      "DIR gets NAME.ply for every structure, carry.bin for carry, field and warp, and report.json, which is written "
      "last: a directory without it is not a whole result. The report has a verdict, good, look or failed, with "
      "reasons and the error that is expected.",
      "Results are the same for any number of threads and on any processor."},
     "by the verdict: 1 failed, 3 look at it (0 with --accept look); 4 --ticks ended first. Results are written in "
     "each case"},
    {"track",
     HOST_TRACK,
     "follow a target that moves, frame by frame",
     {"--model FILE... --frames FILE... -o DIR [OPTION]..."},
     {MESH_FILES,
      "The model is registered onto the first frame and follows the others, surfaces or clouds of points. DIR gets "
      "FRAME/NAME.ply for every frame and structure, and track.csv with a line for each frame: time, ticks, residual, "
      "verdict, whether the target jumped."},
     "by the worst frame's verdict: 1 failed, 3 look at it (0 with --accept look)"},
    {"build",
     HOST_BUILD,
     "prepare a model",
     {"--model FILE... [--reference VOLUME] [--also DIR...] -o MODEL.smr [OPTION]..."},
     {"A prepared model saves the time of preparing, and is what devices get. With --reference it holds the intensity "
      "profiles that registrations into images need.",
      MESH_FILES},
     ""},
    {"info",
     HOST_INFO,
     "say what models, surfaces, volumes and landmarks are",
     {"FILE... [OPTION]..."},
     {"Of surfaces it says what the model of them would be, with the options of preparing; of a label map each "
      "structure with its voxels and volume.",
      MESH_FILES},
     ""},
    {"measure",
     HOST_MEASURE,
     "measure the distances between two surfaces",
     {"A B [--source S] [--threads N]", "LABELS LABELS|DIR [OPTION]..."},
     {"Distances are over the area, both ways: mean, root mean square, 95 % and the largest (Hausdorff); those of "
      "vertices alone stand apart. Also folds of A, new ones with --source, and where A and B are two bodies how they "
      "touch and overlap.",
      "Of label maps: Dice, Hausdorff 95, mean surface distance and volumes of each structure."},
     ""},
    {"carry",
     HOST_CARRY,
     "carry points to where a registration took them, or back",
     {"--result DIR --points FILE -o FILE [OPTION]..."},
     {"A smooth map of space, exact at the vertices, carries what lies between and beside them."},
     "3 of some points, which are named, the way back was not found"},
    {"field",
     HOST_FIELD,
     "write the displacement field of a registration, for ITK and 3D Slicer",
     {"--result DIR [--like VOLUME | --spacing MM] [--inverse] -o FILE"},
     {"Vectors in LPS millimetres: what is added to points of the model's space, or with --inverse to those of the "
      "result's space to lead them back."},
     ""},
    {"warp",
     HOST_WARP,
     "deform the model's image as the model was",
     {"--result DIR --volume VOLUME [--like VOLUME | --spacing MM] -o FILE"},
     {NULL},
     ""},
    {"summary",
     HOST_SUMMARY,
     "tell many results of register in one table",
     {"DIR... -o TABLE.csv [--html PAGE.html] [OPTION]..."},
     {"A row for each directory that register wrote, in the natural order of their names; a page of all with pictures, "
      "sorted by verdict."},
     "1 a report is missing or cannot be read"},
    {"surfaces",
     HOST_SURFACES,
     "make smooth closed surfaces of a label map's structures",
     {"LABELS -o DIR [OPTION]..."},
     {"Label maps are .nrrd, .seg.nrrd, .nii or .mha, also with .gz. DIR gets NAME.ply for each structure and "
      "labels.ctbl with their values and colours."},
     ""},
    {"labels",
     HOST_LABELS,
     "fill closed surfaces into a label map",
     {"DIR --like VOLUME -o FILE [OPTION]..."},
     {"Voxels in several surfaces go to that in which they lie deepest."},
     ""},
    {"replay",
     HOST_REPLAY,
     "repeat a registration from its log, to the last bit",
     {"LOG [--threads N]"},
     {"The inputs are read again, from where it is called. It says that all ticks agree, or which one "
      "differs."},
     "1 it differs"},
    {"phantom",
     HOST_PHANTOM,
     "compute a thigh of 24 structures to try it on",
     {"-o DIR [--seed N] [--small] [OPTION]..."},
     {"DIR gets model/NAME.ply, the image that fits it, a patient's image, landmarks of both and truth/NAME.ply, where "
      "the patient's surfaces are."},
     ""},
    {"bench",
     HOST_BENCH,
     "measure the paper's figures, and how budgets are kept",
     {"--figure1 | --figure2 | --soak -o DIR [OPTION]...",
      "--figure1 | --figure2 | --soak --model FILE... --target FILE... -o DIR [OPTION]..."},
     {"Of the computed thigh, or of files."},
     ""},
};

const size_t host_command_count = sizeof host_command_texts / sizeof host_command_texts[0];

const char *const host_option_groups[] = {"Options", "Surfaces as targets", "An image as the target",
                                          "Preparing the model (not with a .smr)", NULL};

const char host_status_text[] =
    "0 done; 2 bad usage or input, and nothing is written, or the text could not be printed: one line says which";

size_t host_option_group(const host_option *o, int command)
{
    if ((command & (HOST_REGISTER | HOST_TRACK)) == 0)
        return 0;
    if (o->prepares && o->setting != 0)
        return 3;
    return o->setting == 0 ? 0 : (size_t)o->targets;
}

static void print_option(const host_option *o, int command)
{
    char sentence[512];
    const int n = printf("  %s %s", o->name, host_option_value(o, command));
    host_option_sentence(o, command, sentence, sizeof sentence);
    (void)printf("%s%*s", n > TEXT_COLUMN ? "\n" : "", n > TEXT_COLUMN ? TEXT_COLUMN : TEXT_COLUMN - n, "");
    host_print_wrapped(TEXT_COLUMN, TEXT_COLUMN, sentence);
}

static void print_group(size_t group, int command)
{
    size_t n = 0;
    for (size_t i = 0; i < host_option_count; i++) {
        const host_option *const o = &host_option_table[i];
        if ((o->commands & command) == 0 || host_option_group(o, command) != group)
            continue;
        if (n++ == 0)
            (void)printf("\n%s:\n", host_option_groups[group]);
        print_option(o, command);
    }
}

int host_command_help(const char *name)
{
    const host_command_text *c = host_command_texts;
    char s[512];
    while (c < host_command_texts + host_command_count && strcmp(c->name, name) != 0)
        c++;
    if (c == host_command_texts + host_command_count)
        return -1;
    (void)printf("smr %s: %s\n\n", c->name, c->purpose);
    for (size_t i = 0; c->synopsis[i] != NULL; i++)
        (void)printf("%s smr %s %s\n", i == 0 ? "usage:" : "      ", c->name, c->synopsis[i]);
    for (size_t i = 0; c->paragraph[i] != NULL; i++) {
        (void)printf("\n");
        host_print_wrapped(0, 0, c->paragraph[i]);
    }
    for (size_t i = 0; host_option_groups[i] != NULL; i++)
        print_group(i, c->command);
    (void)snprintf(s, sizeof s, "Exit status: %s%s%s.", host_status_text, c->status[0] == '\0' ? "" : "; ", c->status);
    (void)printf("\n");
    host_print_wrapped(0, 0, s);
    return 0;
}

/* 1 when a command before this one has an option of which the same is said. */
static int is_said(const host_option *o, const host_command_text *command)
{
    char sentence[512], other[512];
    host_option_sentence(o, command->command, sentence, sizeof sentence);
    for (const host_command_text *c = host_command_texts; c < command; c++)
        for (size_t i = 0; i < host_option_count; i++) {
            const host_option *const p = &host_option_table[i];
            if ((p->commands & c->command) == 0 || strcmp(p->name, o->name) != 0)
                continue;
            host_option_sentence(p, c->command, other, sizeof other);
            if (strcmp(sentence, other) == 0)
                return 1;
        }
    return 0;
}

static void print_new_options(const host_command_text *c)
{
    size_t n = 0;
    for (size_t group = 0; host_option_groups[group] != NULL; group++)
        for (size_t i = 0; i < host_option_count; i++) {
            const host_option *const o = &host_option_table[i];
            if ((o->commands & c->command) == 0 || host_option_group(o, c->command) != group || is_said(o, c))
                continue;
            if (n++ == 0)
                (void)printf("\n%s:\n", c->name);
            print_option(o, c->command);
        }
}

void host_help(void)
{
    const host_command_text *const end = host_command_texts + host_command_count;
    char status[512];
    (void)printf("smr: shape-matching registration of surfaces onto surfaces or images\n\n");
    for (const host_command_text *c = host_command_texts; c < end; c++) {
        for (size_t i = 0; c->synopsis[i] != NULL; i++)
            (void)printf("  smr %s %s\n", c->name, c->synopsis[i]);
        (void)printf("%*s%s\n", TEXT_COLUMN, "", c->purpose);
    }
    (void)printf("  smr --help | --version | COMMAND --help\n\n");
    host_print_wrapped(0, 0, MESH_FILES);
    host_print_wrapped(0, 0, MODULE);
    (void)printf("\nOptions, each at the first command that has it. smr COMMAND --help has all of a command.\n");
    for (const host_command_text *c = host_command_texts; c < end; c++)
        print_new_options(c);
    (void)printf("\n");
    (void)snprintf(status, sizeof status, "Exit status: %s.", host_status_text);
    host_print_wrapped(0, 0, status);
    for (const host_command_text *c = host_command_texts; c < end; c++)
        if (c->status[0] != '\0') {
            (void)snprintf(status, sizeof status, "%s: %s.", c->name, c->status);
            host_print_wrapped(0, 0, status);
        }
}
