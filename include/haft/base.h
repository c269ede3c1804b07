/* SPDX-License-Identifier: GPL-3.0-or-later */
/** @file base.h
 *  Status and error, memory, safe text, files, units, random streams, input digests: what every
 *  room stands on. */
#ifndef HAFT_BASE_H
#define HAFT_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** @def HAFT_PRINTF
 *  Has a compiler check arguments against a format, both told by their places from 1.
 *  @def HAFT_MUST_CHECK
 *  Has a compiler warn where a result is not looked at. */
#if defined(__GNUC__)
#define HAFT_PRINTF(format_index, first_argument)                                                  \
    __attribute__((format(printf, format_index, first_argument)))
#define HAFT_MUST_CHECK __attribute__((warn_unused_result))
#else
#define HAFT_PRINTF(format_index, first_argument)
#define HAFT_MUST_CHECK
#endif

/** 1 where a sanitizer that needs its runtime first is compiled in. */
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

/** Compiles a function for several widths of vector and chooses when the program starts. Products
 * are never fused with sums (-ffp-contract=off), so the bits are the same whichever is chosen. The
 * choice needs glibc's loader, and runs before a sanitizer is set up. For static functions alone,
 * each of a name of its own: Clang 14 makes their resolvers global, and links no other file to
 * clones. */
#if defined(__GLIBC__) && defined(__x86_64__) && defined(__GNUC__) &&                              \
    (!defined(__clang__) || __clang_major__ >= 14) && !HAFT_SANITIZED
#define HAFT_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define HAFT_CLONES /**< nothing, where the choice cannot be made */
#endif

/** A part of such functions, which goes into each of their clones: left to itself a compiler may
 *  make it one function, for the plainest processor. */
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
    HAFT_ERROR_INPUT,       /**< a case or data file holds something that cannot be used */
    HAFT_ERROR_IO,          /**< the operating system refused a read, a write or a rename */
    HAFT_ERROR_NUMERIC,     /**< a computation could not be completed to its tolerance */
    HAFT_ERROR_LIBRARY,     /**< a library beneath Haft failed */
    HAFT_ERROR_EXISTS,      /**< a result is there already and was not to be overwritten */
    HAFT_ERROR_INTERRUPTED, /**< the caller asked for an early end */
} haft_status;

/** Ends the calling function with the status of a call that fails. It frees nothing: a function
 * that owns something calls another for the steps that may fail, frees, and returns that one's
 * status. */
#define HAFT_TRY(call)                                                                             \
    do {                                                                                           \
        const haft_status try_status = (call);                                                     \
        if (try_status != HAFT_OK) {                                                               \
            return try_status;                                                                     \
        }                                                                                          \
    } while (0)

/** Capacity of an error message; longer ones are cut, and end in "...". */
#define HAFT_ERROR_CAPACITY 4096

/** One failure with its context, owned by the caller. */
typedef struct haft_error {
    haft_status status;                /**< what kind of failure */
    char message[HAFT_ERROR_CAPACITY]; /**< what happened, where, and what would do */
} haft_error;

/** Writes a message and returns `status`, so that `return haft_error_set(...)` reads well. The
 *  message is one line of valid UTF-8, safe to print: see haft_text_quote().
 *  @param[out] error may be NULL: then only the status is handed on
 *  @param[in] status other than HAFT_OK
 *  @param[in] format as printf() takes it, then its arguments
 *  Thread-safe for distinct errors. */
haft_status haft_error_set(haft_error *error, haft_status status, const char *format, ...)
    HAFT_PRINTF(3, 4);

/** Adds a line to the message that `error` holds already.
 *  @param[in,out] error may be NULL: then there is no room
 *  @param[in] spare bytes of the message's capacity to be left free after it
 *  @param[in] format as printf() takes it, then its arguments
 *  @return false, with nothing added, if there is no room for all of it */
bool haft_error_add(haft_error *error, size_t spare, const char *format, ...) HAFT_PRINTF(3, 4);

/** Puts text in front of the message that `error` holds already ("cases/a/case.yaml: ..."). */
void haft_error_prefix(haft_error *error, const char *format, ...) HAFT_PRINTF(2, 3);

/** A short name of a status ("input"), never NULL. */
const char *haft_status_name(haft_status status);

/** The program's version, "major.minor.patch". */
const char *haft_version(void);

/** The revision of the sources it was built from; "" if there is none. */
const char *haft_revision(void);

/** Allocates count * size zeroed bytes, aligned to 64 bytes.
 *  @return NULL after setting `error` on overflow or exhaustion; never NULL for a size of 0. */
void *haft_memory_alloc(size_t count, size_t size, haft_error *error) HAFT_MUST_CHECK;

/** Frees what haft_memory_alloc() gave; NULL is allowed. */
void haft_memory_free(void *memory);

/** Reads one UTF-8 character.
 *  @param[in] text its first byte
 *  @param[in] size bytes of the text
 *  @param[out] code its code point, where there is one
 *  @return its bytes, 0 if there is no valid character. Thread-safe. */
size_t haft_text_character(const char *text, size_t size, uint32_t *code);

/** Whether a character may stand in one line of text: no control character, line break or byte
 *  order mark. Thread-safe. */
bool haft_text_is_printable(uint32_t code);

/** Length of the blank that a text begins with: a space, a tab, or one of Unicode's spaces in UTF-8
 *  (no-break, narrow no-break, thin, figure, zero-width ...). Thread-safe.
 *  @param[in] text ends with a 0
 *  @return its bytes, 0 if the text begins with no blank */
size_t haft_text_blank(const char *text);

/** Bytes of one character as haft_text_spell() writes it, its final 0 included. */
#define HAFT_SPELLED_CAPACITY 12

/** Writes the next character of a text in a way that is safe to show: itself, or spelled out, as
 *  "\\n", "\\x1b" or "\\u202e", if it is a control character, a line break, a mark that turns the
 *  direction of text, or no valid UTF-8.
 *  @param[out] spelled the character and a 0
 *  @param[in] text its next byte
 *  @param[in] size bytes of the text, at least 1
 *  @return the bytes of the text that it stands for. Thread-safe. */
size_t haft_text_spell(char spelled[HAFT_SPELLED_CAPACITY], const char *text, size_t size);

/** Writes a text, character by character, in a way that is safe to show: one line of valid UTF-8
 *  that steers no terminal. Text that is safe already stays as it is.
 *  @param[out] out the text and a 0
 *  @param[in] capacity of `out`, at least 1
 *  @param[in] text any bytes
 *  @param[in] size how many
 *  @return false if it was cut, between two characters. Thread-safe. */
bool haft_text_quote(char *out, size_t capacity, const char *text, size_t size);

/** Opens a regular file for reading, without waiting: not a directory, pipe, device or socket.
 *  @param[out] descriptor to be closed with close(); -1 where it fails
 *  @param[out] size bytes of the file; may be NULL
 *  @param[in] path of the file
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_IO, with the file and the reason. Thread-safe. */
haft_status haft_file_open(int *descriptor, size_t *size, const char *path,
                           haft_error *error) HAFT_MUST_CHECK;

/** Reads a regular file whole.
 *  @param[out] bytes its bytes and a 0, to be freed with haft_memory_free(); NULL where it fails
 *  @param[out] size bytes of the file
 *  @param[in] path of the file
 *  @param[in] most bytes that it may have: nothing is read of a larger one
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_IO, HAFT_ERROR_INPUT if it is larger, HAFT_ERROR_MEMORY. Thread-safe. */
haft_status haft_file_read(char **bytes, size_t *size, const char *path, size_t most,
                           haft_error *error) HAFT_MUST_CHECK;
/** Scans the decimal number that a text begins with: [sign] digits [. digits] [e [sign] digits], in
 *  any locale; no hexadecimal number, "inf" or "nan". Thread-safe.
 *  @param[in] text begins with the number, without blanks before it
 *  @param[out] value the number; infinite or NaN where it is too large or too small for a double,
 *  or goes on as a hexadecimal one; unchanged where there is none
 *  @return how many characters the number has, 0 if there is none */
size_t haft_number_scan(const char *text, double *value);

/** Seconds since some fixed moment, by a clock that nobody sets. Thread-safe. */
double haft_clock_seconds(void);

/** Reads a text that is one finite decimal number and nothing else but blanks. Thread-safe.
 *  @param[in] text the text
 *  @param[out] value the number; unchanged on failure
 *  @return whether it is one */
bool haft_number_read(const char *text, double *value);

/** A units database (UDUNITS-2). Not thread-safe: one thread at a time. */
typedef struct haft_units haft_units;

/** Loads the database. @return HAFT_ERROR_LIBRARY where it is not installed. */
haft_status haft_units_create(haft_units **out, haft_error *error) HAFT_MUST_CHECK;

/** Frees it and sets the pointer to NULL; NULL is allowed. */
void haft_units_destroy(haft_units **units);

/** Reads a quantity, one decimal number and one unit: "600 um", "163 GPa", "289 rad/um",
 *  "6.46e3 nm^4", "85 %", "289 1/um".
 *  @param[in] units the database
 *  @param[in] text the number, then the unit: names with powers joined by blanks, '/', '*', '.' and
 *  parentheses, without factors ("nm 2"), origins ("K @ 20", "s since 1990") or logarithms; only
 *  "1/" may begin it; the unit may be missing only if `unit` is "1"
 *  @param[in] unit the unit wanted ("m", "Pa", "1"); its dimension must agree
 *  @param[out] value the quantity in `unit`, finite
 *  @param[out] error one message where it fails; may be NULL
 *  @return HAFT_ERROR_INPUT if the text is not of that form, is not finite, lacks its unit, has an
 *  unknown unit or one of another dimension; the message names what was read and what is wanted.
 *  HAFT_ERROR_MEMORY */
haft_status haft_units_parse(const haft_units *units, const char *text, const char *unit,
                             double *value, haft_error *error) HAFT_MUST_CHECK;

/** What a stream of random numbers is for: streams of distinct purposes never share numbers. */
typedef enum haft_random_purpose {
    HAFT_RANDOM_BEAM_SURFACE = 1, /**< noise under the surface of a whole beam */
    HAFT_RANDOM_PATCH_SURFACE,    /**< noise under independent patches */
    HAFT_RANDOM_TEST,             /**< tests and benches */
    HAFT_RANDOM_LAW_SAMPLE,       /**< laws drawn from the stochastic model */
    HAFT_RANDOM_MAP_WINDOW,       /**< windows of measured maps */
    HAFT_RANDOM_RESAMPLE,         /**< beams drawn or dealt anew, to learn what chance does */
    HAFT_RANDOM_MISSING_PIXELS,   /**< heights drawn where a map has none */
} haft_random_purpose;

/** Key of a counter-based stream: there is no state to carry or save. */
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

/** Standard normals z[0..n-1], number j of the stream being word (first + j) % 4 of draw
 *  (first + j) / 4 mapped by the quantile: any stretch of a stream can be had alone.
 *  Thread-safe. */
void haft_random_normals(haft_random_key key, uint64_t realization, uint64_t site, uint64_t first,
                         size_t n, double *z);

/** Characters of a digest, its final 0 included. */
#define HAFT_DIGEST_CAPACITY 33

/** The 128-bit XXH3 of a block of memory, as 32 lower-case hexadecimal digits. */
void haft_digest_memory(const void *data, size_t size, char digest[HAFT_DIGEST_CAPACITY]);

#ifdef __cplusplus
}
#endif
#endif
