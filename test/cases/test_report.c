/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The report page: it says what the run says, holds all it shows, and lets no text of the case
 * become markup. Where Chromium is installed the page is laid out, at a desk's and a phone's width:
 * nothing sticks out, and no label of a figure is cut. */
#include "program.h"

#include "haft/study.h"

static const edit nasty[] = {{"title: DelRio cantilevers, RH 85 %, explicit force laws",
                              "title: \"Beams <script>alert(1)</script> & \\\"x\\\" 'y' &amp;\""},
                             {0}};

static bool have(const char *program) {
    char command[100];
    snprintf(command, sizeof command, "command -v %s > /dev/null 2>&1", program);
    return system(command) == 0;
}

static char *read_page(const case_folder *c) {
    char path[400];
    return read_whole_file(path_in(c, "out/report.html", path), NULL);
}

static size_t count(const char *text, const char *what) {
    size_t n = 0;
    for (const char *at = strstr(text, what); at != NULL; at = strstr(at + 1, what)) {
        n++;
    }
    return n;
}

/* Everything an attribute could fetch is in the page itself. */
static void check_fetches_nothing(const char *page) {
    static const char *const attributes[] = {"src=\"", "src='", "href=\"", "href='"};
    for (size_t i = 0; i < sizeof attributes / sizeof *attributes; i++) {
        for (const char *at = strstr(page, attributes[i]); at != NULL;
             at = strstr(at + 1, attributes[i])) {
            const char *value = at + strlen(attributes[i]);
            assert_true(value[0] == '#' || strncmp(value, "data:", 5) == 0);
        }
    }
    assert_null(strstr(page, "<link"));
    assert_null(strstr(page, "<script"));
    assert_null(strstr(page, "@import"));
}

/* Names are given once; what is pointed at is there. */
static void check_names(const char *page) {
    for (const char *at = strstr(page, "id='f"); at != NULL; at = strstr(at + 1, "id='f")) {
        char name[64];
        snprintf(name, sizeof name, "id='%.*s'", (int)strcspn(at + 4, "'"), at + 4);
        assert_int_equal(count(page, name), 1);
    }
    for (const char *at = strstr(page, "href='#"); at != NULL; at = strstr(at + 1, "href='#")) {
        char name[64];
        snprintf(name, sizeof name, "id='%.*s'", (int)strcspn(at + 7, "'"), at + 7);
        assert_int_equal(count(page, name), 1);
    }
}

/* Without gnuplot on the path, which takes longer than all else: the page says so. */
static void report_undrawn(const case_folder *c) {
    char command[800];
    snprintf(command, sizeof command, "PATH=/nowhere exec '%s' report --quiet '%s'", HAFT, c->path);
    ran r = run_expect(0, "/bin/sh", ARGS("-c", command));
    check_says(r.err, "gnuplot cannot be run");
    ran_free(&r);
}

static void a_run_is_reported(void **state) {
    (void)state;
    case_folder c = case_create(nasty);
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    ran r = run_expect(0, HAFT, ARGS("report", c.path));
    check_says(r.out, "out/report.html");
    ran_free(&r);
    char *page = read_page(&c), text[100];
    check_says(page, "<h1>Beams &lt;script&gt;alert(1)&lt;/script&gt; &amp; &quot;x&quot; "
                     "&#39;y&#39; &amp;amp;</h1>");
    check_fetches_nothing(page);
    check_names(page);
    r = run_expect(0, HAFT, ARGS("info", "--json", c.path));
    snprintf(text, sizeof text, "<b>%.1f µm</b>", json_number(r.out, "crack_length_mean_m") * 1e6);
    check_says(page, text);
    snprintf(text, sizeof text, "<b>%.3g mJ/m²</b>", json_number(r.out, "gamma_J_per_m2") * 1e3);
    check_says(page, text);
    snprintf(text, sizeof text, "%.1f to %.1f µm",
             json_number(r.out, "crack_length_mean_low_m") * 1e6,
             json_number(r.out, "crack_length_mean_high_m") * 1e6);
    check_says(page, text);
    ran_free(&r);
    check_says(page, "Not measured yet: `haft budget`");
    check_says(page, "doubtful"); /* of 2 beams */
    check_says(page, "seed");
    check_says(page, "grid_step: ");
    assert_true(count(page, "<svg") == (have("gnuplot") ? 6 : 0));
    free(page);
    case_remove(&c);
}

static void a_budget_is_part_of_it_while_it_is_the_cases_own(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    must_run(HAFT, ARGS("budget", "--quiet", "--beams", "2", c.path));
    report_undrawn(&c);
    char *page = read_page(&c);
    check_says(page, "all refinements at once");
    check_says(page, "10 nm to 5 nm");
    free(page);

    /* other inputs: results are refused, and after a new run the budget is stale */
    case_write(&c, (edit[]){{"seed: 85", "seed: 86"}, {0}});
    ran r = run_expect(3, HAFT, ARGS("report", c.path));
    check_says(r.err, "is of another case than there is now");
    ran_free(&r);
    must_run(HAFT, ARGS("run", "--quiet", "--force", c.path));
    report_undrawn(&c);
    page = read_page(&c);
    check_says(page, "There is one, but of another case");
    check_silent_about(page, "all refinements at once");
    free(page);
    case_remove(&c);
}

static void what_cannot_be_reported_is_told(void **state) {
    (void)state;
    case_folder c = case_create(NULL);
    ran r = run_expect(4, HAFT, ARGS("report", c.path));
    check_says(r.err, "results.h5");
    ran_free(&r);
    assert_false(exists(&c, "out"));
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    r = run_expect(3, HAFT, ARGS("report", "--realization", "7", c.path));
    check_says(r.err, "there is no realization 7");
    ran_free(&r);
    assert_false(exists(&c, "out/report.html"));
    report_undrawn(&c);
    char *page = read_page(&c);
    check_says(page, "They could not be drawn");
    assert_int_equal(count(page, "<svg"), 0);
    free(page);
    case_remove(&c);
}

/* Beams that all let go have no crack length; the page still says what is known. */
static void free_beams_are_reported_too(void **state) {
    (void)state;
    case_folder c = case_create((edit[]){{"thickness: 1 um", "thickness: 10 um"}, {0}});
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    report_undrawn(&c);
    char *page = read_page(&c);
    check_says(page, "no beam stuck");
    check_says(page, "None of 2 beams stuck");
    check_silent_about(page, "nan");
    free(page);
    case_remove(&c);
}

/* ---- in a browser ---- */

/* Shows the page in a frame and puts into the title what the layout is like: the page's width, its
 * first heading, how many texts of figures stick out of their figure. */
static const char FRAME[] =
    "<!doctype html><title>none</title><body><iframe src=\"report.html\" width=\"%d\" "
    "height=\"3000\" style=\"border:0\"></iframe><script>"
    "window.onload=()=>{const d=document.querySelector('iframe').contentDocument;let "
    "n=0,out=0,which='';"
    "for(const s of d.querySelectorAll('svg')){const b=s.getBoundingClientRect();"
    "for(const t of s.querySelectorAll('text')){const r=t.getBoundingClientRect();n++;"
    "if(r.width>0&&(r.left<b.left-1||r.right>b.right+1||r.top<b.top-1||r.bottom>b.bottom+1))"
    "{out++;which+=t.textContent+'; ';}}}"
    "document.title='wide '+d.documentElement.scrollWidth+' texts '+n+' out '+out+' '+which+' "
    "heading '+"
    "d.querySelector('h1').textContent}</script></body>";

static void the_page_is_laid_out_within_its_width(void **state) {
    (void)state;
    if (!have("chromium") || !have("gnuplot")) {
        print_message("chromium or gnuplot is not installed: the page is not laid out\n");
        skip();
    }
    case_folder c = case_create((edit[]){nasty[0], {"realizations: 2", "realizations: 3"}, {0}});
    must_run(HAFT, ARGS("run", "--quiet", c.path));
    must_run(HAFT, ARGS("budget", "--quiet", "--beams", "2", c.path));
    must_run(HAFT, ARGS("report", "--quiet", c.path));
    static const int widths[] = {360, 1200};
    for (size_t i = 0; i < sizeof widths / sizeof *widths; i++) {
        char frame[sizeof FRAME + 20], path[400], command[1600];
        snprintf(frame, sizeof frame, FRAME, widths[i]);
        write_file(path_in(&c, "out/frame.html", path), frame, strlen(frame));
        snprintf(command, sizeof command,
                 "exec chromium --headless --no-sandbox --disable-gpu --user-data-dir='%s/browser' "
                 "--allow-file-access-from-files --virtual-time-budget=20000 --dump-dom "
                 "'file://%s' 2>/dev/null",
                 c.top.folder, path);
        ran r = run_expect(0, "/bin/sh", ARGS("-c", command));
        int wide = 0, texts = 0, out = -1;
        const char *title = strstr(r.out, "<title>wide ");
        if (title == NULL) {
            fail_msg("the page was not shown:\n%.2000s", r.out);
        }
        assert_int_equal(sscanf(title, "<title>wide %d texts %d out %d", &wide, &texts, &out), 3);
        assert_true(wide <= widths[i]);
        assert_true(texts > 50);
        if (out != 0) {
            fail_msg("texts of figures stick out: %.300s", title);
        }
        check_says(title, "heading Beams &lt;script&gt;alert(1)&lt;/script&gt; &amp; \"x\" 'y' "
                          "&amp;amp;</title>");
        ran_free(&r);
    }
    case_remove(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_run_is_reported),
        cmocka_unit_test(a_budget_is_part_of_it_while_it_is_the_cases_own),
        cmocka_unit_test(what_cannot_be_reported_is_told),
        cmocka_unit_test(free_beams_are_reported_too),
        cmocka_unit_test(the_page_is_laid_out_within_its_width),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
