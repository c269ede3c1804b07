/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file base.h
 *  Status and error, memory, safe text, files, units, random streams and input digests. Every room
 *  uses them. */
#ifndef HAFT_BASE_H
#define HAFT_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** @def HAFT_PRINTF
 *  Makes the compiler check arguments against a format; both are given by position, from 1.
 *  @def HAFT_MUST_CHECK
 *  Makes the compiler warn about an unused result. */
#if defined(__GNUC__)
#define HAFT_PRINTF(format_index, first_argument)                                                  \
    __attribute__((format(printf, format_index, first_argument)))
#define HAFT_MUST_CHECK __attribute__((warn_unused_result))
#else
#define HAFT_PRINTF(format_index, first_argument)
#define HAFT_MUST_CHECK
#endif

/** 1 if the address sanitizer is compiled in, whose runtime must start first. */
#if defined(__SANITIZE_ADDRESS__)
#define HAFT_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define HAFT_SANITIZED 1
#endif
#endif
#ifndef HAFT_SANITIZED
#define HAFT_SANITIZED 0
#endif

/** Compiles a function for several SIMD widths; the loader chooses one when the program starts.
 *  Products and sums are never fused (-ffp-contract=off), so all versions give the same bits. The
 *  choice needs glibc's loader. It runs before a sanitizer is set up, so sanitizers exclude it. Use
 *  it only for static functions with unique names: Clang 14 makes their resolvers global, and
 *  cannot link clones from another file. */
#if defined(__GLIBC__) && defined(__x86_64__) && defined(__GNUC__) &&                              \
    (!defined(__clang__) || __clang_major__ >= 14) && !HAFT_SANITIZED
#define HAFT_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define HAFT_CLONES /**< empty where the loader cannot choose */
#endif

/** Inlines a helper into each clone of such functions. Otherwise a compiler may keep it as one
 *  function, compiled for the baseline processor. */
#if defined(__GNUC__)
#define HAFT_INLINE static inline __attribute__((always_inline))
#else
#define HAFT_INLINE static inline
#endif

/** Numbers that a loop of vector code takes at once: enough for two vectors of any processor. */
enum { HAFT_SIMD_WIDTH = 8 };

/** The length of an array of n numbers that loops go through in groups of HAFT_SIMD_WIDTH, from
 *  any of its elements on. */
static inline size_t haft_simd_padded(size_t n) {
    return (n + 2 * HAFT_SIMD_WIDTH - 1) / HAFT_SIMD_WIDTH * HAFT_SIMD_WIDTH;
}

/** What a fallible function returns; HAFT_OK is 0 and everything else is a failure. */
typedef enum haft_status {
    HAFT_OK = 0,
    HAFT_ERROR_MEMORY,      /**< an allocation failed or its size overflows */
    HAFT_ERROR_ARGUMENT,    /**< a caller broke a function's stated preconditions */
    HAFT_ERROR_INPUT,       /**< a case or data file has invalid contents */
    HAFT_ERROR_IO,          /**< the operating system refused a read, a write or a rename */
    HAFT_ERROR_NUMERIC,     /**< a computation could not be completed to its tolerance */
    HAFT_ERROR_LIBRARY,     /**< a library that Haft uses failed */
    HAFT_ERROR_EXISTS,      /**< a result exists already and must not be overwritten */
    HAFT_ERROR_INTERRUPTED, /**< the caller asked to stop early */
} haft_status;

/** Returns from the calling function with the status of a call that fails. It frees nothing: in a
 *  function that owns memory use HAFT_THEN(). */
#define HAFT_TRY(call)                                                                             \
    do {                                                                                           \
        const haft_status try_status = (call);                                                     \
        if (try_status != HAFT_OK) {                                                               \
            return try_status;                                                                     \
        }                                                                                          \
    } while (0)

/** The next step of a function that frees what it owns at its end: a call that is made only while
 *  `status` is HAFT_OK, and sets it. */
#define HAFT_THEN(status, call)                                                                    \
    do {                                                                                           \
        if ((status) == HAFT_OK) {                                                                 \
            (status) = (call);                                                                     \
        }                                                                                          \
    } while (0)

/** Capacity of an error message; longer ones are cut, and end in "...". */
#define HAFT_ERROR_CAPACITY 4096

/** One failure with its context, owned by the caller. */
typedef struct haft_error {
    haft_status status;                /**< what kind of failure */
    char message[HAFT_ERROR_CAPACITY]; /**< what happened, where, and what would be valid */
} haft_error;

/** Writes a message and returns `status`, so that `return haft_error_set(...)` reads well. The
 *  message is one line of valid UTF-8, safe to print: see haft_text_quote().
 *  @param[out] error may be NULL: then only the status is returned
 *  @param[in] status other than HAFT_OK
 *  @param[in] format printf() format, then its arguments
 *  Thread-safe for distinct errors. */
haft_status haft_error_set(haft_error *error, haft_status status, const char *format, ...)
    HAFT_PRINTF(3, 4);

/** Appends a line to the message in `error`.
 *  @param[in,out] error may be NULL: then the result is false
 *  @param[in] spare bytes of the message's capacity to leave free after it
 *  @param[in] format printf() format, then its arguments
 *  @return false, with nothing added, if there is no room for all of it */
bool haft_error_add(haft_error *error, size_t spare, const char *format, ...) HAFT_PRINTF(3, 4);

/** Prepends text to the message in `error` ("cases/a/case.yaml: ..."). */
void haft_error_prefix(haft_error *error, const char *format, ...) HAFT_PRINTF(2, 3);

/** A short name of a status ("input"), never NULL. */
const char *haft_status_name(haft_status status);

/** The program's version, "major.minor.patch". */
const char *haft_version(void);

/** The source revision of the build; "" if unknown. */
const char *haft_revision(void);

/** Allocates count * size zeroed bytes, aligned to 64 bytes.
 *  @return NULL, with `error` set, if the size overflows or memory is exhausted; never NULL for a
 *  size of 0. */
void *haft_memory_alloc(size_t count, size_t size, haft_error *error) HAFT_MUST_CHECK;

/** Frees memory from haft_memory_alloc(); NULL is allowed. */
void haft_memory_free(void *memory);

/** Reads one UTF-8 character.
 *  @param[in] text its first byte
 *  @param[in] size bytes of the text
 *  @param[out] code its code point; unchanged if it is invalid
 *  @return the number of its bytes; 0 if the character is invalid. Thread-safe. */
size_t haft_text_character(const char *text, size_t size, uint32_t *code);

/** Whether a character may be part of a line of text: not a control character, line break or byte
 *  order mark. Thread-safe. */
bool haft_text_is_printable(uint32_t code);

/** Length of the blank at the start of a text: a space, a tab, or one of Unicode's spaces in UTF-8
 *  (no-break, narrow no-break, thin, figure, zero-width ...). Thread-safe.
 *  @param[in] text terminated by a 0
 *  @return the number of its bytes; 0 if there is no blank */
size_t haft_text_blank(const char *text);

/** Bytes of one character as haft_text_spell() writes it, including the final 0. */
#define HAFT_SPELLED_CAPACITY 12

/** Writes the next character of a text so that it is safe to print: unchanged, or escaped as "\\n",
 *  "\\x1b" or "\\u202e" if it is a control character, a line break, a mark that changes the
 *  direction of text, or invalid UTF-8.
 *  @param[out] spelled the character and a 0
 *  @param[in] text its next byte
 *  @param[in] size bytes of the text, at least 1
 *  @return the number of bytes that it takes in the text. Thread-safe. */
size_t haft_text_spell(char spelled[HAFT_SPELLED_CAPACITY], const char *text, size_t size);

/** Writes a text so that it is safe to print: one line of valid UTF-8 without terminal control
 *  sequences. Safe text stays unchanged.
 *  @param[out] out the text and a 0
 *  @param[in] capacity of `out`, at least 1
 *  @param[in] text any bytes
 *  @param[in] size number of bytes
 *  @return false if the text was cut; a cut is always between two characters. Thread-safe. */
bool haft_text_quote(char *out, size_t capacity, const char *text, size_t size);

/** Writes "FOLDER/NAME" into path[capacity].
 *  @return HAFT_ERROR_IO if it does not fit. Thread-safe. */
haft_status haft_path_join(char *path, size_t capacity, const char *folder, const char *name,
                           haft_error *error) HAFT_MUST_CHECK;

/** Opens a regular file for reading without blocking. A directory, pipe, device or socket is an
 *  error.
 *  @param[out] descriptor to be closed with close(); -1 on failure
 *  @param[out] size bytes of the file; may be NULL
 *  @param[in] path of the file
 *  @param[out] error one message on failure; may be NULL
 *  @return HAFT_ERROR_IO; the message names the file and the reason. Thread-safe. */
haft_status haft_file_open(int *descriptor, size_t *size, const char *path,
                           haft_error *error) HAFT_MUST_CHECK;

/** Reads a whole regular file.
 *  @param[out] bytes its bytes and a 0, to be freed with haft_memory_free(); NULL on failure
 *  @param[out] size bytes of the file
 *  @param[in] path of the file
 *  @param[in] most largest size in bytes; a larger file is not read
 *  @param[out] error one message on failure; may be NULL
 *  @return HAFT_ERROR_IO, HAFT_ERROR_INPUT if the file is too large, HAFT_ERROR_MEMORY.
 *  Thread-safe. */
haft_status haft_file_read(char **bytes, size_t *size, const char *path, size_t most,
                           haft_error *error) HAFT_MUST_CHECK;
/** Scans the decimal number at the start of a text: [sign] digits [. digits] [e [sign] digits], in
 *  any locale. It does not accept hexadecimal numbers, "inf" or "nan". Thread-safe.
 *  @param[in] text starts with the number, without leading blanks
 *  @param[out] value the number; infinite if it is too large for a double, NaN if it is too small
 *  or continues as a hexadecimal number; unchanged if there is none
 *  @return the number of characters, 0 if there is no number */
size_t haft_number_scan(const char *text, double *value);

/** A function whose root is sought.
 *  @param[in] data as handed to haft_root_find()
 *  @param[in] x where it is asked for
 *  @param[out] slope its derivative there; NaN where it is not known
 *  @return its value */
typedef double (*haft_root_function)(const void *data, double x, double *slope);

/** The root of a function that changes sign once between `low` and `high`: by Newton's steps, and
 *  by bisection where one would leave the bracket or the slope is NaN. To rounding of the function.
 *  @param[in] function whose root it is
 *  @param[in] data handed to it
 *  @param[in] low, high the bracket; the function is not asked for there
 *  @param[in] rises whether it is positive at `high`
 *  Thread-safe if the function is. */
double haft_root_find(haft_root_function function, const void *data, double low, double high,
                      bool rises);

/** Seconds since an arbitrary fixed moment, by a monotonic clock. Thread-safe. */
double haft_clock_seconds(void);

/** Reads a text that contains one finite decimal number and otherwise only blanks. Thread-safe.
 *  @param[in] text the text
 *  @param[out] value the number; unchanged on failure
 *  @return whether the text is such a number */
bool haft_number_read(const char *text, double *value);

/** A units database (UDUNITS-2). Not thread-safe: one thread at a time. */
typedef struct haft_units haft_units;

/** Loads the database. @return HAFT_ERROR_LIBRARY if it is not installed. */
haft_status haft_units_create(haft_units **out, haft_error *error) HAFT_MUST_CHECK;

/** Frees the database and sets the pointer to NULL; NULL is allowed. */
void haft_units_destroy(haft_units **units);

/** Reads a quantity, which is one decimal number and one unit: "600 um", "163 GPa", "289 rad/um",
 *  "6.46e3 nm^4", "85 %", "289 1/um".
 *  @param[in] units the database
 *  @param[in] text the number, then the unit: names with powers, joined by blanks, '/', '*', '.'
 *  and parentheses, without factors ("nm 2"), origins ("K @ 20", "s since 1990") or logarithms. The
 *  only number at its start may be the 1 of "1/". The unit may be missing only if `unit` is "1"
 *  @param[in] unit the unit wanted ("m", "Pa", "1"); its dimension must agree
 *  @param[out] value the quantity in `unit`, finite
 *  @param[out] error one message on failure; may be NULL
 *  @return HAFT_ERROR_INPUT if the text does not have this form, is not finite, or has a missing or
 *  unknown unit or one of another dimension; the message names what was read and what is wanted.
 *  HAFT_ERROR_MEMORY */
haft_status haft_units_parse(const haft_units *units, const char *text, const char *unit,
                             double *value, haft_error *error) HAFT_MUST_CHECK;

/** The purpose of a stream of random numbers. Streams of distinct purposes never share numbers. */
typedef enum haft_random_purpose {
    HAFT_RANDOM_BEAM_SURFACE = 1, /**< noise under the surface of a whole beam */
    HAFT_RANDOM_PATCH_SURFACE,    /**< noise under independent patches */
    HAFT_RANDOM_TEST,             /**< tests and benches */
    HAFT_RANDOM_LAW_SAMPLE,       /**< laws drawn from the stochastic model */
    HAFT_RANDOM_MAP_WINDOW,       /**< windows of measured maps */
    HAFT_RANDOM_RESAMPLE, /**< beams resampled or permuted, to estimate the effect of chance */
    HAFT_RANDOM_MISSING_PIXELS, /**< heights drawn for missing pixels */
} haft_random_purpose;

/** Key of a counter-based stream, which has no state to carry or save. */
typedef struct haft_random_key {
    uint64_t seed;    /**< the case's */
    uint64_t purpose; /**< a haft_random_purpose */
} haft_random_key;

/** Four 64-bit words, Philox4x64-10 of counter (realization, site, draw, 0).
 *  Source: Salmon, Moraes, Dror, Shaw (2011). Thread-safe. */
void haft_random_words(haft_random_key key, uint64_t realization, uint64_t site, uint64_t draw,
                       uint64_t words[4]);

/** A uniform number in the open interval (0, 1), from the upper 53 bits of a word. */
double haft_random_uniform(uint64_t word);

/** The standard normal quantile, Phi^-1(p) for 0 < p < 1, to 1e-15 relative.
 *  Source: Wichura (1988), algorithm AS 241 (PPND16). Thread-safe. */
double haft_random_normal_quantile(double p);

/** Standard normals z[0..n-1]. z[j] is word (first + j) % 4 of draw (first + j) / 4, mapped by the
 *  quantile, so any part of a stream can be computed alone.
 *  Thread-safe. */
void haft_random_normals(haft_random_key key, uint64_t realization, uint64_t site, uint64_t first,
                         size_t n, double *z);

/** Characters of a digest, including the final 0. */
#define HAFT_DIGEST_CAPACITY 33

/** The 128-bit XXH3 of a block of memory, as 32 lower-case hexadecimal digits. */
void haft_digest_memory(const void *data, size_t size, char digest[HAFT_DIGEST_CAPACITY]);

#ifdef __cplusplus
}
#endif
#endif
