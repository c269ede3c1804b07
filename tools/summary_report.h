/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef HAFT_TOOLS_SUMMARY_REPORT_H
#define HAFT_TOOLS_SUMMARY_REPORT_H

#include "haft/study.h"

/* Prints one member of a JSON object, null where it is no finite number, and `end`. */
void print_json_number(const char *key, double value, const char *end);

/* Prints the statistics of a run beside its references, or as JSON. */
void print_result(const haft_case *c, const haft_summary *summary, bool json);

/* Prints the variants of a sweep, a line each, or their JSON objects in a list. */
void print_sweep(const haft_variant *variant, size_t variants, bool json);

#endif
