/* model_from_files.c: loads the model of a command. Structure names come from file names or from an untrusted model;
 * since they become names of result files, they are checked here.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include "model/model_from_files.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include "base/system.h"
#include "files/file_names.h"
#include "files/file_read.h"
#include "volumes/voxel_volume.h"

#define MAGIC "SMR1" /* the first bytes of every prepared model */

static int accept_image(const host_head *head, host_error *error)
{
    if (head->n < 4 || memcmp(head->data, MAGIC, 4) != 0)
        return host_fail(error, "byte 0", "a model made by smr build");
    return 0;
}

int host_model_is_prepared(const char *path)
{
    unsigned char head[4] = {0, 0, 0, 0};
    struct stat st;
    FILE *file = NULL;
    if (host_has_extension(path, ".smr"))
        return 1;
    /* opening a named pipe would wait for its writer */
    if (stat(path, &st) == 0 && S_ISREG(st.st_mode))
        file = fopen(path, "rb");
    if (file == NULL)
        return 0;
    size_t n = fread(head, 1, sizeof head, file);
    (void)fclose(file);
    return n == sizeof head && memcmp(head, MAGIC, sizeof head) == 0;
}

/* Refuses a file whose name would be cut: its result would have another name. */
static int check_length(const char *path, uint32_t i, host_error *error)
{
    char name[SMR_NAME_BYTES];
    const size_t n = host_base_name(path, name, sizeof name);
    return n < sizeof name ? 0
                           : host_fail_at(error, "name of structure", i,
                                          "a file name of at most %u bytes before its extension, found %zu",
                                          SMR_NAME_BYTES - 1u, n);
}

/* Checks the structures' names. loads: the files that they come from; NULL for a prepared model. */
static int check_names(const host_model *model, const host_load *loads, host_error *error)
{
    for (uint32_t i = 0; i < model->n_parts; i++) {
        const char *const name = model->part[i].name;
        const char *c = name;
        if (loads != NULL) {
            error->file = loads[i].path;
            if (check_length(loads[i].path, i, error) != 0)
                return -1;
        }
        for (c = name; *c != '\0'; c++)
            if (*c == '/' || (unsigned char)*c < 32 || *c == 127)
                return host_fail_at(error, "name of structure", i, "one that can be a file name");
        if (name[0] == '\0' || name[0] == '.')
            return host_fail_at(error, "name of structure", i, "one that can be a file name, found '%s'", name);
        for (uint32_t k = 0; k < i; k++)
            if (strcmp(model->part[k].name, name) == 0)
                return host_fail_at(error, "name of structure", i, "names that differ, '%s' is there twice", name);
    }
    return 0;
}

static int make_parts(host_model *model, uint32_t n, host_error *error)
{
    model->part = calloc(n, sizeof *model->part);
    model->n_parts = model->part == NULL ? 0 : n;
    return model->part == NULL ? host_fail(error, "start", "free memory") : 0;
}

/* Copies one structure's rest shape from the prepared model. */
static int copy_part(host_model *model, uint32_t i, host_error *error)
{
    host_part *const part = &model->part[i];
    smr_structure_info info;
    if (smr_model_structure(model->model, i, &info) != SMR_OK)
        return host_fail_at(error, "structure", i, "a structure that can be read");
    memcpy(part->name, info.name, sizeof part->name);
    part->name[sizeof part->name - 1u] = '\0';
    part->mesh.xyz = malloc(12u * (size_t)info.n_vertices + 1u);
    part->mesh.triangles = malloc(12u * (size_t)info.n_triangles + 1u);
    if (part->mesh.xyz == NULL || part->mesh.triangles == NULL)
        return host_fail_at(error, "structure", i, "free memory");
    part->mesh.n_vertices = info.n_vertices;
    part->mesh.n_triangles = info.n_triangles;
    if (smr_model_mesh(model->model, i, part->mesh.xyz, part->mesh.triangles) != SMR_OK)
        return host_fail_at(error, "structure", i, "a mesh that can be read");
    return 0;
}

static int open_bytes(host_model *model, host_error *error)
{
    const double start = host_seconds();
    const smr_status status = smr_model_open(model->prepared, model->prepared_bytes, &model->model);
    if (status != SMR_OK)
        return host_fail(error, "model", "a whole, undamaged model of this version (%s)", smr_status_name(status));
    if (smr_model_get_info(model->model, &model->info) != SMR_OK)
        return host_fail(error, "image", "a model that can be read");
    model->prepare_s += host_seconds() - start;
    if (model->part != NULL)
        return 0;
    if (make_parts(model, model->info.n_structures, error) != 0)
        return -1;
    for (uint32_t i = 0; i < model->n_parts; i++)
        if (copy_part(model, i, error) != 0)
            return -1;
    return check_names(model, NULL, error);
}

int host_model_open_prepared(const char *path, const host_options *options, host_model *model, host_error *error)
{
    host_bytes bytes;
    memset(model, 0, sizeof *model);
    if (options->prepare_option != NULL)
        return host_fail_of(error, options->prepare_option, "option",
                            "a model of surfaces: a .smr is prepared already");
    if (host_file_read(path, accept_image, &bytes, error) != 0)
        return -1;
    model->prepared = bytes.data;
    model->prepared_bytes = bytes.size;
    if ((uintptr_t)bytes.data % SMR_ALIGN != 0) { /* unpacked bytes may be unaligned */
        model->prepared = host_alloc(bytes.size);
        if (model->prepared != NULL)
            memcpy(model->prepared, bytes.data, bytes.size);
        host_file_free(&bytes);
    }
    int result = model->prepared != NULL ? open_bytes(model, error) : host_fail(error, "file", "free memory");
    if (result != 0)
        host_model_free(model);
    return result;
}

/* Points are carried by the surfaces around them: there must be one. */
static int check_faces(const host_model *model, host_error *error)
{
    uint32_t i = 0;
    while (i < model->n_parts && model->part[i].mesh.n_triangles == 0)
        i++;
    return i < model->n_parts ? 0 : host_fail(error, "faces", "at least one triangle");
}

int host_model_take(host_load *loads, uint32_t n, host_model *model, host_error *error)
{
    memset(model, 0, sizeof *model);
    error->file = "--model";
    if (make_parts(model, n, error) != 0)
        return -1;
    error->file = loads[0].path;
    for (uint32_t i = 0; i < n; i++) {
        (void)host_base_name(loads[i].path, model->part[i].name, sizeof model->part[i].name);
        model->part[i].mesh = loads[i].mesh;
        host_warn_inside_out(loads[i].path, &model->part[i].mesh);
        memset(&loads[i].mesh, 0, sizeof loads[i].mesh);
    }
    return check_faces(model, error) != 0 ? -1 : check_names(model, loads, error);
}

/* Bytes that nearly every model fits in. Asking smr_prepare for the exact size would do its work twice; memory that is
 * never touched costs nothing. */
static size_t likely_bytes(const host_model *model, const smr_prepare_config *config)
{
    const size_t n = config->n_radii > 0 ? config->n_radii : SMR_RADII_MAX / 2u;
    size_t bytes = (size_t)1u << 20;
    for (uint32_t i = 0; i < model->n_parts; i++)
        bytes += (256u + 1024u * n) * model->part[i].mesh.n_vertices + 64u * (size_t)model->part[i].mesh.n_triangles;
    return bytes < ((size_t)1u << 30) ? bytes : (size_t)1u << 30;
}

/* Calls smr_prepare, a second time with more memory when it needs more. */
static smr_status run_prepare(host_model *model, const smr_structure *structures, const smr_prepare_config *config)
{
    size_t scratch_bytes = 0;
    smr_status status = smr_prepare_bytes(structures, model->n_parts, config, &scratch_bytes);
    if (status != SMR_OK)
        return status;
    void *scratch = host_alloc(scratch_bytes);
    if (scratch == NULL)
        return SMR_E_ARENA;
    model->prepared_bytes = likely_bytes(model, config);
    for (status = SMR_E_ARENA; status == SMR_E_ARENA;) {
        const size_t capacity = model->prepared_bytes;
        free(model->prepared);
        model->prepared = host_alloc(capacity);
        if (model->prepared == NULL)
            break;
        status = smr_prepare(structures, model->n_parts, config, scratch, scratch_bytes, model->prepared, capacity,
                             &model->prepared_bytes);
        if (status == SMR_E_ARENA && model->prepared_bytes <= capacity)
            break;
    }
    free(scratch);
    return status;
}

int host_model_prepare(host_model *model, const smr_prepare_config *config, host_error *error)
{
    const double start = host_seconds();
    smr_structure *const structures = calloc(model->n_parts, sizeof *structures);
    smr_status status = SMR_E_ARENA;
    error->file = "--model";
    if (structures != NULL) {
        for (uint32_t i = 0; i < model->n_parts; i++) {
            structures[i].name = model->part[i].name;
            structures[i].mesh = host_mesh_view(&model->part[i].mesh);
        }
        status = run_prepare(model, structures, config);
        free(structures);
    }
    if (status == SMR_E_ARENA)
        return host_fail(error, "prepare", "more free memory");
    if (status != SMR_OK)
        return host_fail(error, "prepare", "%s within the library's limits (%s)",
                         config->reference != NULL ? "surfaces, reference image and options" : "surfaces and options",
                         smr_status_name(status));
    model->prepare_s += host_seconds() - start;
    return open_bytes(model, error);
}

/* An image beside the model is legal, but no profile comes of it. */
static int check_reference(const host_model *model, const char *path, const smr_volume *reference, host_error *error)
{
    error->file = path;
    if (host_check_image_size(model, reference, error) != 0)
        return -1;
    if (!(host_share_covered(model, reference) > 0.0)) {
        (void)host_fail(error, "place", "the image that the model fits into, but none of its vertices lies in it");
        host_error_print(error);
    }
    return 0;
}

/* With the profiles of the reference image and further subjects' shapes, if there are any. */
static int prepare_with(host_model *model, const host_options *options, const smr_port *port, host_error *error)
{
    smr_prepare_config config = options->prepare;
    host_image reference = {0};
    host_mesh also = {0};
    int result = host_also_read(model, &options->also, &also, error);
    config.port = port;
    const smr_subjects subjects = {also.xyz, options->also.n};
    config.also = &subjects;
    if (result == 0 && options->reference != NULL) {
        result = host_image_read(options->reference, options->mirror_model, &reference, error);
        config.reference = &reference.view;
    }
    if (result == 0 && options->reference != NULL)
        result = check_reference(model, options->reference, &reference.view, error);
    if (result == 0)
        result = host_model_prepare(model, &config, error);
    host_image_free(&reference);
    host_mesh_free(&also);
    return result;
}

int host_model_load(const host_files *files, const host_options *options, const smr_port *port, host_model *model,
                    host_error *error)
{
    memset(model, 0, sizeof *model);
    if (files->n == 1 && host_model_is_prepared(files->path[0]))
        return host_model_open_prepared(files->path[0], options, model, error);
    host_load *loads = calloc(files->n, sizeof *loads);
    if (loads == NULL)
        return host_fail(error, "start", "free memory");
    for (uint32_t i = 0; i < files->n; i++)
        loads[i] = (host_load){.path = files->path[i], .need = HOST_MESH_POINTS_TOO, .mirror = options->mirror_model};
    int result = host_load_all(port, loads, files->n, error);
    if (result == 0)
        result = host_model_take(loads, files->n, model, error);
    free(loads);
    if (result == 0)
        result = prepare_with(model, options, port, error);
    if (result != 0)
        host_model_free(model);
    return result;
}

void host_model_free(host_model *model)
{
    for (uint32_t i = 0; i < model->n_parts; i++)
        host_mesh_free(&model->part[i].mesh);
    free(model->part);
    free(model->prepared);
    memset(model, 0, sizeof *model);
}
