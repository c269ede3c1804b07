/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file io_case.h
 *  A case: the contents of case.yaml, with defaults filled in, in SI. haft_case_read() loads a
 *  units database (see haft_units): one thread at a time. */
#ifndef HAFT_IO_CASE_H
#define HAFT_IO_CASE_H

#include "haft/beam.h"
#include "haft/chaos.h"
#include "haft/contact.h"
#include "haft/law.h"
#include "haft/solve.h"
#include "haft/surface.h"
#include "haft/surface_map.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { HAFT_NAME_CAPACITY = 128, HAFT_TEXT_CAPACITY = 512 };

/** Limits of a sweep: keys varied together, values of each key; bytes of a variant's label and of a
 *  value's text. */
enum {
    HAFT_SWEPT_KEYS_MAX = 8,
    HAFT_VARIANTS_MAX = 1000,
    HAFT_LABEL_CAPACITY = 96,
    HAFT_SWEPT_TEXT_CAPACITY = 24
};

/** The stop rule looks at the first n realizations, for n = HAFT_STOP_LEAST and from there in steps
 *  of HAFT_STOP_STRIDE. */
enum { HAFT_STOP_LEAST = 30, HAFT_STOP_STRIDE = 10 };

/** Where the solver's laws come from. */
typedef enum haft_sampler {
    HAFT_SAMPLER_EXPLICIT, /**< patches cut from one seamless surface of the whole beam */
    HAFT_SAMPLER_PATCHES,  /**< independent patches */
    HAFT_SAMPLER_GPCE, /**< this and the rest: drawn from a stochastic model of independent patches,
                            by the haft_chaos_sampler of the same name */
    HAFT_SAMPLER_EXACT,
    HAFT_SAMPLER_KERNEL,
    HAFT_SAMPLER_BOOTSTRAP,
    HAFT_SAMPLER_MEAN,
} haft_sampler;

/** Whether a sampler draws from a stochastic model. */
bool haft_sampler_is_stochastic(haft_sampler sampler);

/** The order of the principal components in the Rosenblatt map. */
typedef enum haft_component_order {
    HAFT_COMPONENTS_FALLING, /**< the component of largest variance first */
    HAFT_COMPONENTS_RISING,  /**< the component of smallest variance first */
} haft_component_order;

/** Which curves laws.h5 keeps. */
typedef enum haft_curves_kept {
    HAFT_CURVES_ALL,
    HAFT_CURVES_NEEDED, /**< the curves that the solver uses as tables, and those of the
                             realizations with evidence; none of a stochastic model's patches */
} haft_curves_kept;

/** What to do with a curve that no Morse law fits. */
typedef enum haft_unfit { HAFT_UNFIT_TABLE, HAFT_UNFIT_STOP } haft_unfit;

/** What determines which forces act. */
typedef enum haft_forces {
    HAFT_FORCES_GIVEN,     /**< the sections of the case: contact.capillary, contact.vdw */
    HAFT_FORCES_AUTO,      /**< the humidity, as in the paper: see haft_case_physics() */
    HAFT_FORCES_CAPILLARY, /**< of the sections of the case, only the capillary one */
    HAFT_FORCES_VDW        /**< only van der Waals; the humidity determines the medium */
} haft_forces;

/** Below this humidity van der Waals forces act, if the humidity determines the forces. */
#define HAFT_VDW_HUMIDITY 0.55

/** The source of a case's surfaces. */
typedef enum haft_surface_source {
    HAFT_SOURCE_GENERATED, /**< generated from the PSD and the marginal */
    HAFT_SOURCE_MAPS,      /**< adjacent windows of the maps themselves */
} haft_surface_source;

/** How the PSD estimated from maps is used. */
typedef enum haft_psd_use { HAFT_PSD_TABLE, HAFT_PSD_FIT } haft_psd_use;

/** The water film adsorbed on each face. */
typedef enum haft_adsorbed {
    HAFT_ADSORBED_NONE,
    HAFT_ADSORBED_SILICA, /**< haft_adsorption_silica() */
    HAFT_ADSORBED_TABLE,
} haft_adsorbed;

/** The distribution of heights of a generated surface. */
typedef enum haft_marginal_kind {
    HAFT_MARGINAL_GAUSSIAN,
    HAFT_MARGINAL_JOHNSON, /**< with the skewness and kurtosis of the case, or of the maps if the
                                case gives none */
    HAFT_MARGINAL_HEIGHTS, /**< the maps' own */
} haft_marginal_kind;

enum { HAFT_FILES_MAX = 16, HAFT_PATH_CAPACITY = 1024 };

/** Files that a case names, relative to its folder; the resolved case has absolute paths. */
typedef struct haft_case_files {
    size_t count;                                      /**< files */
    char path[HAFT_FILES_MAX][HAFT_PATH_CAPACITY];     /**< absolute */
    char digest[HAFT_FILES_MAX][HAFT_DIGEST_CAPACITY]; /**< of their contents */
} haft_case_files;

/** Maps, read and cleaned as a case prescribes. */
typedef struct haft_map_set {
    size_t count;                  /**< maps */
    haft_map *map[HAFT_FILES_MAX]; /**< owned */
} haft_map_set;

/** A resolved case: defaults filled in, everything in SI. */
typedef struct haft_case {
    char name[HAFT_NAME_CAPACITY];  /**< a word */
    char title[HAFT_TEXT_CAPACITY]; /**< a line */
    uint64_t seed;                  /**< of all random numbers */

    /** The rough surfaces. */
    struct {
        haft_psd psd;             /**< for a table, its end points */
        haft_roughness roughness; /**< from which psd was made; its rms is 0 if not given */
        double grid_step;         /**< [m] */
        double kernel_tolerance;  /**< share of the energy that the kernel's taper may remove;
                                       default 1e-5 */

        haft_case_files maps, opposite_maps; /**< of each face; may be none */
        haft_case_files psd_file;            /**< a PSD by points */
        char channel[HAFT_TEXT_CAPACITY];
        double map_size[2];                /**< for matrices without a header [m]; 0 if not given */
        double map_unit, map_lateral_unit; /**< [m]; 0 if not given */
        haft_level level;
        double outliers; /**< deviations beyond which pixels are masked; 0: no masking */
        haft_missing missing;
        haft_window window;
        double tip_radius; /**< [m]; 0 if not given */
        haft_psd_use use;
        double coherence; /**< between the faces */
        haft_surface_source source;
        haft_marginal_kind marginal;
        double skewness, kurtosis; /**< NAN if not given */

        bool fitted;      /**< psd is fitted to the maps' table */
        haft_psd_fit fit; /**< where fitted */
        double map_rms;   /**< if fitted: rms of the maps' heights, both faces together [m] */

        haft_psd_table *table; /**< the PSD given by points; NULL if psd alone defines it; owned */
        haft_marginal *distribution; /**< NULL: Gaussian; owned */
        haft_map_set map, opposite;  /**< if maps are given; owned */
    } surface;

    /** The forces between the surfaces. */
    struct {
        haft_asperity_model asperities;
        double young_modulus; /**< of both bodies [Pa] */
        double poisson_ratio; /**< of both bodies */
        double hardness;      /**< of the softer body [Pa], to check asperities; 0: not given */
        bool has_capillary;
        haft_capillary_spec capillary; /**< its humidity may be 0 if it determines the forces */
        haft_forces forces;
        bool has_vdw;
        struct {
            double hamaker_dry, hamaker_humid; /**< through air, through water [J] */
            double r0;                         /**< [m] */
            haft_vdw_path path;
        } vdw;
        bool has_dispersion;
        struct {
            double hamaker;         /**< through air [J]; 0: that of vdw, hamaker_dry */
            double cut_off;         /**< least gap that counts, before menisci [m] */
            double retardation;     /**< wavelength [m]; 0: none */
            double reach;           /**< gap at which the far field ends [m] */
            double oxide_thickness; /**< on both faces [m]; 0: none */
            double oxide_hamaker;   /**< [J] */
        } dispersion;               /**< forces across the gap of what does not touch */
        haft_far_field *far;    /**< of the surface, for the laws of all sites; owned; NULL without
                                     dispersion */
        haft_adsorbed adsorbed; /**< films on both faces lengthen the capillary range by both */
        haft_case_files adsorbed_file;
        haft_adsorption film; /**< from the table; points into film_data */
        double *film_data;    /**< owned */
        double distance_from, distance_to,
            distance_step; /**< gaps at which f(d) is evaluated [m] */
    } contact;

    /** How curves become laws, and the source of the solver's laws. */
    struct {
        haft_law_kind kind;
        double f_limit;       /**< [Pa]; 0: given by f_limit_share */
        double f_limit_share; /**< share of each curve's f_max; 0: given by f_limit */
        haft_unfit unfit;
        haft_sampler sampler;
        struct {
            size_t vectors;       /**< patches from which the model is built */
            haft_chaos_spec spec; /**< without f_limit and component_order */
            haft_component_order component_order;
        } chaos; /**< for a stochastic sampler */
    } law;

    haft_beam_spec beam;      /**< the cantilever */
    haft_mesh_spec mesh;      /**< load_position included */
    haft_programme programme; /**< of the load */
    haft_path_options path;   /**< how finely the path is followed */

    size_t realizations; /**< beams */

    /** When a run may end before all realizations are done. */
    struct {
        double crack_length_mean; /**< sufficient half width of the confidence interval of the mean
                                       [m]; 0: no stop rule */
        double confidence;        /**< of this and all other intervals; default 95 % */
    } stop;

    /** Which realizations keep their states in results.h5. */
    struct {
        bool all;            /**< every one; then `realization` is ignored */
        size_t count;        /**< else number of them */
        size_t *realization; /**< realizations with evidence; owned by the case */
    } evidence;

    haft_curves_kept curves; /**< in laws.h5 */

    /** Which variant of the file's sweep this is. A variant is an ordinary case, and its resolved
     *  text does not mention the sweep. */
    struct haft_case_sweep {
        size_t variants;                       /**< in the file; 1 without a sweep */
        size_t variant;                        /**< this one */
        size_t keys;                           /**< varied; 0 without a sweep */
        const char *key[HAFT_SWEPT_KEYS_MAX];  /**< dotted paths: "beam.l_meso" */
        const char *unit[HAFT_SWEPT_KEYS_MAX]; /**< "1" for a pure number or a choice */
        double value[HAFT_SWEPT_KEYS_MAX];     /**< in `unit`; a choice's index among the choices */
        bool choice[HAFT_SWEPT_KEYS_MAX];      /**< whether it is a choice */
        char text[HAFT_SWEPT_KEYS_MAX][HAFT_SWEPT_TEXT_CAPACITY]; /**< as written, or truncated */
        char label[HAFT_LABEL_CAPACITY]; /**< usable as a folder name: "02_l_meso-3um" */
    } sweep;                             /**< of the file */

    /** Reference values to print next to Haft's; NaN where the case gives none. */
    struct {
        double paper_crack_length, measured_crack_length; /**< [m] */
        double zero_distance[2]; /**< zero-force distance of patches, smallest and largest [m] */
        double contact_area[2];  /**< there, share of the area */
        double wet_area[2];      /**< there, share of the area */
        double asperities[2];    /**< in contact there, per patch */
    } reference;
} haft_case;

/** Reads and resolves `path`, the case.yaml of a case directory. One message reports all errors,
 *  one per line, in the order of the file: "FILE:LINE:COLUMN: KEY: what is wrong; what would be
 *  right", then "and N more" if the message is full. For a file that is not a plain YAML document
 *  (syntax, anchors, tags, a second document, not UTF-8) only the first error is reported.
 *
 *  Absent: path, study.stop, output, reference, law.chaos and load.limit take their defaults
 *  (load_limit INFINITY, the reference NaN); contact.capillary means dry contact (has_capillary
 *  false, its fields 0); contact.vdw none of those forces (has_vdw false); contact.dispersion none
 *  across the gap (has_dispersion false, far NULL); beam.element_length is
 * required for a uniform mesh alone (else 0). mesh.active_from is half of load.crack_length, or
 * less where dispersion is felt from farther than a tenth of the gap.
 *  @return HAFT_ERROR_IO if it cannot be read, HAFT_ERROR_INPUT if it cannot be used. */
haft_status haft_case_read(haft_case **out, const char *path, haft_error *error) HAFT_MUST_CHECK;

/** Frees a case with all it owns and sets the pointer to NULL; NULL is allowed. */
void haft_case_destroy(haft_case **c);

/** Reads one variant of a case with a sweep:
 *
 *      sweep:
 *        beam.l_meso: [24 um, 12 um, 6 um]
 *        load.crack_length: [130 um, 130 um, 120 um]
 *
 *  The keys are dotted paths of numbers or choices, the lists have equal length: variant i takes
 *  the i-th value of each. haft_case_read() reads variant 0.
 *  @return HAFT_ERROR_ARGUMENT if there is no such variant, otherwise as haft_case_read(). */
haft_status haft_case_read_variant(haft_case **out, const char *path, size_t variant,
                                   haft_error *error) HAFT_MUST_CHECK;

/** Moments of the case's PSD, given by points or self-affine. */
haft_psd_moments haft_case_moments(const haft_case *c);

/** Correlation length of the case's PSD [m], to 1/e. Thread-safe. */
double haft_case_correlation_length(const haft_case *c);

/** Whether the case asks for evidence of this realization. */
bool haft_case_wants_evidence(const haft_case *c, size_t realization);

/** The forces that act in a case: those with a section of their own. If the humidity determines the
 *  forces: only capillary from HAFT_VDW_HUMIDITY up, both below it, only van der Waals at 0. Or one
 *  of the two, to see its effect alone. Source: Hoang et al. (2017), Sec. 5. */
typedef struct haft_physics {
    bool capillary; /**< menisci */
    bool vdw;       /**< van der Waals forces */
    bool humid;     /**< use the Hamaker constant through water */
} haft_physics;

/** The forces of a case. Thread-safe. */
haft_physics haft_case_physics(const haft_case *c);

/** Thickness of the water film adsorbed on each face at the case's humidity [m], 0 if it wants
 * none. Menisci then reach from film to film: the capillary range is that of Kelvin's law and both
 * films. A choice of Haft's: the film's own pressure on Kelvin's law is left out. */
double haft_case_film(const haft_case *c);

/** The dispersion force across the gap of a case's faces that do not touch. Where menisci act its
 *  cut-off is the capillary range if that is more, since water fills what is nearer. The film of
 *  water counts in that range alone, not as a layer.
 *  @return HAFT_ERROR_INPUT as haft_dispersion_check(). Thread-safe. */
haft_status haft_case_dispersion(haft_dispersion *out, const haft_case *c,
                                 haft_error *error) HAFT_MUST_CHECK;

/** The van der Waals forces of contact of a case: of its Hamaker constant through air or water, and
 *  with dispersion across the gap in dry contact, without the energy that the latter has (see
 *  haft_vdw_leave_tail()). Thread-safe.
 *  @return HAFT_ERROR_INPUT as haft_vdw_from_spec() and haft_vdw_leave_tail(). */
haft_status haft_case_vdw(haft_vdw *out, const haft_case *c, haft_error *error) HAFT_MUST_CHECK;

/** "capillary", "van der Waals", "capillary and van der Waals" or "contact alone". */
const char *haft_physics_name(haft_physics physics);

/** The limit push of a case's laws, as haft_law_limit() takes it. */
double haft_case_limit(const haft_case *c);

/** The last part of a swept key's path: "l_meso" of "beam.l_meso". */
const char *haft_sweep_leaf(const struct haft_case_sweep *sweep, size_t key);

/** Quotes a text for a case: in double quotes, with escapes for characters that YAML would misread.
 *  @param[out] out to be freed with haft_memory_free(); NULL after a failure
 *  @param[in] text UTF-8
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_MEMORY. Thread-safe. */
haft_status haft_case_quote(char **out, const char *text, haft_error *error) HAFT_MUST_CHECK;

/** Makes YAML of the resolved case. It reads back to the same bits; the caller frees it with
 *  haft_memory_free(). */
haft_status haft_case_emit(char **text, const haft_case *c, haft_error *error) HAFT_MUST_CHECK;

/** Writes haft_case_emit()'s text to `path`, whole or not at all. */
haft_status haft_case_write(const haft_case *c, const char *path,
                            haft_error *error) HAFT_MUST_CHECK;

/** Digest of everything that the patch surfaces of a stochastic sampler depend on, including their
 *  number: cases with the same digest compute their laws from the same patches. */
haft_status haft_case_patches_digest(const haft_case *c, char digest[HAFT_DIGEST_CAPACITY],
                                     haft_error *error) HAFT_MUST_CHECK;

/** Digest of everything that a law depends on. laws.h5 is valid as long as it does not change. It
 *  covers the surface with the contents of the files it names, contact, f_limit, the beam's width,
 *  l_meso, seed and the program's version; for a direct sampler also which one; for a stochastic
 *  one law.chaos, but not which sampler. The number and length of the beams and the beginning of
 *  the active zone are left out: they change the number of laws, not the laws. */
haft_status haft_case_laws_digest(const haft_case *c, char digest[HAFT_DIGEST_CAPACITY],
                                  haft_error *error) HAFT_MUST_CHECK;

#ifdef __cplusplus
}
#endif
#endif
