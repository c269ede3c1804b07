/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the law's front needs of a table. */
#ifndef HAFT_LAW_TABLE_H
#define HAFT_LAW_TABLE_H

#include "haft/law.h"

/* A law is taken to have two lengths where they differ by at least so much. */
#define HAFT_LAW_WIDER 10

haft_law_value haft_law_table_evaluate(const haft_law_table *table, double d);

/* What finds a table's piece, kept apart so that those of many tables lie side by side: a beam's
 * tables are larger than a cache. */
typedef struct haft_table_head {
    double first, last; /* gaps between which it is not a tangent or nil */
    double per_step;    /* pieces a metre; 0 if they are not even */
    double most;        /* the last one's number */
    const haft_law_table *table;
} haft_table_head;

/* All nil for NULL. */
haft_table_head haft_law_table_head(const haft_law_table *table);

/* Values of n tables, each at its own d; where a table is NULL nothing is written. */
void haft_law_tables_evaluate(const haft_table_head *head, size_t n, const double *d,
                              const haft_law_values *out);

/* Its points: how many, and where they are. */
size_t haft_law_table_points(const haft_law_table *table);
double haft_law_table_point(const haft_law_table *table, size_t i);

/* The force at a point that is not the last. */
double haft_law_table_force(const haft_law_table *table, size_t i);

double haft_law_table_reach(const haft_law_table *table, double share);
double haft_law_table_extent(const haft_law_table *table, double share);
haft_law_lengths haft_law_table_lengths(const haft_law_table *table);
double haft_law_table_range(const haft_law_table *table);

#endif
