/* contact_forces.c: what is added to forces so that structures keep apart, once it is known who takes part.
 * Bounds: those of contact.c for each active vertex, and for each triangle in the iterations in which they
 * are due. SPDX-License-Identifier: MIT */
#include "registration/goals/external_forces.h"

/* The displacement of v by its goal and momentum, before contact, mm. */
static smr_vec requested_displacement(const void *arg, uint32_t v)
{
    const smr_forces *f = arg;
    if (!smr_active(f->schedule, v))
        return smr_v(0, 0, 0);
    const float share = f->shared->config.forces.stiffness * f->schedule->gain * smr_forces_ease(f, v);
    return smr_add(smr_scale(smr_get3(f->force, v), share), smr_momentum(f, v));
}

uint32_t smr_contact_tasks(const void *arg)
{
    const smr_forces *f = arg;
    if (!smr_contact_on(&f->contact))
        return 0;
    return smr_ceil_div(f->schedule->n_active, SMR_CONTACT_CHUNK) +
           (f->contact.triangles_due ? smr_ceil_div(f->shared->n_triangles, SMR_CONTACT_CHUNK) : 0u);
}

void smr_contact_search(void *arg, uint32_t task, uint32_t worker)
{
    smr_forces *f = arg;
    (void)worker;
    const uint32_t n_tasks = smr_ceil_div(f->schedule->n_active, SMR_CONTACT_CHUNK);
    if (task >= n_tasks) {
        const uint32_t first = (task - n_tasks) * SMR_CONTACT_CHUNK;
        for (uint32_t k = first; k < smr_min_u32(first + SMR_CONTACT_CHUNK, f->shared->n_triangles); k++)
            smr_contact_find_triangle(&f->contact, k);
        return;
    }
    const uint32_t last = smr_min_u32((task + 1u) * SMR_CONTACT_CHUNK, f->schedule->n_active);
    for (uint32_t v = task * SMR_CONTACT_CHUNK; v < last; v++) {
        smr_contact_find(&f->contact, v);
        smr_put3(f->contact.push, v, smr_contact_displacement(&f->contact, v, requested_displacement, f));
    }
}
