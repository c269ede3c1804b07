/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The schema of case.yaml as one table: reading, defaults, the resolved case and the digest of the
 * laws' inputs all follow it. A default is written as a user would write it and read by the same
 * code. */
#include "case.h"

#include <math.h>
#include <string.h>

#define AT(field) offsetof(haft_case, field)
#define POSITIVE .low = 0, .high = INFINITY
#define SHARE .low = 0, .high = 1

static const char *const levels[] = {"mean", "plane", "quadratic", "lines", NULL};
static const char *const treatments[] = {"exclude", "fill", NULL};
static const char *const windows[] = {"none", "hann", "welch", "blackman", "tukey", NULL};
static const char *const uses[] = {"table", "fit", NULL};
static const char *const sources[] = {"generated", "maps", NULL};
static const char *const marginals[] = {"gaussian", "johnson", "heights", NULL};
static const char *const films[] = {"none", "silica", "table", NULL};
static const char *const asperities[] = {"summits", "islands", "fitted_islands", NULL};
static const char *const forces[] = {"given", "auto", "capillary", "vdw", NULL};
static const char *const vdw_paths[] = {"separation", "approach", NULL};
static const char *const kinds[] = {"morse", "table", NULL};
static const char *const unfits[] = {"table", "stop", NULL};
static const char *const samplers[] = {"explicit", "patches",   "gpce", "exact",
                                       "kernel",   "bootstrap", "mean", NULL};
static const char *const germs[] = {"legendre", "hermite", "jacobi", NULL};
static const char *const kernels[] = {"scott", "preserving", NULL};
static const char *const bounds[] = {"strict", "paper", NULL};
static const char *const component_orders[] = {"falling", "rising", NULL};
static const char *const curves[] = {"all", "needed", NULL};
static const char *const meshes[] = {"uniform", "exact", "active", NULL};
static const char *const linear_solvers[] = {"auto", "klu", "band", NULL};

/* A choice is stored through an int, and a pair as two adjacent doubles. */
_Static_assert(sizeof(haft_asperity_model) == sizeof(int), "enums are ints");
_Static_assert(sizeof(haft_law_kind) == sizeof(int), "enums are ints");
_Static_assert(sizeof(haft_unfit) == sizeof(int), "enums are ints");
_Static_assert(sizeof(haft_sampler) == sizeof(int), "enums are ints");
_Static_assert(sizeof(haft_mesh_kind) == sizeof(int), "enums are ints");
_Static_assert(sizeof(haft_curves_kept) == sizeof(int), "enums are ints");
_Static_assert(HAFT_CURVES_ALL == 0 && HAFT_CURVES_NEEDED == 1, "order of choices");
_Static_assert(HAFT_LEVEL_MEAN == 0 && HAFT_LEVEL_LINES == 3 && HAFT_MISSING_EXCLUDE == 0 &&
                   HAFT_WINDOW_NONE == 0 && HAFT_WINDOW_TUKEY == 4 && HAFT_PSD_TABLE == 0 &&
                   HAFT_SOURCE_GENERATED == 0 && HAFT_MARGINAL_GAUSSIAN == 0 &&
                   HAFT_MARGINAL_HEIGHTS == 2,
               "order of choices");
_Static_assert(HAFT_ASPERITY_SUMMITS == 0 && HAFT_ASPERITY_ISLANDS == 1 &&
                   HAFT_ASPERITY_FITTED == 2,
               "order of choices");
_Static_assert(HAFT_FORCES_GIVEN == 0 && HAFT_FORCES_AUTO == 1 && HAFT_FORCES_CAPILLARY == 2 &&
                   HAFT_FORCES_VDW == 3 && HAFT_VDW_SEPARATION == 0 && HAFT_VDW_APPROACH == 1,
               "order of choices");
_Static_assert(HAFT_LAW_MORSE == 0 && HAFT_LAW_TABLE == 1, "order of choices");
_Static_assert(HAFT_UNFIT_TABLE == 0 && HAFT_UNFIT_STOP == 1, "order of choices");
_Static_assert(HAFT_SAMPLER_EXPLICIT == 0 && HAFT_SAMPLER_PATCHES == 1 && HAFT_SAMPLER_GPCE == 2 &&
                   HAFT_SAMPLER_EXACT == 3 && HAFT_SAMPLER_KERNEL == 4 &&
                   HAFT_SAMPLER_BOOTSTRAP == 5 && HAFT_SAMPLER_MEAN == 6,
               "order of choices");
_Static_assert(HAFT_CHAOS_GERM_LEGENDRE == 0 && HAFT_CHAOS_GERM_HERMITE == 1 &&
                   HAFT_CHAOS_GERM_JACOBI == 2 && HAFT_CHAOS_KERNEL_SCOTT == 0 &&
                   HAFT_CHAOS_KERNEL_PRESERVING == 1 && HAFT_CHAOS_BOUNDS_STRICT == 0 &&
                   HAFT_CHAOS_BOUNDS_PAPER == 1,
               "order of choices");
_Static_assert(HAFT_MESH_UNIFORM == 0 && HAFT_MESH_EXACT == 1 && HAFT_MESH_ACTIVE == 2,
               "order of choices");
_Static_assert(offsetof(haft_capillary_spec, contact_angle_2) ==
                   offsetof(haft_capillary_spec, contact_angle_1) + sizeof(double),
               "the angles are neighbours");

const haft_section haft_case_sections[] = {
    {"surface", HAFT_SECTION_REQUIRED},
    {"contact", HAFT_SECTION_REQUIRED},
    {"contact.capillary", HAFT_SECTION_SWITCH},
    {"contact.vdw", HAFT_SECTION_SWITCH},
    {"contact.dispersion", HAFT_SECTION_SWITCH},
    {"contact.dispersion.oxide", HAFT_SECTION_SWITCH},
    {"contact.distance", HAFT_SECTION_REQUIRED},
    {"law", HAFT_SECTION_REQUIRED},
    {"law.chaos", HAFT_SECTION_OPTIONAL},
    {"beam", HAFT_SECTION_REQUIRED},
    {"load", HAFT_SECTION_REQUIRED},
    {"path", HAFT_SECTION_OPTIONAL},
    {"study", HAFT_SECTION_REQUIRED},
    {"study.stop", HAFT_SECTION_OPTIONAL},
    {"output", HAFT_SECTION_OPTIONAL},
    {"reference", HAFT_SECTION_OPTIONAL},
};
const size_t haft_case_section_count = sizeof haft_case_sections / sizeof *haft_case_sections;

#define REAL(place, dimension, ...)                                                                \
    { .path = place, .type = HAFT_KEY_REAL, .unit = dimension, __VA_ARGS__ }
#define CHOICE(place, words, ...)                                                                  \
    { .path = place, .type = HAFT_KEY_CHOICE, .choices = words, __VA_ARGS__ }
#define FILES(place, most, ...)                                                                    \
    {                                                                                              \
        .path = place, .type = HAFT_KEY_FILES, .count = most, .fallback = "none",                  \
        .laws = HAFT_LAWS_ALWAYS, __VA_ARGS__                                                      \
    }
#define COUNT(place, ...)                                                                          \
    { .path = place, .type = HAFT_KEY_COUNT, .low_in = true, .high_in = true, __VA_ARGS__ }

/* The keys of a section are adjacent, and the sections are in the order of the table above. */
const haft_key haft_case_keys[] = {
    {.path = "name", .type = HAFT_KEY_NAME, .example = "my-case", .offset = AT(name)},
    {.path = "title",
     .type = HAFT_KEY_TEXT,
     .fallback = "",
     .example = "My case",
     .offset = AT(title)},
    {.path = "seed",
     .type = HAFT_KEY_SEED,
     .example = "1",
     .offset = AT(seed),
     .laws = HAFT_LAWS_ALWAYS},

    /* The PSD is given by its parameters, maps or a table: see haft_case_load_surface(). */
    REAL("surface.zeta_max", "rad/m", POSITIVE, .fallback = "none", .example = "289 rad/um",
         .offset = AT(surface.psd.zeta_max), .laws = HAFT_LAWS_ALWAYS),
    REAL("surface.zeta_0", "rad/m", POSITIVE, .fallback = "none", .example = "19.4 rad/um",
         .offset = AT(surface.psd.zeta_0), .laws = HAFT_LAWS_ALWAYS,
         .where = HAFT_PART_SELF_AFFINE),
    REAL("surface.s_0", "m^4", POSITIVE, .fallback = "none", .example = "6.46e3 nm^4",
         .offset = AT(surface.psd.s_0), .laws = HAFT_LAWS_ALWAYS, .where = HAFT_PART_SELF_AFFINE),
    REAL("surface.s_1", "m^4", POSITIVE, .fallback = "none", .example = "6.46e-3 nm^4",
         .offset = AT(surface.psd.s_1), .laws = HAFT_LAWS_ALWAYS, .where = HAFT_PART_SELF_AFFINE),
    /* Instead of zeta_0, s_0 and s_1. */
    REAL("surface.rms", "m", POSITIVE, .fallback = "none", .example = "5 nm",
         .offset = AT(surface.roughness.rms), .laws = HAFT_LAWS_ALWAYS,
         .where = HAFT_PART_ROUGHNESS),
    REAL("surface.correlation_length", "m", POSITIVE, .fallback = "none", .example = "200 nm",
         .offset = AT(surface.roughness.correlation_length), .laws = HAFT_LAWS_ALWAYS,
         .where = HAFT_PART_ROUGHNESS),
    REAL("surface.hurst", "1", .low = 0, .high = 1, .high_in = true, .fallback = "none",
         .example = "0.8", .offset = AT(surface.roughness.hurst), .laws = HAFT_LAWS_ALWAYS,
         .where = HAFT_PART_ROUGHNESS),
    REAL("surface.grid_step", "m", POSITIVE, .example = "5 nm", .offset = AT(surface.grid_step),
         .laws = HAFT_LAWS_ALWAYS),
    REAL("surface.kernel_tolerance", "1", SHARE, .fallback = "1e-5", .example = "1e-5",
         .offset = AT(surface.kernel_tolerance), .laws = HAFT_LAWS_ALWAYS),
    FILES("surface.maps", HAFT_FILES_MAX, .example = "[map.spm]", .offset = AT(surface.maps),
          .where = HAFT_PART_MAPS),
    FILES("surface.opposite_maps", HAFT_FILES_MAX, .example = "[other.spm]",
          .offset = AT(surface.opposite_maps), .where = HAFT_PART_FACES),
    FILES("surface.psd", 1, .example = "psd.csv", .offset = AT(surface.psd_file)),
    {.path = "surface.channel",
     .type = HAFT_KEY_TEXT,
     .fallback = "",
     .example = "Height",
     .offset = AT(surface.channel),
     .laws = HAFT_LAWS_ALWAYS,
     .where = HAFT_PART_MAPS},
    REAL("surface.map_size", "m", POSITIVE, .count = 2, .fallback = "none",
         .example = "[10 um, 10 um]", .offset = AT(surface.map_size), .laws = HAFT_LAWS_ALWAYS,
         .where = HAFT_PART_MAPS),
    REAL("surface.map_unit", "m", POSITIVE, .fallback = "none", .example = "1 nm",
         .offset = AT(surface.map_unit), .laws = HAFT_LAWS_ALWAYS, .where = HAFT_PART_MAPS),
    REAL("surface.map_lateral_unit", "m", POSITIVE, .fallback = "none", .example = "1 um",
         .offset = AT(surface.map_lateral_unit), .laws = HAFT_LAWS_ALWAYS, .where = HAFT_PART_MAPS),
    CHOICE("surface.level", levels, .fallback = "plane", .example = "plane",
           .offset = AT(surface.level), .laws = HAFT_LAWS_ALWAYS, .where = HAFT_PART_MAPS),
    REAL("surface.outliers", "1", .low = 1, .low_in = true, .high = INFINITY, .fallback = "none",
         .example = "6", .offset = AT(surface.outliers), .laws = HAFT_LAWS_ALWAYS,
         .where = HAFT_PART_MAPS),
    CHOICE("surface.missing", treatments, .fallback = "exclude", .example = "exclude",
           .offset = AT(surface.missing), .laws = HAFT_LAWS_ALWAYS, .where = HAFT_PART_MAPS),
    CHOICE("surface.window", windows, .fallback = "hann", .example = "hann",
           .offset = AT(surface.window), .laws = HAFT_LAWS_ALWAYS, .where = HAFT_PART_MAPS),
    REAL("surface.tip_radius", "m", POSITIVE, .fallback = "none", .example = "8 nm",
         .offset = AT(surface.tip_radius), .laws = HAFT_LAWS_ALWAYS, .where = HAFT_PART_MAPS),
    CHOICE("surface.use", uses, .fallback = "table", .example = "table", .offset = AT(surface.use),
           .laws = HAFT_LAWS_ALWAYS, .where = HAFT_PART_MAPS),
    REAL("surface.coherence", "1", .low = -1, .low_in = true, .high = 1, .high_in = true,
         .fallback = "0", .example = "0", .offset = AT(surface.coherence), .laws = HAFT_LAWS_ALWAYS,
         .where = HAFT_PART_FACES),
    CHOICE("surface.source", sources, .fallback = "generated", .example = "generated",
           .offset = AT(surface.source), .laws = HAFT_LAWS_ALWAYS, .where = HAFT_PART_MAPS),
    CHOICE("surface.marginal", marginals, .fallback = "gaussian", .example = "gaussian",
           .offset = AT(surface.marginal), .laws = HAFT_LAWS_ALWAYS, .where = HAFT_PART_MARGINAL),
    REAL("surface.skewness", "1", .low = -20, .high = 20, .fallback = "none", .example = "0.5",
         .offset = AT(surface.skewness), .laws = HAFT_LAWS_ALWAYS, .where = HAFT_PART_MARGINAL),
    REAL("surface.kurtosis", "1", .low = 1, .high = 2000, .fallback = "none", .example = "3.4",
         .offset = AT(surface.kurtosis), .laws = HAFT_LAWS_ALWAYS, .where = HAFT_PART_MARGINAL),

    CHOICE("contact.asperities", asperities, .example = "islands", .offset = AT(contact.asperities),
           .laws = HAFT_LAWS_ALWAYS),
    REAL("contact.young_modulus", "Pa", POSITIVE, .example = "163 GPa",
         .offset = AT(contact.young_modulus), .laws = HAFT_LAWS_ALWAYS),
    REAL("contact.poisson_ratio", "1", .low = 0, .low_in = true, .high = 0.5, .example = "0.22",
         .offset = AT(contact.poisson_ratio), .laws = HAFT_LAWS_ALWAYS),
    REAL("contact.hardness", "Pa", POSITIVE, .fallback = "none", .example = "11 GPa",
         .offset = AT(contact.hardness)),
    CHOICE("contact.forces", forces, .fallback = "given", .example = "given",
           .offset = AT(contact.forces), .laws = HAFT_LAWS_ALWAYS),
    /* 0 only if it determines the forces: see the cross checks. */
    REAL("contact.capillary.humidity", "1", SHARE, .low_in = true, .example = "85 %",
         .offset = AT(contact.capillary.humidity), .laws = HAFT_LAWS_ALWAYS),
    REAL("contact.capillary.temperature", "K", POSITIVE, .fallback = "300 K", .example = "300 K",
         .offset = AT(contact.capillary.temperature), .laws = HAFT_LAWS_ALWAYS),
    REAL("contact.capillary.surface_energy", "N/m", POSITIVE, .fallback = "72 mN/m",
         .example = "72 mN/m", .offset = AT(contact.capillary.surface_energy),
         .laws = HAFT_LAWS_ALWAYS),
    REAL("contact.capillary.molar_volume", "m^3/mol", POSITIVE, .fallback = "18 cm^3/mol",
         .example = "18 cm^3/mol", .offset = AT(contact.capillary.molar_volume),
         .laws = HAFT_LAWS_ALWAYS),
    REAL("contact.capillary.contact_angles", "rad", .low = 0, .low_in = true,
         .high = 1.5707963267948966, .count = 2, .fallback = "0 deg", .example = "[0 deg, 0 deg]",
         .offset = AT(contact.capillary.contact_angle_1), .laws = HAFT_LAWS_ALWAYS),
    REAL("contact.vdw.hamaker_dry", "J", POSITIVE, .fallback = "18.65e-20 J",
         .example = "18.65e-20 J", .offset = AT(contact.vdw.hamaker_dry), .laws = HAFT_LAWS_ALWAYS),
    REAL("contact.vdw.hamaker_humid", "J", POSITIVE, .fallback = "9.75e-20 J",
         .example = "9.75e-20 J", .offset = AT(contact.vdw.hamaker_humid),
         .laws = HAFT_LAWS_ALWAYS),
    REAL("contact.vdw.r0", "m", POSITIVE, .fallback = "0.209 nm", .example = "0.209 nm",
         .offset = AT(contact.vdw.r0), .laws = HAFT_LAWS_ALWAYS),
    CHOICE("contact.vdw.path", vdw_paths, .fallback = "separation", .example = "separation",
           .offset = AT(contact.vdw.path), .laws = HAFT_LAWS_ALWAYS),
    CHOICE("contact.capillary.adsorbed", films, .fallback = "none", .example = "silica",
           .offset = AT(contact.adsorbed), .laws = HAFT_LAWS_ALWAYS, .where = HAFT_PART_FILM),
    FILES("contact.capillary.adsorbed_table", 1, .example = "film.csv",
          .offset = AT(contact.adsorbed_file), .where = HAFT_PART_FILM),
    /* That of contact.vdw if absent, and bounds of them all: see the cross checks. */
    REAL("contact.dispersion.hamaker", "J", POSITIVE, .fallback = "none", .example = "18.65e-20 J",
         .offset = AT(contact.dispersion.hamaker), .laws = HAFT_LAWS_ALWAYS),
    REAL("contact.dispersion.cut_off", "m", POSITIVE, .fallback = "1 nm", .example = "1 nm",
         .offset = AT(contact.dispersion.cut_off), .laws = HAFT_LAWS_ALWAYS),
    REAL("contact.dispersion.retardation", "m", .low = 0, .low_in = true, .high = INFINITY,
         .fallback = "100 nm", .example = "100 nm", .offset = AT(contact.dispersion.retardation),
         .laws = HAFT_LAWS_ALWAYS),
    REAL("contact.dispersion.reach", "m", POSITIVE, .fallback = "500 nm", .example = "500 nm",
         .offset = AT(contact.dispersion.reach), .laws = HAFT_LAWS_ALWAYS),
    REAL("contact.dispersion.oxide.thickness", "m", POSITIVE, .example = "2 nm",
         .offset = AT(contact.dispersion.oxide_thickness), .laws = HAFT_LAWS_ALWAYS),
    REAL("contact.dispersion.oxide.hamaker", "J", POSITIVE, .example = "6.5e-20 J",
         .offset = AT(contact.dispersion.oxide_hamaker), .laws = HAFT_LAWS_ALWAYS),
    REAL("contact.distance.from", "m", .low = 0, .low_in = true, .high = INFINITY,
         .example = "3 nm", .offset = AT(contact.distance_from), .laws = HAFT_LAWS_ALWAYS),
    REAL("contact.distance.to", "m", POSITIVE, .example = "28 nm",
         .offset = AT(contact.distance_to), .laws = HAFT_LAWS_ALWAYS),
    REAL("contact.distance.step", "m", POSITIVE, .example = "0.1 nm",
         .offset = AT(contact.distance_step), .laws = HAFT_LAWS_ALWAYS),

    CHOICE("law.kind", kinds, .example = "morse", .offset = AT(law.kind)),
    /* One of the two is required: see the cross checks. */
    REAL("law.f_limit", "Pa", POSITIVE, .fallback = "none", .example = "5 MPa",
         .offset = AT(law.f_limit), .laws = HAFT_LAWS_ALWAYS),
    REAL("law.f_limit_share", "1", POSITIVE, .fallback = "none", .example = "20 %",
         .offset = AT(law.f_limit_share), .laws = HAFT_LAWS_ALWAYS),
    CHOICE("law.unfit", unfits, .fallback = "table", .example = "table", .offset = AT(law.unfit)),
    CHOICE("law.sampler", samplers, .fallback = "explicit", .example = "explicit",
           .offset = AT(law.sampler), .laws = HAFT_LAWS_DIRECT),

    COUNT("law.chaos.vectors", .low = 10, .high = 1e6, .fallback = "5000", .example = "5000",
          .offset = AT(law.chaos.vectors), .laws = HAFT_LAWS_CHAOS),
    CHOICE("law.chaos.bounds", bounds, .fallback = "strict", .example = "strict",
           .offset = AT(law.chaos.spec.bounds), .laws = HAFT_LAWS_CHAOS),
    COUNT("law.chaos.components", .low = 0, .high = HAFT_CHAOS_DIMENSION, .fallback = "0",
          .example = "3", .offset = AT(law.chaos.spec.components), .laws = HAFT_LAWS_CHAOS),
    REAL("law.chaos.epsilon", "1", SHARE, .fallback = "0.1 %", .example = "0.1 %",
         .offset = AT(law.chaos.spec.epsilon), .laws = HAFT_LAWS_CHAOS),
    CHOICE("law.chaos.component_order", component_orders, .fallback = "falling",
           .example = "falling", .offset = AT(law.chaos.component_order), .laws = HAFT_LAWS_CHAOS),
    CHOICE("law.chaos.kernel", kernels, .fallback = "scott", .example = "scott",
           .offset = AT(law.chaos.spec.kernel), .laws = HAFT_LAWS_CHAOS),
    CHOICE("law.chaos.germ", germs, .fallback = "legendre", .example = "legendre",
           .offset = AT(law.chaos.spec.germ), .laws = HAFT_LAWS_CHAOS),
    COUNT("law.chaos.order", .low = 0, .high = HAFT_CHAOS_ORDER_LIMIT, .fallback = "12",
          .example = "12", .offset = AT(law.chaos.spec.order), .laws = HAFT_LAWS_CHAOS),
    COUNT("law.chaos.points", .low = 0, .high = HAFT_CHAOS_POINTS_LIMIT, .fallback = "0",
          .example = "13", .offset = AT(law.chaos.spec.points), .laws = HAFT_LAWS_CHAOS),

    REAL("beam.length", "m", POSITIVE, .example = "600 um", .offset = AT(beam.length)),
    REAL("beam.width", "m", POSITIVE, .example = "30 um", .offset = AT(beam.width),
         .laws = HAFT_LAWS_ALWAYS),
    REAL("beam.thickness", "m", POSITIVE, .example = "2.62 um", .offset = AT(beam.thickness)),
    REAL("beam.gap", "m", POSITIVE, .example = "1.9 um", .offset = AT(beam.gap)),
    REAL("beam.young_modulus", "Pa", POSITIVE, .example = "163 GPa",
         .offset = AT(beam.young_modulus)),
    REAL("beam.l_meso", "m", POSITIVE, .example = "3 um", .offset = AT(mesh.l_meso),
         .laws = HAFT_LAWS_ALWAYS),
    CHOICE("beam.mesh", meshes, .fallback = "uniform", .example = "uniform",
           .offset = AT(mesh.kind)),
    /* Required only for a uniform mesh: see the cross checks. */
    REAL("beam.element_length", "m", POSITIVE, .fallback = "none", .example = "15 um",
         .offset = AT(mesh.element_length)),

    REAL("load.position", "m", POSITIVE, .example = "60 um", .offset = AT(mesh.load_position)),
    REAL("load.crack_length", "m", POSITIVE, .example = "120 um",
         .offset = AT(programme.crack_length)),
    REAL("load.crack_threshold", "1", SHARE, .fallback = "1 %", .example = "1 %",
         .offset = AT(programme.crack_threshold)),
    REAL("load.limit", "N", POSITIVE, .fallback = "none", .example = "1 mN",
         .offset = AT(programme.load_limit)),

    CHOICE("path.linear_solver", linear_solvers, .fallback = "auto", .example = "band",
           .offset = AT(path.linear_solver)),
    REAL("path.gap_step", "1", .low = 0, .high = 1, .high_in = true, .fallback = "0.5",
         .example = "0.5", .offset = AT(path.gap_step)),
    REAL("path.ledger_tolerance", "1", SHARE, .fallback = "1e-10", .example = "1e-10",
         .offset = AT(path.ledger_tolerance)),
    REAL("path.residual_tolerance", "1", SHARE, .fallback = "1e-11", .example = "1e-11",
         .offset = AT(path.residual_tolerance)),
    REAL("path.flow_step", "1", SHARE, .fallback = "0.1", .example = "0.1",
         .offset = AT(path.flow_step)),
    COUNT("path.step_limit", .low = 1, .high = 1e12, .fallback = "200000", .example = "200000",
          .offset = AT(path.step_limit)),

    COUNT("study.realizations", .low = 1, .high = 1e7, .example = "20", .offset = AT(realizations)),
    REAL("study.stop.crack_length_mean", "m", POSITIVE, .fallback = "none", .example = "0.5 um",
         .offset = AT(stop.crack_length_mean)),
    REAL("study.stop.confidence", "1", SHARE, .fallback = "95 %", .example = "95 %",
         .offset = AT(stop.confidence)),

    {.path = "output.evidence",
     .type = HAFT_KEY_EVIDENCE,
     .fallback = "[]",
     .example = "[0]",
     .offset = AT(evidence)},
    CHOICE("output.curves", curves, .fallback = "all", .example = "needed", .offset = AT(curves)),

    REAL("reference.paper_crack_length", "m", POSITIVE, .fallback = "none", .example = "219 um",
         .offset = AT(reference.paper_crack_length)),
    REAL("reference.measured_crack_length", "m", POSITIVE, .fallback = "none", .example = "200 um",
         .offset = AT(reference.measured_crack_length)),
    REAL("reference.zero_distance", "m", POSITIVE, .count = 2, .fallback = "none",
         .example = "[8.3 nm, 10 nm]", .offset = AT(reference.zero_distance)),
    REAL("reference.contact_area", "1", SHARE, .count = 2, .fallback = "none",
         .example = "[0.2 %, 0.7 %]", .offset = AT(reference.contact_area)),
    REAL("reference.wet_area", "1", SHARE, .count = 2, .fallback = "none",
         .example = "[14 %, 29 %]", .offset = AT(reference.wet_area)),
    REAL("reference.asperities", "1", POSITIVE, .count = 2, .fallback = "none",
         .example = "[80, 130]", .offset = AT(reference.asperities)),
};
const size_t haft_case_key_count = sizeof haft_case_keys / sizeof *haft_case_keys;
_Static_assert(sizeof haft_case_keys / sizeof *haft_case_keys <= HAFT_KEYS_MAX, "room for keys");
_Static_assert(sizeof haft_case_sections / sizeof *haft_case_sections <= HAFT_SECTIONS_MAX,
               "room for sections");

bool haft_sampler_is_stochastic(haft_sampler sampler) {
    return sampler >= HAFT_SAMPLER_GPCE;
}

void haft_case_preset(haft_case *c) {
    c->programme.load_limit = INFINITY;
    c->surface.skewness = c->surface.kurtosis = NAN;
    c->reference.paper_crack_length = NAN;
    c->reference.measured_crack_length = NAN;
    double *const ranges[] = {c->reference.zero_distance, c->reference.contact_area,
                              c->reference.wet_area, c->reference.asperities};
    for (size_t i = 0; i < sizeof ranges / sizeof *ranges; i++) {
        ranges[i][0] = ranges[i][1] = NAN;
    }
}

int haft_case_find_key(const char *path) {
    for (size_t i = 0; i < haft_case_key_count; i++) {
        if (strcmp(haft_case_keys[i].path, path) == 0) {
            return (int)i;
        }
    }
    return -1;
}

int haft_case_find_section(const char *path) {
    for (size_t i = 0; i < haft_case_section_count; i++) {
        if (strcmp(haft_case_sections[i].path, path) == 0) {
            return (int)i;
        }
    }
    return -1;
}

bool haft_case_is_member(const char *path, const char *section) {
    size_t n = strlen(section);
    if (n > 0) {
        if (strncmp(path, section, n) != 0 || path[n] != '.') {
            return false;
        }
        path += n + 1;
    }
    return strchr(path, '.') == NULL;
}

const char *haft_case_leaf(const char *path) {
    const char *dot = strrchr(path, '.');
    return dot == NULL ? path : dot + 1;
}
