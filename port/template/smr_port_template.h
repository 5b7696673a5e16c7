/* smr_port_template.h: the smallest port. Copy this folder, rename it, fill in what the comments ask for.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_PORT_TEMPLATE_H
#define SMR_PORT_TEMPLATE_H

#include <smr.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What your port remembers between calls: a timer's base address, a task queue. The caller owns it. */
typedef struct smr_template {
    uint64_t last_ns;
} smr_template;

/* Prepares *state and returns the port to hand to smr_init(). *state must stay as long as the port. */
smr_port smr_template_port(smr_template *state);

#ifdef __cplusplus
}
#endif

#endif
