/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The text of a case.yaml, and its parsing by libyaml. Private to this room. */
#ifndef HAFT_IO_CASE_TEXT_H
#define HAFT_IO_CASE_TEXT_H

#include "case.h"

#include <yaml.h>

/* Bytes of a file, followed by a 0. */
typedef struct haft_case_text {
    char *bytes;
    size_t size;
} haft_case_text;

/* Reads a file and checks that it is one plain YAML document; the caller frees the bytes. */
haft_status haft_case_load(haft_case_text *out, const char *path, haft_error *error);

void haft_case_start_parser(yaml_parser_t *parser, const haft_case_text *text);

/* The error of a parser that has failed. */
haft_status haft_case_parser_failed(const yaml_parser_t *parser, const char *file,
                                    haft_error *error);

haft_mark haft_case_mark_of(yaml_mark_t mark);

/* Reads the node of the key `sweep`: counts its variants, and takes the values of the one that
 * reader->c->sweep.variant names. */
void haft_case_read_sweep(haft_case_reader *reader, yaml_document_t *document,
                          const yaml_node_t *node, haft_mark mark);

#endif
