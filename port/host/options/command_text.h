/* command_text.h: what help, man pages and completion say of the commands.
 * SPDX-License-Identifier: MIT */
#ifndef COMMAND_TEXT_H
#define COMMAND_TEXT_H

#include "options/options_table.h"

typedef struct host_command_text {
    const char *name;
    int command;              /* HOST_REGISTER, ... */
    const char *purpose;      /* a few words, in lower case */
    const char *synopsis[4];  /* what follows the name, a way to call it each; NULL behind the last */
    const char *paragraph[6]; /* NULL behind the last */
    const char *status;       /* exit status other than 0 and 2; "" for none */
} host_command_text;

extern const host_command_text host_command_texts[];
extern const size_t host_command_count;

/* The groups in which a command's options are shown. NULL behind the last. */
extern const char *const host_option_groups[];

/* The option's group: its place in host_option_groups. */
size_t host_option_group(const host_option *o, int command);

/* What every page ends with: status 0 and 2. */
extern const char host_status_text[];

/* Prints what `smr NAME --help` says; 0, or -1 when there is no such command. */
int host_command_help(const char *name);

#endif
