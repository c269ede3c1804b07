/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file law.h
 *  Adhesive contact laws f(d): pressure against gap, positive pushing apart, with slope, curvature
 *  and potential; a curve's characteristic numbers; the Morse law fitted to them; the curve itself
 *  as a C1 monotone table. */
#ifndef HAFT_LAW_H
#define HAFT_LAW_H

#include "haft/contact.h"

#ifdef __cplusplus
extern "C" {
#endif

/** The law vector: four numbers that describe a law. Source: Hoang et al. (2017), Eqs. 18-21. */
typedef struct haft_law_vector {
    double e;       /**< energy of the attractive part [J/m^2], > 0 */
    double f_max;   /**< greatest pull [Pa], > 0 */
    double d_max;   /**< gap of the greatest pull [m] */
    double d_limit; /**< gap at which the push reaches f_limit [m], < d_max */
} haft_law_vector;

/** Why a curve has no law vector, or a law vector has no Morse law. */
typedef enum haft_law_fault {
    HAFT_LAW_SOUND = 0,     /**< none */
    HAFT_LAW_NO_ATTRACTION, /**< never pulls */
    HAFT_LAW_TWO_WELLS,     /**< two pulls with a barrier between them */
    HAFT_LAW_RANGE_LEFT,    /**< the push does not reach f_limit on the grid */
    HAFT_LAW_RANGE_RIGHT,   /**< the pull has not decayed at the grid's end */
    HAFT_LAW_BOUND,         /**< e <= f_max / (2 a_left): the left wing alone holds more energy */
    HAFT_LAW_INVALID, /**< a number is not finite, or e, f_max, d_max - d_limit not positive */
    HAFT_LAW_FAULTS   /**< how many there are */
} haft_law_fault;

/** A short name of a fault ("two wells"), never NULL. */
const char *haft_law_fault_name(haft_law_fault fault);

/** The limit push [Pa]. f_limit is a pressure in Pa, or a share of the law's own f_max.
 *  Functions take either as one number, a share as haft_law_share(share) = -share. The result is
 *  f_limit if positive, else -f_limit f_max. */
double haft_law_limit(double f_limit, double f_max);

/** Encodes a share of f_max as a limit push: -share. */
double haft_law_share(double share);

/** Share of f_max: a smaller dip between two wells is no barrier, and the pull at the last point
 *  must be below it. */
#define HAFT_LAW_PROMINENCE 0.05

/** Law vector of a sampled curve, read off its C1 monotone interpolant: d_max and f_max from the
 *  parabola through the three points about the greatest pull, e the exact integral of the
 *  interpolant's negative part (0 from the last point on), d_limit the first crossing of f_limit
 *  to the left of d_max. On a Morse law, whose second derivative jumps at d_max, d_max is good
 *  to first order in the step, f_max to second, e to third, d_limit to fourth. Of several faults
 *  the first in this order is returned: invalid, no attraction, range right, two wells, range
 *  left.
 *  @param[in] n points
 *  @param[in] distance evenly increasing [m], n >= 4
 *  @param[in] force [n] at them [Pa], pushing positive
 *  @param[in] f_limit the limit push as haft_law_limit() takes it, not 0
 *  @param[out] vector set only if the curve is sound
 *  @return the fault; *vector is set only if HAFT_LAW_SOUND. A Morse law may still refuse it
 *  (HAFT_LAW_BOUND): see haft_law_morse(). Thread-safe. */
haft_law_fault haft_law_characterise(size_t n, const double *distance, const double *force,
                                     double f_limit, haft_law_vector *vector);

/** Table of a curve: piecewise cubic Hermite, monotone between points. */
typedef struct haft_law_table haft_law_table;

/** The kinds of laws. */
typedef enum haft_law_kind {
    HAFT_LAW_MORSE, /**< the two-wing Morse law of a vector */
    HAFT_LAW_TABLE, /**< the curve itself */
} haft_law_kind;

/** One law, the sum of a near part, which is Morse or a table, and a far field,
 *
 *      f = f_near - P,    Phi = Phi_near + U,
 *
 *  with P = dU/dd of haft_far_field_evaluate(), which is positive where it pulls. A value, copied
 *  freely; it borrows its table and its far field, which must outlive it. All numbers but `far` are
 *  the near part's. */
typedef struct haft_law {
    haft_law_kind kind;          /**< what its near part is evaluated by */
    double f_max;                /**< greatest pull [Pa]; 0: never pulls */
    double d_max;                /**< its gap [m]; NaN: never pulls */
    double a_left;               /**< Morse exponent below d_max [1/m] */
    double a_right;              /**< and above [1/m] */
    double wall_distance;        /**< below it the wall continues linearly [m] */
    double wall_force;           /**< f at the wall [Pa] */
    double wall_slope;           /**< f' there [Pa/m] */
    double wall_potential;       /**< Phi there [J/m^2] */
    const haft_law_table *table; /**< borrowed; NULL for a Morse law */
    const haft_far_field *far;   /**< borrowed; NULL: none, as functions make laws */
} haft_law;

/** f, f', f'' and Phi at a gap, with Phi' = -f and Phi = 0 at infinity. */
typedef struct haft_law_value {
    double force;     /**< [Pa] */
    double slope;     /**< df/dd [Pa/m] */
    double curvature; /**< d2f/dd2 [Pa/m^2]; from the right at the kinks; at a table's last
                       *   point that is 0 */
    double potential; /**< [J/m^2] */
} haft_law_value;

/** The two-wing Morse law of a vector, in closed form:
 *  a_left = ln(1 + sqrt(1 + f_limit/f_max)) / (d_max - d_limit),
 *  e = f_max (1/(2 a_left) + 3/(2 a_right)),
 *  f = f_max (E^2 - 2 E), E = exp(-a (d - d_max)), a by the side of d_max; below d_limit the
 *  tangent. C1 everywhere.
 *  Source: Hoang et al. (2017), Eqs. 22-23, solved; the validity condition e > f_max/(2 a_left)
 *  follows. @return HAFT_LAW_SOUND, HAFT_LAW_INVALID or HAFT_LAW_BOUND. Thread-safe. */
haft_law_fault haft_law_morse(haft_law *out, const haft_law_vector *vector, double f_limit);

/** What haft_law_morse() returns, without making the law. Thread-safe. */
haft_law_fault haft_law_vector_fault(const haft_law_vector *vector, double f_limit);

/** The vector of a Morse law, read back from its exponents. Inverse of haft_law_morse(). */
haft_law_vector haft_law_morse_vector(const haft_law *law);

/** Makes a table of a curve by monotone cubic Hermite interpolation; to the left of the first
 *  point the tangent continues as the law's wall; to the right of the last the force is zero.
 *  Leading points from which the curve rises are left out. Fourth order in the step where the
 *  curve is monotone and the grid even, third where it is not, second at its extrema.
 *  @param[out] out the table; NULL after a failure
 *  @param[in] n points
 *  @param[in] distance strictly increasing [m], n >= 4; an even grid is looked up in O(1)
 *  @param[in] force [n] at them [Pa], pushing positive
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_INPUT if a number is not finite, if the curve has no wall (it pulls at its
 *  first point, or nowhere pushes and then falls), or if its last value, which is taken as 0,
 *  exceeds HAFT_LAW_PROMINENCE of the greatest pull (or, for a curve that never pulls, of the
 *  greatest push). Source: Hyman (1983), on even grids; Fritsch and Butland (1984). */
haft_status haft_law_table_create(haft_law_table **out, size_t n, const double *distance,
                                  const double *force, haft_error *error) HAFT_MUST_CHECK;

/** Frees a table and sets the pointer to NULL; NULL is allowed. */
void haft_law_table_destroy(haft_law_table **table);

/** The law of a table, which must outlive it. */
haft_law haft_law_from_table(const haft_law_table *table);

/** Value, slope, curvature and potential at gap d [m], which must not be NaN. Finite for |d| up
 *  to 1e100 m (the potential of the wall grows by d^2). Thread-safe. */
haft_law_value haft_law_evaluate(const haft_law *law, double d);

/** Laws laid out for evaluating many at a time. Tables are borrowed. */
typedef struct haft_law_rows haft_law_rows;

/** Lays laws out. Their tables and their far field must outlive the rows.
 *  @param[out] out the rows, to be destroyed
 *  @param[in] n how many laws
 *  @param[in] laws n of them; copied, but for their tables
 *  @param[out] error may be NULL
 *  @return HAFT_ERROR_ARGUMENT for laws of which not all have the same far field, or none;
 *  HAFT_ERROR_MEMORY. Thread-safe. */
haft_status haft_law_rows_create(haft_law_rows **out, size_t n, const haft_law *laws,
                                 haft_error *error) HAFT_MUST_CHECK;
/** Frees rows and sets the pointer to NULL; NULL is allowed. */
void haft_law_rows_destroy(haft_law_rows **rows);

/** Arrays for the values of n laws, see haft_law_value: all four; or all but the curvature, which
 * is then NULL; or the force alone, the others NULL. */
typedef struct haft_law_values {
    double *force;     /**< [Pa] */
    double *slope;     /**< [Pa/m] */
    double *curvature; /**< [Pa/m^2] */
    double *potential; /**< [J/m^2] */
} haft_law_values;

/** Evaluates n laws from law `first` on, law first + i at gap d[i]: the same bits as
 *  haft_law_evaluate(), in a fraction of the time.
 *  @param[in] rows the laws
 *  @param[in] first the first of them asked for
 *  @param[in] n how many, first + n at most as many as there are
 *  @param[in] d [n] gaps [m]
 *  @param[out] out [n] each
 *  @return the number of leading laws that are known to be zero, as in a free span: all n, or a
 *  multiple of HAFT_SIMD_WIDTH. Thread-safe. */
size_t haft_law_rows_evaluate(const haft_law_rows *rows, size_t first, size_t n, const double *d,
                              const haft_law_values *out);

/** The largest gap at which the pull still is `share` of the greatest [m], with the far field in
 *  both: of f_max without one. For a law that never pulls, the gap at which its push vanishes. 0 <
 *  share < 1, else NaN; with a far field, a share below 1e-12 gives where all of it ends.
 *  Thread-safe. */
double haft_law_reach(const haft_law *law, double share);

/** The gap beyond which the law's force, pull or push, stays below `share` of the greatest pull
 *  [m]. It is haft_law_reach() unless a table pushes farther out than it pulls; for a law that
 * never pulls, the gap at which its push vanishes. 0 < share < 1, else NaN. Thread-safe. */
double haft_law_extent(const haft_law *law, double share);

/** The length over which the law's near part changes, for step control [m]: 1/max(a_left, a_right)
 *  of a Morse law; of a table the same read off its steepest slope beyond its wall, 4 f_max over
 *  that slope. A far field changes over a third of the gap or more, which is longer. Thread-safe.
 */
double haft_law_range(const haft_law *law);

/** The lengths over which a law changes: a wall can be much narrower than the well behind it. */
typedef struct haft_law_lengths {
    double range; /**< haft_law_range(): up to the gap `edge` [m] */
    double edge;  /**< [m] */
    double wide;  /**< beyond the edge [m]; equal to `range` unless at least ten times as long */
} haft_law_lengths;

/** The lengths over which a law's near part changes. Of a Morse law the edge is d_max; of a table
 * the end of the last piece that is more than a tenth as steep as the steepest, if that is within
 * its first quarter. Thread-safe. */
haft_law_lengths haft_law_find_lengths(const haft_law *law);

/** The misfit of a law's near part to the curve it stands for: integral |f_law - f| from the law's
 * wall to the curve's end, over that of the curve's pull, by the trapezoidal rule on its points. 0
 * for a law that is the curve; 1 if as much energy is out of place as there is.
 *  @param[in] law compared with the curve
 *  @param[in] n points
 *  @param[in] distance increasing [m], n >= 2
 *  @param[in] force [n] of the curve at them [Pa]
 *  @return not finite for a curve that never pulls. Thread-safe. */
double haft_law_misfit(const haft_law *law, size_t n, const double *distance, const double *force);

/** The energy of a curve's pull, the e of haft_law_characterise(), over all wells and whatever
 *  its faults.
 *  @param[in] n points, >= 2
 *  @param[in] distance n gaps, increasing [m]
 *  @param[in] force n of them [Pa]
 *  @return [J/m^2], 0 for a curve that never pulls. Thread-safe. */
double haft_law_energy(size_t n, const double *distance, const double *force);

#ifdef __cplusplus
}
#endif
#endif
