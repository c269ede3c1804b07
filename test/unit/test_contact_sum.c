/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What sites give a beam, energy, forces and stiffness, against a plain sum over them: on meshes
 * with a node a site and with many sites an element, as few as share a vector and more than are
 * evaluated at once, in free span and behind walls. */
#include "evaluate.h"
#include "random_beam.h"

enum { MOST = 1300 };

static const haft_mesh_spec MESHES[] = {
    {HAFT_MESH_EXACT, 0, 1e-6, 60e-6, 0},       {HAFT_MESH_ACTIVE, 0, 1e-6, 60e-6, 120e-6},
    {HAFT_MESH_UNIFORM, 15e-6, 1e-6, 60e-6, 0}, {HAFT_MESH_UNIFORM, 20e-6, 3e-6, 60e-6, 0},
    {HAFT_MESH_UNIFORM, 75e-6, 1e-6, 60e-6, 0}, {HAFT_MESH_UNIFORM, 150e-6, 30e-6, 60e-6, 0}};

typedef struct sums {
    haft_energy energy;
    double gradient[MOST], hessian[8 * MOST], gap[MOST], largest;
} sums;

static void feel(const haft_model *model, const haft_law *law, const double *u, sums *out) {
    haft_law_rows *rows = NULL;
    haft_error error = {0};
    check_ok(haft_law_rows_create(&rows, haft_model_get(model)->sites, law, &error), error);
    out->energy = haft_model_evaluate(model, rows, u, 1e-7, out->gradient, out->hessian,
                                      &out->largest, out->gap, NULL);
    check_gradient_alone(model, rows, u, 1e-7, out->gradient);
    haft_law_rows_destroy(&rows);
}

/* The place of entry (i, j) in the Hessian's pattern. */
static int find_slot(const haft_model_data *m, int i, int j) {
    int k = m->column[j];
    while (m->row[k] != i) {
        k++;
    }
    return k;
}

/* Adds the sites' sums to those of a beam that feels nothing, and takes their greatest term. */
static void add_sites(const haft_model *m, const haft_law *law, const double *u, sums *s) {
    const haft_model_data *data = haft_model_get(m);
    for (size_t r = data->inert; r < data->sites; r++) {
        const haft_site *site = &data->site[r];
        haft_law_value v = haft_law_evaluate(&law[r], data->gap - haft_model_displacement(site, u));
        s->energy.contact += site->area * v.potential;
        for (int i = 0; i < site->terms; i++) {
            double term = site->area * v.force * site->shape[i] / data->energy_unit;
            s->gradient[site->dof[i]] += term;
            s->largest = fmax(s->largest, fabs(term));
            for (int j = 0; j < site->terms; j++) {
                int slot = find_slot(haft_model_get(m), site->dof[i], site->dof[j]);
                s->hessian[slot] -=
                    site->area * v.slope * site->shape[i] * site->shape[j] / data->energy_unit;
            }
        }
    }
}

static double greatest(const double *v, size_t n) {
    double most = 0;
    for (size_t i = 0; i < n; i++) {
        most = fmax(most, fabs(v[i]));
    }
    return most;
}

static void check_alike(const double *a, const double *b, size_t n) {
    double scale = greatest(b, n);
    for (size_t i = 0; i < n; i++) {
        assert_true(fabs(a[i] - b[i]) < 1e-13 * scale);
    }
}

/* From the clamp into contact: the last third rests on the substrate, some of it behind walls. */
static void lie_down(const haft_model *model, double *u) {
    for (size_t i = 0; i < haft_model_get(model)->dofs; i++) {
        double x = (double)(i / 2 + 1) / (double)(haft_model_get(model)->dofs / 2),
               y = fmin(1.5 * x, 1);
        u[i] =
            i % 2 == 0 ? 0.9945 * y * y * (3 - 2 * y) + 0.0015 * sin(40 * x) : 1e-4 * cos(40 * x);
    }
}

static void check_beam(const random_beam *b, const haft_law *none) {
    static sums felt, plain;
    const haft_model_data *m = haft_model_get(b->model);
    double u[MOST];
    lie_down(b->model, u);
    feel(b->model, b->law, u, &felt);
    feel(b->model, none, u, &plain);
    size_t in_reach = 0;
    for (size_t r = m->inert; r < m->sites; r++) {
        in_reach += haft_law_evaluate(&b->law[r], felt.gap[r]).force != 0;
        assert_true(felt.gap[r] == plain.gap[r]);
    }
    assert_true(in_reach > 0 && in_reach < m->sites);
    double contact = felt.energy.contact;
    add_sites(b->model, b->law, u, &plain);
    check_near(contact, plain.energy.contact, 1e-13 * fabs(contact) + 0x1p-52 * m->energy_unit);
    check_alike(felt.gradient, plain.gradient, m->dofs);
    check_alike(felt.hessian, plain.hessian, m->nonzeros);
    check_relative(felt.largest, plain.largest, 1e-14);
}

static haft_law_table *steep_table(void) {
    enum { POINTS = 40 };
    double d[POINTS], f[POINTS];
    haft_law_table *table = NULL;
    haft_error error = {0};
    for (int i = 0; i < POINTS; i++) {
        d[i] = 8e-9 + 1e-9 * i;
        f[i] = 1e6 * (i < 8 ? 7 - 2 * i : -9 * exp(-0.3 * (i - 8)));
    }
    f[POINTS - 1] = 0;
    check_ok(haft_law_table_create(&table, POINTS, d, f, &error), error);
    return table;
}

/* Of Morse laws; of them with a table here and there; of tables alone. */
static void sites_give_a_plain_sum(void **state) {
    (void)state;
    haft_law_table *table = steep_table();
    for (size_t k = 0; k < sizeof MESHES / sizeof *MESHES; k++) {
        random_beam b = random_beam_create(3, MESHES[k]);
        haft_error error = {0};
        haft_law *none = haft_memory_alloc(haft_model_get(b.model)->sites, sizeof *none, &error);
        assert_non_null(none);
        for (size_t r = 0; r < haft_model_get(b.model)->sites; r++) {
            none[r] = nothing();
        }
        check_beam(&b, none);
        for (int mix = 0; mix < 2; mix++) {
            for (size_t r = 0; r < haft_model_get(b.model)->sites; r += mix == 0 ? 7 : 1) {
                b.law[r] = haft_law_from_table(table);
            }
            check_beam(&b, none);
        }
        haft_memory_free(none);
        random_beam_destroy(&b);
    }
    haft_law_table_destroy(&table);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sites_give_a_plain_sum),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
