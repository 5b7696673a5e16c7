/* model_from_files.h: the model of a command, from surfaces or from a prepared .smr file.
 * SPDX-License-Identifier: MIT */
#ifndef MODEL_FROM_FILES_H
#define MODEL_FROM_FILES_H

#include "meshes/triangle_mesh.h"
#include "options/options.h"

/* A structure: its name and rest shape. */
typedef struct host_part {
    char name[SMR_NAME_BYTES];
    host_mesh mesh; /* owned */
} host_part;

typedef struct host_model {
    host_part *part; /* [n_parts]; owned */
    uint32_t n_parts;
    void *prepared; /* the prepared model; owned */
    size_t prepared_bytes;
    const smr_model *model; /* lies in `prepared`; NULL until then */
    smr_model_info info;
    double prepare_s; /* time of smr_prepare and smr_model_open, s */
} host_model;

/* 1 when the file is a prepared model, by its first bytes or its extension. */
int host_model_is_prepared(const char *path);

/* Reads and opens a .smr file; its structures become the parts. */
int host_model_open_prepared(const char *path, host_model *model, host_error *error);

/* Makes the parts from loaded surfaces and takes over their meshes. Names must differ and be valid file names. */
int host_model_take(host_load *loads, uint32_t n, host_model *model, host_error *error);

/* Prepares the parts into a model and opens it. */
int host_model_prepare(host_model *model, const smr_prepare_config *config, host_error *error);

/* All of the above, for a command that only needs a model. */
int host_model_load(const host_files *files, const host_options *options, const smr_port *port, host_model *model,
                    host_error *error);

void host_model_free(host_model *model);

#endif
