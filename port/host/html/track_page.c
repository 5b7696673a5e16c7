/* track_page.c: the page of a tracking run. The frames that it shows are known from the start: evenly spread, as many
 * as there is room for.
 * SPDX-License-Identifier: MIT */

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "html/page_data.h"
#include "report/register_report.h"

#define FRAMES_MOST 121u
#define VERTICES_MOST 40000u /* of the model, in a frame */
#define MODEL_MOST 5000000u  /* bytes of all positions of the model */
#define TRIANGLE_BYTES_MOST 1500000u
#define TARGET_MOST 2000000u /* bytes of all positions of targets */
#define POINT_BYTES 6u
#define ROWS_MOST 10000u
#define INPUTS_MOST 5000u

/* A frame, as track.csv has it; of very many frames, the worst of several. */
typedef struct row {
    char name[SMR_NAME_BYTES];
    uint32_t number, ticks; /* number: from 0 */
    smr_verdict verdict;
    smr_tick_report last;
    float overlap_mm; /* of what contact should have parted; 0: nothing */
} row;

struct host_track_page {
    const host_job *job;
    host_page_part *part;                             /* [n_parts] thinned structures; owned */
    float *room;                                      /* [vertices of the largest structure][3]; owned */
    row *row;                                         /* [n_rows]; owned */
    host_buffer text;                                 /* the list of shown frames, JSON; owned */
    host_json json;                                   /* writes it */
    uint32_t n_frames, n_rows, n_shown, added, shown; /* n_shown: frames to show; added and shown: so far */
    uint32_t levels[3], settled, jumped, target_most; /* counts over all frames; target_most: points of a frame */
    int showing;                                      /* 1: the frame that was added last is shown */
    float cell_mm;
};

/* Which frame is shown as the k-th: the first, the last, and between them what there is room for. */
static uint32_t shown_frame(const host_track_page *page, uint32_t k)
{
    const uint64_t n = page->n_shown;
    return n == 1u ? 0 : (uint32_t)(((uint64_t)k * (page->n_frames - 1u) + (n - 1u) / 2u) / (n - 1u));
}

static int start(host_track_page *page)
{
    const host_model *const model = &page->job->model;
    size_t most = 0, vertices = 0;
    page->part = calloc((size_t)model->n_parts + 1u, sizeof *page->part);
    page->row = calloc(page->n_frames < ROWS_MOST ? page->n_frames : ROWS_MOST, sizeof *page->row);
    for (uint32_t i = 0; page->part != NULL && i < model->n_parts; i++) {
        page->part[i].mesh = &model->part[i].mesh;
        most = model->part[i].mesh.n_vertices > most ? model->part[i].mesh.n_vertices : most;
    }
    page->room = malloc((most + 1u) * 3u * sizeof *page->room);
    if (page->part == NULL || page->row == NULL || page->room == NULL ||
        host_page_thin_all(page->part, model->n_parts, VERTICES_MOST, TRIANGLE_BYTES_MOST, &page->cell_mm) != 0)
        return -1;
    for (uint32_t i = 0; i < model->n_parts; i++)
        vertices += page->part[i].thin.n_vertices;
    page->n_shown = (uint32_t)(MODEL_MOST / (POINT_BYTES * (vertices + 1u)));
    page->n_shown = page->n_shown < FRAMES_MOST ? page->n_shown : FRAMES_MOST;
    page->n_shown = page->n_shown < page->n_frames ? page->n_shown : page->n_frames;
    page->target_most = TARGET_MOST / (POINT_BYTES * page->n_shown);
    page->json = (host_json){&page->text, 0, 1, 1};
    host_json_open(&page->json, NULL, '[');
    return 0;
}

host_track_page *host_track_page_begin(const host_job *job, uint32_t n_frames)
{
    host_track_page *const page = calloc(1, sizeof *page);
    if (page == NULL)
        return NULL;
    page->job = job;
    page->n_frames = n_frames;
    if (start(page) == 0)
        return page;
    host_track_page_free(page);
    return NULL;
}

void host_track_page_free(host_track_page *page)
{
    if (page == NULL)
        return;
    host_page_parts_free(page->part, page->job->model.n_parts);
    free(page->room);
    free(page->row);
    host_buffer_free(&page->text);
    free(page);
}

/* Of very many frames a row stands for several: for the worst of them. */
static void add_row(host_track_page *page, const host_frame_report *r)
{
    const uint32_t n = page->n_frames < ROWS_MOST ? page->n_frames : ROWS_MOST;
    row *const at = &page->row[(uint64_t)page->added * n / page->n_frames];
    const int new = at == page->row + page->n_rows;
    page->levels[r->verdict.level]++;
    page->settled += r->last.details.settled != 0;
    page->jumped += r->last.details.jumped != 0;
    page->n_rows += new ? 1u : 0u;
    if (!new && (r->verdict.level < at->verdict.level ||
                 (r->verdict.level == at->verdict.level && r->last.residual_mean_mm <= at->last.residual_mean_mm)))
        return;
    *at = (row){"", page->added, r->ticks, r->verdict, r->last, r->overlap_mm};
    (void)snprintf(at->name, sizeof at->name, "%s", r->name);
}

static void end_frame(host_track_page *page)
{
    if (page->showing) {
        host_json_close(&page->json, ']');
        host_json_close(&page->json, '}');
    }
    page->showing = 0;
}

int host_track_page_add(host_track_page *page, const host_frame_report *report)
{
    host_json *const json = &page->json;
    end_frame(page);
    add_row(page, report);
    page->showing = page->shown < page->n_shown && shown_frame(page, page->shown) == page->added;
    page->added++;
    if (!page->showing)
        return 0;
    page->shown++;
    host_json_open(json, NULL, '{');
    host_json_count(json, "number", page->added - 1u);
    host_json_open(json, "places", '[');
    for (uint32_t i = 0; i < page->job->model.n_parts; i++) {
        if (smr_get_positions(page->job->state, i, page->room) != SMR_OK)
            return -1;
        host_page_points(json, NULL, page->room, page->part[i].thin.keep, page->part[i].thin.n_vertices);
    }
    host_json_close(json, ']');
    host_json_open(json, "target", '[');
    return 0;
}

void host_track_page_target(host_track_page *page, const host_mesh *mesh, uint32_t n)
{
    const uint32_t most = page->target_most / (n > 0 ? n : 1u);
    const uint32_t count = mesh->n_vertices < most ? mesh->n_vertices : most;
    uint32_t *const keep = page->showing ? malloc(((size_t)count + 1u) * sizeof *keep) : NULL;
    page->text.failed |= page->showing && keep == NULL;
    if (keep == NULL)
        return;
    for (uint32_t i = 0; i < count; i++) /* evenly spread over the file */
        keep[i] = (uint32_t)((uint64_t)i * mesh->n_vertices / count);
    host_page_points(&page->json, NULL, mesh->xyz, keep, count);
    free(keep);
}

static void put_row(const row *r, double fps, host_json *json)
{
    char text[80];
    host_json_open(json, NULL, '{');
    host_json_count(json, "number", r->number);
    host_json_text(json, "name", r->name);
    host_json_number(json, "time_s", r->number / fps);
    host_json_count(json, "ticks", r->ticks);
    host_json_number(json, "residual_mm",
                     r->last.residual_mean_mm < 0.0f ? (double)NAN : (double)r->last.residual_mean_mm);
    host_json_text(json, "verdict", host_verdict_name((int)r->verdict.level));
    host_json_flag(json, "settled", r->last.details.settled != 0);
    host_json_flag(json, "jumped", r->last.details.jumped != 0);
    host_json_open(json, "reasons", '[');
    for (uint32_t bit = 1; bit != 0 && bit <= r->verdict.reasons; bit <<= 1)
        if ((r->verdict.reasons & bit) != 0)
            host_json_text(json, NULL, smr_reason_text(bit));
    (void)snprintf(text, sizeof text, HOST_OVERLAP_TEXT, (double)r->overlap_mm);
    if (r->overlap_mm > 0.0f)
        host_json_text(json, NULL, text);
    host_json_close(json, ']');
    host_json_close(json, '}');
}

static void put_counts(const host_track_page *page, host_json *json)
{
    static const int levels[] = {SMR_VERDICT_GOOD, SMR_VERDICT_LOOK, SMR_VERDICT_FAILED};
    int worst = 0;
    host_json_open(json, "counts", '{');
    for (int i = 0; i < 3; i++) {
        host_json_count(json, host_verdict_name(levels[i]), page->levels[levels[i]]);
        worst = page->levels[levels[i]] > 0 ? levels[i] : worst;
    }
    host_json_count(json, "settled", page->settled);
    host_json_count(json, "jumped", page->jumped);
    host_json_close(json, '}');
    host_json_text(json, "verdict", host_verdict_name(worst));
}

/* The command, and the files that were read unless they are more than a page has room for. */
static void put_report(const host_job *job, host_json *json)
{
    char hash[24], version[40];
    (void)snprintf(hash, sizeof hash, "%016" PRIx64, smr_state_hash(job->state));
    (void)snprintf(version, sizeof version, "%d.%d.%d", SMR_VERSION_MAJOR, SMR_VERSION_MINOR, SMR_VERSION_PATCH);
    host_json_open(json, "report", '{');
    host_json_text(json, "version", version);
    host_json_text(json, "state_hash", hash);
    host_report_command(job->options, json);
    if (host_file_count() <= INPUTS_MOST) {
        host_report_inputs(json);
    } else {
        host_json_open(json, "inputs", '[');
        host_json_close(json, ']');
        host_json_count(json, "inputs_left_out", host_file_count());
    }
    host_json_close(json, '}');
}

void host_track_page_write(host_track_page *page, host_buffer *out)
{
    const host_job *const job = page->job;
    host_buffer text = {0};
    host_json json = {&text, 0, 1, 1};
    end_frame(page);
    host_json_close(&page->json, ']');
    host_json_open(&json, NULL, '{');
    host_json_text(&json, "kind", "track");
    put_report(job, &json);
    host_json_count(&json, "n_frames", page->n_frames);
    host_json_number(&json, "fps", job->options->fps);
    host_json_flag(&json, "prepared", job->model_is_prepared);
    put_counts(page, &json);
    host_json_open(&json, "rows", '[');
    for (uint32_t i = 0; i < page->n_rows; i++)
        put_row(&page->row[i], job->options->fps, &json);
    host_json_close(&json, ']');
    host_json_open(&json, "structures", '[');
    for (uint32_t i = 0; i < job->model.n_parts; i++) {
        host_json_open(&json, NULL, '{');
        host_json_text(&json, "name", job->model.part[i].name);
        host_page_triangles(&json, &page->part[i].thin);
        host_json_close(&json, '}');
    }
    host_json_close(&json, ']');
    host_json_raw(&json, "frames", &page->text);
    host_json_count(&json, "target_points", page->target_most);
    host_json_number(&json, "cell_mm", (double)page->cell_mm);
    host_page_settings(job->options, &job->course.config, job->model_is_prepared, &json);
    host_json_close(&json, '}');
    host_page_write(&text, out);
    host_buffer_free(&text);
}
