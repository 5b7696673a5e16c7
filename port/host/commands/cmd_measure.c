/* cmd_measure.c: smr measure: distances between two surfaces both ways, Hausdorff distance, folds.
 * SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "commands/commands.h"
#include "labels/label_overlap.h"
#include "options/options_table.h"

static void print_one(const host_overlap *o)
{
    (void)printf("%-32s Dice %.4f  ", o->name, o->dice);
    if (o->to_a.n > 0 && o->to_b.n > 0)
        (void)printf("mean %.4f  Hausdorff95 %.4f  Hausdorff %.4f mm  ", o->mean, o->hausdorff95,
                     o->to_a.max > o->to_b.max ? o->to_a.max : o->to_b.max);
    else
        (void)printf("%s  ", o->a == SMR_NONE ? "only in B" : (o->b == SMR_NONE ? "only in A" : "no surface"));
    (void)printf("volume A %.1f  B %.1f mm3\n", o->mm3_a, o->mm3_b);
}

static void print_all(const host_overlap *overlap, uint32_t n)
{
    uint32_t pairs = 0;
    double dice = 0.0, mean = 0.0, most = 0.0;
    for (uint32_t i = 0; i < n; i++) {
        print_one(&overlap[i]);
        if (overlap[i].a == SMR_NONE || overlap[i].b == SMR_NONE)
            continue;
        pairs++;
        dice += overlap[i].dice;
        mean += overlap[i].mean;
        most = overlap[i].hausdorff95 > most ? overlap[i].hausdorff95 : most;
    }
    if (pairs > 0)
        (void)printf("%u structures in both: Dice %.4f  mean %.4f mm in the mean, Hausdorff95 at most %.4f mm\n", pairs,
                     dice / (double)pairs, mean / (double)pairs, most);
}

static int compare(const host_label_side side[2], const smr_port *port, host_error *error)
{
    host_overlap *const overlap = calloc((size_t)side[0].map.n_labels + side[1].map.n_labels, sizeof *overlap);
    int n = -1;
    error->file = "measure";
    if (overlap == NULL)
        (void)host_fail(error, "labels", "free memory");
    else
        n = host_overlaps_measure(port, &side[0].map, side[0].mesh, &side[1].map, side[1].mesh, overlap, error);
    if (n >= 0)
        print_all(overlap, (uint32_t)n);
    free(overlap);
    return n >= 0 ? 0 : -1;
}

/* When one of the two is a label map, or both. */
static int host_measure_labels(const host_options *options, host_error *error)
{
    host_label_side side[2];
    host_port port = {0};
    int result = HOST_REFUSED;
    memset(side, 0, sizeof side);
    side[0].path = options->operands.path[0];
    side[1].path = options->operands.path[1];
    error->file = "--source";
    if (options->source != NULL)
        (void)host_fail(error, "option", "two surfaces beside it");
    else if (host_port_open(&port, options->threads, error) == 0 &&
             host_label_sides_read(side, options->names, options->passes, &port.port, error) == 0 &&
             compare(side, &port.port, error) == 0)
        result = HOST_DONE;
    host_label_side_free(&side[0]);
    host_label_side_free(&side[1]);
    host_port_close(&port);
    return result;
}

/* Surfaces A and B, and the source: A before it was deformed. */
typedef struct measured {
    host_load load[3];
    uint32_t n;
    smr_surface *surface[2];
    void *memory[2];                 /* owned */
    host_stats area[2], vertices[2]; /* A to B, B to A */
    host_folds folds;
    smr_contact_report contact; /* all 0 where they are not two closed surfaces */
} measured;

#define CONTACT_MM 0.5f /* what is nearer touches */

static int load(measured *m, const host_options *options, const smr_port *port, host_error *error)
{
    m->n = options->source != NULL ? 3 : 2;
    for (uint32_t i = 0; i < m->n; i++) {
        m->load[i] = (host_load){.path = i < 2 ? options->operands.path[i] : options->source,
                                 .need = i < 2 ? HOST_MESH_POINTS_TOO : HOST_MESH_SURFACE,
                                 .mirror = HOST_MIRROR_NONE};
    }
    if (host_load_all(port, m->load, m->n, error) != 0)
        return -1;
    if (m->load[0].mesh.n_triangles == 0 && m->load[1].mesh.n_triangles == 0)
        return host_fail_of(error, m->load[1].path, "faces",
                            "at least one triangle, for one of the two must be a surface");
    return 0;
}

/* The source must have A's vertices and triangles. */
static int check_source(const measured *m, host_error *error)
{
    const host_mesh *const a = &m->load[0].mesh, *const s = &m->load[2].mesh;
    error->file = m->load[2].path;
    if (s->n_vertices != a->n_vertices || s->n_triangles != a->n_triangles)
        return host_fail(error, "size", "the %u vertices and %u triangles of %s", a->n_vertices, a->n_triangles,
                         m->load[0].path);
    if (memcmp(s->triangles, a->triangles, 12u * (size_t)a->n_triangles) != 0)
        return host_fail(error, "faces", "the same triangles as %s", m->load[0].path);
    return 0;
}

static int measure(measured *m, const smr_port *port)
{
    host_query query[2];
    uint32_t from[2] = {0, 0}, i = 0, n = 0;
    memset(query, 0, sizeof query);
    for (i = 0; i < 2; i++) {
        if (m->surface[1u - i] == NULL)
            continue;
        query[n].surface = m->surface[1u - i];
        query[n].mesh = host_mesh_view(&m->load[i].mesh);
        from[n++] = i;
    }
    int result = host_distances(port, query, n);
    for (i = 0; result == 0 && i < n; i++)
        result = host_area_stats(&query[i], 1, NULL, &m->area[from[i]]) |
                 host_vertex_stats(&query[i], 1, NULL, &m->vertices[from[i]]);
    host_queries_free(query, n);
    return result;
}

static int measure_contact(measured *m, const smr_port *port)
{
    smr_job job;
    if (m->surface[0] == NULL || m->surface[1] == NULL)
        return 0;
    if (smr_surface_contact_begin(m->surface[0], m->surface[1], CONTACT_MM, &m->contact, &job) != SMR_OK)
        return -1;
    return smr_job_step(&job, 0, port, 0) == SMR_OK ? 0 : -1;
}

static int evaluate(measured *m, const smr_port *port)
{
    const smr_mesh a = host_mesh_view(&m->load[0].mesh);
    for (uint32_t i = 0; i < 2; i++) {
        const smr_mesh view = host_mesh_view(&m->load[i].mesh);
        if (view.n_triangles == 0)
            continue;
        m->surface[i] = host_surface_make(&view, &m->memory[i]);
        if (m->surface[i] == NULL)
            return -1;
    }
    if (measure(m, port) != 0 || measure_contact(m, port) != 0)
        return -1;
    return a.n_triangles == 0 ? 0 : host_count_folds(&a, m->n == 3 ? m->load[2].mesh.xyz : NULL, &m->folds);
}

/* One direction. Points have no area. */
static void print_stats(const measured *m, uint32_t i)
{
    static const char *const names[] = {"A to B", "B to A"};
    const host_stats *const a = &m->area[i], *const v = &m->vertices[i];
    if (a->n == 0)
        return;
    (void)printf("%s: mean %.4f  rms %.4f  p95 %.4f  max %.4f mm", names[i], a->mean, a->rms, a->p95, a->max);
    if (m->surface[i] == NULL)
        (void)printf("  (%zu points)\n", v->n);
    else
        (void)printf("  (over the area)\n%s, vertices: mean %.4f  rms %.4f  p95 %.4f  max %.4f mm  (%zu vertices)\n",
                     names[i], v->mean, v->rms, v->p95, v->max, v->n);
}

/* Two bodies: not two surfaces of the same one, which have nine tenths of the larger one in common. */
static int two_bodies(const measured *m)
{
    const double a = fabs(host_enclosed_volume(&m->load[0].mesh)), b = fabs(host_enclosed_volume(&m->load[1].mesh));
    return (double)m->contact.volume_mm3 < 0.9 * fmax(a, b);
}

static void print(const measured *m)
{
    print_stats(m, 0);
    print_stats(m, 1);
    if (m->area[0].n > 0 && m->area[1].n > 0)
        (void)printf("Hausdorff: %.4f mm\n", m->area[0].max > m->area[1].max ? m->area[0].max : m->area[1].max);
    if ((m->contact.deepest_mm > 0.0f || m->contact.area_mm2 > 0.0f) && two_bodies(m))
        (void)printf("contact: deepest %.4f mm  overlap %.1f mm3  area within %.1f mm %.1f mm2\n",
                     (double)m->contact.deepest_mm, (double)m->contact.volume_mm3, (double)CONTACT_MM,
                     (double)m->contact.area_mm2);
    if (m->n == 3)
        (void)printf("folds: %" PRIu64 "  (edges turned back in A: %" PRIu64 ")\n", m->folds.n, m->folds.all);
    else if (m->surface[0] != NULL)
        (void)printf("folds: %" PRIu64 "  (edges turned back in A; --source tells new ones)\n", m->folds.all);
}

/* What label maps alone can use. */
static int check_options(const host_options *options, host_error *error)
{
    static const char *const names[] = {"--names", "--passes"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        error->file = names[i];
        if (host_option_given(options, names[i]))
            return host_fail(error, "option", "a label map beside it, these are two surfaces");
    }
    return 0;
}

int host_measure(const host_options *options, host_error *error)
{
    host_port port = {0};
    measured m = {0};
    int result = HOST_REFUSED;
    if (host_is_label_side(options->operands.path[0]) || host_is_label_side(options->operands.path[1]))
        return host_measure_labels(options, error);
    if (check_options(options, error) == 0 && host_port_open(&port, options->threads, error) == 0 &&
        load(&m, options, &port.port, error) == 0 && (m.n < 3 || check_source(&m, error) == 0)) {
        error->file = "measure";
        if (evaluate(&m, &port.port) == 0) {
            print(&m);
            result = HOST_DONE;
        } else {
            (void)host_fail(error, "distances", "surfaces that can be measured, and free memory for it");
        }
    }
    for (uint32_t i = 0; i < 3; i++)
        host_mesh_free(&m.load[i].mesh);
    free(m.memory[0]);
    free(m.memory[1]);
    host_port_close(&port);
    return result;
}
