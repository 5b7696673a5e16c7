/* cmd_build.c: smr build: prepares surfaces into a model, as a file or as C source for a device.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "base/system.h"
#include "commands/commands.h"
#include "files/file_names.h"
#include "files/output_files.h"
#include "model/model_from_files.h"

/* The keywords of C. Those that start with an underscore and a capital are refused for that. */
static int is_keyword(const char *text)
{
    static const char *const words[] = {"auto",    "break",  "case",     "char",   "const",    "continue", "default",
                                        "do",      "double", "else",     "enum",   "extern",   "float",    "for",
                                        "goto",    "if",     "inline",   "int",    "long",     "register", "restrict",
                                        "return",  "short",  "signed",   "sizeof", "static",   "struct",   "switch",
                                        "typedef", "union",  "unsigned", "void",   "volatile", "while"};
    size_t i = 0;
    while (i < sizeof words / sizeof words[0] && strcmp(text, words[i]) != 0)
        i++;
    return i < sizeof words / sizeof words[0] || (text[0] == '_' && text[1] >= 'A' && text[1] <= 'Z');
}

static int is_source(const char *path) { return host_has_extension(path, ".c") || host_has_extension(path, ".h"); }

static int is_identifier(const char *text)
{
    const char *c = text;
    for (c = text; *c != '\0'; c++) {
        const int letter = (*c >= 'a' && *c <= 'z') || (*c >= 'A' && *c <= 'Z') || *c == '_';
        if (!letter && !(c > text && *c >= '0' && *c <= '9'))
            return 0;
    }
    return c > text && c - text < 200 && !is_keyword(text);
}

static void put_c_array(const host_model *model, const char *name, host_buffer *out)
{
    const unsigned char *const bytes = model->prepared;
    host_buffer_print(out,
                      "/* A model image for smr_model_open(name, name_bytes): %u vertices, %u structures. */\n"
                      "#include <stddef.h>\n\nextern const unsigned char %s[];\nextern const size_t %s_bytes;\n\n"
                      "const size_t %s_bytes = %zu;\n_Alignas(%u) const unsigned char %s[%zu] = {",
                      model->info.n_vertices, model->info.n_structures, name, name, name, model->prepared_bytes,
                      SMR_ALIGN, name, model->prepared_bytes);
    for (size_t i = 0; i < model->prepared_bytes; i++) {
        char text[8];
        const int n = snprintf(text, sizeof text, "%s%u,", i % 24u == 0 ? "\n" : "", bytes[i]);
        host_buffer_add(out, text, (size_t)n);
    }
    host_buffer_print(out, "\n};\n");
}

/* For static storage on a device, where the bounds of smr.h take the numbers. */
static void put_sizes(const host_model *model, const char *name, host_buffer *out)
{
    const smr_model_info *const info = &model->info;
    host_buffer_print(out,
                      "/* Sizes of the model %s, as SMR_ARENA_BYTES() takes them. */\n#ifndef %s_H\n#define %s_H\n\n"
                      "#include <stddef.h>\n\n#define %s_VERTICES %uu\n#define %s_TRIANGLES %uu\n"
                      "#define %s_STRUCTURES %uu\n#define %s_BYTES %zuu\n\n",
                      name, name, name, name, info->n_vertices, name, info->n_triangles, name, info->n_structures, name,
                      model->prepared_bytes);
    host_buffer_print(out,
                      "#ifdef __cplusplus\nextern \"C\" {\n#endif\nextern const unsigned char %s[%s_BYTES];\n"
                      "extern const size_t %s_bytes;\n#ifdef __cplusplus\n}\n#endif\n\n#endif\n",
                      name, name, name);
}

/* "MODEL.smr" -> "MODEL.c"; a name of C source stays. Owned by the caller. */
static char *beside(const char *path)
{
    const size_t n = strlen(path);
    char *const text = malloc(n + 3u);
    const size_t stem = host_has_extension(path, ".smr") && n > 4 ? n - 4u : n;
    if (text != NULL)
        (void)snprintf(text, n + 3u, "%.*s%s", (int)stem, path, is_source(path) ? "" : ".c");
    return text;
}

/* The array, and a header of its sizes unless the array itself is to be in a header. */
static int add_c_array(const host_model *model, const host_options *options, host_output *output, host_error *error)
{
    char *const path = beside(options->out);
    const int header = path != NULL && host_has_extension(path, ".h");
    host_buffer text = {0}, sizes = {0};
    int result = path != NULL ? 0 : host_fail(error, "output", "free memory");
    put_c_array(model, options->c_array, &text);
    result = host_output_take(output, path, &text, result, error);
    if (result == 0 && !header) {
        path[strlen(path) - 1u] = 'h';
        put_sizes(model, options->c_array, &sizes);
        result = host_output_take(output, path, &sizes, result, error);
    }
    /* The output set has its own copy of the name, but the error may still point to this one. */
    if (result != 0)
        error->file = options->out;
    free(path);
    return result;
}

static int write_model(const host_model *model, const host_options *options, host_error *error)
{
    const int source_only = options->c_array != NULL && is_source(options->out);
    host_output *const output = host_output_begin(NULL);
    const host_buffer image = {model->prepared, model->prepared_bytes, 0, 0}; /* borrowed: it is not freed */
    int result = 0;
    error->file = options->out;
    if (!source_only)
        result = host_output_add(output, options->out, &image, error);
    if (result == 0 && options->c_array != NULL)
        result = add_c_array(model, options, output, error);
    return host_output_end(output, result, error);
}

int host_build(const host_options *given, host_error *error)
{
    host_port port = {0};
    host_model model = {0};
    int result = HOST_REFUSED;
    error->file = "--c-array";
    if (given->c_array != NULL && !is_identifier(given->c_array)) {
        (void)host_fail(error, given->c_array, "a C identifier");
        return HOST_REFUSED;
    }
    if (given->c_array == NULL && is_source(given->out)) {
        (void)host_fail(error, "value", "a name for the array, for %s is C source", given->out);
        return HOST_REFUSED;
    }
    if (host_port_open(&port, 0, error) == 0 && host_model_load(&given->model, given, &port.port, &model, error) == 0 &&
        write_model(&model, given, error) == 0) {
        result = HOST_DONE;
        host_warn_small(given->model.path[0], &model);
        if (!given->quiet)
            (void)printf("%s: %u structures, %u vertices, %u radii, %zu bytes, prepared in %.3f s\n", given->out,
                         model.info.n_structures, model.info.n_vertices, model.info.n_radii, model.prepared_bytes,
                         model.prepare_s);
    }
    host_model_free(&model);
    host_port_close(&port);
    return result;
}
