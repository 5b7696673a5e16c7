/* option_text.c: what is said of each option: value, sentence, default.
 * SPDX-License-Identifier: MIT */
#include "options/options_table.h"
#include <stdio.h>
#include <string.h>

#define LINE_WIDTH 110
#define ONTO (HOST_REGISTER | HOST_TRACK)

/* Options that set none of the library's settings. Of an option that commands understand differently the first row that
 * names the command counts; commands 0: all that have it. */
static const struct {
    const char *name;
    int commands;
    const char *value, *text;
} option_texts[] = {
    {"--model", ONTO, "FILE...", "surfaces of the model, a structure each, or one prepared .smr"},
    {"--model", HOST_BENCH, "FILE...", "surfaces or a .smr, in place of the computed thigh"},
    {"--model", 0, "FILE...", "surfaces of the model, a structure each"},
    {"--also", 0, "DIR...",
     "results of registering the model onto further subjects, files named alike: what a target does not show follows a "
     "blend of all shapes"},
    {"--reference-prior", 0, "X", "strength of the prior that the shapes of several subjects have equal weights"},
    {"--target", HOST_BENCH, "FILE...", "what they are registered to: surfaces, or one volume"},
    {"--target", 0, "FILE...",
     "surfaces, clouds of points or one volume; several find their structures by name, one serves all"},
    {"--frames", 0, "FILE...",
     "each FILE is a frame, or each directory with a file for each structure, by name; or each is a volume"},
    {"--fps", 0, "N", "frames a second, for the times in track.csv (30)"},
    {"-o", HOST_BUILD, "MODEL.smr", "the model; C source where the name ends in .c"},
    {"-o", HOST_CARRY, "FILE", "the carried points: .mrk.json, .fcsv, .csv, .ply, .stl, .vtk or .obj"},
    {"-o", HOST_FIELD, "FILE", "the displacement field: .nrrd or .mha"},
    {"-o", HOST_WARP, "FILE", "the deformed volume: .nrrd or .mha"},
    {"-o", HOST_LABELS, "FILE", "the label map: .seg.nrrd, .nrrd, .mha, .nii or .nii.gz"},
    {"-o", HOST_SUMMARY, "TABLE.csv", "the table"},
    {"-o", HOST_BENCH, "DIR", "directory of the tables"},
    {"-o", 0, "DIR", "directory of the results; replaces files of the same names"},
    {"--result", 0, "DIR", "directory that smr register wrote"},
    {"--points", HOST_TRACK, "FILE",
     "points of the model's space that go along: columns of track.csv, and DIR/FRAME/points in the file's format"},
    {"--points", 0, "FILE", "points of the model's space: .mrk.json, .fcsv, .csv, or a surface file's vertices"},
    {"--volume", ONTO, "", "closed structures keep the volume that they have at rest, in the scale of the start"},
    {"--volume", 0, "VOLUME", "the image that fits the model"},
    {"--volume-ratio", 0, "NAME=R...",
     "structures get R times that volume, 0.1 to 10; the others keep theirs, as with --volume"},
    {"--names", HOST_LABELS, "FILE", "values of the structures (labels.ctbl in the directory; else 1, 2 ... by name)"},
    {"--names", 0, "FILE", "lines \"7 femur\", or a colour table of 3D Slicer: labels and their names"},
    {"--passes", 0, "N", "passes of smoothing the surfaces of a label map (80)"},
    {"--triangles", 0, "N", "at most so many triangles of each structure, by collapsing edges (all)"},
    {"--like", HOST_LABELS, "VOLUME", "the volume whose grid the label map has"},
    {"--like", HOST_WARP, "VOLUME", "the patient's image, whose grid the result has"},
    {"--like", 0, "VOLUME", "the field has this volume's grid"},
    {"--spacing", HOST_WARP, "MM", "spacing of the result's grid around the deformed model (the volume's)"},
    {"--spacing", 0, "MM", "spacing of the field's grid around the model (3)"},
    {"--inverse", HOST_FIELD, "",
     "on a grid in the result's space, leading back to the model: what deforms images and what 3D Slicer wants"},
    {"--inverse", 0, "", "points of the result's space, back to the model's"},
    {"--reference", 0, "VOLUME", "the image that fits the model's surfaces, for registrations into images"},
    {"--landmarks", 0, "MODEL TARGET",
     "start by two files of landmarks, matched by label: a thin-plate spline, or a pose with --align"},
    {"--landmark-goals", 0, "MODEL NOW",
     "draw points of the model, carried along at rest, to where they are now; the start pose is fitted to them unless "
     "--align or --landmarks say otherwise"},
    {"--landmark-weight", 0, "W|hard", "of each goal, one over the variance of its place; hard: it ends there (1)"},
    {"--contact", 0, "", "keep structures out of each other"},
    {"--contact-with", 0, "FILE...",
     "keep structures out of each other and of these surfaces, which stay where they are in the target's space"},
    {"--log", 0, "FILE", "record what is done, for smr replay: the command line, checksums of inputs, each tick"},
    {"--trace", 0, "FILE.csv", "a row for each iteration: radius, time, distances, likeness, strain, movement"},
    {"--html", HOST_REGISTER, "",
     "report.html beside report.json: the result to look at in any browser, with slices of the image, in one file"},
    {"--html", HOST_TRACK, "",
     "DIR/report.html: frames in a 3D view, curves of track.csv and what to look at, in one file for any browser"},
    {"--save", 0, "FILE", "write where it stopped, after --ticks perhaps"},
    {"--resume", 0, "FILE", "go on from what --save wrote, with the same inputs and options, to the same bits"},
    {"--json", 0, "", "the result as one line of JSON on standard output, and nothing else there"},
    {"--skip-done", 0, "",
     "compute nothing where -o has this command's result of the same inputs: the same exit status, and a line says so"},
    {"--html", HOST_SUMMARY, "PAGE.html", "a page with pictures, failed ones first"},
    {"--format", 0, "ply|stl|vtk|obj", "of the results, binary but for OBJ (ply)"},
    {"--slicer", 0, "FILE.mrml",
     "a scene for 3D Slicer: results, targets, volumes, landmarks, and the field DIR/field.nrrd"},
    {"--times", 0, "", "columns of times in the table, too"},
    {"--truth", 0, "DIR|LABELS", "with an image: measure the result against DIR/NAME.ply, or a label map"},
    {"--c-array", 0, "NAME", "also C source with the model as an array of this name, and a header of its sizes"},
    {"--source", 0, "FILE", "the surface before it was deformed: folds are counted, and lengths compared"},
    {"--mirror-model", 0, "x|y|z", "negate a coordinate of the model: another side's"},
    {"--mirror-target", 0, "x|y|z", "negate a coordinate of the targets"},
    {"--threads", 0, "N", "threads; no result depends on it (as many as processors)"},
    {"--ticks", HOST_TRACK, "N", "at most so many ticks a frame (30)"},
    {"--ticks", 0, "N", "at most so many ticks (the schedule)"},
    {"--budget-ms", 0, "MS", "time of a tick; 0: no clock, deterministic (0)"},
    {"--budget-exact", 0, "", "a budget leaves out no vertex: iterations span ticks, the result stays"},
    {"--align", 0, "none|rigid|similarity|parts",
     "start pose from the surfaces, parts: of each structure, for joints; with --landmarks: fitted to them, in place "
     "of the spline (none)"},
    {"--vertex-errors", 0, "", "results have seen (0, 1) and expected_error (mm) of each vertex"},
    {"--paper", 0, "", "model and registration as the paper has them, where no option says otherwise"},
    {"--accept", 0, "good|look", "the worst verdict whose exit status is 0 (good)"},
    {"--smoothing", 0, "MM",
     "of the landmarks' spline; 0 passes through each (0, into an image 100; or a pose, where six landmarks or more "
     "foretell each other no better by a spline)"},
    {"--quiet", 0, "", "print nothing but errors"},
    {"--clusters", 0, "auto|shared|separate",
     "whether clusters keep to their structure: at small radii, nowhere, everywhere (auto)"},
    {"--search", 0, "MM[,MM]", NULL}, /* two settings; their defaults follow */
    {"--seed", HOST_PHANTOM, "N", "another patient (1)"},
    {"--seed", 0, "N", "of the computed thigh (1)"},
    {"--small", 0, "", "fewer vertices and voxels"},
    {"--figure1", 0, "", "figure1.csv: distance over time by one thread, for four radii"},
    {"--figure2", 0, "", "figure2.csv: time and error over ignored vertices"},
    {"--soak", 0, "", "soak.csv: how far ticks end beyond budgets of 1 to 33 ms by the wall clock"},
    {"--repeats", 0, "N", "repetitions of figure 2's times (7)"},
    {"--step", 0, "N", "% ignored from point to point of figure 2 (10)"},
    {"--seconds", 0, "X", "s of --soak for each budget (4)"},
};

static size_t find_text(const host_option *o, int command)
{
    size_t i = 0;
    const size_t n = sizeof option_texts / sizeof option_texts[0];
    while (i < n && (strcmp(option_texts[i].name, o->name) != 0 ||
                     (option_texts[i].commands != 0 && (option_texts[i].commands & command) == 0)))
        i++;
    return i;
}

const char *host_option_value(const host_option *o, int command)
{
    const size_t k = find_text(o, command);
    const smr_setting *const s = host_option_setting(o);
    if (k < sizeof option_texts / sizeof option_texts[0])
        return option_texts[k].value;
    if (o->kind == HOST_KIND_WORD)
        return host_option_words(o);
    if (o->kind == HOST_KIND_FLAG)
        return "";
    if (o->kind == HOST_KIND_RADII)
        return "MM[,MM...]";
    if (o->kind == HOST_KIND_SPAN)
        return "MM[,MM]";
    if (o->kind == HOST_KIND_TEXT || o->kind == HOST_KIND_FILES)
        return "FILE";
    if (s != NULL && strcmp(s->unit, "mm") == 0)
        return "MM";
    if (s != NULL && strcmp(s->unit, "degrees") == 0)
        return "DEG";
    return o->kind == HOST_KIND_COUNT ? "N" : "X";
}

void host_setting_value(const smr_setting *s, double value, char *to, size_t bytes)
{
    const char *word = s->unit;
    if (s->kind != SMR_SETTING_CHOICE) {
        (void)snprintf(to, bytes, "%g", value);
        return;
    }
    for (; value >= 1.0 && strchr(word, '|') != NULL; value -= 1.0)
        word = strchr(word, '|') + 1;
    (void)snprintf(to, bytes, "%.*s", (int)strcspn(word, "|"), word);
}

/* The default, or both where images have another. */
static void print_default(const host_option *o, const smr_setting *s, char *to, size_t bytes)
{
    char value[64], image[64];
    const host_range range = host_option_range(o);
    host_setting_value(s, s->value, value, sizeof value);
    host_setting_value(s, s->image, image, sizeof image);
    to[0] = '\0';
    if (o->kind == HOST_KIND_FLAG)
        return;
    if (o->kind == HOST_KIND_SPAN) /* the table's next row is where it ends */
        (void)snprintf(to, bytes, " (%g,%g)", s->image, s[1].image);
    else if (o->kind == HOST_KIND_RADII)
        (void)snprintf(to, bytes, " (chosen from the surfaces; with a reference image 60,40,25,15)");
    else if (s->value < range.min)
        (void)snprintf(to, bytes, " (chosen)");
    else if (strcmp(value, image) == 0 || o->targets == HOST_FOR_SURFACES)
        (void)snprintf(to, bytes, " (%s)", value);
    else
        (void)snprintf(to, bytes, " (%s; into an image %s)", value, image);
}

/* Without its full stop; what the library's own default means is left out where the option does not take it. */
static int sentence_length(const host_option *o, const smr_setting *s)
{
    const size_t n = s->value < host_option_range(o).min ? strcspn(s->text, ";") : strlen(s->text);
    return (int)(n > 0 && s->text[n - 1u] == '.' ? n - 1u : n);
}

/* One option for two settings. */
static void print_search(char *to, size_t bytes)
{
    const smr_config surface = smr_config_default(), image = smr_config_default_image();
    (void)snprintf(to, bytes,
                   "surfaces: farthest closest point that is a goal (%g); an image: search distance of profile "
                   "matching, first and last (%g,%g), at most half a radius",
                   (double)surface.basic.search_mm, (double)image.image.profile_mm, (double)image.image.profile_end_mm);
}

void host_option_sentence(const host_option *o, int command, char *to, size_t bytes)
{
    const size_t k = find_text(o, command);
    const smr_setting *const s = host_option_setting(o);
    char standard[160];
    to[0] = '\0';
    if (k < sizeof option_texts / sizeof option_texts[0] && option_texts[k].text == NULL) {
        print_search(to, bytes);
    } else if (k < sizeof option_texts / sizeof option_texts[0]) {
        (void)snprintf(to, bytes, "%s", option_texts[k].text);
    } else if (s != NULL) {
        print_default(o, s, standard, sizeof standard);
        (void)snprintf(to, bytes, "%.*s%s%s", sentence_length(o, s), s->text,
                       o->kind == HOST_KIND_SPAN ? " and at its end" : "", standard);
        if (to[0] >= 'A' && to[0] <= 'Z' && !(to[1] >= 'A' && to[1] <= 'Z'))
            to[0] = (char)(to[0] - 'A' + 'a');
    }
}

void host_print_wrapped(size_t column, size_t left, const char *text)
{
    while (*text != '\0') {
        const size_t n = strcspn(text, " ");
        if (column + 1u + n > LINE_WIDTH) {
            (void)printf("\n%*s", (int)left, "");
            column = left;
        }
        (void)printf("%s%.*s", column > 0 ? " " : "", (int)n, text);
        column += n + (column > 0);
        text += n + (text[n] == ' ');
    }
    (void)printf("\n");
}
