/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A near-contact law of one's own: the Lennard-Jones 9-3 wall
 *
 *     f(d) = (8 w / (3 z)) ((z/d)^9 - (z/d)^3),    Phi(d) = (w/3) ((z/d)^8 - 4 (z/d)^2),
 *
 * of adhesion energy w and equilibrium distance z, made as tools/doc/architecture.md says: a table
 * of the curve, one law a site, a path. All that comes out is compared with closed forms that know
 * nothing of the table or of the finite elements.
 *
 *     cc lennard_jones.c $(pkg-config --cflags --libs haft) -lm -o lennard_jones && ./lennard_jones
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <haft/haft.h>

enum { SITES = 300, POINTS = 6001 };

static const double w = 4e-3; /* [J/m2] */
static const double z = 4e-9; /* [m] */

/* The wall begins at 0.8 z. The pull falls as d^-3 and must end: it is shifted to vanish at 40 z,
 * so that the law is continuous; its potential then is zero there too. */
static const double first = 0.8 * 4e-9, last = 40 * 4e-9;

static double bare_force(double d) {
    return 8 * w / (3 * z) * (pow(z / d, 9) - pow(z / d, 3));
}

static double bare_potential(double d) {
    return w / 3 * (pow(z / d, 8) - 4 * pow(z / d, 2));
}

/* Pushing positive [Pa]. */
static double force(double d) {
    return d < last ? bare_force(d) - bare_force(last) : 0;
}

/* Phi' = -f [J/m2]. */
static double potential(double d) {
    return d < last ? bare_potential(d) - bare_potential(last) + bare_force(last) * (d - last) : 0;
}

static void must(haft_status status, const haft_error *error) {
    if (status != HAFT_OK) {
        fprintf(stderr, "%s\n", error->message);
        exit(1);
    }
}

/* Ends the program unless `is` is `expected` within a share of `scale`. */
static void expect(const char *what, double is, double expected, double share, double scale) {
    double miss = fabs(is - expected) / scale;
    printf("%-42s %14.6g, exact %14.6g, off by %.0e\n", what, is, expected, miss);
    if (!(miss <= share)) {
        fprintf(stderr, "%s: off by more than %g\n", what, share);
        exit(1);
    }
}

static haft_law_table *make_table(haft_error *error) {
    static double d[POINTS], f[POINTS];
    for (size_t i = 0; i < POINTS; i++) {
        d[i] = first + (last - first) * (double)i / (POINTS - 1);
        f[i] = force(d[i]);
    }
    haft_law_table *table = NULL;
    must(haft_law_table_create(&table, POINTS, d, f, error), error);
    return table;
}

/* Of the law: force, slope and potential everywhere, greatest pull, energy of the pull. */
static void check_law(const haft_law *law) {
    double pull = 16 * w / (9 * sqrt(3) * z), worst_force = 0, worst_potential = 0;
    for (double d = first; d < last; d += 0.0137 * z) {
        haft_law_value value = haft_law_evaluate(law, d);
        worst_force = fmax(worst_force, fabs(value.force - force(d)));
        worst_potential = fmax(worst_potential, fabs(value.potential - potential(d)));
    }
    expect("force between the points [Pa]", worst_force, 0, 1e-4, pull);
    expect("potential between the points [J/m2]", worst_potential, 0, 1e-5, w);
    expect("greatest pull [Pa]", law->f_max, pull + bare_force(last), 1e-4, pull);
    expect("its distance [m]", law->d_max, pow(3, 1.0 / 6) * z, 1e-2, z);
    expect("depth of the well [J/m2]", haft_law_evaluate(law, z).potential, potential(z), 1e-6, w);
}

/* Deflection at x of a cantilever of bending stiffness EI by a unit force at s. */
static double flexibility(double x, double s, double stiffness) {
    double near = fmin(x, s), far = fmax(x, s);
    return near * near * (3 * far - near) / (6 * stiffness);
}

/* Of the beam at rest: it must bend as a cantilever does under the law's forces at its gaps, and
 * its energies must be those of the closed forms. The forces are the table's: balance comes from
 * large forces that nearly cancel, so the bend would show the table's error 50 times over. */
static void check_rest(const haft_beam_spec *beam, const haft_law *law, const haft_model *model,
                       const haft_path *path) {
    const haft_path_point *end = &path->point[path->points - 1];
    double stiffness = haft_beam_bending_stiffness(beam), patch = beam->length / SITES;
    double deflection[SITES], pull[SITES], rotation = 0, contact = 0, strain = 0, worst = 0;
    for (size_t r = 0; r < SITES; r++) {
        double x = ((double)r + 0.5) * patch;
        haft_model_shape(model, path->final_state, x, &deflection[r], &rotation);
        double d = beam->gap - deflection[r], area = patch * beam->width;
        pull[r] = -area * haft_law_evaluate(law, d).force;
        contact += area * potential(d);
        strain += 0.5 * pull[r] * deflection[r];
    }
    for (size_t r = 0; r < SITES; r++) {
        double bent = 0;
        for (size_t s = 0; s < SITES; s++) {
            bent += pull[s] *
                    flexibility(((double)r + 0.5) * patch, ((double)s + 0.5) * patch, stiffness);
        }
        worst = fmax(worst, fabs(bent - deflection[r]));
    }
    expect("equilibrium: deflections at rest [m]", worst, 0, 1e-6, beam->gap);
    expect("energy of the contact at rest [J]", end->contact_energy, contact, 1e-6, fabs(contact));
    expect("strain energy at rest [J]", end->internal_energy, strain, 1e-6, fabs(strain));
    expect("effective energy of the crack [J/m2]",
           haft_beam_effective_energy(beam, end->crack_length), w, 0.2, w);
}

int main(void) {
    haft_error error = {HAFT_OK, ""};
    haft_law_table *table = make_table(&error);
    haft_law law[SITES];
    for (size_t r = 0; r < SITES; r++) {
        law[r] = haft_law_from_table(table);
    }
    check_law(&law[0]);

    haft_beam_spec beam = {600e-6, 30e-6, 2.62e-6, 1.9e-6, 163e9};
    haft_mesh_spec mesh = {HAFT_MESH_EXACT, 0, beam.length / SITES, 60e-6, 0};
    haft_programme programme = {120e-6, 0.5, INFINITY};
    haft_model *model = NULL;
    haft_path *path = NULL;
    must(haft_model_create_beam(&model, &beam, &mesh, &error), &error);
    must(haft_solve_path(&path, model, law, &programme, NULL, &error), &error);
    printf("%zu steps, %zu jumps: %s\n", path->points, path->jumps,
           haft_outcome_name(path->outcome));
    bool stuck = path->outcome == HAFT_OUTCOME_STUCK && path->jumps > 0;
    if (stuck) {
        expect("energy ledger", path->ledger_error, 0, 1e-9, 1);
        check_rest(&beam, &law[0], model, path);
    }
    haft_path_destroy(&path);
    haft_model_destroy(&model);
    haft_law_table_destroy(&table);
    return stuck ? 0 : 1;
}
