/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file io.h
 *  Reads and writes cases (strict YAML with units), laws and results (HDF5, written whole or not
 *  at all), parts of results (logs that grow during a run), and CSV.
 *
 *  Functions on laws and results call the serial HDF5 library, which is not thread-safe: one
 *  thread at a time in all of them together, distinct files or not. haft_case_read() loads a
 *  units database (see haft_units): one thread at a time too. The others are thread-safe.
 *
 *  A data file is HDF5 behind 512 bytes that hold its length and checksum; HDF5 skips them (they
 *  are a user block). Readers take a file whole into memory and verify its checksum before HDF5
 *  sees it. A file without a checksum (rewritten by another HDF5 tool) and a height map in HDF5
 *  are read in a child process; if that crashes or does not end, the file is refused as damaged.
 *  No reader follows soft or external links or reads data from other files. The same contents
 *  give the same bytes, except /summary/seconds. */
#ifndef HAFT_IO_H
#define HAFT_IO_H

#include "haft/chaos_laws.h"
#include "haft/io_case.h"
#include "haft/solve.h"
#include "haft/surface_map.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Digest of laws: haft_case_laws_digest(), combined with the origin unless that is "". */
haft_status haft_laws_identify(char digest[HAFT_DIGEST_CAPACITY], const haft_case *c,
                               const char *origin, haft_error *error) HAFT_MUST_CHECK;

/** Reads only the digest and the origin of laws.h5, after verifying its checksum. */
haft_status haft_laws_peek(char digest[HAFT_DIGEST_CAPACITY], char origin[HAFT_DIGEST_CAPACITY],
                           const char *path, haft_error *error) HAFT_MUST_CHECK;

/** Writes laws.h5 under a temporary name beside `path`, flushes it to the disk and renames it
 *  over what is there. A failure leaves nothing behind. The file is made in memory, which
 *  briefly takes twice its size.
 *  @param[in] laws what is written
 *  @param[in] c its resolved text and digests are stored too
 *  @param[in] path of laws.h5
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_ARGUMENT if m is not a multiple of sites, HAFT_ERROR_IO (including a full
 *  disk), HAFT_ERROR_MEMORY or HAFT_ERROR_LIBRARY. */
haft_status haft_laws_write(const haft_laws *laws, const haft_case *c, const char *path,
                            haft_error *error) HAFT_MUST_CHECK;

/** Reads and checks laws.h5: checksum, signature, layout version, shapes, finiteness (forces and
 *  distances, and the vectors of laws without a fault). A file that another HDF5 tool has rewritten
 *  has no checksum and is read in a child process.
 *  @param[out] out the laws; NULL after a failure
 *  @param[out] digest of the inputs that the laws were built from; may be NULL
 *  @param[in] path of laws.h5
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_IO if it cannot be opened, HAFT_ERROR_INPUT if it is of another format or
 *  damaged; the message says how to rebuild it. */
haft_status haft_laws_read(haft_laws **out, char digest[HAFT_DIGEST_CAPACITY], const char *path,
                           haft_error *error) HAFT_MUST_CHECK;

/** Reads law vectors from CSV. Its first line names the columns with their units, "e [mJ/m2]",
 *  "f_max [MPa]", "d_max [nm]", "d_limit [nm]", in any order. Other columns are ignored, except
 *  that lines with a "fault" other than 0 are left out: so the laws.csv of a case can be read.
 *  @param[out] vector [*m], SI; to be freed with haft_memory_free()
 *  @param[out] m number of vectors: the lines read, without those skipped
 *  @param[in] path of the CSV file
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_IO, or HAFT_ERROR_INPUT with file, line and column name. Loads a units
 *  database: one thread at a time. */
haft_status haft_vectors_read(haft_law_vector **vector, size_t *m, const char *path,
                              haft_error *error) HAFT_MUST_CHECK;

/** Facts that the file of a height map may lack. */
typedef struct haft_map_options {
    const char *channel; /**< by its name in the file, NULL or "": the first with heights; of
                              Nanoscope files "Height (retrace)" or "Height 2" too */
    double width;        /**< of the whole map along x [m], if its file does not give it; else 0 */
    double height;       /**< the same along y */
    double unit;         /**< of heights [m], if the file does not give it; else 0 */
    double lateral_unit; /**< of x and y columns [m]; else 0 */
} haft_map_options;

/** Reads a height map. Its format is recognised by its contents:
 *
 *  - Bruker (Veeco, Digital Instruments) Nanoscope, binary, 16 and 32 bit: heights are raw /
 *    2^bits * hard scale * sensitivity (new headers, `@2:Z scale: V [Sens. Zsens] (...) 24.6 V`)
 *    or raw / 2^16 * `Z scale` (old ones), or raw * `Z magnify image` / 655.36 nm (no version);
 *    two equal sides of `Scan size` are those of the frame, whose ratio and lines tell the map's
 *    height;
 *  - Gwyddion Simple Field (.gsf);
 *  - Gwyddion's own files (.gwy): the channel named by options->channel, by its title or number,
 *    or the only one whose unit is a length; a mask is not applied, which the map's note says;
 *  - NumPy arrays (.npy) of real or whole numbers, rows by columns, with size and unit from
 *    `options`;
 *  - text: a matrix under Gwyddion's `# Width:`, `# Height:`, `# Value units:` (English or
 *    German); a bare matrix, with size and unit from `options`; three columns x, y, z of points
 *    on a grid (in any order), assumed if `options` gives no size;
 *  - HDF5: a two-dimensional dataset named by options->channel, or the only one there is; the
 *    unit of heights from its text attribute `unit`, the size from its attribute `size` (width,
 *    height in m), either from `options` if it has none; NetCDF's `units`, `scale_factor`,
 *    `add_offset`, `_FillValue`, `missing_value` and valid range hold, and dimensions of length 1
 *    count for nothing.
 *
 *  For many other formats the message gives the name, and what to do.
 *
 *  Not-a-number is a missing pixel. Row 0 is the top of the image. Assumptions are reported in
 *  the map's note. Marks of missing pixels that the file does not declare (-9999, 1e38, a value
 *  further from the others than a thousand times their range) are refused.
 *  @param[out] out the map; NULL after a failure
 *  @param[in] path of the file
 *  @param[in] options may be NULL
 *  @param[out] digest of the file's bytes; may be NULL
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_IO if the file cannot be read; HAFT_ERROR_INPUT if it is foreign, damaged,
 *  cut short, or if neither it nor `options` gives units or size: the message says what is
 *  needed. Calls HDF5: one thread at a time. */
haft_status haft_map_read(haft_map **out, const char *path, const haft_map_options *options,
                          char digest[HAFT_DIGEST_CAPACITY], haft_error *error) HAFT_MUST_CHECK;

/** Writes a map as Gwyddion Simple Field (32-bit floating point), whole or not at all. */
haft_status haft_map_write(const haft_map *map, const char *path,
                           haft_error *error) HAFT_MUST_CHECK;

/** Writes a new file, whole or not at all.
 *  @param[in] path must not exist yet
 *  @param[in] data its bytes
 *  @param[in] size how many
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_EXISTS if `path` exists, HAFT_ERROR_IO. Thread-safe. */
haft_status haft_io_write(const char *path, const void *data, size_t size,
                          haft_error *error) HAFT_MUST_CHECK;

/** A results file that is being written, one realization after another, in any order, by one
 *  thread at a time. `path` does not exist before haft_results_finish(); until then everything
 *  is in memory (80 bytes per path point, 16 bytes per node and point of evidence; at the end
 *  twice that). A run keeps its realizations in parts and makes this file from them at its end. */
typedef struct haft_results haft_results;

/** Creates the temporary file PATH.tmp.PID, so that a folder without write permission is
 *  reported at once.
 *  @param[out] out the file being written; NULL after a failure
 *  @param[in] path of results.h5
 *  @param[in] c whose results
 *  @param[in] laws_digest may be NULL: unknown
 *  @param[in] overwrite false: HAFT_ERROR_EXISTS if `path` is there, before anything is written,
 *  or if another process has made it by the time of haft_results_finish().
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_results_create(haft_results **out, const char *path, const haft_case *c,
                                const char *laws_digest, bool overwrite,
                                haft_error *error) HAFT_MUST_CHECK;

/** Adds /realizations/K: its path and jumps, and its evidence if the case asks for it (then the
 *  path must have kept its states).
 *  @param[in,out] results the file
 *  @param[in] realization which
 *  @param[in] path it took
 *  @param[in] model haft_model_get() of the model it was followed on
 *  @param[in] laws, vectors one a site of the model; NULL where no evidence is asked for
 *  @param[in] summary its row of /summary
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_ARGUMENT for a realization out of range or added before, or for evidence
 *  without states; after any other failure only haft_results_abandon() may be called. */
haft_status haft_results_add(haft_results *results, size_t realization, const haft_path *path,
                             const haft_model_data *model, const haft_law *laws,
                             const haft_law_vector *vectors, const haft_summary *summary,
                             haft_error *error) HAFT_MUST_CHECK;

/** Writes /summary (NaN, and -1 for outcome and counts, for realizations that were not added),
 *  flushes and renames. Always frees the handle; a failure leaves nothing behind. */
haft_status haft_results_finish(haft_results **results, haft_error *error) HAFT_MUST_CHECK;

/** Discards an unfinished file and its temporary file; NULL is allowed. */
void haft_results_abandon(haft_results **results);

/* ---- parts: the realizations of an unfinished run ---- */

/** One process's part of a run: a log FOLDER/part-RANK-NUMBER, or FOLDER/part-IofN-RANK-NUMBER
 *  for a shard, that grows by a record with a checksum for each realization. A process that is
 *  killed loses only what it had not yet appended. */
typedef struct haft_part haft_part;

/** Starts a new part, without touching existing ones.
 *  @param[out] out the part; NULL after a failure
 *  @param[in] folder of parts, locked by haft_parts_hold()
 *  @param[in] shard, shards, rank of the process in the run, used only for the name; shard from 1
 *  to shards, or both 0 for the whole run
 *  @param[in] c, laws_digest the case and the laws of its realizations
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_IO (nothing is left behind), HAFT_ERROR_MEMORY. Thread-safe. */
haft_status haft_part_create(haft_part **out, const char *folder, size_t shard, size_t shards,
                             int rank, const haft_case *c, const char *laws_digest,
                             haft_error *error) HAFT_MUST_CHECK;

/** Appends one realization, whole or not at all, in any order. The record is with the kernel on
 *  return, and on the disk within about a second of further appending or at haft_part_close().
 *  One thread at a time.
 *  @param[in,out] part grows by a record
 *  @param[in] realization which
 *  @param[in] path, summary its results
 *  @param[in] laws its own, a set of one realization; NULL if they are drawn from a model
 *  @param[in] dofs unknowns of a state, if the path kept its states
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_IO (also for a full disk): earlier records stay whole. */
haft_status haft_part_append(haft_part *part, size_t realization, const haft_path *path,
                             size_t dofs, const haft_summary *summary, const haft_laws *laws,
                             haft_error *error) HAFT_MUST_CHECK;

/** Flushes to the disk and closes; removes an empty part. NULL is allowed. Always frees the
 *  handle. */
haft_status haft_part_close(haft_part **part, haft_error *error);

/** A folder of parts, locked (flock) by one run, or by any number of shards, each in one
 *  process. */
typedef struct haft_parts haft_parts;

/** Creates the folder if necessary, and locks it. A shard (1 to `shards`; both 0: the whole run)
 *  sees and clears its own parts alone.
 *  @return HAFT_ERROR_EXISTS if another process holds it or the shard, or if parts of another
 *  split are there; HAFT_ERROR_IO, HAFT_ERROR_MEMORY. */
haft_status haft_parts_hold(haft_parts **out, const char *folder, size_t shard, size_t shards,
                            haft_error *error) HAFT_MUST_CHECK;

/** Unlocks the folder, and removes it if no part is left in it; NULL is allowed. */
void haft_parts_release(haft_parts **parts);

/** Reads all parts and lists the realizations in them, each verified by its checksum. Incomplete
 *  and damaged records are reported through `note` (may be NULL) with file and byte, and
 *  skipped.
 *  @return HAFT_ERROR_INPUT if a part is of another case, other laws or another build of the
 *  program; the message says what differs. haft_parts_files() is valid even then. */
haft_status haft_parts_scan(haft_parts *parts, const haft_case *c, const char *laws_digest,
                            void (*note)(void *user, const char *text), void *user,
                            haft_error *error) HAFT_MUST_CHECK;

/** Number of part files that the last scan found. */
size_t haft_parts_files(const haft_parts *parts);

/** Number of realizations that it found in them. */
size_t haft_parts_found(const haft_parts *parts);

/** Number of records of realizations that it had already found; the first of each counts. */
size_t haft_parts_repeated(const haft_parts *parts);

/** Number of shards that the run is split into according to the parts; 0 if they do not belong
 *  to shards, or to different splits. */
size_t haft_parts_split(const haft_parts *parts);

/** Whether the last scan found this realization. */
bool haft_parts_has(const haft_parts *parts, size_t realization);

/** Reads one realization back, with its states if they were kept.
 *  @param[out] out its path; NULL after a failure
 *  @param[out] summary its row
 *  @param[out] laws may be NULL; *laws is NULL if none were kept with it
 *  @param[in] parts as scanned
 *  @param[in] realization for which haft_parts_has() is true
 *  @param[in] dofs unknowns a state must have
 *  @param[out] error one message where it fails; may be NULL */
haft_status haft_parts_read(haft_path **out, haft_summary *summary, haft_laws **laws,
                            const haft_parts *parts, size_t realization, size_t dofs,
                            haft_error *error) HAFT_MUST_CHECK;

/** Whether a folder holds parts, judged by the names of its files. Thread-safe. */
bool haft_parts_are_in(const char *folder);

/** Deletes all parts, one by one. Files of other names are never deleted. */
haft_status haft_parts_clear(haft_parts *parts, haft_error *error) HAFT_MUST_CHECK;

/** Deletes all parts atomically: the folder, locked by a run alone, is first renamed
 *  FOLDER.tmp.PID, so that a process killed meanwhile leaves all parts or none. A folder that
 *  also holds other files is not renamed, and its parts are deleted one by one. */
haft_status haft_parts_retire(haft_parts *parts, haft_error *error) HAFT_MUST_CHECK;

/** The parts of a results file that `haft plot` and `haft info` need. */
typedef struct haft_results_view {
    size_t realizations;   /**< of the case */
    haft_summary *summary; /**< realizations */
    char *resolved_case;   /**< YAML text */
    bool rewritten;        /**< by another program, without changing data */
} haft_results_view;

/** Reads the summary and the resolved case of results.h5.
 *  @return HAFT_ERROR_IO if it cannot be opened, HAFT_ERROR_INPUT if it is of another format or
 *  damaged. */
haft_status haft_results_read(haft_results_view **out, const char *path,
                              haft_error *error) HAFT_MUST_CHECK;

/** Frees a view and sets the pointer to NULL; NULL is allowed. */
void haft_results_view_destroy(haft_results_view **view);

/** Reads one realization's path and jumps back (no states). Reads and verifies the whole file:
 *  for many realizations, open it once. */
haft_status haft_results_read_path(haft_path **out, const char *path, size_t realization,
                                   haft_error *error) HAFT_MUST_CHECK;

/** A results file that is open for reading: verified, and completely in memory. */
typedef struct haft_results_file haft_results_file;

/** Reads results.h5 into memory and verifies it.
 *  @param[out] out the file; NULL after a failure
 *  @param[in] path of results.h5
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_IO if it cannot be opened, HAFT_ERROR_INPUT if it is of another format or
 *  damaged, HAFT_ERROR_MEMORY. */
haft_status haft_results_open(haft_results_file **out, const char *path,
                              haft_error *error) HAFT_MUST_CHECK;

/** Like haft_results_read_path(), but from an open file.
 *  @param[out] out the path; NULL after a failure
 *  @param[in] file from haft_results_open()
 *  @param[in] realization from 0
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_INPUT if that realization is missing or damaged, HAFT_ERROR_MEMORY. */
haft_status haft_results_take_path(haft_path **out, haft_results_file *file, size_t realization,
                                   haft_error *error) HAFT_MUST_CHECK;

/** Closes a file and sets the pointer to NULL; NULL is allowed. */
void haft_results_close(haft_results_file **file);

/** Beam shapes kept as evidence. */
typedef struct haft_results_shapes {
    size_t points;      /**< accepted states */
    size_t nodes;       /**< of the mesh */
    double *node_x;     /**< nodes [m] */
    double *deflection; /**< points x nodes [m], towards the substrate */
    double *rotation;   /**< points x nodes */
} haft_results_shapes;

/** @return HAFT_ERROR_INPUT if that realization has no evidence; the message says how to ask for
 *  it. */
haft_status haft_results_read_shapes(haft_results_shapes **out, const char *path,
                                     size_t realization, haft_error *error) HAFT_MUST_CHECK;

/** Frees shapes and sets the pointer to NULL; NULL is allowed. */
void haft_results_shapes_destroy(haft_results_shapes **shapes);

/** Removes the temporary files and folders of parts of `path` (PATH.tmp.PID, PATH.tmp.PID.N)
 *  whose processes no longer exist on this machine. Thread-safe. */
void haft_io_drop_stale(const char *path);

/** Writes a text to `path`, whole or not at all. Thread-safe for distinct paths. */
haft_status haft_text_write(const char *path, const char *text, haft_error *error) HAFT_MUST_CHECK;

/** Reads a text file whole. Removes a byte order mark, converts UTF-16 with such a mark to
 *  UTF-8, and a CR line end to LF. Thread-safe.
 *  @param[out] text its bytes and a 0, for haft_memory_free(); NULL on failure
 *  @param[out] size how many bytes there are before that 0
 *  @param[in] path a regular file without NUL characters
 *  @param[in] most largest number of bytes allowed
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_IO if it cannot be read whole, HAFT_ERROR_INPUT if it is longer than
 *  `most`, holds a NUL character or is no valid UTF-16 behind such a mark, HAFT_ERROR_MEMORY */
haft_status haft_text_read(char **text, size_t *size, const char *path, size_t most,
                           haft_error *error) HAFT_MUST_CHECK;

/** Takes the next line of a text, of any length, and replaces its line end (LF or CR LF; the
 *  last line may lack one) by a 0. Thread-safe for distinct texts.
 *  @param[in,out] rest the text that is left, at first all of it
 *  @return the line, NULL at the end of the text */
char *haft_text_line(char **rest);

/** A column of a CSV file. */
typedef struct haft_csv_column {
    const char *name;    /**< with its unit: "distance [nm]" */
    const double *value; /**< rows numbers, stride apart */
    size_t stride;       /**< in doubles; 0 means 1 */
    double factor;       /**< value is multiplied by this on writing; 0 means 1 */
} haft_csv_column;

/** Writes columns as CSV: the names in the first line, numbers to 12 digits; whole or not at all
 *  (temporary file, then rename). */
haft_status haft_csv_write(const char *path, size_t rows, size_t columns,
                           const haft_csv_column *column, haft_error *error) HAFT_MUST_CHECK;

#ifdef __cplusplus
}
#endif
#endif
