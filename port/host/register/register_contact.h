/* register_contact.h: what structures are kept out of besides each other, and how result surfaces touch and overlap.
 * SPDX-License-Identifier: MIT */
#ifndef REGISTER_CONTACT_H
#define REGISTER_CONTACT_H

#include "base/error_line.h"
#include "smr.h"

#define HOST_CONTACT_MM 0.5f /* surfaces nearer than this touch */

/* Two surfaces that touch or overlap. */
typedef struct host_contact_pair {
    uint32_t a, b; /* structures; b - n_parts: a fixed surface */
    smr_contact_report report;
    float left_mm;  /* how deep they are in each other that should not be; 0 where one lies in the other by design */
    float asked_mm; /* how deep the structure's own target lies in the fixed surface: what contact works against */
} host_contact_pair;

typedef struct host_contacts {
    struct host_target *fixed; /* [n_fixed]; owned */
    uint32_t n_fixed;
    host_contact_pair *pair; /* [n_pairs] those that touch or overlap, in order; owned */
    uint32_t n_pairs;
    int measured; /* 1: pair is of the results */
} host_contacts;

struct host_job;

/* Reads the files of --contact-with, after the model. 0, or -1 with the error filled: also where nothing can touch. */
int host_job_load_fixed(struct host_job *job, host_error *error);

/* Sets them. */
smr_status host_job_set_fixed(struct host_job *job);

/* Measures all pairs of results and fixed surfaces. 0, or -1 with the error filled. */
int host_job_measure_contact(struct host_job *job, host_error *error);

/* Of the model as it is now: the deepest pair that contact should have parted, mm; 0: there is none, or contact is off.
 * 0, or -1 with the error filled. */
int host_job_contact_left(struct host_job *job, float *left_mm, host_error *error);

/* How deep surfaces may still lie in each other for a good result, mm: less where they keep a distance; any depth where
 * contact is off. */
float host_contact_bound(const struct host_job *job);

/* The name of a pair's surface. */
const char *host_contact_name(const struct host_job *job, uint32_t i);

void host_contacts_free(host_contacts *contacts);

#endif
