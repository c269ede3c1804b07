/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The front of a beam against the whole of it: what moves in front feels the same. */
#include "random_beam.h"

enum { MOST = 1300 };

static const haft_mesh_spec MESHES[] = {
    {HAFT_MESH_EXACT, 0, 3e-6, 60e-6, 0},       {HAFT_MESH_ACTIVE, 0, 3e-6, 60e-6, 120e-6},
    {HAFT_MESH_UNIFORM, 15e-6, 3e-6, 60e-6, 0}, {HAFT_MESH_UNIFORM, 20e-6, 3e-6, 60e-6, 0},
    {HAFT_MESH_EXACT, 0, 1e-6, 60e-6, 0},       {HAFT_MESH_UNIFORM, 15e-6, 1e-6, 60e-6, 0}};

/* A beam bent into contact, with gaps of all sizes about its laws' ranges, behind a free span. */
static void bend(const haft_model *model, double wave, double *u) {
    for (size_t i = 0; i < haft_model_get(model)->dofs; i++) {
        double x = (double)(i / 2 + 1) / (double)haft_model_get(model)->dofs, y = fmin(40 * x, 1);
        u[i] = i % 2 == 0 ? 0.9937 * y * y * (3 - 2 * y) + 0.002 * sin(wave * x)
                          : 1e-4 * cos(wave * x);
    }
}

typedef struct felt {
    haft_energy energy;
    double gradient[MOST], hessian[8 * MOST], gap[MOST];
} felt;

static void feel(const haft_model *model, const haft_law_rows *rows, const double *u, felt *out) {
    out->energy = haft_model_evaluate(model, rows, u, 1e-7, out->gradient, out->hessian, NULL,
                                      out->gap, NULL);
}

/* Energies of the front differ from one state to another as the whole's do. */
static void check_gain(double whole, double other_whole, double part, double other_part) {
    double gained = other_whole - whole;
    assert_true(gained != 0);
    assert_true(fabs(other_part - part - gained) < 1e-13 * fabs(whole));
}

/* Two states that differ in front alone: as the whole feels them, so does the front. */
static void compare(const haft_model *model, const haft_law_rows *rows, size_t sites) {
    haft_error error = {0};
    haft_model *front = NULL;
    check_ok(haft_model_create_front(&front, &error), error);
    size_t moving = haft_model_set_front(front, model, sites);
    const haft_model_data *m = haft_model_get(model), *f = haft_model_get(front);
    assert_true(f->sites >= sites && moving < m->dofs && f->dofs == moving + 2);
    assert_true(m->site[sites - 1].dof[0] < (int)moving);
    double u[MOST], v[MOST];
    bend(model, 50, u);
    bend(model, 60, v);
    memcpy(v + moving, u + moving, (m->dofs - moving) * sizeof *v);
    static felt whole, part, other_whole, other_part;
    feel(model, rows, u, &whole);
    feel(model, rows, v, &other_whole);
    feel(front, rows, u, &part);
    feel(front, rows, v, &other_part);
    assert_memory_equal(part.gradient, whole.gradient, moving * sizeof(double));
    assert_memory_equal(part.hessian, whole.hessian, (size_t)m->column[moving] * sizeof(double));
    assert_memory_equal(part.gap + m->inert, whole.gap + m->inert,
                        (f->sites - m->inert) * sizeof(double));
    check_gain(whole.energy.strain, other_whole.energy.strain, part.energy.strain,
               other_part.energy.strain);
    check_gain(whole.energy.contact, other_whole.energy.contact, part.energy.contact,
               other_part.energy.contact);
    for (size_t r = f->sites; r < m->sites; r++) {
        assert_true(whole.gap[r] == other_whole.gap[r]); /* they did not move */
    }
    haft_model_destroy_front(&front);
}

static void a_front_feels_what_the_whole_does(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof MESHES / sizeof *MESHES; k++) {
        random_beam b = random_beam_create(3, MESHES[k]);
        haft_law_rows *rows = NULL;
        haft_error error = {0};
        check_ok(haft_law_rows_create(&rows, haft_model_get(b.model)->sites, b.law, &error), error);
        for (size_t sites = haft_model_get(b.model)->inert + 1;
             sites < haft_model_get(b.model)->sites - 40; sites += 7) {
            compare(b.model, rows, sites);
        }
        haft_law_rows_destroy(&rows);
        random_beam_destroy(&b);
    }
}

/* Where nothing is left to freeze, the front is the whole. */
static void a_front_of_all_sites_is_the_whole(void **state) {
    (void)state;
    random_beam b = random_beam_create(3, MESHES[0]);
    haft_error error = {0};
    haft_model *front = NULL;
    check_ok(haft_model_create_front(&front, &error), error);
    const haft_model_data *m = haft_model_get(b.model), *f = haft_model_get(front);
    assert_true(haft_model_set_front(front, b.model, m->sites) == m->dofs);
    assert_true(f->dofs == m->dofs && f->sites == m->sites);
    haft_model_destroy_front(&front);
    random_beam_destroy(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_front_feels_what_the_whole_does),
        cmocka_unit_test(a_front_of_all_sites_is_the_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
