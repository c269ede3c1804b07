/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file beam.h
 *  The elastic structure: a clamped Euler-Bernoulli beam in Hermite elements over contact sites,
 *  as the energy
 *
 *      Pi(u, P) = 1/2 u'Ku + sum_r A_r Phi_r(d_r) - P w(x_P),   d_r = gap - w(x_r),
 *
 *  w the displacement towards the substrate [m], Phi_r the potential of the law of site r. */
#ifndef HAFT_BEAM_H
#define HAFT_BEAM_H

#include "haft/law.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A cantilever of rectangular section, clamped at x = 0 at height `gap` over its substrate. */
typedef struct haft_beam_spec {
    double length;        /**< [m] */
    double width;         /**< [m] */
    double thickness;     /**< [m] */
    double gap;           /**< h [m] */
    double young_modulus; /**< E [Pa] */
} haft_beam_spec;

/** E w t^3 / 12 [N m^2]. */
double haft_beam_bending_stiffness(const haft_beam_spec *beam);

/** Effective adhesion energy of a crack length, Gamma = (3/2) E h^2 t^3 / l^4 [J/m^2].
 *  Source: de Boer and Michalske (1999); Hoang et al. (2017), Eq. 36. */
double haft_beam_effective_energy(const haft_beam_spec *beam, double crack_length);

/** The crack length of an effective energy, the inverse of the above [m]. */
double haft_beam_equilibrium_crack(const haft_beam_spec *beam, double energy);

/** Where the nodes lie. */
typedef enum haft_mesh_kind {
    HAFT_MESH_UNIFORM, /**< every element_length: several sites share an element */
    HAFT_MESH_EXACT,   /**< at every site and at the load: exact, since the beam is cubic between */
    HAFT_MESH_ACTIVE, /**< exact from `active_from` on, one element over the span before (two, where
                           the load is on it); sites on that span are left out of the contact. The
                           model comes with shorter ones of the same beam */
} haft_mesh_kind;

/** Into how many elements a beam may be cut: the stiffness of shorter ones, which grows with the
 *  third power of their number, loses the digits of the whole beam's. */
enum { HAFT_MOST_ELEMENTS = 10000 };

/** How a beam is cut into elements, and where its sites and the load are. */
typedef struct haft_mesh_spec {
    haft_mesh_kind kind;   /**< where the nodes lie */
    double element_length; /**< [m]; for HAFT_MESH_UNIFORM: divides the length */
    double l_meso;         /**< length of a patch, one site in the middle of each [m] */
    double load_position;  /**< x_P [m], 0 < x_P <= length */
    double active_from;    /**< [m], < length; for HAFT_MESH_ACTIVE */
} haft_mesh_spec;

/** Unknowns an element, a site or the load touches at most. */
enum { HAFT_SPAN = 4 };

/** Strain energy 1/2 q'Dq of an element in its two deformation modes q = B u: evaluated through
 *  differences first, so that rigid motion costs no digits. */
typedef struct haft_element {
    int dof[HAFT_SPAN];        /**< unknowns, -1 where fixed or absent */
    double mode[2][HAFT_SPAN]; /**< B, in scaled unknowns */
    double stiffness[3];       /**< D11, D12, D22 in units of energy */
    double mass[10];           /**< upper triangle of the consistent mass, row by row, scaled */
} haft_element;

/** A contact site: gap d = gap - sum shape[k] u[dof[k]] over its `terms`. */
typedef struct haft_site {
    double x;                /**< position [m] */
    double area;             /**< A_r [m^2] */
    int dof[HAFT_SPAN];      /**< unknowns that move it, -1 where absent */
    double shape[HAFT_SPAN]; /**< [m] a unit of each unknown */
    int terms; /**< set by haft_model_create(), which puts those that count in front */
} haft_site;

/** A discrete structure in scaled unknowns, read-only once made. Any number of threads may share
 *  it. */
typedef struct haft_model haft_model;

/** What others may read of a model.
 *
 *  Scaled: energies in `energy_unit` (E I h^2 / L^3), deflections in h, rotations in h over the
 *  node's own element length. `scale[i]` takes unknown i to metres or radians. */
typedef struct haft_model_data {
    size_t dofs;           /**< unknowns */
    double *scale;         /**< dofs: [m] or [rad] a unit of each unknown */
    double energy_unit;    /**< [J] */
    double gap;            /**< [m] */
    size_t elements;       /**< of the beam */
    haft_element *element; /**< elements, in order of x */
    size_t sites;          /**< where laws act */
    size_t inert;          /**< how many of the first take no part: they are to stay out of reach */
    haft_site *site;       /**< in order of x */
    haft_site load;        /**< where the load acts; its area is unused */
    size_t nodes;          /**< 0 for a structure that is no beam */
    double *node_x;        /**< [m] */
    size_t nonzeros;       /**< entries of the Hessian's pattern */
    int *column;       /**< compressed columns of the full symmetric Hessian: starts, dofs + 1 */
    int *row;          /**< and rows, sorted */
    double *stiffness; /**< K in that pattern, in units of energy */
    double *mass;      /**< M in that pattern: integral of w^2 / (h^2 L) */
} haft_model_data;

/** The data of a model; they live as long as it. Inline, because the solver reads them in its
 *  innermost loops: they are the first member of the model. Thread-safe. */
static inline const haft_model_data *haft_model_get(const haft_model *model) {
    return (const haft_model_data *)(const void *)model;
}

/** The next shorter of an active mesh's models: the same beam and sites, more of them inert, for
 *  states that touch only further on. Owned by the model. @return NULL if there is none. */
const haft_model *haft_model_shorter(const haft_model *model);

/** Number of sites between the clamp and the zone of an active mesh. They are left out of the
 *  contact and need no laws of their own. 0 for other meshes. Thread-safe. */
size_t haft_mesh_inert_sites(const haft_beam_spec *beam, const haft_mesh_spec *mesh);

/** Creates the model of a beam on a mesh. @return HAFT_ERROR_INPUT where l_meso or
 *  element_length does not divide the length (the message names the nearest that does), makes
 *  more than HAFT_MOST_ELEMENTS elements, or the load is off the beam. A load nearer to a node
 *  than 1 % of l_meso gets no node of its own. */
haft_status haft_model_create_beam(haft_model **out, const haft_beam_spec *beam,
                                   const haft_mesh_spec *mesh, haft_error *error) HAFT_MUST_CHECK;

/** A structure given by its parts, for other mechanics and for tests: elements, sites and load
 *  in scaled unknowns as above. Every array is copied. */
typedef struct haft_model_parts {
    size_t dofs;                 /**< unknowns */
    const double *scale;         /**< dofs; NULL: all 1 */
    double energy_unit;          /**< [J] */
    double gap;                  /**< of every site in the undeformed state [m] */
    size_t elements;             /**< how many */
    const haft_element *element; /**< elements */
    size_t sites;                /**< how many */
    size_t inert;                /**< number of leading sites that are left out of the contact */
    const haft_site *site;       /**< sites, in order of x */
    haft_site load;              /**< where the load acts; its area is unused */
} haft_model_parts;

/** Creates the model: the pattern of its Hessian, K and M.
 *  @return HAFT_ERROR_ARGUMENT for parts that do not fit together; HAFT_ERROR_MEMORY. */
haft_status haft_model_create(haft_model **out, const haft_model_parts *parts,
                              haft_error *error) HAFT_MUST_CHECK;

/** The front part of a beam, for states that move there alone while what lies behind is frozen. It
 *  is the model with fewer elements, unknowns and sites: those that a displacement of its unknowns
 *  strains or moves. Its energies are the model's but for a constant. Its gradient and the columns
 *  of its Hessian are the model's own, except in the last two unknowns, those of the frozen node,
 *  which lack what lies behind.
 *  @param[in,out] front from haft_model_create_front(); a view of the model's arrays from now on
 *  @param[in] model a beam
 *  @param[in] sites that are to move, from the first on; a few more do
 *  @return the number of unknowns that are not frozen, from the first on; all, and `front` the same
 *  as the model, where no front of it is shorter. Thread-safe. */
size_t haft_model_set_front(haft_model *front, const haft_model *model, size_t sites);

/** Creates a model for haft_model_set_front(), to be destroyed with haft_model_destroy_front().
 *  @return HAFT_ERROR_MEMORY */
haft_status haft_model_create_front(haft_model **out, haft_error *error) HAFT_MUST_CHECK;

/** Frees it, not the arrays it views, and sets the pointer to NULL; NULL is allowed. */
void haft_model_destroy_front(haft_model **front);

/** Adds factor w_r^2 to the quadratic form of a matrix in the Hessian's pattern, w_r the
 *  displacement of a site: factor [1/m^2] times the products of its shapes to its entries.
 *  @param[in] model the structure
 *  @param[in] site its index, not inert
 *  @param[in] factor in units of energy a square metre
 *  @param[in,out] matrix [nonzeros]
 *  @param[out] kept the entries before, for haft_model_restore_stiffness(). Thread-safe. */
void haft_model_add_stiffness(const haft_model *model, size_t site, double factor, double *matrix,
                              double kept[HAFT_SPAN * HAFT_SPAN]);

/** Sets the entries of a site back to what haft_model_add_stiffness() found. Thread-safe. */
void haft_model_restore_stiffness(const haft_model *model, size_t site,
                                  const double kept[HAFT_SPAN * HAFT_SPAN], double *matrix);

/** Frees a model and sets the pointer to NULL; NULL is allowed. */
void haft_model_destroy(haft_model **model);

/** The energy of a state [J]. */
typedef struct haft_energy {
    double strain;   /**< 1/2 u'Ku */
    double contact;  /**< sum A_r Phi_r(d_r) */
    double rounding; /**< bound of what rounding of u changes in their sum */
} haft_energy;

/** Displacement [m] of a site or of the load point of a model, which has set its `terms`.
 *  Inline, because the solver calls it often. */
static inline double haft_model_displacement(const haft_site *site, const double *u) {
    double w = 0;
    for (int k = 0; k < site->terms; k++) {
        w += site->shape[k] * u[site->dof[k]];
    }
    return w;
}

/** Gaps d[sites] of a state [m]. Thread-safe. */
void haft_model_gaps(const haft_model *model, const double *u, double *d);

/** Displacements of all sites except the inert ones: the same bits as haft_model_displacement().
 *  @param[in] model the structure
 *  @param[in] v dofs scaled unknowns, or a direction in them
 *  @param[out] w sites [m]; inert sites' are left alone. Thread-safe. */
void haft_model_displacements(const haft_model *model, const double *v, double *w);

/** The number of leading inert sites whose gap is larger than their reach.
 *  @param[in] model the structure
 *  @param[in] u dofs scaled unknowns
 *  @param[in] reach of each site [m]
 *  @return `inert` if it is all of them. Thread-safe. */
size_t haft_model_clear_sites(const haft_model *model, const double *u, const double *reach);

/** y[dofs] += sum over all sites except the inert ones of force[r] times the shape functions of
 *  site r. force[r] acts along the displacement, in units of energy per metre. Thread-safe. */
void haft_model_add_forces(const haft_model *model, const double *force, double *y);

/** Energy of a state and, where not NULL, the gradient of Pi at load P [N] in units of energy
 *  and the Hessian in the model's pattern. Inert sites are left out.
 *  @param[in] model the structure
 *  @param[in] u [dofs] state, scaled unknowns
 *  @param[in] load P [N]
 *  @param[out] gradient [dofs]; may be NULL
 *  @param[out] hessian [nonzeros]; may be NULL
 *  @param[in] laws one a site
 *  @param[out] force_scale may be NULL: the largest single term in the gradient, the scale of
 *  its rounding error
 *  @param[out] gap [sites] may be NULL: the gaps at which the laws were evaluated [m]; those of
 *  inert sites are not set
 *  @param[out] site_stiffness [sites] may be NULL: each site's part of the Hessian, -A_r
 *  f'_r(d_r) in units of energy per square metre, for haft_model_multiply(); those of inert
 *  sites are not set. Thread-safe. */
haft_energy haft_model_evaluate(const haft_model *model, const haft_law_rows *laws, const double *u,
                                double load, double *gradient, double *hessian, double *force_scale,
                                double *gap, double *site_stiffness);

/** The gradient alone: the same bits in less time.
 *  @param[in] model the structure
 *  @param[in] laws one a site
 *  @param[in] u [dofs] state, scaled unknowns
 *  @param[in] load P [N]
 *  @param[out] gradient [dofs], in units of energy; not finite where the state or a law is not.
 *  Thread-safe. */
void haft_model_gradient(const haft_model *model, const haft_law_rows *laws, const double *u,
                         double load, double *gradient);

/** y = H x, by the deformation modes of the elements and site by site. The product with the
 *  assembled Hessian would lose digits like (length / element)^4. Thread-safe. */
void haft_model_multiply(const haft_model *model, const double *site_stiffness, const double *x,
                         double *y);

/** Deflection w [m] and rotation dw/dx of a beam at x, by Hermite interpolation. */
void haft_model_shape(const haft_model *model, const double *u, double x, double *deflection,
                      double *rotation);

/** The shape of a beam on another of its meshes: nodes of `to` that `from` has take its values,
 *  others those of the cubic between. Exact if the sites in which the meshes differ bear no
 *  force, since the beam is then cubic between the nodes of either.
 *  @param[in] from the mesh of `u`
 *  @param[in] to another active mesh of the same beam
 *  @param[in] u dofs of `from`
 *  @param[out] out dofs of `to`, not `u`. Thread-safe. */
void haft_model_carry(const haft_model *from, const haft_model *to, const double *u, double *out);

/** Length from the clamp to the first point where the attraction of its patch is felt, d(x) <=
 *  reach[r], in the beam's own cubic shape, to rounding.
 *  @param[in] model the structure
 *  @param[in] reach one a site [m]: haft_law_reach(law, share) of its law
 *  @param[in] u dofs scaled unknowns
 *  @return the beam's length if it touches nowhere (it is free). Thread-safe. */
double haft_model_crack_length(const haft_model *model, const double *reach, const double *u);

#ifdef __cplusplus
}
#endif
#endif
