/* report_html.c: puts the page of a report together: its head, the data, its tail. ASCII throughout.
 * SPDX-License-Identifier: MIT */
#include "html/report_html.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "html/page_image.h"
#include "html/page_parts.h"
#include "html/page_scene.h"
#include "html/page_settings.h"

#define MARGIN_MM 25.0f     /* of the image around the surfaces */
#define VOXELS_MAX 5600000u /* of the image */

static void put_floats(host_json *json, const char *key, const float *value, int n)
{
    int i = 0;
    host_json_open(json, key, '[');
    for (i = 0; i < n; i++)
        host_json_number(json, NULL, (double)value[i]);
    host_json_close(json, ']');
}

static void put_counts(host_json *json, const char *key, const uint32_t *value)
{
    int i = 0;
    host_json_open(json, key, '[');
    for (i = 0; i < 3; i++)
        host_json_count(json, NULL, value[i]);
    host_json_close(json, ']');
}

/* "image": the target image around the surfaces; its voxels go to `voxels`. */
static void put_image(const host_job *job, const host_page_box *box, host_json *json, host_buffer *voxels)
{
    const smr_volume *const v = &job->image.view;
    host_page_image image;
    memset(&image, 0, sizeof image);
    if (!job->options->image_target || host_page_image_make(v, box, MARGIN_MM, VOXELS_MAX, &image) != 0 ||
        image.at == NULL) {
        voxels->failed |= image.size[0] > 0; /* out of memory */
        free(image.at);
        host_json_null(json, "image");
        return;
    }
    host_json_open(json, "image", '{');
    host_json_text(json, "path", job->options->target.path[0]);
    put_counts(json, "size", image.size);
    put_floats(json, "spacing", image.spacing, 3);
    put_floats(json, "first", image.first, 3);
    put_floats(json, "direction", v->direction, 9);
    put_counts(json, "whole_size", v->size);
    put_floats(json, "whole_spacing", v->spacing, 3);
    host_json_number(json, "low", image.low);
    host_json_number(json, "high", image.high);
    host_json_close(json, '}');
    host_buffer_add(voxels, image.at, (size_t)image.size[0] * image.size[1] * image.size[2]);
    free(image.at);
}

static double measured(float figure) { return figure < 0.0f ? (double)NAN : (double)figure; }

static void put_course(const host_course *course, host_json *json)
{
    size_t i = 0;
    host_json_open(json, "course", '[');
    for (i = 0; i < course->n; i++) {
        const host_step *const s = &course->step[i];
        host_json_open(json, NULL, '{');
        host_json_count(json, "iteration", s->iteration);
        host_json_number(json, "radius_mm", s->radius_mm);
        host_json_number(json, "time_ms", s->time_ms);
        host_json_count(json, "taken", s->taken);
        host_json_number(json, "residual_mm", measured(s->residual_mm));
        host_json_number(json, "moved_max_mm", measured(s->moved_max_mm));
        host_json_number(json, "matched_share", measured(s->matched_share));
        host_json_close(json, '}');
    }
    host_json_close(json, ']');
}

void host_report_html(const host_job *job, const host_buffer *report, host_buffer *out)
{
    host_buffer text, surfaces, voxels;
    host_page_box box;
    memset(&text, 0, sizeof text);
    memset(&surfaces, 0, sizeof surfaces);
    memset(&voxels, 0, sizeof voxels);
    {
        host_json json = {&text, 0, 1, 0};
        host_json_open(&json, NULL, '{');
        host_json_flag(&json, "image_target", job->options->image_target);
        host_json_flag(&json, "resumed", job->options->resume != NULL);
        host_json_flag(&json, "prepared", job->model_is_prepared);
        host_page_scene(job, &json, &surfaces, &box);
        put_image(job, &box, &json, &voxels);
        put_course(&job->course, &json);
        host_page_settings(job->options, &job->course.config, job->model_is_prepared, &json);
        host_json_close(&json, '}');
    }
    host_buffer_add(out, host_report_page_head, host_report_page_head_bytes);
    host_page_put_json(out, "report-data", report);
    host_page_put_json(out, "page-data", &text);
    host_page_put_bytes(out, "surface-bytes", &surfaces);
    host_page_put_bytes(out, "voxel-bytes", &voxels);
    host_buffer_add(out, host_report_page_tail, host_report_page_tail_bytes);
    out->failed |= report->failed | text.failed | surfaces.failed | voxels.failed;
    host_buffer_free(&text);
    host_buffer_free(&surfaces);
    host_buffer_free(&voxels);
}
