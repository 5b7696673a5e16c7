/* register_course.c: what the page of a report tells of the way: where the structures started, and each iteration.
 * SPDX-License-Identifier: MIT */
#include <stdlib.h>

#include "register/register_job.h"

#define FIRST_STEPS 256u

int host_job_course_begin(host_job *job, host_error *error)
{
    size_t n = 0;
    uint32_t i = 0;
    float *at = NULL;
    if (!job->options->html)
        return 0;
    for (i = 0; i < job->model.n_parts; i++)
        n += job->model.part[i].mesh.n_vertices;
    job->course.before_xyz = at = malloc((3u * n + 1u) * sizeof *at);
    error->file = "register";
    if (at == NULL)
        return host_fail(error, "memory", "room for the start positions");
    for (i = 0; i < job->model.n_parts; i++) {
        if (smr_get_positions(job->state, i, at) != SMR_OK)
            return host_fail_at(error, "structure", i, "positions from the library");
        at += 3u * (size_t)job->model.part[i].mesh.n_vertices;
    }
    return 0;
}

int host_job_course_step(host_job *job, host_error *error)
{
    host_course *const course = &job->course;
    const smr_tick_report *const last = &job->last;
    if (!job->options->html)
        return 0;
    if (course->n == course->capacity) {
        const size_t capacity = course->capacity == 0 ? FIRST_STEPS : 2u * course->capacity;
        host_step *const grown = realloc(course->step, capacity * sizeof *grown);
        error->file = "register";
        if (grown == NULL)
            return host_fail(error, "memory", "room for what the iterations did");
        course->step = grown;
        course->capacity = capacity;
    }
    course->step[course->n++] = (host_step){last->iteration,
                                            last->details.n_taken,
                                            (double)job->model.info.radius_mm[last->details.radius],
                                            1e3 * job->ticks_s,
                                            last->residual_mean_mm,
                                            last->displacement_max_mm,
                                            last->details.matched_share};
    return 0;
}

void host_course_free(host_course *course)
{
    free(course->before_xyz);
    free(course->step);
}
