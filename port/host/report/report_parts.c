/* report_parts.c: parts of report.json, and the result in a few lines for people.
 * SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "report/register_report.h"

void host_report_command(const host_options *options, host_json *json)
{
    host_json_open(json, "command", '[');
    host_json_text(json, NULL, "smr");
    host_json_text(json, NULL, options->command == HOST_TRACK ? "track" : "register");
    for (int i = 0; i < options->n_arguments; i++)
        host_json_text(json, NULL, options->arguments[i]);
    host_json_close(json, ']');
}

static void put_file(const char *key, const char *name, uint64_t bytes, uint32_t crc32, host_json *json)
{
    char text[16];
    (void)snprintf(text, sizeof text, "%08" PRIx32, crc32);
    host_json_open(json, NULL, '{');
    host_json_text(json, key, name);
    host_json_count(json, "bytes", bytes);
    host_json_text(json, "crc32", text);
    host_json_close(json, '}');
}

void host_report_inputs(host_json *json)
{
    host_input *input = NULL;
    const int n = host_file_list(0, 0, &input);
    json->out->failed |= n < 0;
    host_json_open(json, "inputs", '[');
    for (int i = 0; i < n; i++)
        put_file("path", input[i].path, input[i].bytes, input[i].crc32, json);
    host_json_close(json, ']');
    free(input);
}

void host_report_results(const host_output *output, host_json *json)
{
    host_json_open(json, "results", '[');
    for (size_t i = 0; i < host_output_count(output); i++) {
        const host_output_fact fact = host_output_fact_of(output, i);
        put_file(fact.inside ? "file" : "path", fact.name, fact.bytes, fact.crc32, json);
    }
    host_json_close(json, ']');
}

void host_report_labels(const host_job *job, uint32_t part, host_json *json)
{
    const host_result *const result = &job->result[part];
    const host_stats *const a = &result->area.to_target, *const b = &result->area.to_result;
    if (job->truth_map == NULL)
        return;
    if (!host_json_object(json, "labels", result->dice >= 0.0))
        return;
    host_json_number(json, "dice", result->dice);
    host_json_number(json, "hausdorff95_mm", fmax(a->p95, b->p95));
    host_json_number(json, "surface_distance_mm",
                     (a->mean * a->weight + b->mean * b->weight) / (a->weight + b->weight));
    host_json_number(json, "volume_mm3", result->label_mm3[0]);
    host_json_number(json, "truth_volume_mm3", result->label_mm3[1]);
    host_json_close(json, '}');
}

void host_report_volume(const host_job *job, uint32_t i, host_json *json)
{
    static const char *const keys[] = {"volume_mm3", "volume_rest_mm3", "volume_ratio", "volume_asked_mm3",
                                       "volume_ratio_asked"};
    const smr_structure_volume *const v = &job->result[i].volume;
    const int known = v->closed && !job->kept_start;
    const float value[] = {v->present_mm3, v->rest_mm3, v->ratio, v->asked_mm3, v->asked_ratio};
    for (size_t k = 0; k < sizeof keys / sizeof keys[0]; k++)
        if (known && (k < 3 || job->options->config.contact.volume > 0.0f))
            host_json_number(json, keys[k], (double)value[k]);
        else
            host_json_null(json, keys[k]);
}

/* A sum under way. */
typedef struct total {
    double deepest, volume, area;
} total;

static void add(total *t, const smr_contact_report *r)
{
    t->deepest = (double)r->deepest_mm > t->deepest ? (double)r->deepest_mm : t->deepest;
    t->volume += (double)r->volume_mm3;
    t->area += (double)r->area_mm2;
}

static void put(host_json *json, const total *t)
{
    host_json_number(json, "deepest_mm", t->deepest);
    host_json_number(json, "volume_mm3", t->volume);
    host_json_number(json, "area_mm2", t->area);
}

static total total_of(const host_contacts *c, uint32_t structure)
{
    total t = {0, 0, 0};
    for (uint32_t i = 0; i < c->n_pairs; i++)
        if (structure == SMR_ALL || c->pair[i].a == structure || c->pair[i].b == structure)
            add(&t, &c->pair[i].report);
    return t;
}

void host_report_contact(const host_job *job, host_json *json)
{
    const host_contacts *const c = &job->contacts;
    total t = total_of(c, SMR_ALL);
    if (!host_json_object(json, "contact", c->measured))
        return;
    host_json_flag(json, "on", job->course.config.contact.share > 0.0f);
    host_json_number(json, "within_mm", (double)HOST_CONTACT_MM);
    put(json, &t);
    host_json_open(json, "pairs", '[');
    for (uint32_t i = 0; i < c->n_pairs; i++) {
        t = (total){0, 0, 0};
        add(&t, &c->pair[i].report);
        host_json_open(json, NULL, '{');
        host_json_text(json, "a", host_contact_name(job, c->pair[i].a));
        host_json_text(json, "b", host_contact_name(job, c->pair[i].b));
        put(json, &t);
        host_json_close(json, '}');
    }
    host_json_close(json, ']');
    host_json_open(json, "structures", '[');
    for (uint32_t i = 0; i < job->model.n_parts + c->n_fixed; i++) {
        t = total_of(c, i);
        host_json_open(json, NULL, '{');
        host_json_text(json, "structure", host_contact_name(job, i)); /* "name" is what line by line readers look for */
        put(json, &t);
        host_json_close(json, '}');
    }
    host_json_close(json, ']');
    host_json_close(json, '}');
}

#define SHOWN 0.995   /* of the model's area: less is said */
#define OTHERS 0.005f /* of the target: more is said */

/* The verdict in words, and what it is made of. */
static void print_verdict(const host_verdict *v)
{
    (void)printf("verdict: %s", v->level == HOST_VERDICT_LOOK ? "look at the result" : host_verdict_name(v->level));
    for (uint32_t i = 0; i < v->n_reasons; i++)
        (void)printf("%s%s", i == 0 ? ": " : "; ", v->reason[i]);
    (void)printf(" (probability %.2f", v->probability);
    if (v->expected_error_mm >= 0.0 && v->level != HOST_VERDICT_FAILED)
        (void)printf(", expected error %.2f mm", v->expected_error_mm);
    (void)printf(")\n");
}

void host_job_summary(const host_job *job)
{
    const host_stats *const a = &job->area.to_target, *const b = &job->area.to_result;
    const char *const key = job->options->image_target ? "truth" : "target";
    smr_log_state log;
    uint32_t carried = 0;
    (void)printf("%s after %u iterations, %.3f s (load %.3f, prepare %.3f, start %.3f, register %.3f), %u threads\n",
                 host_job_converged(job) ? "converged" : "not converged", job->last.iteration,
                 host_seconds() - job->begin_s, job->load_s, job->model_is_prepared ? 0.0 : job->model.prepare_s,
                 job->start_s, job->register_s, job->port.port.n_workers);
    if (job->n_landmarks > 0 && job->warp_kind != SMR_WARP_SPLINE && job->options->align == HOST_ALIGN_NONE)
        (void)printf("start: %u landmarks carry no spline, a %s fit instead\n", job->n_landmarks,
                     host_warp_name(job->warp_kind));
    const int part = job->overlap.n > 0 && job->overlap.weight < SHOWN * a->weight;
    if (part)
        (void)printf("the %.0f %% of the model that the target shows: mean %.3f  rms %.3f  p95 %.3f  max %.3f mm\n",
                     100.0 * job->overlap.weight / a->weight, job->overlap.mean, job->overlap.rms, job->overlap.p95,
                     job->overlap.max);
    if (a->n > 0)
        (void)printf("%smodel to %s: mean %.3f  rms %.3f  p95 %.3f  max %.3f mm\n", part ? "whole " : "", key, a->mean,
                     a->rms, a->p95, a->max);
    if (job->n_targets > 0)
        (void)printf("%s to model: mean %.3f  rms %.3f  p95 %.3f  max %.3f mm\n", key, b->mean, b->rms, b->p95, b->max);
    if (job->measures.other_share >= OTHERS)
        (void)printf("left out as other bodies or outliers: %.0f %% of the target\n",
                     100.0 * (double)job->measures.other_share);
    if (job->by_vertex.n > 0)
        (void)printf("vertex to vertex: mean %.3f  max %.3f mm\n", job->by_vertex.mean, job->by_vertex.max);
    if (job->goals != NULL)
        (void)printf("landmarks to their places: mean %.3f  max %.3f mm\n", job->goals->mean, job->goals->max);
    if (job->options->image_target)
        (void)printf("vertices with a goal in the image: %.1f %%\n",
                     job->last.details.matched_share > 0.0f ? 100.0 * (double)job->last.details.matched_share : 0.0);
    (void)printf("folds: %" PRIu64 "  state hash: %016" PRIx64 "\n", job->folds.n, smr_state_hash(job->state));
    for (uint32_t i = 0; i < job->model.n_parts; i++)
        if (host_job_carries(job, i))
            (void)printf("%s%s", carried++ == 0 ? "carried along without a target: " : ", ", job->model.part[i].name);
    if (carried > 0)
        (void)putchar('\n');
    for (uint32_t i = 0; i < job->n_targets; i++)
        if (job->target[i].users == 0)
            (void)printf("not used, no structure has its name: %s\n", job->target[i].path);
    if (job->options->log != NULL && smr_get_log(job->state, &log) == SMR_OK)
        (void)printf("log: %s, %u ticks%s\n", job->options->log, log.n_ticks, log.full ? ", then it was full" : "");
    (void)printf("results: %s\n", job->options->out);
    if (job->options->slicer != NULL)
        (void)printf("scene for 3D Slicer: %s\n", job->options->slicer);
    if (job->options->html)
        (void)printf("to look at: %s/report.html\n", job->options->out);
    print_verdict(&job->verdict);
}
