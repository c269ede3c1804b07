/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file contact.h
 *  The apparent contact pressure f(d) of a rough patch against a plane at distance d from its mean
 *  plane: Hertzian asperities and capillary menisci. Positive pressure pushes apart. */
#ifndef HAFT_CONTACT_H
#define HAFT_CONTACT_H

#include "haft/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Water condensing between two surfaces at a humidity. */
typedef struct haft_capillary_spec {
    double humidity;        /**< relative humidity, 0 < RH < 1 */
    double temperature;     /**< [K] */
    double surface_energy;  /**< liquid-vapour, gamma [N/m] */
    double molar_volume;    /**< of the liquid [m^3/mol] */
    double contact_angle_1; /**< [rad], 0 <= angle < pi/2 */
    double contact_angle_2; /**< [rad] */
} haft_capillary_spec;

/** What condensed water does between two surfaces. */
typedef struct haft_capillary {
    double kelvin_radius; /**< r_K = gamma V_m / (R T ln RH) [m], negative */
    double pressure;      /**< Laplace pressure R T ln RH / V_m [Pa], negative */
    double range;         /**< h_C = -r_K (cos rho_1 + cos rho_2) [m] */
} haft_capillary;

/** Kelvin radius, Laplace pressure and capillary range. Thread-safe.
 *  Source: Hoang et al. (2017), Eqs. 12-14; the range without the printed factor 2, which would
 *  double the wet area they report. @return HAFT_ERROR_INPUT outside the valid ranges. */
haft_status haft_capillary_from_spec(haft_capillary *out, const haft_capillary_spec *spec,
                                     haft_error *error) HAFT_MUST_CHECK;

/** Thickness of the water film adsorbed on one surface at a humidity, by points: linear in between,
 *  proportional to RH below the first, constant beyond the last. */
typedef struct haft_adsorption {
    size_t n;                /**< points */
    const double *humidity;  /**< increasing, above 0 and below 1 */
    const double *thickness; /**< not falling [m] */
} haft_adsorption;

/** Film on silica at room temperature, layers of 0.282 nm: 3 at RH 30 % and 4 at 60 % (Asay and Kim
 *  2005, J. Phys. Chem. B 109, 16760: up to three layers grow between 0 and 30 %; that there is one
 *  more at 60 % has not been checked against it), 4.5 at 75 % and 6.5 at 90 % (Verdaguer et al.
 *  2007, Langmuir 23, 9699: 4 to 5 up to 75 %, 6 to 7 at 90 %). A coarse reading of their
 * abstracts, which disagree by a layer where they meet; below 30 % proportional to RH, though the
 * first layer is there earlier; constant above 90 %, where the film grows without limit. The
 * thickness of a layer is a water molecule's size, and taken from neither. With measured numbers at
 * hand, give them as a table. */
haft_adsorption haft_adsorption_silica(void);

/** @return HAFT_ERROR_INPUT for no points, points out of order, or thicknesses that are negative,
 * fall or are not finite. */
haft_status haft_adsorption_check(const haft_adsorption *film, haft_error *error) HAFT_MUST_CHECK;

/** The film's thickness at a humidity [m], of a film that passed haft_adsorption_check().
 *  Thread-safe. */
double haft_adsorption_thickness(const haft_adsorption *film, double humidity);

/** Equivalent modulus of two elastic bodies, ((1-nu1^2)/E1 + (1-nu2^2)/E2)^-1 [Pa]. */
double haft_contact_modulus(double young_1, double poisson_1, double young_2, double poisson_2);

/** The molecules' attraction between two half-spaces of one kind. */
typedef struct haft_vdw_spec {
    double hamaker; /**< Hamaker constant of the bodies across what lies between them [J] */
    double r0;      /**< distance of two atoms at which their potential is zero [m] */
} haft_vdw_spec;

/** The same as a constant stress of finite range (Dugdale), of equal energy. */
typedef struct haft_vdw {
    double energy; /**< w [J/m^2] */
    double stress; /**< sigma_0 = w/h_0 [Pa], positive */
    double range;  /**< h_0 [m] */
} haft_vdw;

/** w = H / (16 pi D_0^2), D_0 = (2/15)^(1/6) r0; h_0 = 0.97 2^(1/6) r0; sigma_0 = w/h_0.
 *  Source: Hoang et al. (2017), Eq. 15. Their Tab. 1 follows but for the rounding of D_0 to 1.49 A,
 *  which makes its w half a percent larger. Thread-safe.
 *  @return HAFT_ERROR_INPUT unless both are positive. */
haft_status haft_vdw_from_spec(haft_vdw *out, const haft_vdw_spec *spec,
                               haft_error *error) HAFT_MUST_CHECK;

/** Which of two forces a sphere has between its fold and the range of its attraction: that on the
 *  way out, on which it holds on up to the fold, or that on the way in, on which it jumps. */
typedef enum haft_vdw_path { HAFT_VDW_SEPARATION, HAFT_VDW_APPROACH } haft_vdw_path;

/** Least lambda, the adhesion parameter of Maugis. */
#define HAFT_MAUGIS_LAMBDA_LEAST 1e-4

/** Greatest lambda. */
#define HAFT_MAUGIS_LAMBDA_MOST 1e2

/** Greatest |approach|, in its unit. */
#define HAFT_MAUGIS_APPROACH_MOST 1e12

/** The table's error in force and radius, in their units. */
#define HAFT_MAUGIS_ACCURACY 1e-8

/** A sphere of radius R pressed on a plane by an approach (negative: not yet there), with adhesion
 *  w, sigma_0 and modulus E, in the units
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
    double force;  /**< pushing positive */
    double slope;  /**< of the force by approach */
    double radius; /**< a of the contact; 0 if it does not touch */
    double reach;  /**< c of the attraction */
} haft_maugis;

/** Approaches that part its branches; jump and touch do not depend on the way. */
typedef struct haft_maugis_range {
    double fold;  /**< on separation the sphere lets go */
    double touch; /**< it comes into contact; fold where lambda is above 0.938 */
    double jump;  /**< on approach it is caught, -2/(pi lambda) */
} haft_maugis_range;

/** Thread-safe. @return HAFT_ERROR_ARGUMENT for a lambda out of bounds. */
haft_status haft_maugis_limits(haft_maugis_range *out, double lambda,
                               haft_error *error) HAFT_MUST_CHECK;

/** The equations solved, to rounding; all 0 beyond the reach of the attraction. Thread-safe.
 *  @return HAFT_ERROR_ARGUMENT for a lambda or an approach out of bounds. */
haft_status haft_maugis_solve(haft_maugis *out, double lambda, double approach, haft_vdw_path path,
                              haft_error *error) HAFT_MUST_CHECK;

/** Force and radius against lambda and approach, to be made once (a tenth of a second, a megabyte)
 *  and shared by all threads. */
typedef struct haft_maugis_table haft_maugis_table;

/** Makes the table. @return HAFT_ERROR_MEMORY. Thread-safe. */
haft_status haft_maugis_table_create(haft_maugis_table **out, haft_error *error) HAFT_MUST_CHECK;

/** Frees it and sets the pointer to NULL; NULL is allowed. */
void haft_maugis_table_destroy(haft_maugis_table **table);

/** The share of the table's cells that miss HAFT_MAUGIS_ACCURACY, all about lambda = 0.938, and are
 *  solved directly instead. */
double haft_maugis_table_gaps(const haft_maugis_table *table);

/** Force, and the radius of contact into *radius, as haft_maugis_solve() gives them, to
 *  HAFT_MAUGIS_ACCURACY (of pi w R and of the unit of radius). lambda is taken to the nearest
 *  within bounds. Thread-safe. */
double haft_maugis_lookup(const haft_maugis_table *table, double lambda, double approach,
                          haft_vdw_path path, double *radius);

/** What counts as one asperity. */
typedef enum haft_asperity_model {
    /** Points above the lowest distance and not lower than any of their 8 neighbours (of equal
     *  neighbours the first in the scan); apex and radius from the quadratic of central
     *  differences, radius the inverse of the mean curvature. A border point that is highest
     *  among the neighbours it has counts if the quadratic of one-sided differences has its apex
     *  no further than half a step beyond the border: else the apex is the adjoining patch's. So
     *  a patch cut in two has each parabolic asperity once. */
    HAFT_ASPERITY_SUMMITS,
    /** Connected regions above d (8-connected); the paraboloid with the region's area A and volume
     *  V: penetration 2V/A, radius A^2/(4 pi V), hence Hertz area A/2. A region cut by the border
     *  counts in each patch with its part. Its push can fall a little where islands merge. Its
     *  van der Waals pull is at most the adhesive stress over A. */
    HAFT_ASPERITY_ISLANDS,
    /** Islands of three points or more, each with the pull of its sphere, however great: what a
     *  sphere fitted to each island gives without further thought. To compare with results that
     *  were got so. With van der Waals forces an island of few points a hair above d - h_0 has a
     *  sphere of any radius (cut at a thousand patch diagonals): the greatest pull has no bound of
     *  the surface's own, and forces follow the grid step. */
    HAFT_ASPERITY_FITTED,
} haft_asperity_model;

/** What acts between a patch and the plane. */
typedef struct haft_contact_spec {
    haft_asperity_model asperities;  /**< what counts as one */
    double modulus;                  /**< equivalent modulus [Pa] */
    bool has_capillary;              /**< false: Hertz alone */
    double pressure;                 /**< Laplace pressure [Pa], not positive */
    double capillary_range;          /**< h_C [m] */
    bool has_vdw;                    /**< each asperity a Maugis sphere instead of a Hertzian one */
    haft_vdw vdw;                    /**< their attraction; read only with has_vdw */
    haft_vdw_path path;              /**< which way the patch goes */
    const haft_maugis_table *maugis; /**< borrowed; needed with has_vdw */
} haft_contact_spec;

/** A patch's answer at n >= 2 distances; arrays are the caller's, each of length n. Areas are
 *  fractions of the nominal area. wet_area is the area below h_C, contact area included, and 0
 *  without a capillary; the capillary pressure acts on wet_area - contact_area, or on nothing where
 *  that is negative. contact_area, wet_area and asperities may be NULL. */
typedef struct haft_curve {
    size_t n;               /**< distances, at least 2 */
    const double *distance; /**< [m], strictly increasing, evenly spaced */
    double *force;          /**< f(d) [Pa] */
    double *contact_area;   /**< Hertz area, pi R (z_s - d) summed */
    double *wet_area;       /**< share of points with d - z < h_C */
    double *asperities;     /**< asperities in contact an area [1/m^2] */
} haft_curve;

/** Scratch for patches of up to rows x columns points (each at least 3, 2^31 in all); one a thread.
 *  Takes about 15 bytes a point. The first curve longer than any before takes a little more. */
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
 *  The heights are gone through once: points are counted into the intervals between the distances
 *  (menisci merge because area is counted, not asperities), and the few above the lowest distance
 *  are listed for the summits or, bunched by interval, for the islands, which grow and merge by
 *  union-find.
 *  Source: Hertz (1882); Hoang et al. (2017), Sec. 2.2.2.
 *  @param[in,out] work scratch of one thread
 *  @param[in] spec what acts
 *  @param[in] z heights [m], row by row
 *  @param[in] rows, columns of the patch, at most the work's
 *  @param[in] step of the grid, both ways [m], > 0
 *  @param[in,out] curve distances in, force and areas out
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_ARGUMENT for a distance grid that is not even (to a millionth of its step) or
 *  increasing, a patch larger than the work or a spec out of range; HAFT_ERROR_INPUT for heights
 *  that are not finite; HAFT_ERROR_MEMORY. Thread-safe for distinct work. */
haft_status haft_contact_curve(haft_contact_work *work, const haft_contact_spec *spec,
                               const double *z, size_t rows, size_t columns, double step,
                               haft_curve *curve, haft_error *error) HAFT_MUST_CHECK;

/** haft_contact_curve() for n specs of the same patch, to the same bits. Those that differ in their
 *  water alone have their asperities, the most of the work, counted once.
 *  @param[in,out] work scratch of one thread
 *  @param[in] n how many
 *  @param[in] spec n of them
 *  @param[in] z heights [m], row by row
 *  @param[in] rows, columns of the patch, at most the work's
 *  @param[in] step of the grid, both ways [m], > 0
 *  @param[in,out] curve n of them; after a failure their contents are undefined
 *  @param[out] error one message where it fails; may be NULL
 *  @return as haft_contact_curve(), of the first that fails. Thread-safe for distinct work. */
haft_status haft_contact_curves(haft_contact_work *work, size_t n, const haft_contact_spec *spec,
                                const double *z, size_t rows, size_t columns, double step,
                                haft_curve *curve, haft_error *error) HAFT_MUST_CHECK;

/** Whether van der Waals forces can be computed of every asperity that a patch of rows x columns
 *  points can have, as haft_contact_curve() asks: radii from a thousandth of a step, which no
 *  sampled asperity has, to a thousand diagonals, which stand for flat.
 *  @param[in] vdw the forces
 *  @param[in] modulus equivalent modulus [Pa], > 0
 *  @param[in] rows points of a patch, > 0; not whole where a patch has a share of a row
 *  @param[in] columns likewise
 *  @param[in] step between points [m], > 0
 *  @param[out] error may be NULL
 *  @return HAFT_ERROR_INPUT if a lambda is out of the table's bounds. Thread-safe. */
haft_status haft_contact_check_spheres(const haft_vdw *vdw, double modulus, double rows,
                                       double columns, double step,
                                       haft_error *error) HAFT_MUST_CHECK;

/** What a patch looks like where its force vanishes. */
typedef struct haft_zero_force {
    bool found;          /**< false: no change of sign on the grid */
    double distance;     /**< where that is [m] */
    double contact_area; /**< share of the area */
    double wet_area;     /**< share of the area */
    double asperities;   /**< [1/m^2] */
} haft_zero_force;

/** The distance at which f changes from push to pull, nearest inside that of the greatest pull;
 *  everything else interpolated linearly there. The curve must hold all its arrays. Thread-safe. */
haft_zero_force haft_contact_zero_force(const haft_curve *curve);

#ifdef __cplusplus
}
#endif
#endif
