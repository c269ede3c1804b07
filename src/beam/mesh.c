/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Meshing a cantilever: nodes, Hermite elements, one contact site in the middle of each patch.
 * An element's strain energy is written in its two deformation modes, the end rotations relative to
 * the chord: q1 = rotation_1 - chord, q2 = rotation_2 - chord, energy (2EI/l)(q1^2+q1 q2+q2^2). */
#include "sites.h"

#include <math.h>
#include <string.h>

/* Each shorter mesh has this share of the sites of the one before, and at least so many. */
#define SHORTER_SHARE 0.85
enum { LEAST_ACTIVE = 24 };

/* Elements that differ from the pitch by less than this share of it have the same length. */
#define PITCH_TOLERANCE 1e-9

/* The load gets no node of its own if a node is nearer than this share of a patch: so short an
 * element would cost the others digits. The load then acts within its element. All nodes stay
 * exact (Hermite elements contain the Green's functions of their nodes); only the deflection at
 * the load lacks P a^3 / (3 E I), with a the distance from the node. */
#define LOAD_TOLERANCE 0.01

static haft_status check_fineness(const haft_beam_spec *beam, const haft_mesh_spec *mesh,
                                  haft_error *error) {
    bool uniform = mesh->kind == HAFT_MESH_UNIFORM;
    double part = uniform ? mesh->element_length : mesh->l_meso;
    double least = beam->length / HAFT_MOST_ELEMENTS;
    if (part < least * (1 - PITCH_TOLERANCE)) {
        return haft_error_set(
            error, HAFT_ERROR_INPUT,
            "%s = %g m is too short for a beam of %g m: more than %d elements lose "
            "the digits of its stiffness; the shortest allowed is %.9g m",
            uniform ? "element_length" : "l_meso", part, beam->length, HAFT_MOST_ELEMENTS, least);
    }
    return HAFT_OK;
}

static haft_status count_divisions(double length, double part, const char *key, size_t *count,
                                   haft_error *error) {
    double ratio = length / part;
    double whole = round(ratio);
    if (!(part > 0) || !(length > 0) || !isfinite(ratio) || whole < 1 || whole > 1e7) {
        return haft_error_set(error, HAFT_ERROR_INPUT, "%s = %g m does not fit a beam of %g m", key,
                              part, length);
    }
    if (fabs(ratio - whole) > 1e-9 * whole) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "%s = %g m does not divide the length of %g m; the nearest that does "
                              "is %.9g m",
                              key, part, length, length / whole);
    }
    *count = (size_t)whole;
    return HAFT_OK;
}

/* Inserts a position into a sorted list unless it is already there. */
static size_t insert_node(double *x, size_t n, double position, double tolerance) {
    size_t i = 0;
    while (i < n && x[i] < position - tolerance) {
        i++;
    }
    if (i < n && fabs(x[i] - position) <= tolerance) {
        return n;
    }
    memmove(x + i + 1, x + i, (n - i) * sizeof *x);
    x[i] = position;
    return n + 1;
}

static double site_position(double length, size_t sites, size_t r) {
    return length * ((double)r + 0.5) / (double)sites;
}

size_t haft_mesh_inert_sites(const haft_beam_spec *beam, const haft_mesh_spec *mesh) {
    size_t r = 0, sites = (size_t)llround(beam->length / mesh->l_meso);
    while (mesh->kind == HAFT_MESH_ACTIVE && r < sites &&
           site_position(beam->length, sites, r) < mesh->active_from) {
        r++;
    }
    return r;
}

static haft_status place_nodes(double **out, size_t *count, const haft_beam_spec *beam,
                               const haft_mesh_spec *mesh, size_t sites, haft_error *error) {
    size_t elements = 0;
    if (mesh->kind == HAFT_MESH_UNIFORM) {
        HAFT_TRY(count_divisions(beam->length, mesh->element_length, "element_length", &elements,
                                 error));
    }
    double *x = haft_memory_alloc(elements + sites + 3, sizeof *x, error);
    size_t inert = haft_mesh_inert_sites(beam, mesh);
    if (x == NULL) {
        return HAFT_ERROR_MEMORY;
    }
    size_t n = 0;
    if (mesh->kind == HAFT_MESH_UNIFORM) {
        for (size_t i = 0; i <= elements; i++) {
            x[n++] = beam->length * (double)i / (double)elements;
        }
    } else {
        x[n++] = 0;
        for (size_t r = inert; r < sites; r++) {
            x[n++] = site_position(beam->length, sites, r);
        }
        x[n++] = beam->length;
        n = insert_node(x, n, mesh->load_position, LOAD_TOLERANCE * mesh->l_meso);
    }
    *out = x;
    *count = n;
    return HAFT_OK;
}

size_t haft_beam_find_element(const double *node_x, size_t nodes, double x) {
    size_t low = 0, high = nodes - 1;
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (node_x[middle] <= x) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

/* The same, and the local coordinate of x in it, from 0 to 1. */
static size_t find_place(const double *node_x, size_t nodes, double x, double *xi) {
    size_t e = haft_beam_find_element(node_x, nodes, x);
    *xi = (x - node_x[e]) / (node_x[e + 1] - node_x[e]);
    return e;
}

static int node_dof(size_t node, int rotation) {
    return node == 0 ? -1 : (int)(2 * (node - 1)) + rotation;
}

static void element_dofs(size_t e, int dof[HAFT_SPAN]) {
    for (int k = 0; k < HAFT_SPAN; k++) {
        dof[k] = node_dof(e + (size_t)(k / 2), k % 2);
    }
}

/* The same for site r of a uniform mesh, 2 r + 1 half patches from the clamp. Integer arithmetic
 * gives sites at the same place of their elements the same bits. */
static size_t find_uniform_element(size_t elements, size_t sites, size_t r, double *xi) {
    size_t beam = 2 * sites; /* half patches; an element is beam / elements of them long */
    *xi = (double)((2 * r + 1) * elements % beam) / (double)beam;
    return (2 * r + 1) * elements / beam;
}

/* Shape functions at xi in element e of length l [m per unit of each unknown]. */
static haft_site make_point(size_t e, double xi, double l, const double *node_scale, double gap) {
    haft_site site = {0};
    element_dofs(e, site.dof);
    double xi2 = xi * xi, xi3 = xi2 * xi;
    site.shape[0] = gap * (1 - 3 * xi2 + 2 * xi3);
    site.shape[1] = node_scale[e] * l * (xi - 2 * xi2 + xi3);
    site.shape[2] = gap * (3 * xi2 - 2 * xi3);
    site.shape[3] = node_scale[e + 1] * l * (xi3 - xi2);
    return site;
}

/* Length of element e. Elements of one pitch get the same bits, whatever the rounding of their
 * nodes' positions. */
static double element_length(const double *node_x, size_t e, double pitch) {
    double l = node_x[e + 1] - node_x[e];
    return fabs(l - pitch) < PITCH_TOLERANCE * pitch ? pitch : l;
}

static haft_element make_element(const double *node_length, size_t e, double l,
                                 double beam_length) {
    haft_element element = {0};
    element_dofs(e, element.dof);
    double s1 = l / node_length[e], s2 = l / node_length[e + 1];
    double mode[2][HAFT_SPAN] = {{1, s1, -1, 0}, {1, 0, -1, s2}};
    memcpy(element.mode, mode, sizeof mode);
    double slender = beam_length / l;
    double unit = slender * slender * slender;
    element.stiffness[0] = 4 * unit;
    element.stiffness[1] = 2 * unit;
    element.stiffness[2] = 4 * unit;
    double m = l / (420 * beam_length);
    double mass[10] = {156 * m,     22 * m * s1,      54 * m,  -13 * m * s2, 4 * m * s1 * s1,
                       13 * m * s1, -3 * m * s1 * s2, 156 * m, -22 * m * s2, 4 * m * s2 * s2};
    memcpy(element.mass, mass, sizeof mass);
    return element;
}

/* The arrays that a mesh is made from; freed together. */
typedef struct beam_parts {
    double *x, *node_length, *node_scale, *scale;
    haft_element *element;
    haft_site *site;
} beam_parts;

static void free_parts(beam_parts *parts) {
    haft_memory_free(parts->x);
    haft_memory_free(parts->node_length);
    haft_memory_free(parts->node_scale);
    haft_memory_free(parts->scale);
    haft_memory_free(parts->element);
    haft_memory_free(parts->site);
}

static haft_status allocate_parts(beam_parts *parts, size_t nodes, size_t sites,
                                  haft_error *error) {
    parts->node_length = haft_memory_alloc(nodes, sizeof(double), error);
    parts->node_scale = haft_memory_alloc(nodes, sizeof(double), error);
    parts->scale = haft_memory_alloc(2 * nodes, sizeof(double), error);
    parts->element = haft_memory_alloc(nodes, sizeof(haft_element), error);
    parts->site = haft_memory_alloc(sites, sizeof(haft_site), error);
    bool all =
        parts->node_length && parts->node_scale && parts->scale && parts->element && parts->site;
    return all ? HAFT_OK : HAFT_ERROR_MEMORY;
}

static void scale_nodes(beam_parts *parts, size_t nodes, double pitch, double gap) {
    for (size_t i = 0; i < nodes; i++) {
        double before = i == 0 ? 0 : element_length(parts->x, i - 1, pitch);
        double after = i + 1 == nodes ? 0 : element_length(parts->x, i, pitch);
        double own = before > 0 && after > 0 ? 0.5 * (before + after) : before + after;
        parts->node_length[i] = own;
        parts->node_scale[i] = gap / own;
        if (i > 0) {
            parts->scale[2 * (i - 1)] = gap;
            parts->scale[2 * (i - 1) + 1] = gap / own;
        }
    }
}

/* The point at x, which is at xi in element e. */
static haft_site place_point(const beam_parts *parts, const haft_beam_spec *beam, size_t e,
                             double xi, double x, double pitch) {
    double l = element_length(parts->x, e, pitch);
    haft_site site = make_point(e, xi, l, parts->node_scale, beam->gap);
    site.x = x;
    return site;
}

static haft_site make_site(const beam_parts *parts, const haft_beam_spec *beam, bool uniform,
                           size_t nodes, size_t sites, size_t r, double pitch) {
    double x = site_position(beam->length, sites, r), xi;
    size_t e = uniform ? find_uniform_element(nodes - 1, sites, r, &xi)
                       : find_place(parts->x, nodes, x, &xi);
    haft_site site = place_point(parts, beam, e, xi, x, pitch);
    site.area = beam->width * beam->length / (double)sites;
    return site;
}

static haft_site make_load(const beam_parts *parts, const haft_beam_spec *beam, size_t nodes,
                           double x, double pitch) {
    double xi;
    size_t e = find_place(parts->x, nodes, x, &xi);
    return place_point(parts, beam, e, xi, x, pitch);
}

static haft_status build(haft_model **out, const haft_beam_spec *beam, const haft_mesh_spec *mesh,
                         size_t sites, size_t nodes, beam_parts *parts, haft_error *error) {
    HAFT_TRY(allocate_parts(parts, nodes, sites, error));
    bool uniform = mesh->kind == HAFT_MESH_UNIFORM;
    double pitch = beam->length / (double)(uniform ? nodes - 1 : sites);
    scale_nodes(parts, nodes, pitch, beam->gap);
    for (size_t e = 0; e + 1 < nodes; e++) {
        double length = element_length(parts->x, e, pitch);
        parts->element[e] = make_element(parts->node_length, e, length, beam->length);
    }
    for (size_t r = 0; r < sites; r++) {
        parts->site[r] = make_site(parts, beam, uniform, nodes, sites, r, pitch);
    }
    double l = beam->length;
    haft_model_parts assembled = {
        .dofs = 2 * (nodes - 1),
        .scale = parts->scale,
        .energy_unit = haft_beam_bending_stiffness(beam) * beam->gap * beam->gap / (l * l * l),
        .gap = beam->gap,
        .elements = nodes - 1,
        .element = parts->element,
        .sites = sites,
        .inert = haft_mesh_inert_sites(beam, mesh),
        .site = parts->site,
        .load = make_load(parts, beam, nodes, mesh->load_position, pitch),
    };
    haft_status status = haft_model_create(out, &assembled, error);
    if (status == HAFT_OK) {
        (*out)->data.nodes = nodes;
        (*out)->data.node_x = parts->x;
        parts->x = NULL;
    }
    return status;
}

static haft_status create_mesh(haft_model **out, const haft_beam_spec *beam,
                               const haft_mesh_spec *mesh, size_t sites, haft_error *error) {
    size_t nodes = 0;
    beam_parts parts = {0};
    haft_status status = place_nodes(&parts.x, &nodes, beam, mesh, sites, error);
    HAFT_THEN(status, build(out, beam, mesh, sites, nodes, &parts, error));
    free_parts(&parts);
    return status;
}

/* Creates the shorter models of a beam. */
static haft_status add_shorter(haft_model *model, const haft_beam_spec *beam,
                               const haft_mesh_spec *mesh, haft_error *error) {
    haft_mesh_spec shorter = *mesh;
    size_t sites = model->data.sites;
    for (haft_model *last = model; last != NULL; last = last->shorter) {
        size_t active = (size_t)(SHORTER_SHARE * (double)(sites - last->data.inert));
        if (active < LEAST_ACTIVE) {
            break;
        }
        shorter.active_from = beam->length * (double)(sites - active) / (double)sites;
        HAFT_TRY(create_mesh(&last->shorter, beam, &shorter, sites, error));
    }
    return HAFT_OK;
}

haft_status haft_model_create_beam(haft_model **out, const haft_beam_spec *beam,
                                   const haft_mesh_spec *mesh, haft_error *error) {
    *out = NULL;
    bool positive = beam->length > 0 && beam->width > 0 && beam->thickness > 0 && beam->gap > 0 &&
                    beam->young_modulus > 0;
    if (!positive || !isfinite(haft_beam_bending_stiffness(beam) * beam->gap * beam->length)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "a beam's length, width, thickness, gap and modulus must be positive "
                              "and finite");
    }
    if (!(mesh->load_position > 0 && mesh->load_position <= beam->length)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "the load at %g m is off the beam; it must lie in (0, %g m]",
                              mesh->load_position, beam->length);
    }
    if (mesh->kind == HAFT_MESH_ACTIVE && !(mesh->active_from < beam->length)) {
        return haft_error_set(error, HAFT_ERROR_INPUT,
                              "the active zone begins at %g m, off the beam of %g m",
                              mesh->active_from, beam->length);
    }
    size_t sites = 0;
    haft_status status = count_divisions(beam->length, mesh->l_meso, "l_meso", &sites, error);
    HAFT_THEN(status, check_fineness(beam, mesh, error));
    HAFT_THEN(status, create_mesh(out, beam, mesh, sites, error));
    if (status == HAFT_OK && mesh->kind == HAFT_MESH_ACTIVE) {
        status = add_shorter(*out, beam, mesh, error);
    }
    if (status != HAFT_OK) {
        haft_model_destroy(out);
    }
    return status;
}
