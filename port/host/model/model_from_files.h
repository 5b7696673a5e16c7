/* model_from_files.h: loads the model of a command from files; looks at the orientation, size and place of inputs.
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
int host_model_open_prepared(const char *path, const host_options *options, host_model *model, host_error *error);

/* Makes the parts from loaded surfaces and takes over their meshes. Names must differ and be valid file names. */
int host_model_take(host_load *loads, uint32_t n, host_model *model, host_error *error);

/* Prepares the parts into a model and opens it. */
int host_model_prepare(host_model *model, const smr_prepare_config *config, host_error *error);

/* Appends the vertices of results of the model, directory after directory. 0, or -1 with the error filled. */
int host_also_read(const host_model *model, const host_files *directories, host_mesh *all, host_error *error);

/* All of the above, for a command that only needs a model. */
int host_model_load(const host_files *files, const host_options *options, const smr_port *port, host_model *model,
                    host_error *error);

void host_model_free(host_model *model);

/* 1 when the surface is closed and its normals point inwards: its volume is negative. */
int host_is_inside_out(const host_mesh *mesh);

/* Prints a line on stderr when it is so. */
void host_warn_inside_out(const char *path, const host_mesh *mesh);

/* What a closed surface encloses, mm^3: below 0 where it is inside out. */
double host_enclosed_volume(const host_mesh *mesh);

/* The box around points. Start with count = 0. */
typedef struct host_box {
    float low[3], high[3]; /* mm */
    size_t count;          /* of points in it */
} host_box;

void host_box_add(host_box *box, const float *xyz, size_t n);
void host_box_add_volume(host_box *box, const smr_volume *volume);

/* Refuses a target whose diagonal and the model's differ by a factor above 100: one is in metres, perhaps. */
int host_check_target_size(const host_model *model, const host_box *target, host_error *error);

/* Prints a line on stderr when the model's diagonal is below 5 mm. */
void host_warn_small(const char *path, const host_model *model);

/* The diagonal of a box around the targets over that of the model; 0 where either is a point. */
double host_size_ratio(const host_model *model, const host_box *target);

/* Refuses an image when its diagonal and the model's differ by a factor above 500. */
int host_check_image_size(const host_model *model, const smr_volume *image, host_error *error);

/* Share of the model's vertices that lie in the image, 0..1. */
double host_share_covered(const host_model *model, const smr_volume *image);

#endif
