/* report_files.c: what report.json says of the command and of the files that it read and wrote.
 * SPDX-License-Identifier: MIT */
#include "report/report_files.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "files/file_read.h"

void host_report_command(const host_options *options, host_json *json)
{
    int i = 0;
    host_json_open(json, "command", '[');
    host_json_text(json, NULL, "smr");
    host_json_text(json, NULL, options->command == HOST_TRACK ? "track" : "register");
    for (i = 0; i < options->n_arguments; i++)
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
    int i = 0;
    json->out->failed |= n < 0;
    host_json_open(json, "inputs", '[');
    for (i = 0; i < n; i++)
        put_file("path", input[i].path, input[i].bytes, input[i].crc32, json);
    host_json_close(json, ']');
    free(input);
}

void host_report_results(const host_output *output, host_json *json)
{
    size_t i = 0;
    host_json_open(json, "results", '[');
    for (i = 0; i < host_output_count(output); i++) {
        const host_output_fact fact = host_output_fact_of(output, i);
        put_file(fact.inside ? "file" : "path", fact.name, fact.bytes, fact.crc32, json);
    }
    host_json_close(json, ']');
}
