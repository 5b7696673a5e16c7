/* track_html.c: puts the page of a tracking run together: its head, the data, its tail. ASCII throughout.
 * SPDX-License-Identifier: MIT */
#include "html/track_html.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "files/file_read.h"
#include "html/page_parts.h"
#include "html/page_settings.h"
#include "report/report_files.h"
#include "track/track_verdict.h"

#define INPUTS_MOST 5000u

static void put_reasons(const host_track_row *row, host_json *json)
{
    char text[80];
    uint32_t bit = 0;
    host_json_open(json, "reasons", '[');
    for (bit = 1; bit != 0 && bit <= row->reasons; bit <<= 1)
        if ((row->reasons & bit) != 0)
            host_json_text(json, NULL, smr_reason_text(bit));
    (void)snprintf(text, sizeof text, HOST_OVERLAP_TEXT, (double)row->overlap_mm);
    if (row->overlap_mm > 0.0f)
        host_json_text(json, NULL, text);
    host_json_close(json, ']');
}

static void put_rows(const host_track_shown *s, double fps, host_json *json)
{
    uint32_t i = 0;
    host_json_open(json, "rows", '[');
    for (i = 0; i < s->n_rows; i++) {
        const host_track_row *const row = &s->row[i];
        host_json_open(json, NULL, '{');
        host_json_count(json, "number", row->number);
        host_json_text(json, "name", row->name);
        host_json_number(json, "time_s", row->number / fps);
        host_json_count(json, "ticks", row->ticks);
        host_json_number(json, "residual_mm", row->residual_mm < 0.0f ? (double)NAN : (double)row->residual_mm);
        host_json_text(json, "verdict", host_verdict_name((int)row->level));
        host_json_flag(json, "settled", row->settled != 0);
        host_json_flag(json, "jumped", row->jumped != 0);
        put_reasons(row, json);
        host_json_close(json, '}');
    }
    host_json_close(json, ']');
}

static void put_counts(const host_track_shown *s, host_json *json)
{
    static const int levels[] = {SMR_VERDICT_GOOD, SMR_VERDICT_LOOK, SMR_VERDICT_FAILED};
    int i = 0, worst = 0;
    host_json_open(json, "counts", '{');
    for (i = 0; i < 3; i++) {
        host_json_count(json, host_verdict_name(levels[i]), s->levels[levels[i]]);
        worst = s->levels[levels[i]] > 0 ? levels[i] : worst;
    }
    host_json_count(json, "settled", s->settled);
    host_json_count(json, "jumped", s->jumped);
    host_json_close(json, '}');
    host_json_text(json, "verdict", host_verdict_name(worst));
}

static void put_structure(const host_track_shown *s, uint32_t part, const host_page_box *box, size_t vertex,
                          size_t triangle, host_json *json, host_buffer *bytes)
{
    uint32_t i = 0;
    host_json_open(json, NULL, '{');
    host_json_text(json, "name", s->model->part[part].name);
    host_page_put_triangles(json, bytes, s->triangles + 3u * triangle, s->n_triangle[part], s->n_kept[part]);
    host_json_open(json, "at", '[');
    for (i = 0; i < s->n_frames; i++) {
        host_page_put_place(json, NULL, bytes);
        host_page_points(bytes, box, s->model_xyz + 3u * ((size_t)i * s->n_vertices + vertex), NULL, s->n_kept[part]);
    }
    host_json_close(json, ']');
    host_json_close(json, '}');
}

static void put_targets(const host_track_shown *s, const host_page_box *box, host_json *json, host_buffer *bytes)
{
    const float *xyz = s->target_xyz;
    uint32_t i = 0;
    host_json_open(json, "frames", '[');
    for (i = 0; i < s->n_frames; i++)
        host_json_count(json, NULL, s->frame[i]);
    host_json_close(json, ']');
    host_json_open(json, "targets", '[');
    for (i = 0; i < s->n_frames; i++) {
        host_json_open(json, NULL, '{');
        host_json_count(json, "points", s->n_target[i]);
        host_page_put_place(json, "at", bytes);
        host_page_points(bytes, box, xyz, NULL, s->n_target[i]);
        host_json_close(json, '}');
        xyz += 3u * (size_t)s->n_target[i];
    }
    host_json_close(json, ']');
    host_json_count(json, "target_points", s->target_most);
    host_json_number(json, "cell_mm", (double)s->cell_mm);
}

static void put_scene(const host_track_shown *s, host_json *json, host_buffer *bytes)
{
    host_page_box box = host_page_box_empty();
    size_t targets = 0, vertex = 0, triangle = 0;
    uint32_t i = 0;
    for (i = 0; i < s->n_frames; i++)
        targets += s->n_target[i];
    host_page_box_add(&box, s->model_xyz, (size_t)s->n_frames * s->n_vertices);
    host_page_box_add(&box, s->target_xyz, targets);
    host_json_open(json, "scene", '{');
    host_page_put_box(&box, json);
    host_json_open(json, "structures", '[');
    for (i = 0; i < s->model->n_parts; i++) {
        put_structure(s, i, &box, vertex, triangle, json, bytes);
        vertex += s->n_kept[i];
        triangle += s->n_triangle[i];
    }
    host_json_close(json, ']');
    put_targets(s, &box, json, bytes);
    host_json_close(json, '}');
}

/* Frames of many files can be more than a page has room for. */
static void put_inputs(const host_options *options, host_json *json)
{
    host_report_command(options, json);
    if (host_file_count() <= INPUTS_MOST) {
        host_report_inputs(json);
        return;
    }
    host_json_open(json, "inputs", '[');
    host_json_close(json, ']');
    host_json_count(json, "inputs_left_out", host_file_count());
}

static void put_data(const host_job *job, const host_track_shown *s, uint32_t n_frames, host_buffer *text,
                     host_buffer *bytes)
{
    host_json json = {text, 0, 1, 0};
    char hash[24], version[40];
    (void)snprintf(hash, sizeof hash, "%016" PRIx64, smr_state_hash(job->state));
    (void)snprintf(version, sizeof version, "%d.%d.%d", SMR_VERSION_MAJOR, SMR_VERSION_MINOR, SMR_VERSION_PATCH);
    host_json_open(&json, NULL, '{');
    host_json_text(&json, "version", version);
    host_json_text(&json, "state_hash", hash);
    host_json_count(&json, "frames", n_frames);
    host_json_number(&json, "fps", job->options->fps);
    host_json_count(&json, "vertices", job->model.info.n_vertices);
    host_json_flag(&json, "prepared", job->model_is_prepared);
    put_counts(s, &json);
    put_rows(s, job->options->fps, &json);
    put_scene(s, &json, bytes);
    put_inputs(job->options, &json);
    host_page_settings(job->options, &job->course.config, job->model_is_prepared, &json);
    host_json_close(&json, '}');
}

void host_track_html(const host_job *job, const host_track_page *page, uint32_t n_frames, host_buffer *out)
{
    const host_track_shown shown = host_track_page_shown(page);
    host_buffer text, bytes;
    memset(&text, 0, sizeof text);
    memset(&bytes, 0, sizeof bytes);
    put_data(job, &shown, n_frames, &text, &bytes);
    host_buffer_add(out, host_track_page_head, host_track_page_head_bytes);
    host_page_put_json(out, "page-data", &text);
    host_page_put_bytes(out, "surface-bytes", &bytes);
    host_buffer_add(out, host_track_page_tail, host_track_page_tail_bytes);
    out->failed |= text.failed | bytes.failed;
    host_buffer_free(&text);
    host_buffer_free(&bytes);
}
