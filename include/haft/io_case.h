/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file io_case.h
 *  A case: everything that case.yaml says, resolved, in SI. haft_case_read() loads a units database
 *  (see haft_units): one thread at a time. */
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

/** Bounds of a sweep: keys varied together, values each; bytes of a variant's label. */
enum {
    HAFT_SWEPT_KEYS_MAX = 8,
    HAFT_VARIANTS_MAX = 1000,
    HAFT_LABEL_CAPACITY = 96,
    HAFT_SWEPT_TEXT_CAPACITY = 24
};

/** Where the stop rule looks: at prefixes of the realizations, from this many on, every so many. */
enum { HAFT_STOP_LEAST = 30, HAFT_STOP_STRIDE = 10 };

/** Where the solver's laws come from. */
typedef enum haft_sampler {
    HAFT_SAMPLER_EXPLICIT, /**< patches cut from one seamless surface of the whole beam */
    HAFT_SAMPLER_PATCHES,  /**< independent patches */
    HAFT_SAMPLER_GPCE, /**< this and the rest: drawn from a stochastic model of independent patches,
                            as the haft_chaos_sampler of the same name says */
    HAFT_SAMPLER_EXACT,
    HAFT_SAMPLER_KERNEL,
    HAFT_SAMPLER_BOOTSTRAP,
    HAFT_SAMPLER_MEAN,
} haft_sampler;

/** Whether a sampler draws from a stochastic model. */
bool haft_sampler_is_stochastic(haft_sampler sampler);

/** Which principal component comes first in the Rosenblatt map. */
typedef enum haft_component_order {
    HAFT_COMPONENTS_FALLING, /**< the one of the largest variance */
    HAFT_COMPONENTS_RISING,  /**< the one of the smallest */
} haft_component_order;

/** Which curves laws.h5 keeps. */
typedef enum haft_curves_kept {
    HAFT_CURVES_ALL,
    HAFT_CURVES_NEEDED, /**< those that the solver takes as tables, and those of the realizations
                             that leave evidence; of a stochastic model's patches none */
} haft_curves_kept;

/** What is done with a curve that no Morse law fits. */
typedef enum haft_unfit { HAFT_UNFIT_TABLE, HAFT_UNFIT_STOP } haft_unfit;

/** Who says which forces act. */
typedef enum haft_forces {
    HAFT_FORCES_GIVEN,     /**< the sections there are: contact.capillary, contact.vdw */
    HAFT_FORCES_AUTO,      /**< the humidity, as in the paper: see haft_case_physics() */
    HAFT_FORCES_CAPILLARY, /**< of the sections there are, the capillary alone */
    HAFT_FORCES_VDW        /**< van der Waals alone, through what the humidity says */
} haft_forces;

/** Below this humidity van der Waals forces are counted, if forces are chosen by it. */
#define HAFT_VDW_HUMIDITY 0.55

/** Where a case's surfaces come from. */
typedef enum haft_surface_source {
    HAFT_SOURCE_GENERATED, /**< drawn anew, of the PSD and marginal */
    HAFT_SOURCE_MAPS,      /**< windows of the maps themselves, side by side */
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
    HAFT_MARGINAL_JOHNSON, /**< of the case's skewness and kurtosis, or the maps' where it gives
                              none */
    HAFT_MARGINAL_HEIGHTS, /**< the maps' own */
} haft_marginal_kind;

enum { HAFT_FILES_MAX = 16, HAFT_PATH_CAPACITY = 1024 };

/** Files that a case names, found from its folder; the resolved case has them in full. */
typedef struct haft_case_files {
    size_t count;                                      /**< files */
    char path[HAFT_FILES_MAX][HAFT_PATH_CAPACITY];     /**< absolute */
    char digest[HAFT_FILES_MAX][HAFT_DIGEST_CAPACITY]; /**< of their contents */
} haft_case_files;

/** Maps read and cleaned as a case says. */
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
        haft_psd psd;             /**< of a table, its corners */
        haft_roughness roughness; /**< that psd was made from; its rms is 0 if not given */
        double grid_step;         /**< [m] */
        double kernel_tolerance;  /**< energy the kernel's taper may take; default 1e-5 */

        haft_case_files maps, opposite_maps; /**< of either face; none: psd is the case's own */
        haft_case_files psd_file;            /**< a PSD by points */
        char channel[HAFT_TEXT_CAPACITY];
        double map_size[2];                /**< of bare matrices [m]; 0 if not given */
        double map_unit, map_lateral_unit; /**< [m]; 0 if not given */
        haft_level level;
        double outliers; /**< deviations beyond which pixels are masked; 0: none are */
        haft_missing missing;
        haft_window window;
        double tip_radius; /**< [m]; 0 if not given */
        haft_psd_use use;
        double coherence; /**< of the faces */
        haft_surface_source source;
        haft_marginal_kind marginal;
        double skewness, kurtosis; /**< NAN if not given */

        bool fitted;      /**< psd is the form fitted to the maps' table */
        haft_psd_fit fit; /**< where fitted */
        double map_rms;   /**< where fitted: of the maps' heights, both faces' [m] */

        haft_psd_table *table;       /**< the PSD by points, NULL if psd is all there is; owned */
        haft_marginal *distribution; /**< NULL: Gaussian; owned */
        haft_map_set map, opposite;  /**< where maps are given; owned */
    } surface;

    /** What acts between them. */
    struct {
        haft_asperity_model asperities;
        double young_modulus; /**< of both bodies [Pa] */
        double poisson_ratio; /**< of both bodies */
        double hardness;      /**< of the softer body [Pa], to judge asperities by; 0: not given */
        bool has_capillary;
        haft_capillary_spec capillary; /**< its humidity may be 0 if forces are chosen by it */
        haft_forces forces;
        bool has_vdw;
        struct {
            double hamaker_dry, hamaker_humid; /**< through air, through water [J] */
            double r0;                         /**< [m] */
            haft_vdw_path path;
        } vdw;
        haft_adsorbed adsorbed; /**< films on both faces lengthen the capillary range by both */
        haft_case_files adsorbed_file;
        haft_adsorption film; /**< of the table; points into film_data */
        double *film_data;    /**< owned */
        double distance_from, distance_to,
            distance_step; /**< gaps at which f(d) is evaluated [m] */
    } contact;

    /** How curves become laws, and where the solver's laws come from. */
    struct {
        haft_law_kind kind;
        double f_limit;       /**< [Pa]; 0: by its share */
        double f_limit_share; /**< of each curve's f_max; 0: by f_limit */
        haft_unfit unfit;
        haft_sampler sampler;
        struct {
            size_t vectors;       /**< patches the model is built from */
            haft_chaos_spec spec; /**< but for f_limit and component_order */
            haft_component_order component_order;
        } chaos; /**< of a stochastic sampler */
    } law;

    haft_beam_spec beam;      /**< the cantilever */
    haft_mesh_spec mesh;      /**< load_position included */
    haft_programme programme; /**< of the load */
    haft_path_options path;   /**< how finely it is followed */

    size_t realizations; /**< beams */

    /** When a run may end before all realizations are done. */
    struct {
        double crack_length_mean; /**< half width of the mean's interval that is enough [m]; 0: none
                                   */
        double confidence;        /**< of this and all other intervals; default 95 % */
    } stop;

    /** Which realizations leave their states in results.h5. */
    struct {
        bool all;            /**< every one; then `realization` is not read */
        size_t count;        /**< else how many */
        size_t *realization; /**< which realizations leave evidence; owned by the case */
    } evidence;

    haft_curves_kept curves; /**< in laws.h5 */

    /** Which variant of the file's sweep this is; a variant is a plain case, and its resolved text
     *  knows nothing of the sweep. */
    struct haft_case_sweep {
        size_t variants;                       /**< in the file; 1 without a sweep */
        size_t variant;                        /**< this one */
        size_t keys;                           /**< varied; 0 without a sweep */
        const char *key[HAFT_SWEPT_KEYS_MAX];  /**< dotted paths: "beam.l_meso" */
        const char *unit[HAFT_SWEPT_KEYS_MAX]; /**< "1" for a pure number or a choice */
        double value[HAFT_SWEPT_KEYS_MAX];     /**< in `unit`; a choice's place among the choices */
        bool choice[HAFT_SWEPT_KEYS_MAX];      /**< whether it is one */
        char text[HAFT_SWEPT_KEYS_MAX][HAFT_SWEPT_TEXT_CAPACITY]; /**< as written, or its front */
        char label[HAFT_LABEL_CAPACITY]; /**< fit for a folder's name: "02_l_meso-3um" */
    } sweep;                             /**< of the file */

    /** Numbers to print beside ours; NaN where the case gives none. */
    struct {
        double paper_crack_length, measured_crack_length; /**< [m] */
        double zero_distance[2]; /**< where patches' forces vanish, least and greatest [m] */
        double contact_area[2];  /**< there, share of the area */
        double wet_area[2];      /**< there, share of the area */
        double asperities[2];    /**< in contact there, a patch */
    } reference;
} haft_case;

/** Reads and resolves `path`, the case.yaml of a case directory. All that is wrong is told at once,
 *  a line each, in the order of the file: "FILE:LINE:COLUMN: KEY: what is wrong; what would be
 *  right", and "and N more" where the message is full. A file that is no plain YAML document
 *  (syntax, anchors, tags, a second document, not UTF-8) is told by its first fault.
 *
 *  Absent: path, study.stop, output, reference, law.chaos and load.limit take their defaults
 *  (load_limit INFINITY, the reference NaN); contact.capillary means dry contact (has_capillary
 *  false, its fields 0); contact.vdw none of those forces (has_vdw false); beam.element_length is
 * required for a uniform mesh alone (else 0). mesh.active_from is half of load.crack_length.
 *  @return HAFT_ERROR_IO if it cannot be read, HAFT_ERROR_INPUT if it cannot be used. */
haft_status haft_case_read(haft_case **out, const char *path, haft_error *error) HAFT_MUST_CHECK;

/** Frees a case with all it owns and sets the pointer to NULL; NULL is allowed. */
void haft_case_destroy(haft_case **c);

/** Reads one variant of a case with a sweep,
 *
 *      sweep:
 *        beam.l_meso: [24 um, 12 um, 6 um]
 *        load.crack_length: [130 um, 130 um, 120 um]
 *
 *  numbers and choices by their dotted paths, lists of equal length: variant i takes the i-th value
 *  of each. haft_case_read() reads variant 0.
 *  @return HAFT_ERROR_ARGUMENT if there is no such variant; else as haft_case_read(). */
haft_status haft_case_read_variant(haft_case **out, const char *path, size_t variant,
                                   haft_error *error) HAFT_MUST_CHECK;

/** Moments of the case's PSD, whether by points or self-affine. */
haft_psd_moments haft_case_moments(const haft_case *c);

/** Correlation length of the case's PSD [m], to 1/e. Thread-safe. */
double haft_case_correlation_length(const haft_case *c);

/** Shall this realization leave evidence? */
bool haft_case_wants_evidence(const haft_case *c, size_t realization);

/** The forces that act in a case: those with a section of their own, or, if forces are chosen by
 *  humidity, the capillary alone from HAFT_VDW_HUMIDITY up, both below it, van der Waals alone at
 * 0; or one of the two, to see what it does by itself. Source: Hoang et al. (2017), Sec. 5. */
typedef struct haft_physics {
    bool capillary; /**< menisci */
    bool vdw;       /**< van der Waals forces */
    bool humid;     /**< the Hamaker constant is that through water */
} haft_physics;

/** Those of a case. Thread-safe. */
haft_physics haft_case_physics(const haft_case *c);

/** "capillary", "van der Waals", "capillary and van der Waals" or "contact alone". */
const char *haft_physics_name(haft_physics physics);

/** The limit push of a case's laws, as haft_law_limit() takes it. */
double haft_case_limit(const haft_case *c);

/** The last part of a swept key's path: "l_meso" of "beam.l_meso". */
const char *haft_sweep_leaf(const struct haft_case_sweep *sweep, size_t key);

/** A text as a case may hold it: in double quotes, with escapes for what YAML would take otherwise.
 *  @param[out] out to be freed with haft_memory_free(); NULL after a failure
 *  @param[in] text UTF-8
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_MEMORY. Thread-safe. */
haft_status haft_case_quote(char **out, const char *text, haft_error *error) HAFT_MUST_CHECK;

/** The resolved case as YAML that reads back to the same bits; the caller frees it with
 *  haft_memory_free(). */
haft_status haft_case_emit(char **text, const haft_case *c, haft_error *error) HAFT_MUST_CHECK;

/** Writes haft_case_emit()'s text to `path`, whole or not at all. */
haft_status haft_case_write(const haft_case *c, const char *path,
                            haft_error *error) HAFT_MUST_CHECK;

/** Digest of all that the surfaces of a stochastic sampler's patches depend on, and of how many
 *  there are: cases of the same digest read their laws off the same patches. */
haft_status haft_case_patches_digest(const haft_case *c, char digest[HAFT_DIGEST_CAPACITY],
                                     haft_error *error) HAFT_MUST_CHECK;

/** Digest of all that a law depends on (surface with the contents of the files it names, contact,
 * f_limit, the beam's width, l_meso, seed, the program's version; of a direct sampler which; of a
 * stochastic one law.chaos, whichever it is): what must not change for laws.h5 to stay valid. How
 * many beams there are, how long they are and where their active zone begins tells how many laws it
 * must hold, not what they are. */
haft_status haft_case_laws_digest(const haft_case *c, char digest[HAFT_DIGEST_CAPACITY],
                                  haft_error *error) HAFT_MUST_CHECK;

#ifdef __cplusplus
}
#endif
#endif
