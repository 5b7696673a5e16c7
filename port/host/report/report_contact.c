/* report_contact.c: the key "contact" of report.json: which surfaces touch and overlap, pair by pair, and sums.
 * SPDX-License-Identifier: MIT */
#include "report/register_report.h"

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
    uint32_t i = 0;
    for (i = 0; i < c->n_pairs; i++)
        if (structure == SMR_ALL || c->pair[i].a == structure || c->pair[i].b == structure)
            add(&t, &c->pair[i].report);
    return t;
}

void host_report_contact(const host_job *job, host_json *json)
{
    const host_contacts *const c = &job->contacts;
    uint32_t i = 0;
    total t = total_of(c, SMR_ALL);
    if (!c->measured) {
        host_json_null(json, "contact");
        return;
    }
    host_json_open(json, "contact", '{');
    host_json_flag(json, "on", job->course.config.contact.share > 0.0f);
    host_json_number(json, "within_mm", (double)HOST_CONTACT_MM);
    put(json, &t);
    host_json_open(json, "pairs", '[');
    for (i = 0; i < c->n_pairs; i++) {
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
    for (i = 0; i < job->model.n_parts + c->n_fixed; i++) {
        t = total_of(c, i);
        host_json_open(json, NULL, '{');
        host_json_text(json, "structure", host_contact_name(job, i)); /* "name" is what line by line readers look for */
        put(json, &t);
        host_json_close(json, '}');
    }
    host_json_close(json, ']');
    host_json_close(json, '}');
}
