/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The operations of our vectors against those of SUNDIALS' own, for lengths around whole lanes and
 * with results in place of what they are made of. */
#include "check.h"

#include <sundials/sundials_config.h>

#include "solve/vectors.h"

enum { MOST = 35 };

typedef struct workplace {
    SUNContext context;
} workplace;

static int enter(void **state) {
    static workplace here;
    *state = &here;
#if SUNDIALS_VERSION_MAJOR >= 7
    return SUNContext_Create(SUN_COMM_NULL, &here.context);
#else
    return SUNContext_Create(NULL, &here.context);
#endif
}

static int leave(void **state) {
    return SUNContext_Free(&((workplace *)*state)->context);
}

/* x and y at random, and z for what is made of them. */
typedef struct triple {
    N_Vector x, y, z;
} triple;

static triple draw(N_Vector x) {
    assert_non_null(x);
    size_t n = (size_t)N_VGetLength(x);
    triple v = {x, N_VClone(x), N_VClone(x)};
    haft_random_key key = {11, HAFT_RANDOM_TEST};
    haft_random_normals(key, n, 0, 0, n, N_VGetArrayPointer(v.x));
    haft_random_normals(key, n, 1, 0, n, N_VGetArrayPointer(v.y));
    return v;
}

static triple draw_ours(const workplace *w, size_t n) {
    return draw(haft_vector_create(n, w->context));
}

static triple draw_theirs(const workplace *w, size_t n) {
    return draw(N_VNew_Serial((sunindextype)n, w->context));
}

static void discard(triple v) {
    N_VDestroy(v.x);
    N_VDestroy(v.y);
    N_VDestroy(v.z);
}

enum { SUM, DIFFERENCE, SCALED, PRODUCT, ABSOLUTE, INVERSE, QUOTIENT, OPERATIONS };

static void operate(int operation, triple v, N_Vector z) {
    switch (operation) {
    case SUM:
        N_VLinearSum(0.7, v.x, -1.3, v.y, z);
        break;
    case DIFFERENCE:
        N_VLinearSum(1, v.x, -1, v.y, z);
        break;
    case SCALED:
        N_VScale(-2.7, v.x, z);
        break;
    case PRODUCT:
        N_VProd(v.x, v.y, z);
        break;
    case ABSOLUTE:
        N_VAbs(v.x, z);
        break;
    case INVERSE:
        N_VInv(v.x, z);
        break;
    default:
        N_VDiv(v.x, v.y, z);
        break;
    }
}

/* Number by number there is nothing to round otherwise. */
static void makes_vectors_of_the_same_bits(void **state) {
    for (size_t n = 1; n <= MOST; n++) {
        for (int operation = 0; operation < 2 * OPERATIONS; operation++) {
            triple ours = draw_ours(*state, n), theirs = draw_theirs(*state, n);
            bool in_place = operation >= OPERATIONS;
            N_Vector a = in_place ? ours.x : ours.z, b = in_place ? theirs.x : theirs.z;
            operate(operation % OPERATIONS, ours, a);
            operate(operation % OPERATIONS, theirs, b);
            assert_memory_equal(N_VGetArrayPointer(a), N_VGetArrayPointer(b), n * sizeof(double));
            discard(ours);
            discard(theirs);
        }
    }
}

static void makes_the_same_norms(void **state) {
    for (size_t n = 1; n <= MOST; n++) {
        triple ours = draw_ours(*state, n), theirs = draw_theirs(*state, n);
        assert_true(N_VMaxNorm(ours.x) == N_VMaxNorm(theirs.x));
        assert_true(N_VMin(ours.x) == N_VMin(theirs.x));
        check_relative(N_VWL2Norm(ours.x, ours.y), N_VWL2Norm(theirs.x, theirs.y), 1e-14);
        discard(ours);
        discard(theirs);
    }
}

/* A residual that is not a number must not pass for one that is small. */
static void keeps_what_is_not_a_number(void **state) {
    for (size_t i = 0; i < MOST; i++) {
        triple v = draw_ours(*state, MOST);
        N_VGetArrayPointer(v.x)[i] = NAN;
        assert_true(isnan(N_VWL2Norm(v.x, v.y)));
        discard(v);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(makes_vectors_of_the_same_bits),
        cmocka_unit_test(makes_the_same_norms),
        cmocka_unit_test(keeps_what_is_not_a_number),
    };
    return cmocka_run_group_tests(tests, enter, leave);
}
