/* cmd_measure_labels.c: smr measure of label maps: Dice's coefficient, distances and volumes of each structure.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/threads.h"
#include "commands/commands.h"
#include "labels/label_overlap.h"
#include "labels/label_side.h"

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
    uint32_t i = 0, pairs = 0;
    double dice = 0.0, mean = 0.0, most = 0.0;
    for (i = 0; i < n; i++) {
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

int host_measure_labels(const host_options *options, host_error *error)
{
    host_label_side side[2];
    host_port port;
    int result = HOST_REFUSED;
    memset(side, 0, sizeof side);
    memset(&port, 0, sizeof port);
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
