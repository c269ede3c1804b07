/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the law's front needs of a table. */
#ifndef HAFT_LAW_TABLE_H
#define HAFT_LAW_TABLE_H

#include "haft/law.h"

haft_law_value haft_law_table_evaluate(const haft_law_table *table, double d);

/* Those of n tables, each at its own d; where a table is NULL nothing is written. */
void haft_law_tables_evaluate(const haft_law_table *const *table, size_t n, const double *d,
                              const haft_law_values *out);
double haft_law_table_reach(const haft_law_table *table, double share);
double haft_law_table_range(const haft_law_table *table);

#endif
