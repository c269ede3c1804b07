/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A sweep: keys by their dotted paths, each with a list of values. One reading of the file resolves
 * one variant. Its values are read as if they were written at their keys, so that they are checked
 * like any other value and a variant is an ordinary case. */
#include "case_text.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

const char *haft_sweep_leaf(const struct haft_case_sweep *sweep, size_t key) {
    return haft_case_leaf(sweep->key[key]);
}

static bool can_be_swept(const haft_key *key) {
    bool number = key->type == HAFT_KEY_REAL && key->count == 0;
    return number || key->type == HAFT_KEY_COUNT || key->type == HAFT_KEY_CHOICE ||
           key->type == HAFT_KEY_SEED;
}

static void complain_unknown(haft_case_reader *reader, const char *path, haft_mark mark) {
    const char *known[HAFT_KEYS_MAX] = {NULL}, *same_leaf = NULL;
    size_t n = 0;
    for (size_t i = 0; i < haft_case_key_count; i++) {
        if (can_be_swept(&haft_case_keys[i])) {
            known[n++] = haft_case_keys[i].path;
            bool same = strcmp(haft_case_leaf(known[n - 1]), haft_case_leaf(path)) == 0;
            same_leaf = same ? known[n - 1] : same_leaf;
        }
    }
    const char *nearest = haft_case_nearest(path, known, n);
    nearest = nearest != NULL ? nearest : same_leaf;
    if (nearest != NULL) {
        haft_case_complain(reader, mark, "sweep", "cannot vary \"%.60s\"; did you mean %s?", path,
                           nearest);
    } else {
        haft_case_complain(reader, mark, "sweep",
                           "cannot vary \"%.60s\"; give the whole path of a number or a choice, as "
                           "in \"beam.l_meso: [3 um, 6 um]\"",
                           path);
    }
}

/* Adds "_leaf-value" to the label, without characters that do not belong in a folder name. */
static void add_to_label(struct haft_case_sweep *sweep, const char *leaf, const char *value) {
    char text[HAFT_LABEL_CAPACITY * 2];
    snprintf(text, sizeof text, "_%s-%s", leaf, value);
    size_t used = strlen(sweep->label);
    for (const char *c = text; *c != '\0' && used + 1 < sizeof sweep->label; c++) {
        if (isalnum((unsigned char)*c) || strchr(".+-_%", *c) != NULL) {
            sweep->label[used++] = *c;
        }
    }
    sweep->label[used] = '\0';
}

/* Checks the list of a key. @return its number of values, 0 if it is not a list */
static size_t count_values(haft_case_reader *reader, yaml_document_t *document, const char *path,
                           const yaml_node_t *list) {
    haft_mark mark = haft_case_mark_of(list->start_mark);
    if (list->type != YAML_SEQUENCE_NODE) {
        haft_case_complain(reader, mark, path, "is no list of values; write \"%s: [...]\"", path);
        return 0;
    }
    const yaml_node_item_t *item = list->data.sequence.items.start;
    size_t n = (size_t)(list->data.sequence.items.top - item);
    if (n < 1 || n > HAFT_VARIANTS_MAX) {
        haft_case_complain(reader, mark, path, "has %zu values; give 1 to %d", n,
                           HAFT_VARIANTS_MAX);
        return 0;
    }
    for (size_t i = 0; i < n; i++) {
        const yaml_node_t *entry = yaml_document_get_node(document, item[i]);
        if (entry->type != YAML_SCALAR_NODE) {
            haft_case_complain(reader, haft_case_mark_of(entry->start_mark), path,
                               "holds more than a value; write a list of values");
            return 0;
        }
    }
    return n;
}

/* Stores the value of the current variant in its key. */
static void take_value(haft_case_reader *reader, yaml_document_t *document, int key,
                       const yaml_node_t *list) {
    const haft_key *k = &haft_case_keys[key];
    struct haft_case_sweep *sweep = &reader->c->sweep;
    const yaml_node_t *entry =
        yaml_document_get_node(document, list->data.sequence.items.start[sweep->variant]);
    const char *text = (const char *)entry->data.scalar.value;
    reader->mark[key] = haft_case_mark_of(entry->start_mark);
    bool good = haft_case_store(reader, key, 0, text, entry->data.scalar.length, reader->mark[key]);
    reader->state[key] = good ? HAFT_GOOD : HAFT_BAD;
    sweep->key[sweep->keys] = k->path;
    sweep->unit[sweep->keys] = k->unit != NULL ? k->unit : "1";
    sweep->choice[sweep->keys] = k->type == HAFT_KEY_CHOICE;
    if (good) {
        sweep->value[sweep->keys] = haft_case_number(reader->c, k);
    }
    (void)haft_text_quote(sweep->text[sweep->keys], sizeof sweep->text[0], text, strlen(text));
    sweep->keys++;
    if (strncmp(k->path, "reference.", strlen("reference.")) !=
        0) { /* references do not change results */
        add_to_label(sweep, haft_case_leaf(k->path), text);
    }
}

static void read_swept_key(haft_case_reader *reader, yaml_document_t *document,
                           const yaml_node_t *name, const yaml_node_t *list) {
    haft_mark mark = haft_case_mark_of(name->start_mark);
    struct haft_case_sweep *sweep = &reader->c->sweep;
    if (name->type != YAML_SCALAR_NODE) {
        haft_case_complain(reader, mark, "sweep", "has a key that is no plain word; leave it out");
        return;
    }
    const char *path = (const char *)name->data.scalar.value;
    int key = haft_case_find_key(path);
    if (key < 0 || !can_be_swept(&haft_case_keys[key])) {
        complain_unknown(reader, path, mark);
        return;
    }
    if (reader->state[key] != HAFT_UNSEEN) {
        haft_case_complain(reader, mark, path, "is given twice, first at line %zu; leave one out",
                           reader->mark[key].line);
        return;
    }
    reader->state[key] = HAFT_BAD;
    size_t n = count_values(reader, document, path, list);
    if (n == 0) {
        return;
    }
    if (sweep->keys == HAFT_SWEPT_KEYS_MAX) {
        haft_case_complain(reader, mark, "sweep", "varies more than %d keys", HAFT_SWEPT_KEYS_MAX);
        return;
    }
    if (sweep->keys > 0 && n != sweep->variants) {
        haft_case_complain(reader, mark, path, "has %zu values where %s has %zu; give as many", n,
                           sweep->key[0], sweep->variants);
        return;
    }
    sweep->variants = n;
    if (sweep->variant < n) {
        take_value(reader, document, key, list);
    }
}

void haft_case_read_sweep(haft_case_reader *reader, yaml_document_t *document,
                          const yaml_node_t *node, haft_mark mark) {
    if (reader->sweep_mark.line != 0) {
        haft_case_complain(reader, mark, "sweep",
                           "is given twice, first at line %zu; leave one out",
                           reader->sweep_mark.line);
        return;
    }
    reader->sweep_mark = mark;
    struct haft_case_sweep *sweep = &reader->c->sweep;
    snprintf(sweep->label, sizeof sweep->label, "%02zu", sweep->variant);
    bool empty = node->type != YAML_MAPPING_NODE ||
                 node->data.mapping.pairs.start == node->data.mapping.pairs.top;
    if (empty) {
        haft_case_complain(reader, mark, "sweep",
                           "varies nothing; write keys and their values below it, as in "
                           "\"beam.l_meso: [3 um, 6 um]\"");
        return;
    }
    for (const yaml_node_pair_t *pair = node->data.mapping.pairs.start;
         pair < node->data.mapping.pairs.top; pair++) {
        read_swept_key(reader, document, yaml_document_get_node(document, pair->key),
                       yaml_document_get_node(document, pair->value));
    }
}
