/* volume_ratios.c: the words NAME=R of --volume-ratio.
 * SPDX-License-Identifier: MIT */
#include "options/volume_ratios.h"

#include <string.h>

#include "base/text_scan.h"

#define RATIO_LEAST 0.1 /* as smr_set_volume_ratio() has it */
#define RATIO_MOST 10.0

int host_volume_ratio_split(const char *word, size_t *name, double *ratio)
{
    const char *const equals = strrchr(word, '=');
    if (equals == NULL || equals == word)
        return 0;
    *name = (size_t)(equals - word);
    return host_word_double((host_word){equals + 1, strlen(equals + 1)}, ratio) && *ratio >= RATIO_LEAST &&
           *ratio <= RATIO_MOST;
}

/* 1 where an earlier word has the same name. */
static int is_again(const host_files *words, uint32_t number)
{
    size_t name = 0, other = 0;
    double ratio = 0.0;
    uint32_t i = 0;
    (void)host_volume_ratio_split(words->path[number], &name, &ratio);
    for (i = 0; i < number; i++)
        if (host_volume_ratio_split(words->path[i], &other, &ratio) && other == name &&
            strncmp(words->path[i], words->path[number], name) == 0)
            return 1;
    return 0;
}

int host_volume_ratios_check(const host_files *words, host_error *error)
{
    size_t name = 0;
    double ratio = 0.0;
    uint32_t i = 0;
    error->file = "--volume-ratio";
    for (i = 0; i < words->n; i++)
        if (!host_volume_ratio_split(words->path[i], &name, &ratio))
            return host_fail(error, words->path[i], "NAME=R, a structure and a ratio of at least %g and at most %g",
                             RATIO_LEAST, RATIO_MOST);
        else if (is_again(words, i))
            return host_fail(error, words->path[i], "one ratio for each structure");
    return 0;
}
