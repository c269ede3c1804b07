/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file contact.h
 *  The apparent contact pressure f(d) between a rough patch and a plane at distance d from its mean
 *  plane: Hertzian asperities, capillary menisci and van der Waals forces. Positive pressure pushes
 *  apart. */
#ifndef HAFT_CONTACT_H
#define HAFT_CONTACT_H

#include "haft/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Water that condenses between two surfaces at a humidity. */
typedef struct haft_capillary_spec {
    double humidity;        /**< relative humidity, 0 < RH < 1 */
    double temperature;     /**< [K] */
    double surface_energy;  /**< surface energy liquid-vapour, gamma [N/m] */
    double molar_volume;    /**< of the liquid [m^3/mol] */
    double contact_angle_1; /**< [rad], 0 <= angle < pi/2 */
    double contact_angle_2; /**< [rad] */
} haft_capillary_spec;

/** The forces of condensed water between two surfaces. */
typedef struct haft_capillary {
    double kelvin_radius; /**< r_K = gamma V_m / (R T ln RH) [m], negative */
    double pressure;      /**< Laplace pressure R T ln RH / V_m [Pa], negative */
    double range;         /**< h_C = -r_K (cos rho_1 + cos rho_2) [m] */
} haft_capillary;

/** Computes Kelvin radius, Laplace pressure and capillary range. Thread-safe.
 *  Source: Hoang et al. (2017), Eqs. 12-14; the range omits the printed factor 2, which would
 *  double the wet area that they report. @return HAFT_ERROR_INPUT for values outside the valid
 *  ranges. */
haft_status haft_capillary_from_spec(haft_capillary *out, const haft_capillary_spec *spec,
                                     haft_error *error) HAFT_MUST_CHECK;

/** Thickness of the water film adsorbed on one surface over humidity, given by points: linear
 *  between them, proportional to RH below the first, constant beyond the last. */
typedef struct haft_adsorption {
    size_t n;                /**< number of points */
    const double *humidity;  /**< increasing, between 0 and 1, both excluded */
    const double *thickness; /**< non-decreasing [m] */
} haft_adsorption;

/** Film on silica at room temperature, in layers of 0.282 nm: 3 at RH 30 % and 4 at 60 % (Asay and
 *  Kim 2005, J. Phys. Chem. B 109, 16760: up to three layers grow between 0 and 30 %; the fourth at
 *  60 % has not been checked against it), 4.5 at 75 % and 6.5 at 90 % (Verdaguer et al. 2007,
 *  Langmuir 23, 9699: 4 to 5 up to 75 %, 6 to 7 at 90 %). These numbers are a coarse reading of the
 *  abstracts, which disagree by a layer where their ranges meet. The film is proportional to RH
 *  below 30 %, although the first layer forms earlier, and constant above 90 %, although a real
 *  film grows without limit. The thickness of a layer is the size of a water molecule and comes
 *  from neither source. Where measured values exist, give them as a table. */
haft_adsorption haft_adsorption_silica(void);

/** Checks a film. @return HAFT_ERROR_INPUT for no points, points out of order, or thicknesses that
 *  are negative, decreasing or not finite. */
haft_status haft_adsorption_check(const haft_adsorption *film, haft_error *error) HAFT_MUST_CHECK;

/** The thickness of a film at a humidity [m]. The film must have passed haft_adsorption_check().
 *  Thread-safe. */
double haft_adsorption_thickness(const haft_adsorption *film, double humidity);

/** Equivalent modulus of two elastic bodies, ((1-nu1^2)/E1 + (1-nu2^2)/E2)^-1 [Pa]. */
double haft_contact_modulus(double young_1, double poisson_1, double young_2, double poisson_2);

/** Van der Waals attraction between two half-spaces of one material. */
typedef struct haft_vdw_spec {
    double hamaker; /**< Hamaker constant of the bodies across the medium between them [J] */
    double r0;      /**< distance of two atoms with zero potential [m] */
} haft_vdw_spec;

/** The same attraction as a constant stress of finite range (Dugdale), with equal energy. */
typedef struct haft_vdw {
    double energy; /**< w [J/m^2] */
    double stress; /**< sigma_0 = w/h_0 [Pa], positive */
    double range;  /**< h_0 [m] */
} haft_vdw;

/** w = H / (16 pi D_0^2), D_0 = (2/15)^(1/6) r0; h_0 = 0.97 2^(1/6) r0; sigma_0 = w/h_0.
 *  Source: Hoang et al. (2017), Eq. 15. This reproduces their Tab. 1, except that its w is half a
 *  percent larger because D_0 is rounded to 1.49 A. Thread-safe.
 *  @return HAFT_ERROR_INPUT unless both are positive. */
haft_status haft_vdw_from_spec(haft_vdw *out, const haft_vdw_spec *spec,
                               haft_error *error) HAFT_MUST_CHECK;

/** Which of its two forces a sphere has between its fold and the range of its attraction: on
 *  separation it adheres up to the fold; on approach it jumps into contact. */
typedef enum haft_vdw_path { HAFT_VDW_SEPARATION, HAFT_VDW_APPROACH } haft_vdw_path;

/** Smallest lambda, the adhesion parameter of Maugis. */
#define HAFT_MAUGIS_LAMBDA_LEAST 1e-4

/** Largest lambda. */
#define HAFT_MAUGIS_LAMBDA_MOST 1e2

/** Largest |approach|, in its unit. */
#define HAFT_MAUGIS_APPROACH_MOST 1e12

/** Error of the table in force and radius, in their units. */
#define HAFT_MAUGIS_ACCURACY 1e-8

/** A sphere of radius R pressed onto a plane by an approach (negative: the undeformed sphere does
 *  not reach the plane), with adhesion w, sigma_0 and modulus E, in the units
 *
 *      approach (9 pi^2 w^2 R / (16 E^2))^(1/3)    force pi w R, pushing positive
 *      radius   (3 pi w R^2 / (4 E))^(1/3)         lambda = sigma_0 (9 R / (2 pi w E^2))^(1/3)
 *
 *  Touching, with m = c/a:
 *      lambda a^2/2 [(m^2 - 2) arcsec m + sqrt(m^2 - 1)]
 *          + 4 lambda^2 a/3 [sqrt(m^2 - 1) arcsec m - m + 1] = 1,
 *      force = a^3 - lambda a^2 [sqrt(m^2 - 1) + m^2 arcsec m],
 *      approach = a^2 - 4/3 lambda a sqrt(m^2 - 1);
 *  not touching: force = -(pi/2) lambda c^2, approach = c^2/2 - 8/(3 pi) lambda c - 2/(pi lambda).
 *  Source: Maugis (1992); Johnson and Greenwood (1997); Kim, McMeeking and Johnson (1998). */
typedef struct haft_maugis {
    double force;  /**< pushing is positive */
    double slope;  /**< derivative of the force by the approach */
    double radius; /**< a, of the contact; 0 without contact */
    double reach;  /**< c, of the attraction */
} haft_maugis;

/** The approaches at which the branches of a sphere begin or end. Jump and touch are the same on
 *  approach and on separation. */
typedef struct haft_maugis_range {
    double fold;  /**< on separation, the sphere detaches */
    double touch; /**< contact begins; equal to fold if lambda is above 0.938 */
    double jump;  /**< on approach, attraction begins, -2/(pi lambda) */
} haft_maugis_range;

/** Computes the range of a lambda. Thread-safe. @return HAFT_ERROR_ARGUMENT for a lambda out of
 *  bounds. */
haft_status haft_maugis_limits(haft_maugis_range *out, double lambda,
                               haft_error *error) HAFT_MUST_CHECK;

/** Solves the equations to rounding; all results are 0 beyond the reach of the attraction.
 *  Thread-safe.
 *  @return HAFT_ERROR_ARGUMENT for a lambda or an approach out of bounds. */
haft_status haft_maugis_solve(haft_maugis *out, double lambda, double approach, haft_vdw_path path,
                              haft_error *error) HAFT_MUST_CHECK;

/** Table of force and radius over lambda and approach, to be made once (0.1 s, 1 MB) and shared by
 *  all threads. */
typedef struct haft_maugis_table haft_maugis_table;

/** Makes the table. @return HAFT_ERROR_MEMORY. Thread-safe. */
haft_status haft_maugis_table_create(haft_maugis_table **out, haft_error *error) HAFT_MUST_CHECK;

/** Frees it and sets the pointer to NULL; NULL is allowed. */
void haft_maugis_table_destroy(haft_maugis_table **table);

/** The share of the table's cells that do not reach HAFT_MAUGIS_ACCURACY and are solved directly
 *  instead; all are near lambda = 0.938. */
double haft_maugis_table_gaps(const haft_maugis_table *table);

/** The force, and in *radius the contact radius, as haft_maugis_solve() gives them, to
 *  HAFT_MAUGIS_ACCURACY (in units of pi w R and of the radius). lambda is clamped to its bounds.
 *  Thread-safe. */
double haft_maugis_lookup(const haft_maugis_table *table, double lambda, double approach,
                          haft_vdw_path path, double *radius);

/** What counts as one asperity. */
typedef enum haft_asperity_model {
    /** Points above the lowest distance and no lower than their 8 neighbours (of equal neighbours,
     *  the first in the scan). Apex and radius come from the quadratic of central differences; the
     *  radius is the inverse of the mean curvature. A border point that is highest among its
     *  existing neighbours counts if the apex of the quadratic of one-sided differences is at most
     *  half a step beyond the border; otherwise the apex belongs to the adjoining patch. So if a
     *  patch is cut in two, each parabolic asperity counts once. */
    HAFT_ASPERITY_SUMMITS,
    /** Regions above d (8-connected), each as a paraboloid with the area A and volume V of the
     *  region: penetration 2V/A, radius A^2/(4 pi V), so the Hertz area is A/2. A region cut by the
     *  border counts in each patch with its part. The push can fall a little where islands merge.
     *  The van der Waals pull of a region is at most the adhesive stress times A. */
    HAFT_ASPERITY_ISLANDS,
    /** Islands of at least three points, each with the unlimited pull of its fitted sphere. For
     *  comparison with results that were computed in this way. With van der Waals forces, an island
     *  of a few points just above d - h_0 can have a sphere of any radius (limited to 1000 patch
     *  diagonals): the surface does not bound the largest pull, and forces depend on the grid
     *  step. */
    HAFT_ASPERITY_FITTED,
} haft_asperity_model;

/** The forces between a patch and the plane. */
typedef struct haft_contact_spec {
    haft_asperity_model asperities; /**< the asperity model */
    double modulus;                 /**< equivalent modulus [Pa] */
    bool has_capillary;             /**< false: no water */
    double pressure;                /**< Laplace pressure [Pa], not positive */
    double capillary_range;         /**< h_C [m] */
    bool has_vdw;       /**< true: each asperity is a Maugis sphere instead of a Hertzian one */
    haft_vdw vdw;       /**< the attraction; used only with has_vdw */
    haft_vdw_path path; /**< approach or separation */
    const haft_maugis_table *maugis; /**< borrowed; needed with has_vdw */
} haft_contact_spec;

/** Forces and areas of a patch at n >= 2 distances. The caller owns the arrays, each of length n.
 *  Areas are fractions of the nominal area. wet_area is the area with a gap below h_C, including
 *  the contact area, and 0 without a capillary. The capillary pressure acts on wet_area -
 *  contact_area, or on no area if that is negative. contact_area, wet_area and asperities may be
 *  NULL. */
typedef struct haft_curve {
    size_t n;               /**< number of distances, at least 2 */
    const double *distance; /**< [m], strictly increasing, evenly spaced */
    double *force;          /**< f(d) [Pa] */
    double *contact_area;   /**< Hertz area, sum of pi R (z_s - d) */
    double *wet_area;       /**< share of points with d - z < h_C */
    double *asperities;     /**< asperities in contact per area [1/m^2] */
} haft_curve;

/** Scratch for patches of up to rows x columns points (each at least 3, at most 2^31 points in
 *  all); one per thread. Takes about 15 bytes per point. It grows a little when a curve is longer
 *  than all before. */
typedef struct haft_contact_work haft_contact_work;

/** Makes the scratch of one thread. @return HAFT_ERROR_ARGUMENT for a size out of range,
 *  HAFT_ERROR_MEMORY. Thread-safe. */
haft_status haft_contact_work_create(haft_contact_work **out, size_t rows, size_t columns,
                                     haft_error *error) HAFT_MUST_CHECK;

/** Frees it and sets the pointer to NULL; NULL is allowed. */
void haft_contact_work_destroy(haft_contact_work **work);

/** f(d) of the patch z[rows][columns] with the given grid step.
 *
 *  f(d) = (1/A) sum (4/3) E sqrt(R) (z_s - d)^{3/2} + pressure * (wet(d) - contact(d)).
 *
 *  One pass over the heights counts the points in each interval between the distances; menisci
 *  merge because area is counted, not asperities. The few points above the lowest distance are
 *  listed for the summits or, sorted by interval, for the islands, which grow and merge by
 *  union-find.
 *  Source: Hertz (1882); Hoang et al. (2017), Sec. 2.2.2.
 *  @param[in,out] work scratch of one thread
 *  @param[in] spec the forces
 *  @param[in] z heights [m], row by row
 *  @param[in] rows, columns of the patch, at most the work's
 *  @param[in] step of the grid, in both directions [m], > 0
 *  @param[in,out] curve distances in, force and areas out
 *  @param[out] error one message on failure; may be NULL
 *  @return HAFT_ERROR_ARGUMENT for distances that are not uniform (to a millionth of a step) and
 *  increasing, a patch larger than the work or a spec out of range; HAFT_ERROR_INPUT for heights
 *  that are not finite; HAFT_ERROR_MEMORY. Thread-safe for distinct work. */
haft_status haft_contact_curve(haft_contact_work *work, const haft_contact_spec *spec,
                               const double *z, size_t rows, size_t columns, double step,
                               haft_curve *curve, haft_error *error) HAFT_MUST_CHECK;

/** haft_contact_curve() for n specs of the same patch, with identical bits. Specs that differ only
 *  in the water share the evaluation of asperities, which is most of the work.
 *  @param[in,out] work scratch of one thread
 *  @param[in] n number of specs and curves
 *  @param[in] spec n specs
 *  @param[in] z heights [m], row by row
 *  @param[in] rows, columns of the patch, at most the work's
 *  @param[in] step of the grid, in both directions [m], > 0
 *  @param[in,out] curve n curves; after a failure their contents are undefined
 *  @param[out] error one message on failure; may be NULL
 *  @return as haft_contact_curve(), for the first spec that fails. Thread-safe for distinct
 *  work. */
haft_status haft_contact_curves(haft_contact_work *work, size_t n, const haft_contact_spec *spec,
                                const double *z, size_t rows, size_t columns, double step,
                                haft_curve *curve, haft_error *error) HAFT_MUST_CHECK;

/** Checks that van der Waals forces can be computed for every asperity that a patch of rows x
 *  columns points can have; haft_contact_curve() requires this. Radii range from a thousandth of a
 *  step, less than any sampled asperity has, to 1000 diagonals, which represent a flat asperity.
 *  @param[in] vdw the attraction
 *  @param[in] modulus equivalent modulus [Pa], > 0
 *  @param[in] rows points of a patch, > 0; need not be an integer
 *  @param[in] columns as rows
 *  @param[in] step between points [m], > 0
 *  @param[out] error may be NULL
 *  @return HAFT_ERROR_INPUT if a lambda exceeds the bounds of the table. Thread-safe. */
haft_status haft_contact_check_spheres(const haft_vdw *vdw, double modulus, double rows,
                                       double columns, double step,
                                       haft_error *error) HAFT_MUST_CHECK;

/** The state of a patch at its zero-force distance. */
typedef struct haft_zero_force {
    bool found;          /**< false: the force does not change sign on the grid */
    double distance;     /**< zero-force distance [m] */
    double contact_area; /**< share of the area */
    double wet_area;     /**< share of the area */
    double asperities;   /**< [1/m^2] */
} haft_zero_force;

/** Finds the distance at which f changes from push to pull, the nearest one inside the distance of
 *  the largest pull; the other values are interpolated linearly there. The curve must have all its
 *  arrays. Thread-safe. */
haft_zero_force haft_contact_zero_force(const haft_curve *curve);

/** Dispersion forces across a gap of two faces that do not touch. Both are of one substrate, and
 * may bear a native oxide and on it a film of adsorbed water; a layer of thickness 0 is not there,
 * and its Hamaker constant is not read then. */
typedef struct haft_dispersion {
    double substrate;          /**< Hamaker constant with itself across vacuum [J], > 0 */
    double oxide;              /**< likewise */
    double film;               /**< likewise */
    double oxide_thickness[2]; /**< of each face [m], 0 to 100 nm */
    double film_thickness[2];  /**< likewise, outside the oxide */
    double retardation;        /**< wavelength lambda [m], >= 0; 0: light is infinitely fast */
    double cut_off;            /**< least gap at which an average counts force [m] */
} haft_dispersion;

/** The wavelength of Gregory (1981) [m]. */
#define HAFT_DISPERSION_RETARDATION 100e-9

/** Least cut-off [m]: closer than this are no two faces of atoms that touch (Israelachvili 2011,
 *  ch. 13). */
#define HAFT_DISPERSION_CUT_OFF_LEAST 0.165e-9

/** Greatest cut-off, and greatest thickness of a layer [m]. */
#define HAFT_DISPERSION_LENGTH_MOST 100e-9

/** Energy and force an area at one gap, or averaged over a surface at one distance. */
typedef struct haft_dispersion_value {
    double energy;   /**< W [J/m^2], negative */
    double pressure; /**< dW/dg [Pa]; positive pulls, the other way from f(d) of a curve */
    double slope;    /**< d^2 W/dg^2 [Pa/m] */
} haft_dispersion_value;

/** Refuses what the functions below must not be given. Thread-safe.
 *  @return HAFT_ERROR_INPUT for a Hamaker constant that is read and not positive, a cut-off out of
 *  HAFT_DISPERSION_CUT_OFF_LEAST to HAFT_DISPERSION_LENGTH_MOST, a thickness out of 0 to
 *  HAFT_DISPERSION_LENGTH_MOST, a negative wavelength, or a number that is not finite. */
haft_status haft_dispersion_check(const haft_dispersion *law, haft_error *error) HAFT_MUST_CHECK;

/** Two plane faces at a gap g, whatever the cut-off:
 *
 *      W(g) = -sum_ij a_i b_j / (12 pi x^2 (1 + 5.32 x/lambda)),    x = g + s_i + t_j,
 *
 *  over the interfaces of the one face at depths s_i and of the other at t_j. The outermost is at
 *  depth 0 and has a = sqrt(A_outer), A being Hamaker constants; each one below has
 *  sqrt(A_below) - sqrt(A_above), by the combining relation A_12 = sqrt(A_1 A_2). Bare faces have
 *  W = -A/(12 pi g^2), retarded.
 *  Source: layers and combining relations Israelachvili (2011), ch. 13; retardation Gregory (1981),
 *  J. Colloid Interface Sci. 83, 138, made for bare plates. With Hamaker constants that are right
 * at 1 nm, silicon, bare or oxidized, comes within 10 % of the exact theory of Lifshitz from 1 to
 * 500 nm; bare silica pulls too far, by 5 % at 10 nm and 26 % about 100 nm with some published
 * data, by twice that with others.
 *  @param[in] law one that passed haft_dispersion_check()
 *  @param[in] gap g [m], > 0. Thread-safe. */
haft_dispersion_value haft_dispersion_at(const haft_dispersion *law, double gap);

/** Takes off the energy of contact what dispersion across the gap has beyond its cut-off,
 *
 *      w' = w - |W(cut_off)|,    sigma_0' = w'/h_0,
 *
 *  so that flat faces, brought apart from contact, take w in all: w' within the range h_0 and
 *  |W(cut_off)| beyond the cut-off, and nothing counts twice. What this leaves out: between h_0 and
 *  the cut-off a point that belongs to no asperity in contact has no force.
 *  @param[in,out] vdw from haft_vdw_from_spec()
 *  @param[in] law one that passed haft_dispersion_check()
 *  @param[out] error may be NULL
 *  @return HAFT_ERROR_INPUT where nothing would be left. Thread-safe. */
haft_status haft_vdw_leave_tail(haft_vdw *vdw, const haft_dispersion *law,
                                haft_error *error) HAFT_MUST_CHECK;

/** What an average over a surface needs to know of it: its heights, counted in bins. */
typedef struct haft_height_bins haft_height_bins;

/** Counts heights into bins of one width between the least and the greatest. Each bin in turn
 * stands for heights spread evenly, with the mean and the variance of those it holds: averages are
 * wrong by the square of the width where a cut-off goes through a bin, by less elsewhere.
 * Thread-safe.
 *  @param[out] out to be freed by haft_height_bins_destroy()
 *  @param[in] z n heights [m] above the mean plane
 *  @param[in] n how many, > 0
 *  @param[in] bins how many, > 0; empty ones are dropped
 *  @param[out] error may be NULL
 *  @return HAFT_ERROR_ARGUMENT for no heights or no bins, HAFT_ERROR_INPUT for heights that are not
 *  finite, HAFT_ERROR_MEMORY. */
haft_status haft_height_bins_create(haft_height_bins **out, const double *z, size_t n, size_t bins,
                                    haft_error *error) HAFT_MUST_CHECK;

/** Frees it and sets the pointer to NULL; NULL is allowed. */
void haft_height_bins_destroy(haft_height_bins **bins);

/** The average over a surface of heights z, its mean plane at distance d from a plane face:
 *
 *      U(d) = < W(max(d - z, cut_off)) >,
 *      P(d) = dU/dd = < W'(d - z) where d - z > cut_off, else 0 >,
 *
 *  each point having the force of plane faces at its gap (Derjaguin). For the gap of two rough
 * faces z are the sums of their heights. The integrals over each bin are exact, and so is P =
 * dU/dd. The slope is of P, with what the points at the cut-off add to it; a bin of equal heights
 * adds nothing there, as P jumps. Thread-safe.
 *  @param[in] law one that passed haft_dispersion_check()
 *  @param[in] bins the heights
 *  @param[in] distance d [m], any */
haft_dispersion_value haft_dispersion_average(const haft_dispersion *law,
                                              const haft_height_bins *bins, double distance);

/** The same average over heights of a normal distribution, energy and pressure to 1e-8 of
 *  themselves, by Gauss's quadrature between the cut-off and twelve rms. Thread-safe.
 *  @param[in] law one that passed haft_dispersion_check()
 *  @param[in] rms of the heights [m], finite and >= 0
 *  @param[in] distance d [m], any */
haft_dispersion_value haft_dispersion_gaussian(const haft_dispersion *law, double rms,
                                               double distance);

/** The most coefficients of a far field. */
#define HAFT_FAR_FIELD_TERMS 24

/** A point's energy and pressure count by their own size and this share of the greatest. */
#define HAFT_FAR_FIELD_SHARE 0.01

/** A smooth energy of distance, that vanishes with its first two derivatives at d_out:
 *
 *      U(d) = sum_{k=3}^{n+2} c_k t^k,    t = s/(s + d) - s/(s + d_out),    d_first <= d < d_out;
 *
 *  0 from d_out on; below d_first as the force's tangent there has it, so that the force does not
 *  explode in deep contact. Kept as U = t^3 sum_j coefficient[j] u^j, u = stretch t - 1, from -1 at
 *  d_out to 1 at d_first: the same polynomial, without the cancelling of large c_k. Of a rough
 *  surface with 24 terms, it misses the greatest pressure by 1e-5 at most, the tail at 50 nm by
 *  0.3 % of itself and at 100 nm by 2 %; where there is less than a millionth of the greatest
 *  pressure, nothing is left but the order of magnitude. */
typedef struct haft_far_field {
    double first;          /**< d_first [m] */
    double out;            /**< d_out [m] */
    double scale;          /**< s [m], chosen with the fit */
    double stretch;        /**< 2/t(d_first) */
    size_t n;              /**< coefficients in use */
    double energy_error;   /**< greatest, of the greatest |U| among the points of the fit */
    double pressure_error; /**< greatest, of the greatest |P| among them */
    double own_error;      /**< greatest of P, of |P| + HAFT_FAR_FIELD_SHARE of the greatest */
    double coefficient[HAFT_FAR_FIELD_TERMS]; /**< [J/m^2] */
} haft_far_field;

/** The far field nearest to energies and pressures at given distances, d_first and d_out the first
 *  and the last of them: least squares of U - U(d_out) and P, each against its own size and
 *  HAFT_FAR_FIELD_SHARE of the greatest, the points weighted to lie as Chebyshev's would. The scale
 * s is tried from a thousandth of d_out - d_first to all of it. Thread-safe.
 *  @param[out] out the fit with its errors, to be looked at
 *  @param[in] terms n, 1 to HAFT_FAR_FIELD_TERMS; the degree of U is n + 2
 *  @param[in] points how many, at least 2 and at least n; dense where the pressure bends
 *  @param[in] distance [m], increasing, the first not negative
 *  @param[in] energy U there [J/m^2]
 *  @param[in] pressure P = dU/dd there [Pa]
 *  @param[out] error may be NULL
 *  @return HAFT_ERROR_ARGUMENT for a number of terms or points out of range, or distances that do
 *  not increase; HAFT_ERROR_INPUT for numbers that are not finite, or energies or pressures that
 *  all vanish; HAFT_ERROR_MEMORY. */
haft_status haft_far_field_fit(haft_far_field *out, size_t terms, size_t points,
                               const double *distance, const double *energy, const double *pressure,
                               haft_error *error) HAFT_MUST_CHECK;

/** What a far field is made of: energy and pressure at a distance [m]; the slope is not read. */
typedef haft_dispersion_value haft_far_field_source(const void *context, double distance);

/** haft_far_field_fit() to a function, asked at 601 distances between first and out. Thread-safe if
 *  the function is.
 *  @param[out] out the fit with its errors, to be looked at
 *  @param[in] terms n, 1 to HAFT_FAR_FIELD_TERMS
 *  @param[in] first d_first [m], >= 0
 *  @param[in] far d_out [m], > first
 *  @param[in] source of energies and pressures
 *  @param[in] context handed to it
 *  @param[out] error may be NULL
 *  @return as haft_far_field_fit(). */
haft_status haft_far_field_make(haft_far_field *out, size_t terms, double first, double far,
                                haft_far_field_source *source, const void *context,
                                haft_error *error) HAFT_MUST_CHECK;

/** Arrays for the values of a far field: all four; or all but the curvature, which is then NULL; or
 *  the pressure alone, the others NULL. None may overlap another. */
typedef struct haft_far_field_values {
    double *energy;    /**< U [J/m^2] */
    double *pressure;  /**< P = dU/dd [Pa], positive pulls */
    double *slope;     /**< dP/dd [Pa/m] */
    double *curvature; /**< d2P/dd2 [Pa/m^2]; from the right at d_first */
} haft_far_field_values;

/** The values at n distances, any; the same bits for each, whatever else is asked for. Thread-safe.
 *  @param[in] field a fit
 *  @param[in] n how many
 *  @param[in] distance d [m]
 *  @param[out] out n each */
void haft_far_field_evaluate(const haft_far_field *field, size_t n, const double *distance,
                             const haft_far_field_values *out);

#ifdef __cplusplus
}
#endif
#endif
