/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks the text of a case.yaml before the schema applies. It must be a regular file of limited
 * size, in UTF-8 (or UTF-16 with a byte order mark). Its YAML events must form one document without
 * anchors, tags or deep nesting, so that the tree that libyaml builds of it is small. The first
 * error ends the reading, with its line and column. */
#include "case_text.h"
#include "text.h"

haft_mark haft_case_mark_of(yaml_mark_t mark) {
    return (haft_mark){mark.line + 1, mark.column + 1};
}

/* ---- bytes ---- */

/* Complains of the first byte that is not UTF-8 text. */
static haft_status check_characters(const haft_case_text *text, const char *file,
                                    haft_error *error) {
    size_t line = 1, column = 1;
    for (size_t i = 0; i < text->size;) {
        uint32_t code = 0;
        const char *at = text->bytes + i;
        size_t n = haft_text_character(at, text->size - i, &code);
        if (n == 0 || code == 0) {
            return haft_error_set(error, HAFT_ERROR_INPUT,
                                  "%s:%zu:%zu: byte 0x%02x is not UTF-8 text; save the file as "
                                  "UTF-8",
                                  file, line, column, (unsigned char)*at);
        }
        column = code == '\n' ? 1 : column + 1;
        line += code == '\n';
        i += n;
    }
    return HAFT_OK;
}

/* ---- YAML ---- */

void haft_case_start_parser(yaml_parser_t *parser, const haft_case_text *text) {
    yaml_parser_set_encoding(parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(parser, (const unsigned char *)text->bytes, text->size);
}

haft_status haft_case_parser_failed(const yaml_parser_t *parser, const char *file,
                                    haft_error *error) {
    if (parser->error == YAML_MEMORY_ERROR) {
        return haft_error_set(error, HAFT_ERROR_MEMORY, "%s: out of memory", file);
    }
    haft_mark mark = haft_case_mark_of(parser->problem_mark);
    const char *context = parser->context;
    return haft_error_set(error, HAFT_ERROR_INPUT, "%s:%zu:%zu: is no valid YAML: %s%s%s", file,
                          mark.line, mark.column,
                          parser->problem != NULL ? parser->problem : "cannot be read",
                          context != NULL ? " " : "", context != NULL ? context : "");
}

/* The name of a YAML feature that a case must not use; NULL if the event is allowed. */
static const char *forbidden(const yaml_event_t *event, size_t documents, size_t depth) {
    const yaml_char_t *anchor = NULL, *tag = NULL;
    switch (event->type) {
    case YAML_ALIAS_EVENT:
        return "uses an alias (*name); write the value itself";
    case YAML_SCALAR_EVENT:
        anchor = event->data.scalar.anchor;
        tag = event->data.scalar.tag;
        break;
    case YAML_SEQUENCE_START_EVENT:
        anchor = event->data.sequence_start.anchor;
        tag = event->data.sequence_start.tag;
        break;
    case YAML_MAPPING_START_EVENT:
        anchor = event->data.mapping_start.anchor;
        tag = event->data.mapping_start.tag;
        break;
    default:
        break;
    }
    return anchor != NULL                  ? "uses an anchor (&name); write the value itself"
           : tag != NULL                   ? "uses a tag (!name); leave it out"
           : documents > 1                 ? "begins a second document; a case is one document"
           : depth > HAFT_CASE_DEPTH_LIMIT ? "is nested too deeply; no key of a case is"
                                           : NULL;
}

static haft_status check_events(const haft_case_text *text, const char *file, haft_error *error) {
    yaml_parser_t parser;
    if (!yaml_parser_initialize(&parser)) {
        return haft_error_set(error, HAFT_ERROR_MEMORY, "%s: out of memory", file);
    }
    haft_case_start_parser(&parser, text);
    haft_status status = HAFT_OK;
    size_t documents = 0, depth = 0;
    for (bool more = true; more && status == HAFT_OK;) {
        yaml_event_t event;
        if (!yaml_parser_parse(&parser, &event)) {
            status = haft_case_parser_failed(&parser, file, error);
            break;
        }
        documents += event.type == YAML_DOCUMENT_START_EVENT;
        depth += event.type == YAML_SEQUENCE_START_EVENT || event.type == YAML_MAPPING_START_EVENT;
        depth -= event.type == YAML_SEQUENCE_END_EVENT || event.type == YAML_MAPPING_END_EVENT;
        const char *problem = forbidden(&event, documents, depth);
        if (problem != NULL) {
            haft_mark mark = haft_case_mark_of(event.start_mark);
            status = haft_error_set(error, HAFT_ERROR_INPUT, "%s:%zu:%zu: %s", file, mark.line,
                                    mark.column, problem);
        }
        more = event.type != YAML_STREAM_END_EVENT;
        yaml_event_delete(&event);
    }
    yaml_parser_delete(&parser);
    if (status == HAFT_OK && documents == 0) {
        status = haft_error_set(error, HAFT_ERROR_INPUT,
                                "%s:1:1: is empty; a case begins with \"name: my-case\"", file);
    }
    return status;
}

haft_status haft_case_load(haft_case_text *out, const char *path, haft_error *error) {
    haft_status status = haft_file_read(&out->bytes, &out->size, path, HAFT_CASE_SIZE_LIMIT, error);
    HAFT_THEN(status, haft_text_decode(&out->bytes, &out->size, path, error));
    HAFT_THEN(status, check_characters(out, path, error));
    HAFT_THEN(status, check_events(out, path, error));
    if (status != HAFT_OK) {
        haft_memory_free(out->bytes);
        out->bytes = NULL;
    }
    return status;
}
