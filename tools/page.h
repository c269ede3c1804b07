/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One HTML page that contains all it shows: style, text, figures. */
#ifndef HAFT_TOOLS_PAGE_H
#define HAFT_TOOLS_PAGE_H

#include "haft/base.h"

#include <stdbool.h>
#include <stdio.h>

typedef struct page {
    FILE *stream; /* in memory */
    char *text;
    size_t size;
    unsigned figures;
    bool failed; /* out of memory for a text or a picture */
} page;

/* Begins a page: head, style, heading. @return HAFT_ERROR_MEMORY. */
haft_status page_open(page *p, const char *title, haft_error *error);

/* Writes markup unchanged; only for markup that the program itself makes. */
void page_markup(page *p, const char *markup);

/* Writes text, as printf does, and escapes what HTML would read as markup. */
void page_text(page *p, const char *format, ...) HAFT_PRINTF(2, 3);

/* <tag class="kind">text</tag>; kind may be NULL. */
void page_element(page *p, const char *tag, const char *kind, const char *format, ...)
    HAFT_PRINTF(4, 5);

/* Puts the picture at `path` into the page, with its caption: SVG unchanged, PNG encoded.
 * @return false, with nothing written, if it cannot be read */
bool page_figure(page *p, const char *path, const char *caption);

/* Ends the page and writes it, all or nothing. The page is freed in any case. */
haft_status page_store(page *p, const char *path, haft_error *error);

#endif
