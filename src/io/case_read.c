/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads a checked document against the schema: first each key into its field, or a complaint; then
 * the missing keys; then the checks that need several keys. */
#include "case_text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- the document against the schema ---- */

static const char *kind_of(const yaml_node_t *node) {
    return node->type == YAML_MAPPING_NODE ? "a mapping" : "a list";
}

static bool make_evidence(haft_case_reader *reader, size_t n) {
    reader->c->evidence.realization = haft_memory_alloc(n, sizeof(size_t), reader->error);
    reader->evidence_mark = haft_memory_alloc(n, sizeof(haft_mark), reader->error);
    if (reader->c->evidence.realization == NULL || reader->evidence_mark == NULL) {
        reader->failure = HAFT_ERROR_MEMORY;
        return false;
    }
    return true;
}

static bool read_list(haft_case_reader *reader, yaml_document_t *document, int key,
                      const yaml_node_t *node) {
    const haft_key *k = &haft_case_keys[key];
    const yaml_node_item_t *item = node->data.sequence.items.start;
    size_t n = (size_t)(node->data.sequence.items.top - item);
    haft_mark mark = haft_case_mark_of(node->start_mark);
    if (k->type == HAFT_KEY_REAL && n != k->count) {
        haft_case_complain(reader, mark, k->path, "has %zu entries; give %zu, as in \"%s: %s\"", n,
                           k->count, haft_case_leaf(k->path), k->example);
        return false;
    }
    if (k->type == HAFT_KEY_FILES && (n < 1 || n > k->count)) {
        haft_case_complain(reader, mark, k->path, "has %zu entries; give 1 to %zu files", n,
                           k->count);
        return false;
    }
    if (k->type == HAFT_KEY_EVIDENCE && n > HAFT_EVIDENCE_LIMIT) {
        haft_case_complain(reader, mark, k->path, "has %zu entries; give %d at most, or all", n,
                           HAFT_EVIDENCE_LIMIT);
        return false;
    }
    if (k->type == HAFT_KEY_EVIDENCE && n > 0 && !make_evidence(reader, n)) {
        return false;
    }
    bool good = true;
    for (size_t i = 0; i < n && good; i++) {
        const yaml_node_t *entry = yaml_document_get_node(document, item[i]);
        haft_mark place = haft_case_mark_of(entry->start_mark);
        if (entry->type != YAML_SCALAR_NODE) {
            haft_case_complain(reader, place, k->path, "holds %s; write it as in \"%s: %s\"",
                               kind_of(entry), haft_case_leaf(k->path), k->example);
            good = false;
        } else {
            good = haft_case_store(reader, key, i, (const char *)entry->data.scalar.value,
                                   entry->data.scalar.length, place);
        }
    }
    return good;
}

static bool read_value(haft_case_reader *reader, yaml_document_t *document, int key,
                       const yaml_node_t *node) {
    const haft_key *k = &haft_case_keys[key];
    haft_mark mark = haft_case_mark_of(node->start_mark);
    bool takes_list = k->type == HAFT_KEY_EVIDENCE || (k->count > 0 && k->type != HAFT_KEY_FILES);
    if (node->type == YAML_SEQUENCE_NODE && (takes_list || k->type == HAFT_KEY_FILES)) {
        return read_list(reader, document, key, node);
    }
    if (node->type != YAML_SCALAR_NODE) {
        haft_case_complain(reader, mark, k->path, "is %s; write it as in \"%s: %s\"", kind_of(node),
                           haft_case_leaf(k->path), k->example);
        return false;
    }
    const char *text = (const char *)node->data.scalar.value;
    if (k->type == HAFT_KEY_EVIDENCE && strcmp(text, "all") == 0) {
        reader->c->evidence.all = true;
        return true;
    }
    if (takes_list) {
        haft_case_complain(
            reader, mark, k->path, "\"%.60s\" is no list; write it as in \"%s: %s\"%s", text,
            haft_case_leaf(k->path), k->example, k->type == HAFT_KEY_EVIDENCE ? ", or all" : "");
        return false;
    }
    return haft_case_store(reader, key, 0, text, node->data.scalar.length, mark);
}

/* Complains of a key that is not in the schema, and suggests the nearest key or the right section.
 */
static void complain_unknown(haft_case_reader *reader, const char *section, const char *leaf,
                             const char *path, haft_mark mark) {
    const char *known[HAFT_KEYS_MAX + HAFT_SECTIONS_MAX] = {NULL};
    const char *elsewhere = NULL;
    size_t n = 0;
    char all[256] = "";
    size_t used = 0;
    for (size_t i = 0; i < haft_case_key_count + haft_case_section_count; i++) {
        const char *candidate = i < haft_case_key_count
                                    ? haft_case_keys[i].path
                                    : haft_case_sections[i - haft_case_key_count].path;
        const char *name = haft_case_leaf(candidate);
        if (haft_case_is_member(candidate, section)) {
            int wrote = snprintf(all + used, sizeof all - used, "%s%s", n > 0 ? ", " : "", name);
            used = wrote < 0 || used + (size_t)wrote >= sizeof all ? sizeof all - 1
                                                                   : used + (size_t)wrote;
            known[n++] = name;
        } else if (strcmp(name, leaf) == 0) {
            elsewhere = candidate;
        }
    }
    const char *nearest = haft_case_nearest(leaf, known, n);
    if (elsewhere != NULL) {
        haft_case_complain(reader, mark, path, "is no key here; did you mean %s?", elsewhere);
    } else if (nearest != NULL) {
        haft_case_complain(reader, mark, path, "is no key; did you mean %s?", nearest);
    } else {
        haft_case_complain(reader, mark, path, "is no key; here are known: %s", all);
    }
}

static void complain_twice(haft_case_reader *reader, haft_mark mark, const char *path,
                           haft_mark first) {
    haft_case_complain(reader, mark, path, "is given twice, first at line %zu; leave one out",
                       first.line);
}

static void read_mapping(haft_case_reader *reader, yaml_document_t *document,
                         const yaml_node_t *mapping, const char *section);

static void read_section(haft_case_reader *reader, yaml_document_t *document, int section,
                         const yaml_node_t *node, haft_mark mark) {
    const char *path = haft_case_sections[section].path;
    if (reader->section_mark[section].line != 0) {
        complain_twice(reader, mark, path, reader->section_mark[section]);
        return;
    }
    reader->section_mark[section] = mark;
    if (node->type == YAML_MAPPING_NODE) {
        read_mapping(reader, document, node, path);
        return;
    }
    for (size_t i = 0; i < haft_case_key_count; i++) {
        const haft_key *key = &haft_case_keys[i];
        if (haft_case_is_member(key->path, path)) {
            haft_case_complain(reader, haft_case_mark_of(node->start_mark), path,
                               "is no mapping; write its keys below it, as in \"%s: %s\"",
                               haft_case_leaf(key->path), key->example);
            break;
        }
    }
    for (size_t i = 0; i < haft_case_key_count; i++) { /* one complaint is enough */
        if (strncmp(haft_case_keys[i].path, path, strlen(path)) == 0 &&
            haft_case_keys[i].path[strlen(path)] == '.') {
            reader->state[i] = HAFT_BAD;
        }
    }
}

static void read_pair(haft_case_reader *reader, yaml_document_t *document, const char *section,
                      const yaml_node_t *name, const yaml_node_t *value) {
    haft_mark mark = haft_case_mark_of(name->start_mark);
    const char *place = *section == '\0' ? "case" : section;
    if (name->type != YAML_SCALAR_NODE || name->data.scalar.length >= HAFT_KEY_CAPACITY / 2 ||
        strlen((const char *)name->data.scalar.value) != name->data.scalar.length ||
        name->data.scalar.length == 0 || strchr((const char *)name->data.scalar.value, '.')) {
        haft_case_complain(reader, mark, place, "has a key that is no plain word; leave it out");
        return;
    }
    const char *leaf = (const char *)name->data.scalar.value;
    if (*section == '\0' && strcmp(leaf, "sweep") == 0) {
        haft_case_read_sweep(reader, document, value, mark);
        return;
    }
    char path[HAFT_KEY_CAPACITY * 2];
    snprintf(path, sizeof path, "%s%s%s", section, *section == '\0' ? "" : ".", leaf);
    int key = haft_case_find_key(path), inner = haft_case_find_section(path);
    if (inner >= 0) {
        read_section(reader, document, inner, value, mark);
    } else if (key < 0) {
        complain_unknown(reader, section, leaf, path, mark);
    } else if (reader->state[key] != HAFT_UNSEEN) {
        complain_twice(reader, mark, path, reader->mark[key]);
    } else {
        reader->mark[key] = haft_case_mark_of(value->start_mark);
        reader->state[key] = read_value(reader, document, key, value) ? HAFT_GOOD : HAFT_BAD;
    }
}

static void read_mapping(haft_case_reader *reader, yaml_document_t *document,
                         const yaml_node_t *mapping, const char *section) {
    for (const yaml_node_pair_t *pair = mapping->data.mapping.pairs.start;
         pair < mapping->data.mapping.pairs.top; pair++) {
        read_pair(reader, document, section, yaml_document_get_node(document, pair->key),
                  yaml_document_get_node(document, pair->value));
    }
}

/* ---- missing keys ---- */

/* The section of a path, -1 for the top level. */
static int section_of(const char *path) {
    char name[HAFT_KEY_CAPACITY];
    snprintf(name, sizeof name, "%s", path);
    char *dot = strrchr(name, '.');
    if (dot == NULL) {
        return -1;
    }
    *dot = '\0';
    return haft_case_find_section(name);
}

static haft_mark place_of_section(const haft_case_reader *reader, int section) {
    return section < 0 ? (haft_mark){1, 1} : reader->section_mark[section];
}

static void complain_missing_section(haft_case_reader *reader, int section) {
    const char *path = haft_case_sections[section].path;
    char keys[200] = "";
    size_t used = 0;
    for (size_t i = 0; i < haft_case_key_count; i++) {
        const haft_key *key = &haft_case_keys[i];
        if (key->fallback == NULL && haft_case_is_member(key->path, path)) {
            int wrote = snprintf(keys + used, sizeof keys - used, "%s%s: %s", used > 0 ? ", " : "",
                                 haft_case_leaf(key->path), key->example);
            used = wrote < 0 || used + (size_t)wrote >= sizeof keys ? sizeof keys - 1
                                                                    : used + (size_t)wrote;
        }
    }
    haft_case_complain(reader, place_of_section(reader, section_of(path)), path,
                       "is missing; add \"%s: {%s}\"", haft_case_leaf(path), keys);
}

static void fill_in(haft_case_reader *reader, int index) {
    const haft_key *key = &haft_case_keys[index];
    reader->state[index] = HAFT_DEFAULTED;
    if (strcmp(key->fallback, "none") == 0 || key->type == HAFT_KEY_EVIDENCE) {
        return;
    }
    size_t entries = key->count > 0 ? key->count : 1;
    for (size_t i = 0; i < entries; i++) {
        (void)haft_case_store(reader, index, i, key->fallback, strlen(key->fallback),
                              reader->mark[index]);
    }
}

static void read_missing(haft_case_reader *reader) {
    for (size_t i = 0; i < haft_case_section_count; i++) {
        int parent = section_of(haft_case_sections[i].path);
        bool told = parent >= 0 && reader->section_mark[parent].line == 0;
        if (haft_case_sections[i].kind == HAFT_SECTION_REQUIRED &&
            reader->section_mark[i].line == 0 && !told) {
            complain_missing_section(reader, (int)i);
        }
    }
    for (size_t i = 0; i < haft_case_key_count; i++) {
        const haft_key *key = &haft_case_keys[i];
        int section = section_of(key->path);
        bool absent = section >= 0 && reader->section_mark[section].line == 0;
        if (reader->state[i] != HAFT_UNSEEN ||
            (absent && haft_case_sections[section].kind != HAFT_SECTION_OPTIONAL)) {
            continue;
        }
        reader->mark[i] = place_of_section(reader, section);
        if (key->fallback != NULL) {
            fill_in(reader, (int)i);
        } else {
            haft_case_complain(reader, reader->mark[i], key->path, "is missing; add \"%s: %s\"",
                               haft_case_leaf(key->path), key->example);
        }
    }
    const struct haft_case_sweep *sweep = &reader->c->sweep;
    for (size_t i = 0; i < sweep->keys; i++) {
        int section = section_of(sweep->key[i]);
        if (section >= 0 && reader->section_mark[section].line == 0 &&
            haft_case_sections[section].kind == HAFT_SECTION_SWITCH) {
            haft_case_complain(reader, reader->sweep_mark, "sweep",
                               "varies %s, but there is no section %s, whose absence turns it off; "
                               "add it, with its other keys",
                               sweep->key[i], haft_case_sections[section].path);
        }
    }
    int capillary = haft_case_find_section("contact.capillary");
    reader->c->contact.has_capillary = reader->section_mark[capillary].line != 0;
    int vdw = haft_case_find_section("contact.vdw");
    reader->c->contact.has_vdw = reader->section_mark[vdw].line != 0;
    int dispersion = haft_case_find_section("contact.dispersion");
    reader->c->contact.has_dispersion = reader->section_mark[dispersion].line != 0;
}

static void read_document(haft_case_reader *reader, yaml_document_t *document) {
    const yaml_node_t *root = yaml_document_get_root_node(document);
    if (root == NULL || root->type != YAML_MAPPING_NODE) {
        haft_case_complain(reader, (haft_mark){1, 1}, "case",
                           "is no mapping; a case begins with \"name: my-case\"");
        return;
    }
    read_mapping(reader, document, root, "");
    read_missing(reader);
    if (reader->failure == HAFT_OK) {
        haft_case_cross_check(reader);
    }
}

static haft_status parse(haft_case_reader *reader, const haft_case_text *text, const char *file,
                         haft_error *error) {
    yaml_parser_t parser;
    yaml_document_t document;
    if (!yaml_parser_initialize(&parser)) {
        return haft_error_set(error, HAFT_ERROR_MEMORY, "%s: out of memory", file);
    }
    haft_case_start_parser(&parser, text);
    haft_status status = HAFT_OK;
    if (yaml_parser_load(&parser, &document)) {
        read_document(reader, &document);
        yaml_document_delete(&document);
        status = reader->failure;
    } else {
        status = haft_case_parser_failed(&parser, file, error);
    }
    yaml_parser_delete(&parser);
    if (status == HAFT_OK && reader->complaints > 0) {
        status = haft_case_report(reader, file, error);
    }
    return status;
}

/* By default an active mesh begins at this share of the requested crack length. A beam loaded to
 * that crack length is far above its substrate there; if it is not, the solver reports it. */
#define ACTIVE_SHARE 0.5

/* With dispersion the beam is felt from farther, and the zone begins nearer the clamp: at six
 * tenths of the way to where the S shape from the clamp to the crack's tip, of height
 * h (1 - 3 x^2 + 2 x^3), comes into reach. */
#define FAR_SHARE 0.6

static double active_share(const haft_case *c) {
    double felt = c->contact.dispersion.reach / c->beam.gap, low = 0, high = 1;
    if (!c->contact.has_dispersion || !(felt < 1)) {
        return ACTIVE_SHARE;
    }
    while (high - low > 1e-6) {
        double x = 0.5 * (low + high);
        *(1 - x * x * (3 - 2 * x) > felt ? &low : &high) = x;
    }
    return fmin(ACTIVE_SHARE, FAR_SHARE * low);
}

static haft_status resolve(haft_case **out, const haft_case_text *text, const char *path,
                           size_t variant, haft_error *error) {
    haft_status status = HAFT_ERROR_MEMORY;
    haft_units *units = NULL;
    haft_case_reader *reader = haft_memory_alloc(1, sizeof *reader, error);
    haft_case *c = haft_memory_alloc(1, sizeof *c, error);
    if (reader != NULL && c != NULL) {
        status = haft_units_create(&units, error);
    }
    if (status == HAFT_OK) {
        haft_case_preset(c);
        reader->c = c;
        reader->path = path;
        c->sweep.variants = 1;
        c->sweep.variant = variant;
        reader->units = units;
        reader->error = error;
        status = parse(reader, text, path, error);
        c->mesh.active_from = active_share(c) * c->programme.crack_length;
    }
    if (status == HAFT_OK && variant >= c->sweep.variants) {
        status = haft_error_set(error, HAFT_ERROR_ARGUMENT, "%s: there is no variant %zu of %zu",
                                path, variant, c->sweep.variants);
    }
    haft_units_destroy(&units);
    if (reader != NULL) {
        haft_memory_free(reader->evidence_mark);
    }
    haft_memory_free(reader);
    if (status != HAFT_OK) {
        haft_case_destroy(&c);
    }
    *out = c;
    return status;
}

haft_status haft_case_read(haft_case **out, const char *path, haft_error *error) {
    return haft_case_read_variant(out, path, 0, error);
}

haft_status haft_case_read_variant(haft_case **out, const char *path, size_t variant,
                                   haft_error *error) {
    *out = NULL;
    haft_case_text text;
    HAFT_TRY(haft_case_load(&text, path, error));
    haft_status status = resolve(out, &text, path, variant, error);
    haft_memory_free(text.bytes);
    return status;
}

void haft_case_destroy(haft_case **c) {
    if (c != NULL && *c != NULL) {
        haft_memory_free((*c)->evidence.realization);
        haft_memory_free((*c)->contact.film_data);
        haft_memory_free((*c)->contact.far);
        haft_psd_table_destroy(&(*c)->surface.table);
        haft_marginal_destroy(&(*c)->surface.distribution);
        for (size_t k = 0; k < HAFT_FILES_MAX; k++) {
            haft_map_destroy(&(*c)->surface.map.map[k]);
            haft_map_destroy(&(*c)->surface.opposite.map[k]);
        }
        haft_memory_free(*c);
        *c = NULL;
    }
}
