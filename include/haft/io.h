/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file io.h
 *  Cases (strict YAML with units), laws and results (HDF5, written whole or not at all), parts of
 *  results (logs that grow while a run is at work), CSV.
 *
 *  Functions on laws and results call the serial HDF5 library, which is not thread-safe: one thread
 *  at a time in all of them together, distinct files or not. haft_case_read() loads a units
 *  database (see haft_units): one thread at a time too. The others are thread-safe.
 *
 *  A data file is HDF5 behind 512 bytes that hold its length and checksum; HDF5 skips them (they
 *  are a user block). But for /summary/seconds, the same contents make the same bytes. */
#ifndef HAFT_IO_H
#define HAFT_IO_H

#include "haft/beam.h"
#include "haft/chaos.h"
#include "haft/contact.h"
#include "haft/law.h"
#include "haft/solve.h"
#include "haft/surface.h"

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
    HAFT_FORCES_GIVEN, /**< the sections there are: contact.capillary, contact.vdw */
    HAFT_FORCES_AUTO   /**< the humidity, as in the paper: see haft_case_physics() */
} haft_forces;

/** Below this humidity van der Waals forces are counted, if forces are chosen by it. */
#define HAFT_VDW_HUMIDITY 0.55

/** A resolved case: defaults filled in, everything in SI. */
typedef struct haft_case {
    char name[HAFT_NAME_CAPACITY];
    char title[HAFT_TEXT_CAPACITY];
    uint64_t seed;

    struct {
        haft_psd psd;
        double grid_step;        /**< [m] */
        double kernel_tolerance; /**< energy the kernel's taper may take; default 1e-5 */
    } surface;

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
        double distance_from, distance_to,
            distance_step; /**< gaps at which f(d) is evaluated [m] */
    } contact;

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

    haft_beam_spec beam;
    haft_mesh_spec mesh; /**< load_position included */
    haft_programme programme;
    haft_path_options path;

    size_t realizations;

    /** When a run may end before all realizations are done. */
    struct {
        double crack_length_mean; /**< half width of the mean's interval that is enough [m]; 0: none
                                   */
        double confidence;        /**< of this and all other intervals; default 95 % */
    } stop;

    struct {
        bool all;
        size_t count;
        size_t *realization; /**< which realizations leave evidence; owned by the case */
    } evidence;

    haft_curves_kept curves;

    /** Which variant of the file's sweep this is; a variant is a plain case, and its resolved text
     *  knows nothing of the sweep. */
    struct haft_case_sweep {
        size_t variants; /**< in the file; 1 without a sweep */
        size_t variant;  /**< this one */
        size_t keys;     /**< varied; 0 without a sweep */
        const char *key[HAFT_SWEPT_KEYS_MAX], *unit[HAFT_SWEPT_KEYS_MAX];
        double value[HAFT_SWEPT_KEYS_MAX]; /**< in `unit`; a choice's place among the choices */
        char text[HAFT_SWEPT_KEYS_MAX][HAFT_SWEPT_TEXT_CAPACITY]; /**< as written, or its front */
        char label[HAFT_LABEL_CAPACITY]; /**< fit for a folder's name: "02_l_meso-3um" */
    } sweep;

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

/** Shall this realization leave evidence? */
bool haft_case_wants_evidence(const haft_case *c, size_t realization);

/** The forces that act in a case: those with a section of their own, or, if forces are chosen by
 *  humidity, the capillary alone from HAFT_VDW_HUMIDITY up, both below it, van der Waals alone at
 * 0. Source: Hoang et al. (2017), Sec. 5. */
typedef struct haft_physics {
    bool capillary, vdw;
    bool humid; /**< the Hamaker constant is that through water */
} haft_physics;
haft_physics haft_case_physics(const haft_case *c);

/** "capillary", "van der Waals", "capillary and van der Waals" or "contact alone". */
const char *haft_physics_name(haft_physics physics);

/** The limit push of a case's laws, as haft_law_limit() takes it. */
double haft_case_limit(const haft_case *c);

/** The last part of a swept key's path: "l_meso" of "beam.l_meso". */
const char *haft_sweep_leaf(const struct haft_case_sweep *sweep, size_t key);

/** The resolved case as YAML that reads back to the same bits; the caller frees it with
 *  haft_memory_free(). */
haft_status haft_case_emit(char **text, const haft_case *c, haft_error *error) HAFT_MUST_CHECK;

/** Writes haft_case_emit()'s text to `path`, whole or not at all. */
haft_status haft_case_write(const haft_case *c, const char *path,
                            haft_error *error) HAFT_MUST_CHECK;

/** Digest of all that a law depends on (surface, contact, f_limit, the beam's width, l_meso, seed,
 * the program's version; of a direct sampler which; of a stochastic one law.chaos, whichever it
 * is): what must not change for laws.h5 to stay valid. How many beams there are, how long they are
 * and where their active zone begins tells how many laws it must hold, not what they are. */
haft_status haft_case_laws_digest(const haft_case *c, char digest[HAFT_DIGEST_CAPACITY],
                                  haft_error *error) HAFT_MUST_CHECK;

/** Contents of laws.h5: m laws read off curves on n distances, the curves that are kept, and the
 *  stochastic model built from the laws, if there is one. */
typedef struct haft_laws {
    size_t m, n;
    size_t sites;             /**< laws a realization; m where a model was built from them */
    size_t first_site;        /**< law i of realization j is j * sites + i, and that of the site
                                   first_site + i: those before never come into range */
    double f_limit;           /**< as haft_law_limit() takes it */
    double *distance;         /**< n [m] */
    size_t curves;            /**< kept, <= m */
    int *curve_law;           /**< curves: which law each is of, rising; NULL: all are kept */
    double *force;            /**< curves x n [Pa] */
    haft_law_vector *vector;  /**< m; NaN where the fault forbids it */
    haft_law_fault *fault;    /**< m */
    double *zero_distance;    /**< m: zero-force distance [m], NaN if none */
    double *contact_area;     /**< m: there, share of the area */
    double *wet_area;         /**< m */
    double *asperities;       /**< m: in contact, a patch */
    haft_chaos *chaos;        /**< of the sound vectors; NULL without a model. Owned */
    haft_chaos_errors errors; /**< of its expansion */
    char origin[HAFT_DIGEST_CAPACITY]; /**< digest of the vectors it was fitted to; "" if built */
} haft_laws;

/** Digest of laws: haft_case_laws_digest(), and with it the origin where that is not "". */
haft_status haft_laws_identify(char digest[HAFT_DIGEST_CAPACITY], const haft_case *c,
                               const char *origin, haft_error *error) HAFT_MUST_CHECK;

/** Reads the digest and the origin of laws.h5 alone, and checks nothing but their shape. */
haft_status haft_laws_peek(char digest[HAFT_DIGEST_CAPACITY], char origin[HAFT_DIGEST_CAPACITY],
                           const char *path, haft_error *error) HAFT_MUST_CHECK;

/** @return HAFT_ERROR_MEMORY; a set without distances has NaN for what is read off curves. */
haft_status haft_laws_create(haft_laws **out, size_t m, size_t n,
                             haft_error *error) HAFT_MUST_CHECK;

/** The same with room for some of the curves alone, at most INT_MAX laws; curve_law is to be
 * filled in unless curves == m. */
haft_status haft_laws_create_sparse(haft_laws **out, size_t m, size_t curves, size_t n,
                                    haft_error *error) HAFT_MUST_CHECK;

/** The curve of law k, n forces; NULL if it is not kept. Thread-safe. */
const double *haft_laws_curve(const haft_laws *laws, size_t k);

/** A copy of the laws first .. first + count - 1 as one realization's, its first that of the same
 *  site as `first`. @param[in] keep [count] whose curves are to be kept, of those there are */
haft_status haft_laws_select(haft_laws **out, const haft_laws *laws, size_t first, size_t count,
                             const bool *keep, haft_error *error) HAFT_MUST_CHECK;

/** Puts realizations one after another: sets of one realization each, of as many sites on the same
 *  distances. The sets are used up, each destroyed as soon as it is copied. */
haft_status haft_laws_join(haft_laws **out, haft_laws **set, size_t count,
                           haft_error *error) HAFT_MUST_CHECK;
void haft_laws_destroy(haft_laws **laws);

/** Writes laws.h5 under a temporary name beside `path`, flushes it to the disk and renames it over
 *  what is there. Nothing is left behind by a failure. It is made in memory, at twice its size
 *  for a moment. @param[in] c its resolved text and digests go with it.
 *  @return HAFT_ERROR_ARGUMENT if m is no multiple of sites, HAFT_ERROR_IO (a full disk too),
 *  HAFT_ERROR_MEMORY or HAFT_ERROR_LIBRARY. */
haft_status haft_laws_write(const haft_laws *laws, const haft_case *c, const char *path,
                            haft_error *error) HAFT_MUST_CHECK;

/** Reads and checks laws.h5: checksum, signature, layout version, shapes, finiteness (forces and
 *  distances, and the vectors of sound laws). A file rewritten by another HDF5 tool has no checksum
 *  and is read without that guard.
 *  @param[out] digest may be NULL: the digest of the inputs it was built from.
 *  @return HAFT_ERROR_IO if it cannot be opened, HAFT_ERROR_INPUT if it is foreign or damaged; the
 *  message says how to build it anew. */
haft_status haft_laws_read(haft_laws **out, char digest[HAFT_DIGEST_CAPACITY], const char *path,
                           haft_error *error) HAFT_MUST_CHECK;

/** Reads law vectors from CSV. Its first line names the columns with their units, "e [mJ/m2]",
 * "f_max [MPa]", "d_max [nm]", "d_limit [nm]", in any order; other columns are passed over, save
 * that lines with anything but 0 under "fault" are left out: so the laws.csv of a case can be read.
 *  @param[out] vector [*m], SI; to be freed with haft_memory_free()
 *  @return HAFT_ERROR_IO, or HAFT_ERROR_INPUT with file, line and column name. Loads a units
 *  database: one thread at a time. */
haft_status haft_vectors_read(haft_law_vector **vector, size_t *m, const char *path,
                              haft_error *error) HAFT_MUST_CHECK;

/** One row of results.h5's /summary. */
typedef struct haft_summary {
    double crack_length; /**< after unloading [m]; the beam's length if free */
    double loaded_crack_length;
    double gamma;            /**< Eq. 36 [J/m^2]; 0 if free */
    double work, dissipated; /**< [J] */
    double internal_energy;  /**< strain energy at rest [J] */
    double end_influence;    /**< see haft_path.end_influence */
    double ledger_error;
    double seconds; /**< time taken; the one number that is not reproducible */
    int outcome;    /**< a haft_outcome */
    int jumps, steps;
    int unfit; /**< sites whose curve no Morse law fits */
} haft_summary;

/** A results file being written: one realization after another, in any order, by one thread at a
 *  time. Nothing shows under `path` before haft_results_finish(); until then all is held in memory
 *  (80 bytes a path point, 16 bytes a node and point of evidence; at the end twice that). A run
 *  keeps its realizations in parts and makes this file out of them at its end. */
typedef struct haft_results haft_results;

/** Makes the temporary file PATH.tmp.PID, so that a folder that cannot be written is told at once.
 *  @param[in] laws_digest may be NULL: unknown
 *  @param[in] overwrite false: HAFT_ERROR_EXISTS if `path` is there, before anything is written, or
 *  if another process has made it by the time of haft_results_finish(). */
haft_status haft_results_create(haft_results **out, const char *path, const haft_case *c,
                                const char *laws_digest, bool overwrite,
                                haft_error *error) HAFT_MUST_CHECK;

/** Adds /realizations/K: its path and jumps, and its evidence where the case asks for it (then the
 *  path must have kept its states). @param[in] laws, vectors one a site of the model
 *  @return HAFT_ERROR_ARGUMENT for a realization out of range or added before, or for evidence
 *  without states; any other failure lasts: only haft_results_abandon() is of use then. */
haft_status haft_results_add(haft_results *results, size_t realization, const haft_path *path,
                             const haft_model *model, const haft_law *laws,
                             const haft_law_vector *vectors, const haft_summary *summary,
                             haft_error *error) HAFT_MUST_CHECK;

/** Writes /summary (realizations never added carry NaN, and -1 for outcome and counts), flushes and
 *  renames. The handle is gone whatever comes of it; a failure leaves nothing behind. */
haft_status haft_results_finish(haft_results **results, haft_error *error) HAFT_MUST_CHECK;

/** Drops an unfinished file and its temporary name; NULL is allowed. */
void haft_results_abandon(haft_results **results);

/* ---- parts: the realizations of an unfinished run ---- */

/** One process's part of a run: a log FOLDER/part-RANK-NUMBER that grows by a checksummed record a
 *  realization. A process that is killed loses what it had not yet appended, no more. */
typedef struct haft_part haft_part;

/** Starts a new part; it never touches those that are there.
 *  @param[in] rank of the process in the run, for the name alone
 *  @return HAFT_ERROR_IO (nothing is left behind), HAFT_ERROR_MEMORY. Thread-safe. */
haft_status haft_part_create(haft_part **out, const char *folder, int rank, const haft_case *c,
                             const char *laws_digest, haft_error *error) HAFT_MUST_CHECK;

/** Appends one realization, whole or not at all, in any order. The kernel has it on return; the
 * disk within about a second of further appending, or at haft_part_close(). One thread at a time.
 *  @param[in] laws its own, a set of one realization; NULL where they are drawn from a model
 *  @param[in] dofs unknowns of a state, where the path kept its states
 *  @return HAFT_ERROR_IO (a full disk too): what was appended before stays whole. */
haft_status haft_part_append(haft_part *part, size_t realization, const haft_path *path,
                             size_t dofs, const haft_summary *summary, const haft_laws *laws,
                             haft_error *error) HAFT_MUST_CHECK;

/** Flushes to the disk and closes, and removes a part that holds nothing; NULL is allowed. The
 * handle is gone whatever comes of it. */
haft_status haft_part_close(haft_part **part, haft_error *error);

/** A folder of parts, held by one run at a time (flock). */
typedef struct haft_parts haft_parts;

/** Makes the folder if need be and takes it.
 *  @return HAFT_ERROR_EXISTS if another process holds it, HAFT_ERROR_IO, HAFT_ERROR_MEMORY. */
haft_status haft_parts_hold(haft_parts **out, const char *folder,
                            haft_error *error) HAFT_MUST_CHECK;

/** Gives the folder up, and removes it if no part is left in it; NULL is allowed. */
void haft_parts_release(haft_parts **parts);

/** Reads all parts and finds out which realizations they hold, each checked against its checksum.
 *  Torn tails and damaged records are told through `note` (may be NULL) with file and byte, and
 *  skipped; the rest is kept.
 *  @return HAFT_ERROR_INPUT if a part is of another case, other laws or another build of the
 *  program; the message says what differs. haft_parts_files() is right even then. */
haft_status haft_parts_scan(haft_parts *parts, const haft_case *c, const char *laws_digest,
                            void (*note)(void *user, const char *text), void *user,
                            haft_error *error) HAFT_MUST_CHECK;

/** How many part files, and how many realizations in them, the last scan found. */
size_t haft_parts_files(const haft_parts *parts);
size_t haft_parts_found(const haft_parts *parts);
bool haft_parts_has(const haft_parts *parts, size_t realization);

/** Reads one realization back; its states too, if they were kept.
 *  @param[out] laws may be NULL; *laws is NULL where none were kept with it
 *  @param[in] dofs unknowns a state must have */
haft_status haft_parts_read(haft_path **out, haft_summary *summary, haft_laws **laws,
                            const haft_parts *parts, size_t realization, size_t dofs,
                            haft_error *error) HAFT_MUST_CHECK;

/** Deletes all parts. */
haft_status haft_parts_clear(haft_parts *parts, haft_error *error) HAFT_MUST_CHECK;

/** What `haft plot` and `haft info` need of a results file. Reading it checks the whole file
 *  against its checksum; the readers of one realization check the length alone. */
typedef struct haft_results_view {
    size_t realizations;
    haft_summary *summary; /**< realizations */
    char *resolved_case;   /**< YAML text */
} haft_results_view;
haft_status haft_results_read(haft_results_view **out, const char *path,
                              haft_error *error) HAFT_MUST_CHECK;
void haft_results_view_destroy(haft_results_view **view);

/** Reads one realization's path and jumps back (no states). */
haft_status haft_results_read_path(haft_path **out, const char *path, size_t realization,
                                   haft_error *error) HAFT_MUST_CHECK;

/** Beam shapes kept as evidence. */
typedef struct haft_results_shapes {
    size_t points, nodes;
    double *node_x;     /**< nodes [m] */
    double *deflection; /**< points x nodes [m], towards the substrate */
    double *rotation;   /**< points x nodes */
} haft_results_shapes;

/** @return HAFT_ERROR_INPUT if that realization left no evidence; the message says how to ask. */
haft_status haft_results_read_shapes(haft_results_shapes **out, const char *path,
                                     size_t realization, haft_error *error) HAFT_MUST_CHECK;
void haft_results_shapes_destroy(haft_results_shapes **shapes);

/** Removes the temporary files of `path` (PATH.tmp.PID) whose processes are no more on this
 * machine. Thread-safe. */
void haft_io_drop_stale(const char *path);

/** Writes a text to `path`, whole or not at all. Thread-safe for distinct paths. */
haft_status haft_text_write(const char *path, const char *text, haft_error *error) HAFT_MUST_CHECK;

/** A column of a CSV file. */
typedef struct haft_csv_column {
    const char *name; /**< with its unit: "distance [nm]" */
    const double *value;
    size_t stride; /**< in doubles; 0 means 1 */
    double factor; /**< value is multiplied by this on writing; 0 means 1 */
} haft_csv_column;

/** Writes rows of columns as CSV, first line the names, numbers to 12 digits; whole or not at all
 *  (temporary name, rename). */
haft_status haft_csv_write(const char *path, size_t rows, size_t columns,
                           const haft_csv_column *column, haft_error *error) HAFT_MUST_CHECK;

#ifdef __cplusplus
}
#endif
#endif
