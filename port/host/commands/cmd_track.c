/* cmd_track.c: smr track: registers the model onto the first frame, follows the others, and writes each.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "carry/carry_result.h"
#include "commands/commands.h"
#include "html/page_data.h"

#define TICKS 30u     /* of a frame, at most, where nothing else is asked for */
#define CSV_EVERY 32u /* frames between two writings of track.csv: what is there is always whole */
#define PAGE "report.html"
#define NAME_ROOM (2u * SMR_NAME_BYTES + 8u)

typedef struct tracked {
    host_options options; /* of the registration onto the first frame */
    host_job job;
    host_frames frames;
    host_track_points points;
    host_track_doubts doubts;
    host_buffer csv;
    host_image image[2];    /* frames that are images: one is borrowed until the next one has taken its place */
    host_track_page *page;  /* NULL without --html */
    uint64_t most_vertices; /* of a frame's targets */
    host_track_verdict verdict;
} tracked;

/* Frames are images, or none is. */
static int check_image(const tracked *t, const host_frame *frame, host_error *error)
{
    host_image image = {0};
    int result = 0;
    error->file = frame->files.path[0];
    if (host_frame_is_image(frame) != t->options.image_target)
        return host_fail(error, "frame",
                         t->options.image_target ? "a volume, as the first frame is"
                                                 : "a surface or a cloud, as in the first frame");
    if (t->options.image_target)
        result = host_image_read(frame->files.path[0], t->options.mirror_target, &image, error);
    host_image_free(&image);
    return result;
}

/* Reads a frame to see that it can be used. */
static int check_frame(tracked *t, const host_frame *frame, const smr_port *port, host_error *error)
{
    host_load *loads = NULL;
    uint64_t vertices = 0;
    int result = check_image(t, frame, error);
    if (result != 0 || t->options.image_target)
        return result;
    result = host_frame_load(frame, port, t->options.mirror_target, &loads, error);
    for (uint32_t i = 0; result == 0 && i < frame->files.n; i++)
        vertices += loads[i].mesh.n_vertices;
    if (vertices > t->most_vertices)
        t->most_vertices = vertices;
    if (result == 0 && vertices > SMR_VERTICES_MAX) {
        error->file = frame->files.path[0];
        result = host_fail(error, "frame", "at most %u vertices in all its files", SMR_VERTICES_MAX);
    }
    host_frame_unload(frame, loads);
    return result;
}

/* Every file of every frame must have a structure. */
static int check_names(tracked *t, host_error *error)
{
    for (uint32_t i = 0; i < t->frames.n; i++)
        for (uint32_t k = 0; k < t->frames.frame[i].files.n; k++)
            if (host_frame_part(&t->frames.frame[i], k, &t->job.model) == HOST_NO_PART)
                return host_fail_of(error, t->frames.frame[i].files.path[k], "name",
                                    "the name of one of the model's structures");
    for (uint32_t i = 0; i < t->frames.n && t->options.html; i++)
        if (strcmp(t->frames.frame[i].name, PAGE) == 0)
            return host_fail_of(error, t->frames.frame[i].name, "name", "another name, that is the page's");
    return 0;
}

/* Everything up to the end of the first frame's registration. Nothing is written before all frames were read once. */
static int start(tracked *t, const host_options *options, host_error *error)
{
    int result = 0;
    t->options = *options;
    t->options.config.track.mode = SMR_TRACK_RECOVER;
    t->options.ticks = 0; /* the first frame's schedule ends */
    t->job.options = &t->options;
    if (host_output_check(options->out, error) != 0 || host_frames_list(&options->frames, &t->frames, error) != 0 ||
        host_port_open(&t->job.port, options->threads, error) != 0 ||
        (options->points != NULL && host_track_points_read(&t->points, options->points, error) != 0))
        return -1;
    for (uint32_t i = 0; result == 0 && i < t->frames.n; i++)
        result = check_frame(t, &t->frames.frame[i], &t->job.port.port, error);
    t->options.target = t->frames.frame[0].files;
    t->options.config.basic.n_target_vertices = (uint32_t)t->most_vertices;
    if (result != 0 || host_job_load(&t->job, error) != 0 || host_job_check_format(&t->job, error) != 0 ||
        host_job_check(&t->job, error) != 0 || check_names(t, error) != 0 || host_job_match(&t->job, error) != 0 ||
        host_job_prepare(&t->job, error) != 0 ||
        host_track_points_bind(&t->points, &t->job.model, options->mirror_model, (int)options->format,
                               &t->job.port.port, error) != 0)
        return -1;
    if (options->html) {
        t->page = host_track_page_begin(&t->job, t->frames.n);
        error->file = options->out;
        if (t->page == NULL)
            return host_fail(error, "page", "free memory");
    }
    return host_job_run(&t->job, error);
}

static int refuse(const host_frame *frame, smr_status status, host_error *error)
{
    return host_fail_of(error, frame->files.path[0], "frame", "%s (%s)",
                        status == SMR_E_ARENA ? "free memory" : "surfaces or clouds within the library's limits",
                        smr_status_name(status));
}

/* By what the library says, and by what contact has left. */
static int judge(tracked *t, const host_frame *frame, host_frame_report *report, host_error *error)
{
    const host_model *const images = t->options.image_target ? &t->job.model : NULL;
    const smr_status status =
        host_track_judge(t->job.state, images, (int)report->last.details.settled, &report->verdict, &t->doubts);
    if (status != SMR_OK)
        return refuse(frame, status, error);
    if (host_job_contact_left(&t->job, &report->overlap_mm, error) != 0)
        return -1;
    if (report->overlap_mm > 0.0f && report->verdict.level == SMR_VERDICT_GOOD)
        report->verdict.level = SMR_VERDICT_LOOK;
    return 0;
}

/* Ticks towards the frame's targets, which setting them came to this status. */
static int follow(tracked *t, const host_frame *frame, smr_status status, host_frame_report *report, host_error *error)
{
    const uint32_t most = t->job.options->ticks > 0 ? t->job.options->ticks : TICKS;
    smr *const s = t->job.state;
    memset(&report->last, 0, sizeof report->last);
    for (report->ticks = 0; status >= 0 && report->ticks < most && !report->last.details.settled; report->ticks++)
        status = smr_tick(s, (uint64_t)(t->options.budget_ms * 1e6), &report->last);
    while (status == SMR_PARTIAL) /* to the end of the iteration, which the verdict needs */
        status = smr_tick(s, 0, &report->last);
    return status < 0 ? refuse(frame, status, error) : judge(t, frame, report, error);
}

static void add_line(tracked *t, uint32_t number, const host_frame *frame, const host_frame_report *r)
{
    if (number == 0) {
        host_buffer_print(&t->csv, "frame,time_s,ticks,residual_mm,verdict,settled,jumped,recovering,target_serial");
        host_track_points_columns(&t->points, &t->csv);
        host_buffer_print(&t->csv, "\n");
    }
    host_csv_text(&t->csv, frame->name, "");
    host_buffer_print(&t->csv, ",%.4f,%u,%.4f,%s,%u,%u,%u,%u", number / t->options.fps, r->ticks,
                      (double)r->last.residual_mean_mm, host_verdict_name((int)r->verdict.level),
                      r->last.details.settled, r->last.details.jumped, r->last.details.recovering,
                      r->last.details.target_serial);
    host_track_points_row(&t->points, &t->csv);
    host_buffer_print(&t->csv, "\n");
    host_track_note(&t->verdict, r);
}

static int add_parts(tracked *t, const host_frame *frame, host_output *output, host_error *error)
{
    host_buffer buffer = {0};
    int result = 0;
    for (uint32_t i = 0; result == 0 && i < t->job.model.n_parts; i++) {
        const host_part *const part = &t->job.model.part[i];
        host_mesh mesh = part->mesh;
        char name[NAME_ROOM];
        (void)snprintf(name, sizeof name, "%s/%s%s", frame->name, part->name,
                       host_format_extension((int)t->options.format));
        mesh.xyz = malloc((mesh.n_vertices + 1u) * 3u * sizeof *mesh.xyz);
        if (mesh.xyz == NULL || smr_get_positions(t->job.state, i, mesh.xyz) != SMR_OK)
            buffer.failed = 1;
        else
            host_mesh_write(&mesh, (int)t->options.format, &buffer);
        result = host_output_take(output, name, &buffer, 0, error);
        free(mesh.xyz);
    }
    return result;
}

/* What else can be carried by the frame's result at any later time. */
static int add_carry(tracked *t, const host_frame *frame, host_output *output, host_error *error)
{
    char name[NAME_ROOM + sizeof HOST_CARRY_NAME];
    host_buffer buffer = {0};
    (void)snprintf(name, sizeof name, "%s/" HOST_CARRY_NAME, frame->name);
    host_job_carry(&t->job, &buffer);
    return host_output_take(output, name, &buffer, 0, error);
}

/* Keeps the frame for the page. loads: its meshes; NULL: those of the first frame, none of an image. */
static int keep_frame(tracked *t, uint32_t index, const host_load *loads, const host_frame_report *r, host_error *error)
{
    const uint32_t n = t->frames.frame[index].files.n;
    if (t->page == NULL)
        return 0;
    const int result = host_track_page_add(t->page, r);
    for (uint32_t i = 0; result == 0 && i < (loads == NULL ? t->job.n_targets : n); i++)
        host_track_page_target(t->page, loads == NULL ? &t->job.target[i].mesh : &loads[i].mesh, n);
    error->file = t->options.out;
    return result == 0 ? 0 : host_fail(error, "page", "free memory");
}

static int add_page(tracked *t, host_output *output, host_error *error)
{
    host_buffer buffer = {0};
    host_track_page_write(t->page, &buffer);
    return host_output_take(output, PAGE, &buffer, 0, error);
}

/* A frame's files, and at times the table as far as it is: a set of their own, there in whole or not at all. */
static int write_frame(tracked *t, uint32_t number, host_error *error)
{
    const host_frame *const frame = &t->frames.frame[number];
    host_output *const output = host_output_begin(t->options.out);
    const int table = number % CSV_EVERY == 0 || number + 1u == t->frames.n;
    int result = add_parts(t, frame, output, error);
    if (result == 0)
        result = add_carry(t, frame, output, error);
    if (result == 0)
        result = host_track_points_add(&t->points, frame->name, output, error);
    if (result == 0 && table)
        result = host_output_add(output, "track.csv", &t->csv, error);
    if (result == 0 && t->page != NULL && number + 1u == t->frames.n)
        result = add_page(t, output, error);
    return host_output_end(output, result, error);
}

/* Follows surfaces and clouds, which are borrowed until the frame is done. What the frame lacks is carried. */
static int follow_surfaces(tracked *t, uint32_t number, host_frame_report *report, host_error *error)
{
    const host_frame *const frame = &t->frames.frame[number];
    host_load *load = NULL;
    void **const kept = calloc(frame->files.n, sizeof *kept);
    smr_status status = SMR_OK;
    int result = kept == NULL ? host_fail(error, "frame", "free memory") : 0;
    (void)smr_set_surface(t->job.state, SMR_ALL, NULL);
    if (result == 0)
        result = host_frame_load(frame, &t->job.port.port, t->options.mirror_target, &load, error);
    for (uint32_t i = 0; result == 0 && i < frame->files.n && status == SMR_OK; i++)
        status = host_frame_set_target(t->job.state, host_frame_part(frame, i, &t->job.model), &load[i].mesh, &kept[i]);
    if (result == 0)
        result = follow(t, frame, status, report, error);
    if (result == 0)
        result = keep_frame(t, number, load, report, error);
    (void)smr_set_surface(t->job.state, SMR_ALL, NULL);
    host_frame_unload(frame, load);
    for (uint32_t i = 0; kept != NULL && i < frame->files.n; i++)
        free(kept[i]);
    free(kept);
    return result;
}

/* Follows an image: it takes the place of the one before the last. */
static int follow_image(tracked *t, uint32_t number, host_frame_report *report, host_error *error)
{
    const host_frame *const frame = &t->frames.frame[number];
    host_image *const image = &t->image[number % 2u];
    host_image_free(image);
    if (host_image_read(frame->files.path[0], t->options.mirror_target, image, error) != 0)
        return -1;
    if (follow(t, frame, smr_set_volume(t->job.state, &image->view), report, error) != 0)
        return -1;
    return keep_frame(t, number, NULL, report, error);
}

/* Frames after the first. */
static int run_frame(tracked *t, uint32_t number, host_error *error)
{
    const host_frame *const frame = &t->frames.frame[number];
    host_frame_report r = {0};
    r.name = frame->name;
    if ((t->options.image_target ? follow_image(t, number, &r, error) : follow_surfaces(t, number, &r, error)) != 0 ||
        host_track_points_carry(&t->points, t->job.state, &t->job.model, error) != 0)
        return -1;
    add_line(t, number, frame, &r);
    return write_frame(t, number, error);
}

static int run(tracked *t, const host_options *options, host_error *error)
{
    host_frame_report first = {0};
    if (start(t, options, error) != 0)
        return -1;
    t->options.ticks = options->ticks;
    first.name = t->frames.frame[0].name;
    first.last = t->job.last;
    first.ticks = t->job.ticks;
    if (judge(t, &t->frames.frame[0], &first, error) != 0 ||
        host_track_points_carry(&t->points, t->job.state, &t->job.model, error) != 0)
        return -1;
    add_line(t, 0, &t->frames.frame[0], &first);
    if (keep_frame(t, 0, NULL, &first, error) != 0 || write_frame(t, 0, error) != 0)
        return -1;
    for (uint32_t i = 1; i < t->frames.n; i++)
        if (run_frame(t, i, error) != 0)
            return -1;
    return 0;
}

/* By the worst frame. */
static int status_of(const tracked *t)
{
    const uint32_t worst = t->verdict.worst.verdict.level;
    if (worst == SMR_VERDICT_FAILED)
        return HOST_FAILED;
    return worst > t->options.accept ? HOST_LOOK : HOST_DONE;
}

/* For people. The last lines are the verdict. */
static void print(const tracked *t)
{
    const uint32_t *const n = t->verdict.n;
    (void)printf("%u frames: %u good, %u to look at, %u failed\n", t->frames.n, n[SMR_VERDICT_GOOD],
                 n[SMR_VERDICT_LOOK], n[SMR_VERDICT_FAILED]);
    host_track_print_doubts(&t->doubts, &t->job.model);
    (void)printf("results: %s\n", t->options.out);
    if (t->options.html)
        (void)printf("to look at: %s/" PAGE "\n", t->options.out);
    host_track_print_verdict(&t->verdict);
}

int host_track(const host_options *options, host_error *error)
{
    tracked *const t = calloc(1, sizeof *t);
    int result = HOST_REFUSED;
    if (t == NULL) {
        (void)host_fail(error, "start", "free memory");
        return HOST_REFUSED;
    }
    if (options->html)
        host_file_keep_checksums();
    if (run(t, options, error) == 0) {
        result = status_of(t);
        if (!options->quiet)
            print(t);
    }
    if (result == HOST_REFUSED)
        host_error_keep(error); /* it may borrow a frame's name */
    host_track_page_free(t->page);
    host_job_free(&t->job);
    host_image_free(&t->image[0]);
    host_image_free(&t->image[1]);
    host_frames_free(&t->frames);
    host_track_points_free(&t->points);
    host_buffer_free(&t->csv);
    free(t);
    return result;
}
