/* SPDX-License-Identifier: GPL-3.0-or-later */
/* That another program can verify a result: the equilibrium of every state is checked from the
 * files alone, with laws, shape functions and beam forces written here from their definitions. */
#include "program.h"

#include <hdf5.h>

typedef struct evidence {
    size_t sites, nodes, states, curve_points;
    double *site_x, *site_area, *e, *f_max, *d_max, *d_limit, *node_x, *load, *displacement;
    double *law_kind, *distance, *force; /* force: of this realization's sites */
    double gap, f_limit, stiffness, load_position;
    double *far, far_out, far_scale, far_stretch; /* far: NULL without dispersion */
    size_t far_terms;
} evidence;

static double *read_reals(hid_t file, const char *name, size_t *count) {
    hid_t data = H5Dopen2(file, name, H5P_DEFAULT);
    if (data < 0) {
        fail_msg("no dataset %s", name);
    }
    hid_t space = H5Dget_space(data);
    size_t n = (size_t)H5Sget_simple_extent_npoints(space);
    double *value = calloc(n + 1, sizeof *value);
    assert_non_null(value);
    assert_true(H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, value) >= 0);
    H5Sclose(space);
    H5Dclose(data);
    *count = n;
    return value;
}

static double *read_of(hid_t file, int realization, const char *name, size_t *count) {
    char path[100];
    snprintf(path, sizeof path, "/realizations/%d/evidence/%s", realization, name);
    return read_reals(file, path, count);
}

static double read_constant(hid_t file, int realization, const char *name) {
    char path[100];
    double value = NAN;
    snprintf(path, sizeof path, "/realizations/%d/evidence", realization);
    hid_t attribute = H5Aopen_by_name(file, path, name, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(attribute >= 0 && H5Aread(attribute, H5T_NATIVE_DOUBLE, &value) >= 0);
    H5Aclose(attribute);
    return value;
}

static evidence read_evidence(const case_folder *c, int realization) {
    char path[400];
    evidence v = {0};
    size_t n = 0, curves = 0;
    hid_t file = H5Fopen(path_in(c, "out/results.h5", path), H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    v.site_x = read_of(file, realization, "site_x", &v.sites);
    v.site_area = read_of(file, realization, "site_area", &n);
    v.e = read_of(file, realization, "e", &n);
    v.f_max = read_of(file, realization, "f_max", &n);
    v.d_max = read_of(file, realization, "d_max", &n);
    v.d_limit = read_of(file, realization, "d_limit", &n);
    v.law_kind = read_of(file, realization, "law_kind", &n);
    assert_int_equal(n, v.sites);
    v.node_x = read_of(file, realization, "node_x", &v.nodes);
    v.load = read_of(file, realization, "load", &v.states);
    v.displacement = read_of(file, realization, "displacement", &n);
    assert_int_equal(n, 2 * v.nodes * v.states);
    v.gap = read_constant(file, realization, "gap");
    v.f_limit = read_constant(file, realization, "f_limit");
    v.stiffness = read_constant(file, realization, "bending_stiffness");
    v.load_position = read_constant(file, realization, "load_position");
    snprintf(path, sizeof path, "/realizations/%d/evidence/far_field", realization);
    if (H5Lexists(file, path, H5P_DEFAULT) > 0) {
        v.far = read_of(file, realization, "far_field", &v.far_terms);
        v.far_out = read_constant(file, realization, "far_out");
        v.far_scale = read_constant(file, realization, "far_scale");
        v.far_stretch = read_constant(file, realization, "far_stretch");
    }
    H5Fclose(file);
    file = H5Fopen(path_in(c, "out/laws.h5", path), H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    v.distance = read_reals(file, "/curves/distance", &v.curve_points);
    double *all = read_reals(file, "/curves/force", &curves);
    size_t own = v.sites * v.curve_points;
    assert_true(curves >= ((size_t)realization + 1) * own);
    v.force = calloc(own, sizeof *v.force);
    assert_non_null(v.force);
    memcpy(v.force, all + (size_t)realization * own, own * sizeof *v.force);
    free(all);
    H5Fclose(file);
    return v;
}

static void free_evidence(evidence *v) {
    double *const all[] = {v->site_x,   v->site_area, v->e,    v->f_max,        v->d_max,
                           v->d_limit,  v->node_x,    v->load, v->displacement, v->law_kind,
                           v->distance, v->force,     v->far};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        free(all[i]);
    }
}

/* The two-wing Morse law with Eqs. 22 and 23 solved for its exponents; below d_limit the tangent.
 */
static double morse_pressure(const evidence *v, size_t r, double d) {
    double left = log(1 + sqrt(1 + v->f_limit / v->f_max[r])) / (v->d_max[r] - v->d_limit[r]);
    double right = 1.5 * v->f_max[r] / (v->e[r] - v->f_max[r] / (2 * left));
    double at = fmax(d, v->d_limit[r]), a = at < v->d_max[r] ? left : right;
    double x = exp(-a * (at - v->d_max[r]));
    double slope = v->f_max[r] * (-2 * a * x * x + 2 * a * x);
    return v->f_max[r] * (x * x - 2 * x) + (d - at) * slope;
}

static double secant(const double *f, size_t i) {
    return f[i + 1] - f[i];
}

/* Slope times step at an inner point, not the first: the difference of fourth order, held to what
 * keeps the cubic monotone. */
static double inner_slope(const double *f, size_t i) {
    double s = secant(f, i - 1), t = secant(f, i), most = 3 * fmin(fabs(s), fabs(t));
    if (!(s * t > 0)) {
        return 0;
    }
    double slope = (f[i - 2] - 8 * f[i - 1] + 8 * f[i + 1] - f[i + 2]) / 12;
    return s > 0 ? fmax(0, fmin(slope, most)) : fmin(0, fmax(slope, -most));
}

/* The curve itself, cubic between its points, its last value 0 and 0 from there on. */
static double table_pressure(const evidence *v, size_t r, double d) {
    size_t n = v->curve_points;
    const double *f = v->force + r * n;
    double step = (v->distance[n - 1] - v->distance[0]) / (double)(n - 1);
    double place = (d - v->distance[0]) / step;
    if (place >= (double)(n - 4)) {
        return 0; /* a few nm beyond the end; no state of these tests rests in the last cells */
    }
    size_t i = (size_t)place;
    assert_true(i >= 2);
    double t = place - (double)i, m0 = inner_slope(f, i), m1 = inner_slope(f, i + 1);
    return f[i] * (1 + 2 * t) * (1 - t) * (1 - t) + m0 * t * (1 - t) * (1 - t) +
           f[i + 1] * t * t * (3 - 2 * t) + m1 * t * t * (t - 1);
}

/* What the far field adds: -dU/dd, by the derivatives of t and u. */
static double far_pressure(const evidence *v, double d) {
    if (v->far == NULL || d >= v->far_out) {
        return 0;
    }
    double s = v->far_scale, t = s / (s + d) - s / (s + v->far_out),
           fall = -s / ((s + d) * (s + d));
    double u = v->far_stretch * t - 1, sum = 0, slope = 0;
    for (size_t j = v->far_terms; j-- > 0;) {
        slope = slope * u + sum;
        sum = sum * u + v->far[j];
    }
    return -(3 * t * t * sum + t * t * t * v->far_stretch * slope) * fall;
}

/* Cubic shape functions of the element that holds x; gives its number. */
static size_t shapes_at(const evidence *v, double x, double shape[4]) {
    size_t i = 0;
    while (i + 2 < v->nodes && v->node_x[i + 1] <= x) {
        i++;
    }
    double l = v->node_x[i + 1] - v->node_x[i], t = (x - v->node_x[i]) / l;
    shape[0] = (1 + 2 * t) * (1 - t) * (1 - t);
    shape[1] = l * t * (1 - t) * (1 - t);
    shape[2] = t * t * (3 - 2 * t);
    shape[3] = l * t * t * (t - 1);
    return i;
}

/* A sum of forces on each unknown, and the greatest of its terms. */
typedef struct balance {
    double *sum, greatest;
} balance;

static void add_force(balance *b, const evidence *v, size_t unknown, double force) {
    size_t node = unknown / 2; /* moments count by the length of the element beside them */
    size_t next = node + 1 < v->nodes ? node + 1 : node;
    double arm = unknown % 2 == 0 ? 1 : v->node_x[next] - v->node_x[next == node ? node - 1 : node];
    b->sum[unknown] += force / arm;
    b->greatest = fmax(b->greatest, fabs(force / arm));
}

static void add_beam(balance *b, const evidence *v, const double *u) {
    for (size_t i = 0; i + 1 < v->nodes; i++) {
        double l = v->node_x[i + 1] - v->node_x[i], c = v->stiffness / (l * l * l);
        const double *q = u + 2 * i;
        double chord = (q[2] - q[0]) / l, a = q[1] - chord, z = q[3] - chord;
        double first = c * l * l * (4 * a + 2 * z), last = c * l * l * (2 * a + 4 * z);
        add_force(b, v, 2 * i, (first + last) / l);
        add_force(b, v, 2 * i + 1, first);
        add_force(b, v, 2 * i + 2, -(first + last) / l);
        add_force(b, v, 2 * i + 3, last);
    }
}

static void add_point_force(balance *b, const evidence *v, double x, double force) {
    double shape[4];
    size_t i = shapes_at(v, x, shape);
    for (size_t k = 0; k < 4; k++) {
        add_force(b, v, 2 * i + k, force * shape[k]);
    }
}

static double greatest_load(const evidence *v) {
    double greatest = 0;
    for (size_t s = 0; s < v->states; s++) {
        greatest = fmax(greatest, v->load[s]);
    }
    return greatest;
}

/* What is left of the balance of forces in a state [N], and the greatest force in it; the load may
 * be falsified by a factor. */
static double imbalance(const evidence *v, size_t state, double factor, double *greatest,
                        int *in_contact) {
    const double *u = v->displacement + state * 2 * v->nodes;
    balance b = {.sum = calloc(2 * v->nodes, sizeof(double))};
    assert_non_null(b.sum);
    assert_true(u[0] == 0 && u[1] == 0); /* the clamp */
    add_beam(&b, v, u);
    add_point_force(&b, v, v->load_position, -factor * v->load[state]);
    *in_contact = 0;
    for (size_t r = 0; r < v->sites; r++) {
        double shape[4], d = v->gap;
        size_t i = shapes_at(v, v->site_x[r], shape);
        for (size_t k = 0; k < 4; k++) {
            d -= shape[k] * u[2 * i + k];
        }
        double pressure = v->law_kind[r] == 0 ? morse_pressure(v, r, d) : table_pressure(v, r, d);
        pressure += far_pressure(v, d);
        add_point_force(&b, v, v->site_x[r], pressure * v->site_area[r]);
        *in_contact += fabs(d - v->d_max[r]) < 10e-9;
    }
    double worst = 0;
    for (size_t i = 2; i < 2 * v->nodes; i++) {
        worst = fmax(worst, fabs(b.sum[i]));
    }
    free(b.sum);
    *greatest = b.greatest;
    return worst;
}

/* That over the greatest force, or a millionth of the path's load: at the start only the laws' far
 * tails pull. */
static double residual(const evidence *v, size_t state, double factor, int *in_contact) {
    double greatest = 0, left = imbalance(v, state, factor, &greatest, in_contact);
    return left / fmax(greatest, 1e-6 * greatest_load(v));
}

static void check_states(const case_folder *c, int realization, const char *what) {
    evidence v = read_evidence(c, realization);
    double worst = 0, least_false = INFINITY, least_told = INFINITY;
    int most = 0;
    assert_true(v.states > 50 && v.load[v.states - 1] == 0);
    check_relative(v.stiffness, 163e9 * 3e-6 * pow(1e-6, 3) / 12, 1e-14);
    for (size_t s = 0; s < v.states; s++) {
        int in_contact = 0;
        worst = fmax(worst, residual(&v, s, 1, &in_contact));
        most = in_contact > most ? in_contact : most;
        if (v.load[s] > 0) { /* however small: what is left is the falsified part of the load */
            double greatest = 0, left = imbalance(&v, s, 1.0001, &greatest, &in_contact);
            least_told = fmin(least_told, left / v.load[s]);
        }
        bool weighs = v.load[s] > 1e-3 * greatest_load(&v); /* beside the pulls */
        if (weighs) {
            least_false = fmin(least_false, residual(&v, s, 1.0001, &in_contact));
        }
    }
    print_message("%s, beam %d: %zu states out of balance by %.1e at most; with the load off by "
                  "1e-4 by %.1e at least\n",
                  what, realization, v.states, worst, least_false);
    check_less(worst, 1e-9);
    assert_true(most > 10); /* a good part of the beam was down */
    check_less(1e-8, least_false);
    check_less(2e-5, least_told);
    free_evidence(&v);
}

#define ALL_EVIDENCE                                                                               \
    { "evidence: [0]", "evidence: all" }

#define DISPERSION                                                                                 \
    { "contact:", "contact:\n  dispersion: {hamaker: 18.65e-20 J, reach: 200 nm}" }

static void every_state_is_in_balance(void **state) {
    (void)state;
    static const struct {
        const char *what;
        edit change[3];
    } variants[] = {
        {"uniform mesh, an element a site", {ALL_EVIDENCE}},
        {"uniform mesh, three sites an element",
         {ALL_EVIDENCE, {"element_length: 3 um", "element_length: 9 um"}}},
        {"exact mesh", {ALL_EVIDENCE, {"mesh: uniform", "mesh: exact"}}},
        {"tables", {ALL_EVIDENCE, {"kind: morse", "kind: table"}}},
        {"dispersion", {ALL_EVIDENCE, DISPERSION}},
    };
    for (size_t i = 0; i < sizeof variants / sizeof *variants; i++) {
        case_folder c = case_create(variants[i].change);
        must_run(HAFT, ARGS("run", "--quiet", c.path));
        check_states(&c, 0, variants[i].what);
        check_states(&c, 1, variants[i].what);
        case_remove(&c);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_state_is_in_balance),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
