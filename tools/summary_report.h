/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef HAFT_TOOLS_SUMMARY_REPORT_H
#define HAFT_TOOLS_SUMMARY_REPORT_H

#include "haft/study.h"

/* Prints one member of a JSON object, null if the value is not a finite number, and then `end`. */
void print_json_number(const char *key, double value, const char *end);

/* Prints the statistics of a run beside the case's references, or as JSON. */
void print_result(const haft_case *c, const haft_summary *summary, bool json);

/* Prints the variants of a sweep, one a line, or a list of JSON objects, one a variant. */
void print_sweep(const haft_variant *variant, size_t variants, bool json);

#endif
