/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Data shared by the figures of a model. Private to this room. */
#ifndef HAFT_STUDY_STOCHASTIC_FIGURES_H
#define HAFT_STUDY_STOCHASTIC_FIGURES_H

#include "study/laws/stochastic.h"

enum { ORDERS = 3 };

/* Range of a component in figures, in standard deviations. */
#define SHOWN 4.5

/* Expansions of a few orders, 4, 8 and the case's own, the last, and components drawn from each. */
typedef struct orders {
    haft_chaos_parts p; /* of the case's model */
    size_t n, order[ORDERS];
    haft_chaos *chaos[ORDERS];
    double *eta[ORDERS]; /* [N_g][many] */
    char label[ORDERS][16];
} orders;

haft_status haft_stochastic_orders_open(orders *o, const haft_case *c, const haft_laws *laws,
                                        haft_error *error) HAFT_MUST_CHECK;
void haft_stochastic_orders_close(orders *o);

/* map.csv: the inverse Rosenblatt map and the expansions (Fig. C.23b, c). */
haft_status haft_stochastic_write_map(const orders *o, const haft_laws *laws, const char *directory,
                                      haft_error *error) HAFT_MUST_CHECK;

/* orders.csv: errors by germ and order (Fig. C.23a). */
haft_status haft_stochastic_write_orders(const haft_case *c, const haft_laws *laws,
                                         const char *directory, haft_error *error) HAFT_MUST_CHECK;

/* parts.csv, density.csv: convergence in the number of vectors (Fig. B.22). */
haft_status haft_stochastic_write_parts(const haft_case *c, const haft_laws *laws,
                                        const char *directory, haft_error *error) HAFT_MUST_CHECK;

#endif
