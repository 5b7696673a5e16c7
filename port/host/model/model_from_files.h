/* The model of a command: surfaces that are prepared, or a ready .smr image.
 * SPDX-License-Identifier: MIT */
#ifndef MODEL_FROM_FILES_H
#define MODEL_FROM_FILES_H

#include "meshes/mesh_load.h"
#include "options/options.h"

/* One structure: its name and rest shape, in the caller's order. */
typedef struct host_part {
    char name[SMR_NAME_BYTES];
    host_mesh mesh; /* owned */
} host_part;

typedef struct host_model {
    host_part *part; /* [n_parts]; owned */
    uint32_t n_parts;
    void *image; /* owned */
    size_t image_bytes;
    const smr_model *model; /* in the image; NULL until prepared */
    smr_model_info info;
    double prepare_s; /* time of smr_prepare and smr_model_open */
} host_model;

/* Whether the file is a model image by its first bytes or its extension. */
int host_model_is_image(const char *path);

/* Reads and opens a .smr; its structures become parts. */
int host_model_open_image(const char *path, host_model *model, host_error *error);

/* Makes parts of loaded surfaces and takes their meshes. Names must differ and be fit for file names. */
int host_model_take(host_load *loads, uint32_t n, host_model *model, host_error *error);

/* Prepares the parts into an image and opens it. */
int host_model_prepare(host_model *model, const smr_prepare_config *config, host_error *error);

/* All of the above for a command that needs nothing but a model. */
int host_model_load(const host_files *files, const host_options *options, const smr_port *port, host_model *model,
                    host_error *error);

void host_model_free(host_model *model);

#endif
