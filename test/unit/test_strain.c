/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Elements done in runs against the same one by one, and what their forces weigh. */
#include "evaluate.h"
#include "random_beam.h"

enum { MOST = 1000 };

typedef struct strained {
    double energy, largest, gradient[MOST];
} strained;

/* Every element by itself, through its modes. */
static void strain_each(const haft_model *m, const double *u, strained *out) {
    *out = (strained){0};
    for (size_t e = 0; e < haft_model_get(m)->elements; e++) {
        const haft_element *el = &haft_model_get(m)->element[e];
        double v[HAFT_SPAN], q[2], moment[2];
        for (int k = 0; k < HAFT_SPAN; k++) {
            v[k] = el->dof[k] < 0 ? 0 : u[el->dof[k]];
        }
        for (int i = 0; i < 2; i++) {
            const double *b = el->mode[i];
            q[i] = (b[0] * v[0] + b[2] * v[2]) + (b[1] * v[1] + b[3] * v[3]);
        }
        moment[0] = el->stiffness[0] * q[0] + el->stiffness[1] * q[1];
        moment[1] = el->stiffness[1] * q[0] + el->stiffness[2] * q[1];
        out->energy += 0.5 * (q[0] * moment[0] + q[1] * moment[1]);
        for (int k = 0; k < HAFT_SPAN; k++) {
            double force = el->mode[0][k] * moment[0] + el->mode[1][k] * moment[1];
            if (el->dof[k] >= 0) {
                out->gradient[el->dof[k]] += force;
                out->largest = fmax(out->largest, fabs(force));
            }
        }
    }
}

static void bend(const haft_model *model, double *u) {
    for (size_t i = 0; i < haft_model_get(model)->dofs; i++) {
        u[i] = sin(0.37 * (double)(i * i));
    }
}

/* Beams of every number of elements, and one whose load splits an element. */
static void runs_give_the_forces_of_each_element(void **state) {
    (void)state;
    for (size_t elements = 1; elements <= 41; elements++) {
        haft_beam_spec beam = {3e-6 * (double)elements, 30e-6, 2.62e-6, 1.9e-6, 163e9};
        haft_mesh_spec mesh = {elements % 2 ? HAFT_MESH_UNIFORM : HAFT_MESH_EXACT, 3e-6, 3e-6,
                               elements > 20 ? 37.1e-6 : 1.5e-6, 0};
        haft_error error = {0};
        haft_model *model = NULL;
        check_ok(haft_model_create_beam(&model, &beam, &mesh, &error), error);
        double u[MOST], y[MOST], none[MOST] = {0};
        bend(model, u);
        strained each;
        strain_each(model, u, &each);
        haft_model_multiply(model, none, u, y);
        assert_memory_equal(y, each.gradient, haft_model_get(model)->dofs * sizeof *y);
        haft_model_destroy(&model);
    }
}

/* With laws that are nil everywhere the beam's own energy and forces are all there is. */
static void their_energy_and_greatest_force_are_each_elements(void **state) {
    (void)state;
    static const haft_mesh_spec meshes[] = {{HAFT_MESH_EXACT, 0, 3e-6, 60e-6, 0},
                                            {HAFT_MESH_UNIFORM, 15e-6, 3e-6, 60e-6, 0},
                                            {HAFT_MESH_ACTIVE, 0, 3e-6, 61e-6, 120e-6}};
    for (size_t k = 0; k < sizeof meshes / sizeof *meshes; k++) {
        random_beam b = random_beam_create(1, meshes[k]);
        for (size_t r = 0; r < haft_model_get(b.model)->sites; r++) {
            b.law[r] = nothing();
        }
        double u[MOST], gradient[MOST], largest = 0;
        bend(b.model, u);
        strained each;
        strain_each(b.model, u, &each);
        haft_energy energy = evaluate(b.model, b.law, u, 0, gradient, NULL, &largest);
        check_relative(energy.strain, each.energy * haft_model_get(b.model)->energy_unit, 1e-14);
        assert_memory_equal(gradient, each.gradient,
                            haft_model_get(b.model)->dofs * sizeof *gradient);
        assert_true(largest == each.largest);
        random_beam_destroy(&b);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(runs_give_the_forces_of_each_element),
        cmocka_unit_test(their_energy_and_greatest_force_are_each_elements),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
