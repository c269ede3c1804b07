/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The resolved case as text, and the digest of the inputs of the laws. Both follow the schema: SI
 * units, 17 digits (which determine a double), keys in the table's order. */
#include "case.h"
#include "store.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const void *field_of(const haft_case *c, const haft_key *key) {
    return (const char *)c + key->offset;
}

/* Whether the key has a value to write. An optional number without a default may be absent. */
static bool is_present(const haft_case *c, const haft_key *key) {
    if (!c->contact.has_capillary && haft_case_is_member(key->path, "contact.capillary")) {
        return false;
    }
    if (!c->contact.has_vdw && haft_case_is_member(key->path, "contact.vdw")) {
        return false;
    }
    if (!c->contact.has_dispersion && haft_case_is_member(key->path, "contact.dispersion")) {
        return false;
    }
    if (!(c->contact.dispersion.oxide_thickness > 0) &&
        haft_case_is_member(key->path, "contact.dispersion.oxide")) {
        return false;
    }
    if (!haft_sampler_is_stochastic(c->law.sampler) &&
        haft_case_is_member(key->path, "law.chaos")) {
        return false;
    }
    if (!haft_case_has_part(c, key)) {
        return false;
    }
    if (key->fallback == NULL || strcmp(key->fallback, "none") != 0) {
        return true;
    }
    if (key->type == HAFT_KEY_FILES) {
        const haft_case_files *files = field_of(c, key);
        return files->count > 0;
    }
    double value = 0;
    memcpy(&value, field_of(c, key), sizeof value);
    bool zero = key->low < 0 || (key->low == 0 && key->low_in); /* then a 0 has been given */
    return isfinite(value) && (value != 0 || zero);
}

/* Writes a text in double quotes, with escapes for what YAML would misread or reject. */
static void write_quoted(FILE *stream, const char *text) {
    fputc('"', stream);
    for (const char *at = text; *at != '\0';) {
        uint32_t code = (unsigned char)*at;
        size_t n = haft_text_character(at, strlen(at), &code);
        n = n == 0 ? 1 : n;
        if (code == '"' || code == '\\') {
            fprintf(stream, "\\%c", (int)code);
        } else if (!haft_text_is_printable(code)) {
            fprintf(stream, code < 0x100 ? "\\x%02" PRIx32 : "\\u%04" PRIx32, code);
        } else {
            fwrite(at, 1, n, stream);
        }
        at += n;
    }
    fputc('"', stream);
}

static void write_real(FILE *stream, const haft_key *key, double value) {
    bool pure = strcmp(key->unit, "1") == 0;
    fprintf(stream, "%.17g%s%s", value, pure ? "" : " ", pure ? "" : key->unit);
}

static void write_reals(FILE *stream, const haft_key *key, const void *field) {
    double value[4];
    size_t n = key->count > 0 ? key->count : 1;
    memcpy(value, field, n * sizeof *value);
    fputs(key->count > 0 ? "[" : "", stream);
    for (size_t i = 0; i < n; i++) {
        fputs(i > 0 ? ", " : "", stream);
        write_real(stream, key, value[i]);
    }
    fputs(key->count > 0 ? "]" : "", stream);
}

static void write_evidence(FILE *stream, const haft_case *c) {
    if (c->evidence.all) {
        fputs("all", stream);
        return;
    }
    fputc('[', stream);
    for (size_t i = 0; i < c->evidence.count; i++) {
        fprintf(stream, "%s%zu", i > 0 ? ", " : "", c->evidence.realization[i]);
    }
    fputc(']', stream);
}

/* Writes paths, or, for the digest of the laws, the digests of the files' contents. */
static void write_files(FILE *stream, const haft_case_files *files, bool contents) {
    fputc('[', stream);
    for (size_t i = 0; i < files->count; i++) {
        fputs(i > 0 ? ", " : "", stream);
        write_quoted(stream, contents ? files->digest[i] : files->path[i]);
    }
    fputc(']', stream);
}

static void write_value(FILE *stream, const haft_case *c, const haft_key *key) {
    const void *field = field_of(c, key);
    switch (key->type) {
    case HAFT_KEY_NAME:
    case HAFT_KEY_TEXT:
        write_quoted(stream, field);
        break;
    case HAFT_KEY_SEED: {
        uint64_t value;
        memcpy(&value, field, sizeof value);
        fprintf(stream, "%" PRIu64, value);
        break;
    }
    case HAFT_KEY_COUNT: {
        size_t value;
        memcpy(&value, field, sizeof value);
        fprintf(stream, "%zu", value);
        break;
    }
    case HAFT_KEY_REAL:
        write_reals(stream, key, field);
        break;
    case HAFT_KEY_CHOICE: {
        int value;
        memcpy(&value, field, sizeof value);
        fputs(key->choices[value], stream);
        break;
    }
    case HAFT_KEY_EVIDENCE:
        write_evidence(stream, c);
        break;
    case HAFT_KEY_FILES:
        write_files(stream, field, false);
        break;
    }
}

/* Finds the section directly in `section` ("" for the top level) that contains a key at any depth.
 * Returns the length of its name in the key's path; 0 if the key lies in `section` itself. */
static size_t inner_section(const char *path, const char *section, size_t length) {
    size_t skip = length > 0 ? length + 1 : 0;
    const char *dot = strncmp(path, section, length) == 0 ? strchr(path + skip, '.') : NULL;
    return dot == NULL ? 0 : (size_t)(dot - path);
}

static bool lies_in(const haft_key *key, const char *section, size_t length) {
    return length == 0 || (strncmp(key->path, section, length) == 0 && key->path[length] == '.');
}

/* Writes a whole section at its first key, so that each section is opened once, even if its keys
 * are not adjacent in the schema. The first `length` characters of `section` name it. */
static void write_section(FILE *stream, const haft_case *c, const char *section, size_t length,
                          int depth) {
    for (size_t i = 0; i < haft_case_key_count; i++) {
        const haft_key *key = &haft_case_keys[i];
        if (!lies_in(key, section, length) || !is_present(c, key)) {
            continue;
        }
        size_t inner = inner_section(key->path, section, length);
        if (inner == 0) {
            fprintf(stream, "%*s%s: ", 2 * depth, "", haft_case_leaf(key->path));
            write_value(stream, c, key);
            fputc('\n', stream);
            continue;
        }
        bool first = true;
        for (size_t k = 0; k < i && first; k++) {
            first = !lies_in(&haft_case_keys[k], key->path, inner) ||
                    !is_present(c, &haft_case_keys[k]);
        }
        if (first) {
            size_t skip = length > 0 ? length + 1 : 0;
            fprintf(stream, "%*s%.*s:\n", 2 * depth, "", (int)(inner - skip), key->path + skip);
            write_section(stream, c, key->path, inner, depth + 1);
        }
    }
}

static void write_case(FILE *stream, const haft_case *c) {
    write_section(stream, c, "", 0, 0);
}

static void write_input(FILE *stream, const haft_case *c, const haft_key *key) {
    fprintf(stream, "%s: ", key->path);
    if (key->type == HAFT_KEY_FILES) {
        write_files(stream, field_of(c, key), true);
    } else {
        write_value(stream, c, key);
    }
    fputc('\n', stream);
}

/* Whether a key affects only how a law is computed from a patch, not the patch. */
static bool is_read_off(const haft_key *key) {
    bool law = strncmp(key->path, "law.", strlen("law.")) == 0;
    return strncmp(key->path, "contact.", strlen("contact.")) == 0 ||
           (law && strcmp(key->path, "law.chaos.vectors") != 0);
}

/* Writes the inputs of the laws, one per line, or only those of the patches. The program's version
 * is among them, since a new version may compute other laws. */
static void write_inputs(FILE *stream, const haft_case *c, bool patches) {
    bool stochastic = haft_sampler_is_stochastic(c->law.sampler);
    haft_laws_need other = stochastic ? HAFT_LAWS_CHAOS : HAFT_LAWS_DIRECT;
    fprintf(stream, "haft: %s\n", haft_version());
    for (size_t i = 0; i < haft_case_key_count; i++) {
        const haft_key *key = &haft_case_keys[i];
        bool counts = key->laws == HAFT_LAWS_ALWAYS || key->laws == (int)other;
        if (counts && is_present(c, key) && !(patches && is_read_off(key))) {
            write_input(stream, c, key);
        }
    }
}

static void write_laws_inputs(FILE *stream, const haft_case *c) {
    write_inputs(stream, c, false);
}

static void write_patch_inputs(FILE *stream, const haft_case *c) {
    write_inputs(stream, c, true);
}

/* Runs a writer on a memory stream; *text belongs to the stream, to be freed with free(). */
static haft_status write_text(char **text, size_t *size, const haft_case *c,
                              void (*write)(FILE *, const haft_case *), haft_error *error) {
    FILE *stream = open_memstream(text, size);
    if (stream == NULL) {
        return haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for a case's text");
    }
    write(stream, c);
    bool failed = ferror(stream) != 0;
    failed = fclose(stream) != 0 || failed || *text == NULL; /* the last write may fail here */
    if (failed) {
        free(*text);
        *text = NULL;
        return haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for a case's text");
    }
    return HAFT_OK;
}

haft_status haft_case_quote(char **out, const char *text, haft_error *error) {
    char *written = NULL;
    size_t size = 0;
    *out = NULL;
    FILE *stream = open_memstream(&written, &size);
    if (stream != NULL) {
        write_quoted(stream, text);
    }
    bool good = stream != NULL && fclose(stream) == 0 && written != NULL;
    *out = good ? haft_memory_alloc(size + 1, 1, error) : NULL;
    if (*out != NULL) {
        memcpy(*out, written, size);
    } else if (!good) {
        haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for a text");
    }
    free(written);
    return *out == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
}

bool haft_case_wants_evidence(const haft_case *c, size_t realization) {
    for (size_t i = 0; i < c->evidence.count && !c->evidence.all; i++) {
        if (c->evidence.realization[i] == realization) {
            return true;
        }
    }
    return c->evidence.all;
}

haft_status haft_case_emit(char **text, const haft_case *c, haft_error *error) {
    *text = NULL;
    char *written = NULL;
    size_t size = 0;
    HAFT_TRY(write_text(&written, &size, c, write_case, error));
    *text = haft_memory_alloc(size + 1, 1, error);
    if (*text != NULL) {
        memcpy(*text, written, size);
    }
    free(written);
    return *text == NULL ? HAFT_ERROR_MEMORY : HAFT_OK;
}

static haft_status digest_text(const haft_case *c, void (*write)(FILE *, const haft_case *),
                               char digest[HAFT_DIGEST_CAPACITY], haft_error *error) {
    char *written = NULL;
    size_t size = 0;
    haft_status status = write_text(&written, &size, c, write, error);
    if (status == HAFT_OK) {
        haft_digest_memory(written, size, digest);
        free(written);
    }
    return status;
}

haft_status haft_case_laws_digest(const haft_case *c, char digest[HAFT_DIGEST_CAPACITY],
                                  haft_error *error) {
    return digest_text(c, write_laws_inputs, digest, error);
}

haft_status haft_case_patches_digest(const haft_case *c, char digest[HAFT_DIGEST_CAPACITY],
                                     haft_error *error) {
    return digest_text(c, write_patch_inputs, digest, error);
}

haft_status haft_case_write(const haft_case *c, const char *path, haft_error *error) {
    char *text = NULL;
    haft_status status = haft_case_emit(&text, c, error);
    HAFT_THEN(status, haft_store_put(path, text, strlen(text), error));
    haft_memory_free(text);
    return status;
}
