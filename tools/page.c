/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes HTML that needs no other file; the policy in its head forbids the browser to fetch one.
 * Pictures keep a white background in the dark scheme, since their colours are made for it. */
#include "page.h"

#include "haft/io.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static const size_t PICTURE_MOST = (size_t)1 << 28;

static const char HEAD[] =
    "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
    "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
    "<meta name=\"color-scheme\" content=\"light dark\">\n"
    "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
    "style-src 'unsafe-inline'\">\n";

static const char STYLE[] =
    "<style>\n"
    ":root{--paper:#fff;--ink:#1b1f24;--soft:#57606a;--line:#d0d7de;--panel:#f4f6f8;"
    "--good:#116329;--wary:#7d4e00;--bad:#a40e26}\n"
    "@media screen and (prefers-color-scheme:dark){:root{--paper:#14181d;--ink:#e6e9ed;"
    "--soft:#a3adb8;--line:#3a424b;--panel:#1e242b;--good:#6fdd8b;--wary:#f0b95b;--bad:#ff9a94}}\n"
    "*{box-sizing:border-box}\n"
    "body{margin:0;background:var(--paper);color:var(--ink);font:1rem/1.5 system-ui,"
    "'DejaVu Sans',sans-serif;overflow-wrap:break-word}\n"
    "main{max-width:62rem;margin:0 auto;padding:1rem}\n"
    "h1{font-size:1.6rem;line-height:1.2;margin:.6rem 0}h2{font-size:1.2rem;margin:2rem 0 .6rem;"
    "border-bottom:1px solid var(--line);padding-bottom:.2rem}\n"
    "p{margin:.5rem 0}.soft{color:var(--soft);font-size:.9rem}\n"
    ".cards{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(15rem,100%),1fr));"
    "gap:.8rem;margin:1rem 0}\n"
    ".card{background:var(--panel);border:1px solid var(--line);border-radius:.4rem;"
    "padding:.8rem}\n"
    ".card b{display:block;font-size:1.7rem;line-height:1.2}.card span{display:block}\n"
    ".check{border-left:.35rem solid var(--line);padding:.1rem 0 .1rem .8rem;margin:.8rem 0;"
    "break-inside:avoid}\n"
    ".check strong{display:block}.check em{font-style:normal;font-weight:600}\n"
    ".holds{border-color:var(--good)}.holds em{color:var(--good)}\n"
    ".doubtful,.untold{border-color:var(--wary)}.doubtful em,.untold em{color:var(--wary)}\n"
    ".broken{border-color:var(--bad)}.broken em{color:var(--bad)}\n"
    ".wide{overflow-x:auto}table{border-collapse:collapse;width:100%;font-size:.92rem}\n"
    "th,td{padding:.3rem .6rem;border-bottom:1px solid var(--line);text-align:right;"
    "vertical-align:top;white-space:nowrap}th{text-align:right}\n"
    "th:first-child,td:first-child,td.say,th.say{text-align:left}td.say{white-space:normal;"
    "overflow-wrap:anywhere;min-width:13rem}.facts td.say{min-width:0}.facts "
    "td{white-space:normal}\n"
    "tr.sum td{font-weight:600}\n"
    "figure{margin:1.2rem 0;break-inside:avoid}.picture{overflow-x:auto;background:#fff;"
    "border:1px solid var(--line);border-radius:.4rem}\n"
    ".picture svg,.picture img{display:block;width:100%;min-width:40rem;height:auto}\n"
    ".picture img{max-width:48rem;margin:0 auto}\n"
    "figcaption{color:var(--soft);font-size:.9rem;margin-top:.3rem}\n"
    "pre{background:var(--panel);border:1px solid var(--line);border-radius:.4rem;"
    "padding:.8rem;font-size:.8rem;white-space:pre-wrap;overflow-wrap:anywhere}\n"
    "@media print{body{font-size:10pt}main{max-width:none;padding:0}.picture{overflow:visible;"
    "border:0}.picture svg,.picture img{min-width:0}.wide{overflow:visible}"
    "th,td{padding:.15rem .35rem}h2{break-after:avoid}tr{break-inside:avoid}}\n"
    "</style>\n</head>\n<body>\n<main>\n";

haft_status page_open(page *p, const char *title, haft_error *error) {
    *p = (page){0};
    p->stream = open_memstream(&p->text, &p->size);
    if (p->stream == NULL) {
        return haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for a page");
    }
    page_markup(p, HEAD);
    page_element(p, "title", NULL, "%s", title);
    page_markup(p, STYLE);
    page_element(p, "h1", NULL, "%s", title);
    return HAFT_OK;
}

/* All output to the page goes through here. If the memory stream cannot grow, fwrite() reports it
 * here and perhaps never again; so the failure is kept for page_store(). */
static void put(page *p, const char *text, size_t size) {
    p->failed |= fwrite(text, 1, size, p->stream) != size;
}

void page_markup(page *p, const char *markup) {
    put(p, markup, strlen(markup));
}

/* Keeps line breaks, which a resolved case has; other characters that cannot be shown are spelled
 * out. */
static void write_escaped(page *p, const char *text) {
    size_t left = strlen(text);
    while (left > 0) {
        char spelled[HAFT_SPELLED_CAPACITY];
        size_t n = haft_text_spell(spelled, text, left);
        switch (*text) {
        case '\n':
            page_markup(p, "\n");
            break;
        case '&':
            page_markup(p, "&amp;");
            break;
        case '<':
            page_markup(p, "&lt;");
            break;
        case '>':
            page_markup(p, "&gt;");
            break;
        case '"':
            page_markup(p, "&quot;");
            break;
        case '\'':
            page_markup(p, "&#39;");
            break;
        default:
            page_markup(p, spelled);
        }
        text += n;
        left -= n;
    }
}

static void write_formatted(page *p, const char *format, va_list args) HAFT_PRINTF(2, 0);

static void write_formatted(page *p, const char *format, va_list args) {
    char *text = NULL;
    if (vasprintf(&text, format, args) < 0) {
        p->failed = true;
        return;
    }
    write_escaped(p, text);
    free(text);
}

void page_text(page *p, const char *format, ...) {
    va_list args;
    va_start(args, format);
    write_formatted(p, format, args);
    va_end(args);
}

void page_element(page *p, const char *tag, const char *kind, const char *format, ...) {
    page_markup(p, "<");
    page_markup(p, tag);
    if (kind != NULL) {
        page_markup(p, " class=\"");
        page_markup(p, kind);
        page_markup(p, "\"");
    }
    page_markup(p, ">");
    va_list args;
    va_start(args, format);
    write_formatted(p, format, args);
    va_end(args);
    page_markup(p, "</");
    page_markup(p, tag);
    page_markup(p, ">\n");
}

/* ---- pictures ---- */

static void write_base64(page *p, const unsigned char *data, size_t size) {
    static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        size_t n = size - i;
        unsigned long bits = (unsigned long)data[i] << 16;
        bits |= n > 1 ? (unsigned long)data[i + 1] << 8 : 0;
        bits |= n > 2 ? data[i + 2] : 0;
        char four[4] = {digit[bits >> 18 & 63], digit[bits >> 12 & 63],
                        n > 1 ? digit[bits >> 6 & 63] : '=', n > 2 ? digit[bits & 63] : '='};
        put(p, four, 4);
    }
}

/* Numbers the names inside a picture, so that equal names in two pictures do not clash. */
static void write_svg(page *p, const char *svg) {
    static const char *const opens[] = {"id=\"", "id='", "href=\"#", "href='#", "url(#", "url('#"};
    while (*svg != '\0') {
        size_t length = 0;
        for (size_t i = 0; i < sizeof opens / sizeof *opens && length == 0; i++) {
            size_t n = strlen(opens[i]);
            length = strncmp(svg, opens[i], n) == 0 ? n : 0;
        }
        if (length > 0) {
            char number[24];
            put(p, svg, length);
            snprintf(number, sizeof number, "f%u-", p->figures);
            page_markup(p, number);
            svg += length;
        } else {
            put(p, svg++, 1);
        }
    }
}

bool page_figure(page *p, const char *path, const char *caption) {
    size_t size = 0, length = strlen(path);
    char *data = NULL;
    p->failed |= haft_file_read(&data, &size, path, PICTURE_MOST, NULL) == HAFT_ERROR_MEMORY;
    const char *svg = NULL;
    bool vector = length > 4 && strcmp(path + length - 4, ".svg") == 0;
    if (data != NULL && vector) {
        svg = strstr(data, "<svg");
    }
    if (data == NULL || (vector && svg == NULL)) {
        haft_memory_free(data);
        return false;
    }
    p->figures++;
    page_markup(p, "<figure>\n<div class=\"picture\">");
    if (vector) {
        write_svg(p, svg);
    } else {
        page_markup(p, "<img alt=\"");
        page_text(p, "%s", caption);
        page_markup(p, "\" src=\"data:image/png;base64,");
        write_base64(p, (const unsigned char *)data, size);
        page_markup(p, "\">");
    }
    page_markup(p, "</div>\n");
    page_element(p, "figcaption", NULL, "%s", caption);
    page_markup(p, "</figure>\n");
    haft_memory_free(data);
    return true;
}

haft_status page_store(page *p, const char *path, haft_error *error) {
    page_markup(p, "</main>\n</body>\n</html>\n");
    bool failed = p->failed || ferror(p->stream) != 0;
    failed = fclose(p->stream) != 0 || failed || p->text == NULL; /* fclose() may hide an error */
    p->stream = NULL;
    haft_status status =
        failed ? haft_error_set(error, HAFT_ERROR_MEMORY, "out of memory for %s", path)
               : haft_text_write(path, p->text, error);
    free(p->text);
    *p = (page){0};
    return status;
}
