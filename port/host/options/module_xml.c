/* module_xml.c: describes `smr register` to 3D Slicer, as its command line modules describe themselves
 * (SlicerExecutionModel). Files and the start are listed here; all other options come from the table of options, their
 * sentences, ranges and defaults from the library's settings. smr-register (port/host/slicer) runs what Slicer makes of
 * it: it drops what has its default, and turns the flags of its own into options of smr.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>
#include "base/byte_buffer.h"
#include "options/options_table.h"

/* A parameter; NULL: it has no such element. */
typedef struct parameter {
    const char *tag;     /* with its attributes */
    const char *flag;    /* without dashes; one letter: a short one */
    const char *label;   /* NULL: the flag */
    const char *text;    /* one sentence */
    const char *channel; /* of files */
    const char *standard;
} parameter;

#define SURFACE "geometry fileExtensions=\".ply\""
#define POINTS "pointfile fileExtensions=\".mrk.json\" coordinateSystem=\"lps\" multiple=\"false\""

static const parameter inputs[] = {
    {SURFACE, "model", "Model", "The surface to deform.", "input", NULL},
    {SURFACE, "target", "Target surface", "What the model is registered to; or a volume.", "input", NULL},
    {"image", "image", "Target volume", "The patient's image, instead of a surface.", "input", NULL},
    {"image", "reference", "Reference volume", "The image that the model was segmented from; for a target volume.",
     "input", NULL},
    {POINTS, "model-landmarks", "Landmarks of the model", "Paired by label with those of the target; for the start.",
     "input", NULL},
    {POINTS, "target-landmarks", "Landmarks of the target", "Where they are in the patient.", "input", NULL},
};
static const parameter outputs[] = {
    {SURFACE, "output", "Result", "The deformed model.", "output", NULL},
    {"transform type=\"nonlinear\" fileExtensions=\".nrrd\"", "field", "Transform",
     "Carries points and images of the model to the patient.", "output", NULL},
    {"directory", "o", "Folder", "All results with report.json; kept only when it is given.", "output", NULL},
    {"string", NULL, "Verdict", "good, look or failed.", "output", NULL},
    {"string", NULL, "Expected error", "Of the result, mm.", "output", NULL},
};
/* Options whose words and ranges are not the library's. An enumeration's first word is its default, and no value. */
static const parameter start[] = {
    {"string-enumeration", "align", "Start pose", "Found from the surfaces, or fitted to the landmarks.", NULL, "none"},
    {"string-enumeration", "mirror-model", NULL, "Negates a coordinate of the model.", NULL, "none"},
    {"string-enumeration", "mirror-target", NULL, "Negates a coordinate of the target.", NULL, "none"},
    {"string", "smoothing", NULL, "mm, of the landmarks' spline; 0 passes through every landmark.", NULL, ""},
    {"string", "search", NULL, "mm: how far a goal may be; into an image first and last, as 10,2.", NULL, ""},
    {"string", "gradient", NULL, "mm, into an image: search distance of edges, first and last.", NULL, ""},
    {"string-enumeration", "clusters", NULL, "Separate at small radii (auto), nowhere or everywhere.", NULL, "auto"},
    {"string", "threads", NULL, "As many as processors when it is empty.", NULL, ""},
    {"boolean", "paper", NULL, "As the paper has it, where nothing else is said.", NULL, "false"},
};

static void put_element(host_buffer *out, const char *tag, const char *text)
{
    host_buffer_print(out, "<%s>", tag);
    host_xml_text(out, text);
    host_buffer_print(out, "</%s>", tag);
}

/* A C identifier: Slicer refuses others. */
static void put_name(host_buffer *out, const char *text)
{
    const char *c = text;
    host_buffer_print(out, "<name>");
    for (; *c != '\0'; c++) {
        const int letter = (*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') || (*c >= '0' && *c <= '9');
        host_buffer_print(out, "%c", letter ? *c | 0x20 : '_');
    }
    host_buffer_print(out, "</name>");
}

/* Up to its description. */
static void put_head(host_buffer *out, const parameter *p)
{
    host_buffer_print(out, "  <%s>", p->tag);
    put_name(out, p->flag != NULL && p->flag[1] != '\0' ? p->flag : p->label);
    if (p->flag != NULL)
        put_element(out, p->flag[1] != '\0' ? "longflag" : "flag", p->flag);
    put_element(out, "label", p->label != NULL ? p->label : p->flag);
    put_element(out, "description", p->text);
    if (p->channel != NULL)
        put_element(out, "channel", p->channel);
    if (p->standard != NULL)
        put_element(out, "default", p->standard);
}

static void put_end(host_buffer *out, const parameter *p)
{
    host_buffer_print(out, "</%.*s>\n", (int)strcspn(p->tag, " "), p->tag);
}

/* "a|b|c" */
static void put_words(host_buffer *out, const char *words)
{
    while (words != NULL) {
        const int n = (int)strcspn(words, "|");
        host_buffer_print(out, "<element>%.*s</element>", n, words);
        words = words[n] == '|' ? words + n + 1 : NULL;
    }
}

static void put_listed(host_buffer *out, const parameter *p)
{
    char name[64];
    put_head(out, p);
    if (strcmp(p->tag, "string-enumeration") == 0) {
        (void)snprintf(name, sizeof name, "--%s", p->flag);
        const host_option *o = host_option_find(name, HOST_REGISTER);
        if (o != NULL && strstr(host_option_words(o), p->standard) == NULL)
            put_element(out, "element", p->standard);
        if (o != NULL)
            put_words(out, host_option_words(o));
    }
    put_end(out, p);
}

static void put_range(host_buffer *out, const host_option *o)
{
    const host_range range = host_option_range(o);
    const char *const step = o->kind == HOST_KIND_COUNT || range.max > 1000.0 ? "1" : range.max > 1.0 ? "0.1" : "0.01";
    host_buffer_print(out, "<constraints><minimum>%.10g</minimum><maximum>%.10g</maximum><step>%s</step></constraints>",
                      range.min, range.max, step);
}

/* One with a setting of the library. Where the default is none that the option takes, an empty text stands for it. */
static void put_setting(host_buffer *out, const host_option *o, const smr_setting *s)
{
    static const char *const tags[] = {[HOST_KIND_FLAG] = "boolean",
                                       [HOST_KIND_COUNT] = "integer",
                                       [HOST_KIND_FLOAT] = "float",
                                       [HOST_KIND_DOUBLE] = "double",
                                       [HOST_KIND_WORD] = "string-enumeration"};
    const host_range range = host_option_range(o);
    const int known = o->kind < HOST_KIND_RADII && (o->kind == HOST_KIND_WORD || s->value >= range.min);
    const int has = s->kind == SMR_SETTING_NUMBER && (strcmp(s->unit, "mm") == 0 || strcmp(s->unit, "degrees") == 0);
    char value[64] = "", text[600];
    parameter p = {"string", o->name + strspn(o->name, "-"), NULL, text, NULL, value};
    if (known) {
        p.tag = tags[o->kind];
        host_setting_value(s, s->value, value, sizeof value);
    }
    if (o->kind == HOST_KIND_FLAG)
        p.standard = "false";
    (void)snprintf(text, sizeof text, "%s%s%s%s", s->text, has ? " (" : "", has ? s->unit : "", has ? ")" : "");
    put_head(out, &p);
    if (known && o->kind == HOST_KIND_WORD)
        put_words(out, host_option_words(o));
    else if (known && o->kind != HOST_KIND_FLAG)
        put_range(out, o);
    put_end(out, &p);
}

static void put_group(host_buffer *out, const char *label, const parameter *list, size_t n)
{
    host_buffer_print(out, " <parameters><label>%s</label><description>%s</description>\n", label, label);
    for (size_t i = 0; i < n; i++)
        put_listed(out, &list[i]);
    host_buffer_print(out, " </parameters>\n");
}

/* 1 when an option is among those that are listed by hand. */
static int is_listed(const host_option *o)
{
    for (size_t i = 0; i < sizeof start / sizeof start[0]; i++)
        if (strcmp(o->name + strspn(o->name, "-"), start[i].flag) == 0)
            return 1;
    return 0;
}

/* The options that set something for this kind of target (0: any), or for preparing the model. */
static void put_settings(host_buffer *out, const char *label, int prepares, int targets)
{
    host_buffer_print(out, " <parameters advanced=\"true\"><label>%s</label><description>%s</description>\n", label,
                      label);
    for (size_t i = 0; i < host_option_count; i++) {
        const host_option *const o = &host_option_table[i];
        const smr_setting *const s = host_option_setting(o);
        if (s != NULL && (o->commands & HOST_REGISTER) != 0 && o->prepares == prepares &&
            (prepares || o->targets == targets) && !is_listed(o))
            put_setting(out, o, s);
    }
    host_buffer_print(out, " </parameters>\n");
}

static void put_all(host_buffer *out)
{
    host_buffer_print(
        out,
        "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<executable>\n <category>Registration</category>\n"
        " <title>Shape matching (smr)</title>\n <description>Deforms a model's surface onto a surface or into an image "
        "by shape matching over clusters of its vertices (Gilles and Pai, MICCAI 2008).</description>\n"
        " <version>%d.%d.%d</version>\n <documentation-url></documentation-url>\n <license>MIT</license>\n"
        " <contributor></contributor>\n",
        SMR_VERSION_MAJOR, SMR_VERSION_MINOR, SMR_VERSION_PATCH);
    put_group(out, "Files", inputs, sizeof inputs / sizeof inputs[0]);
    put_group(out, "Results", outputs, sizeof outputs / sizeof outputs[0]);
    put_group(out, "Start", start, sizeof start / sizeof start[0]);
    put_settings(out, "Any target", 0, 0);
    put_settings(out, "Surfaces as targets", 0, HOST_FOR_SURFACES);
    put_settings(out, "An image as the target", 0, HOST_FOR_IMAGES);
    put_settings(out, "Preparing the model", 1, 0);
    host_buffer_print(out, "</executable>\n");
}

int host_module_xml(void)
{
    host_buffer out = {0};
    int result = 0;
    put_all(&out);
    if (out.failed || fwrite(out.data, 1, out.size, stdout) != out.size)
        result = -1;
    host_buffer_free(&out);
    return result;
}
